"""Building works in 2D plans: lines end at the jambs, one undo step takes all of it back."""

import Draft
import Part
import pytest
from conftest import V
from enfilade import accept, document, marks
from enfilade_common.model import PluginError, Wishes
from rounds import work, written
from test_plan2d import draw, places

KINDS = ("draft", "shapes")


def ends(doc):
    """Every straight line that is drawn, however it is cut into objects."""
    out = set()
    for element in document.read(doc).elements():
        for stroke in (s for s in element.strokes if s.kind == "lines"):
            ring = stroke.points + (stroke.points[:1] if stroke.closed else [])
            out |= {tuple(sorted((round(x), round(y)) for x, y in pair)) for pair in zip(ring, ring[1:])}
    return out


def accepted(doc, folder, template, works, names=()):
    """Accepts works, undoes and redoes them; gives the lines that went and those that came."""
    made, found, option = written(doc, Wishes(), folder, template, works, names)
    doc.clearUndos()
    before, stood = places(doc), ends(doc)
    accept.accept(doc, made, found, option)
    assert doc.UndoNames == ["Enfilade: option 1"]
    after, stand = places(doc), ends(doc)
    doc.undo()
    doc.recompute()
    assert places(doc) == before, "one Undo takes all of it back"
    doc.redo()
    doc.recompute()
    assert places(doc) == after
    return stood - stand, stand - stood


def group(doc, label):
    made = doc.addObject("App::DocumentObjectGroup", "Group")
    made.Label = label
    return made


def line(ax, ay, bx, by):
    return tuple(sorted(((ax, ay), (bx, by))))


WALL = ("P0l", "P0r", "P1l", "P1r")
FACES = {line(x, 1600, x, 5750) for x in (3950, 4050)}
JAMBS = [[4, 0.7], [4, 1.6]]


@pytest.mark.parametrize("kind", KINDS)
def test_an_opening_ends_the_faces_at_its_jambs(doc, tmp_path, template, kind):
    made = draw(doc, kind)
    layer = group(doc, "A-WALL")
    for name in ("P1l", "P1r"):
        layer.addObject(made[name])
    doc.recompute()
    gone, new = accepted(doc, tmp_path, template, [work("open", (4, 3), (4, 4.8))], WALL)
    assert gone == FACES
    assert new == {line(x, *ys) for x in (3950, 4050) for ys in ((1600, x, 3000), (4800, x, 5750))} | {
        line(3950, y, 4050, y) for y in (3000, 4800)
    }
    drawn = [e for e in document.read(doc).elements() if e.layer == "A-WALL"]
    assert len(drawn) == 6 and all(e.group == "P" and e.clauses for e in drawn), "they belong to their wall, marks too"


@pytest.mark.parametrize("kind", KINDS)
def test_a_door_is_drawn_like_those_of_the_plan(doc, tmp_path, template, kind):
    draw(doc, kind)
    _, new = accepted(doc, tmp_path, template, [work("door", (4, 3), (4, 3.9), filling="door")], WALL)
    assert line(4050, 3000, 4950, 3000) in new, "its leaf, into the first room"
    arcs = [s for e in document.read(doc).elements() for s in e.strokes if s.kind == "arc"]
    assert sorted(s.radius for s in arcs) == pytest.approx([900, 900])
    (swing,) = (s for s in arcs if s.centre[1] > 2900)
    assert [(round(x), round(y)) for x, y in swing.points] == [(4950, 3000), (4050, 3900)]


@pytest.mark.parametrize("kind", KINDS)
def test_glass_needs_a_layer_of_glass(doc, tmp_path, template, kind):
    made = draw(doc, kind)
    glass = work("glaze", (4, 3), (4, 4.8), filling="glass")
    before = places(doc)
    written_job, found, option = written(doc, Wishes(), tmp_path, template, [glass], WALL)
    with pytest.raises(PluginError, match="no layer for glass or windows.*take the new drawing file"):
        accept.accept(doc, written_job, found, option)
    assert places(doc) == before
    pane = Draft.make_line(V(0, 2000, 0), V(250, 2000, 0))
    group(doc, "A-GLAZ").addObject(pane)
    doc.recompute()
    _, new = accepted(doc, tmp_path, template, [glass], WALL)
    assert line(4000, 3000, 4000, 4800) in new and made
    (drawn,) = (e for e in document.read(doc).elements() if e.layer == "A-GLAZ" and e.name != pane.Name)
    assert [(round(x), round(y)) for x, y in drawn.points()] == [(4000, 3000), (4000, 4800)]


@pytest.mark.parametrize("kind", KINDS)
def test_a_door_is_widened(doc, tmp_path, template, kind):
    draw(doc, kind)
    made = work("widen", (4, 0.7), (4, 2.5), demolished=[((4, 1.6), (4, 2.5))], opening=JAMBS)
    gone, new = accepted(doc, tmp_path, template, [made], WALL)
    assert gone == FACES | {line(3950, 1600, 4050, 1600)}
    assert new == {line(x, 2500, x, 5750) for x in (3950, 4050)} | {line(3950, 2500, 4050, 2500)}
    assert not any(s.kind == "arc" for e in document.read(doc).elements() for s in e.strokes), "its leaf is gone"


@pytest.mark.parametrize("kind", KINDS)
def test_a_door_is_walled_up(doc, tmp_path, template, kind):
    draw(doc, kind)
    made = work("close", (4, 0.7), (4, 1.6), demolished=[], built=[((4, 0.7), (4, 1.6))], opening=JAMBS)
    gone, new = accepted(doc, tmp_path, template, [made], WALL)
    assert gone == {line(3950, y, 4050, y) for y in (700, 1600)}
    assert new == {line(x, 700, x, 1600) for x in (3950, 4050)}
    assert not any(s.kind == "arc" for e in document.read(doc).elements() for s in e.strokes)


@pytest.mark.parametrize("kind", KINDS)
def test_a_door_is_hung_elsewhere(doc, tmp_path, template, kind):
    draw(doc, kind)
    made = work("rehang", (4, 3), (4, 3.9), built=[((4, 0.7), (4, 1.6))], opening=JAMBS, filling="door")
    gone, new = accepted(doc, tmp_path, template, [made], WALL)
    assert gone == FACES | {line(3950, y, 4050, y) for y in (700, 1600)}
    assert {line(3950, y, 4050, y) for y in (3000, 3900)} | {line(x, 700, x, 1600) for x in (3950, 4050)} <= new
    (swing,) = (s for e in document.read(doc).elements() for s in e.strokes if s.kind == "arc")
    assert swing.centre == pytest.approx((4050, 3000))


@pytest.mark.parametrize("kind", KINDS)
def test_a_free_end_goes_back(doc, tmp_path, template, kind):
    draw(doc, kind)
    gone, new = accepted(doc, tmp_path, template, [work("end", (5.55, 3.5), (5.55, 2.5))], ("Q0", "Q1", "Q2", "Q3"))
    assert gone == {line(x, 2500, x, 4500) for x in (5500, 5600)} | {line(5500, 2500, 5600, 2500)}
    assert new == {line(x, 3500, x, 4500) for x in (5500, 5600)} | {line(5500, 3500, 5600, 3500)}


@pytest.mark.parametrize("kind", KINDS)
def test_a_wall_goes_with_its_door_and_the_others_are_closed(doc, tmp_path, template, kind):
    draw(doc, kind)
    made = work("remove", (4, 0.25), (4, 5.75), demolished=[((4, 0.25), (4, 0.7)), ((4, 1.6), (4, 5.75))])
    gone, new = accepted(doc, tmp_path, template, [made], WALL)
    faces = FACES | {line(x, 250, x, 700) for x in (3950, 4050)}
    assert gone == faces | {line(3950, y, 4050, y) for y in (700, 1600)}
    assert new == {line(3950, y, 4050, y) for y in (250, 5750)}, "where it met them, the outer walls have a face"
    assert not any(s.kind == "arc" for e in document.read(doc).elements() for s in e.strokes)


@pytest.mark.parametrize("kind", KINDS)
def test_a_new_wall_is_drawn(doc, tmp_path, template, kind):
    draw(doc, kind)
    made = work("add", (2, 0.25), (2, 3), demolished=[], built=[((2, 0.25), (2, 3))])
    gone, new = accepted(doc, tmp_path, template, [made], WALL)
    assert gone == set()
    assert new == {line(1950, 250, 1950, 3000), line(2050, 250, 2050, 3000), line(1950, 3000, 2050, 3000)}


def test_jambs_meet_faces_that_lie_between_millimetres(doc, tmp_path, template):
    made = draw(doc, "draft")
    for name, x in (("P1l", 3950.3), ("P1r", 4050.4)):
        made[name].Points = [V(x, 1600, 0), V(x, 5750, 0)]
    doc.recompute()
    accepted(doc, tmp_path, template, [work("open", (4, 3), (4, 4.8))], WALL)
    drawn = [[round(c, 4) for p in s.points for c in p] for e in document.read(doc).elements() for s in e.strokes]
    assert [4050.4, 3000, 3950.3, 3000] in drawn and [4050.4, 4800, 3950.3, 4800] in drawn


def test_walls_of_one_line(doc, tmp_path, template):
    made = draw(doc, "draft")
    single = Draft.make_line(V(1000, 4000, 0), V(3000, 4000, 0))
    single.Label = "single"
    doc.recompute()
    gone, new = accepted(doc, tmp_path / "1", template, [work("open", (1.5, 4), (2.4, 4), 0.0)], ["single"])
    assert gone == {line(1000, 4000, 3000, 4000)}
    assert new == {line(1000, 4000, 1500, 4000), line(2400, 4000, 3000, 4000)} and made
    close = work("close", (1.5, 4), (2.4, 4), 0.0, demolished=[], built=[((1.5, 4), (2.4, 4))], opening=[[1.5, 4], [2.4, 4]])
    gone, new = accepted(doc, tmp_path / "2", template, [close], ["single"])
    assert (gone, new) == (set(), {line(1500, 4000, 2400, 4000)})


def test_closed_outlines_are_opened(doc, tmp_path, template):
    draw(doc, "draft")
    block = Draft.make_wire([V(*p, 0) for p in ((1000, 3000), (2000, 3000), (2000, 3100), (1000, 3100))], closed=True, face=False)
    block.Label = "block"
    rectangle = Draft.make_rectangle(1000, 100, placement_at(1000, 4000), False)
    rectangle.Label = "rectangle"
    doc.recompute()
    for label, y in (("block", 3.05), ("rectangle", 4.05)):
        gone, new = accepted(doc, tmp_path / label, template, [work("open", (1.4, y), (1.7, y))], (label,))
        low, high = round(1000 * y) - 50, round(1000 * y) + 50
        assert gone == {line(1000, at, 2000, at) for at in (low, high)}
        parts = {line(a, at, b, at) for at in (low, high) for a, b in ((1000, 1400), (1700, 2000))}
        assert new == parts | {line(x, low, x, high) for x in (1400, 1700)}


def placement_at(x, y):
    import FreeCAD as App

    return App.Placement(V(x, y, 0), App.Rotation())


def test_an_imported_layer_in_one_shape(doc, tmp_path, template):
    """FreeCAD's importer may make one compound of a whole layer."""
    made = draw(doc, "shapes")
    edges = [made[n].Shape for n in WALL]
    for name in WALL:
        doc.removeObject(made[name].Name)
    layer = doc.addObject("Part::Feature", "A_WALL")
    layer.Shape, layer.Label = Part.makeCompound([*edges, Part.makeCircle(300, V(1000, 1000, 0))]), "A_WALL"
    doc.recompute()
    gone, new = accepted(doc, tmp_path, template, [work("open", (4, 3), (4, 4.8))], ("A_WALL",))
    assert gone == FACES and line(3950, 3000, 4050, 3000) in new
    assert len(layer.Shape.Edges) == 9 and layer.Shape.Edges[-3].Curve.TypeId == "Part::GeomCircle"


def test_a_plan_in_metres(doc, tmp_path, template):
    made = draw(doc, "shapes")
    for obj in made.values():
        if obj.TypeId == "Part::Feature":
            obj.Shape = obj.Shape.scaled(0.001)
    made["swing"].Radius, made["swing"].Placement.Base = 0.9, V(4, 0.7, 0)
    doc.recompute()
    template = {**template, "input": {**template["input"], "unit": "m"}}
    wishes = Wishes(unit="m")
    written_job, found, option = written(doc, wishes, tmp_path, template, [work("open", (4, 3), (4, 4.8))], WALL)
    accept.accept(doc, written_job, found, option)
    points = {(round(x, 6), round(y, 6)) for e in document.read(doc).elements() for x, y in e.points()}
    assert {(3.95, 3.0), (4.05, 4.8)} <= points


def test_what_cannot_be_drawn_is_refused(doc, tmp_path, template):
    made = draw(doc, "draft")
    curve = Draft.make_bspline([V(1000, 4000, 0), V(2000, 4400, 0), V(3000, 4000, 0)])
    curve.Label = "curve"
    doc.recompute()

    def no(works, words, names):
        written_job, found, option = written(doc, Wishes(), tmp_path, template, works, names)
        before = places(doc)
        doc.clearUndos()
        with pytest.raises(PluginError, match=words):
            accept.accept(doc, written_job, found, option)
        assert places(doc) == before and doc.UndoCount == 0

    fine = work("open", (4, 3), (4, 4.8))
    no([fine, work("open", (1.4, 4.2), (1.8, 4.3))], "'curve' is round where it would be cut", ("curve",))
    no([fine, work("open", (20, 3), (20, 4))], "no line of this document is drawn there", ())
    no([work("open", (4, 3), (4, 4.8), demolished=[])], "does not say what is cut or built", WALL)
    made["P1l"].setExpression("Placement.Base.z", "0 mm")
    doc.recompute()
    no([fine], "'P1l' cannot be changed: an expression decides", WALL)
    assert marks.group(made["P1l"]) == "P"
