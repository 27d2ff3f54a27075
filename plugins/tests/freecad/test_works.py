"""Building works in Arch walls become objects of the document, in one undo step that takes all of it back."""

import json
import subprocess

import Arch
import Draft
import FreeCAD as App
import pytest
from conftest import KINDS, V, build_house, door_in, wall_on
from enfilade import accept, document, marks
from enfilade_common import job, results
from enfilade_common.model import PluginError, Wishes
from rounds import work, written
from test_accepting import state


def everything(doc):
    """What stands where, what hangs on what."""
    links = {o.Name: (o.Label, sorted(h.Name for h in getattr(o, "Hosts", None) or [])) for o in doc.Objects}
    return state(doc), links


def walls_of(doc):
    return {e.label: e for e in document.read(doc).elements()}


def spans(wall):
    return sorted((round(o.start), round(o.end), o.kind) for o in wall.openings)


def accepted(doc, wishes, folder, template, works, names=(), look=None):
    """Accepts works; looks at the document, takes them back, makes them again."""
    made, found, option = written(doc, wishes, folder, template, works, names)
    doc.clearUndos()
    before = everything(doc)
    labels = accept.accept(doc, made, found, option)
    assert doc.UndoNames == ["Enfilade: option 1"]
    after = everything(doc)
    assert after != before
    if look is not None:
        look()
    doc.undo()
    doc.recompute()
    for one, other in zip(everything(doc), before):
        assert {k: v for k, v in one.items() if v != other.get(k)} == {}, "one Undo takes all of it back"
    assert everything(doc) == before
    doc.redo()
    doc.recompute()
    assert everything(doc) == after
    return labels


def refused(doc, wishes, folder, template, works, words, names=()):
    made, found, option = written(doc, wishes, folder, template, works, names)
    doc.clearUndos()
    before = everything(doc)
    with pytest.raises(PluginError, match=words):
        accept.accept(doc, made, found, option)
    assert everything(doc) == before and doc.UndoCount == 0


OPENINGS = {
    # P1 stands from y = 0.125 m, its door from 0.7 to 1.6 m.
    "open": (work("open", (4, 3.2), (4, 5)), (3075, 4875, "passage")),
    "door": (work("door", (4, 3.3), (4, 4.2), filling="door"), (3175, 4075, "door")),
    "glaze": (work("glaze", (4, 3.2), (4, 5), filling="glass"), (3075, 4875, "window")),
}


@pytest.mark.parametrize("name", OPENINGS)
@pytest.mark.parametrize("kind", KINDS)
def test_an_opening_is_cut_into_a_wall(doc, wishes, tmp_path, template, kind, name):
    walls, door, _ = build_house(doc, kind)
    made, wanted = OPENINGS[name]
    volume = walls["P1"].Shape.Volume

    def look():
        assert spans(walls_of(doc)["P1"]) == sorted([(575, 1475, "door"), wanted])
        height = 1950 if name == "glaze" else 2100
        gone = (wanted[1] - wanted[0]) * 100 * height
        assert walls["P1"].Shape.Volume == pytest.approx(volume - gone, rel=1e-6), "as high as the door beside it"
        (new,) = (o for o in doc.Objects if document.kind_of(o) == "Window" and o.Name != door.Name)
        assert new.Hosts == [walls["P1"]] and new.IfcType == {"open": "Opening Element", "door": "Door", "glaze": "Window"}[name]
        box = new.Shape.BoundBox
        assert 3950 - 0.1 <= box.XMin and box.XMax <= 4050 + 0.1, "within the wall"

    accepted(doc, wishes, tmp_path, template, [made], ["P1", "P2"], look)


def test_an_opening_in_a_wall_without_doors_goes_to_the_top(doc, wishes, tmp_path, template):
    walls, _, _ = build_house(doc)
    volume = walls["P2"].Shape.Volume

    def look():
        assert spans(walls_of(doc)["P2"]) == [(950, 2750, "passage")]
        assert walls["P2"].Shape.Volume == pytest.approx(volume - 1800 * 100 * 3000, rel=1e-6)

    accepted(doc, wishes, tmp_path, template, [work("open", (5, 3), (6.8, 3))], ["P2"], look)


def test_the_result_need_not_name_the_wall(doc, wishes, tmp_path, template):
    build_house(doc)
    accepted(doc, wishes, tmp_path, template, [work("open", (5, 3), (6.8, 3))])


JAMBS = [[4, 0.7], [4, 1.6]]


@pytest.mark.parametrize("filling", ("nothing", "door"))
def test_a_door_is_widened(doc, wishes, tmp_path, template, filling):
    walls, door, _ = build_house(doc)
    made = work("widen", (4, 0.7), (4, 2.5), demolished=[((4, 1.6), (4, 2.5))], opening=JAMBS, filling=filling)
    name = door.Name

    def look():
        assert spans(walls_of(doc)["P1"]) == [(575, 2375, "passage" if filling == "nothing" else "door")]
        assert doc.getObject(name) is None, "the door of 0.9 m is gone"

    accepted(doc, wishes, tmp_path, template, [made], ["P1"], look)


def test_a_door_is_walled_up(doc, wishes, tmp_path, template):
    walls, door, _ = build_house(doc)
    made = work("close", (4, 0.7), (4, 1.6), demolished=[], built=[((4, 0.7), (4, 1.6))], opening=JAMBS)
    volume, name = walls["P1"].Shape.Volume, door.Name

    def look():
        assert spans(walls_of(doc)["P1"]) == [] and doc.getObject(name) is None
        assert walls["P1"].Shape.Volume == pytest.approx(volume + 900 * 100 * 2100, rel=1e-6)

    accepted(doc, wishes, tmp_path, template, [made], ["P1"], look)


@pytest.mark.parametrize("width", (0.9, 1.0))
def test_a_door_is_hung_elsewhere(doc, wishes, tmp_path, template, width):
    walls, door, _ = build_house(doc)
    at = ((4, 1.9), (4, 1.9 + width))
    made = work("rehang", *at, built=[((4, 0.7), (4, 1.6))], opening=JAMBS, filling="door")
    name = door.Name

    def look():
        assert spans(walls_of(doc)["P1"]) == [(1775, round(1775 + 1000 * width), "door")]
        assert (doc.getObject(name) is not None) is (width == 0.9), "a door that fits is the same door"

    accepted(doc, wishes, tmp_path, template, [made], ["P1"], look)


@pytest.mark.parametrize("kind", KINDS)
def test_a_free_end_goes_back(doc, wishes, tmp_path, template, kind):
    build_house(doc, kind)

    def look():
        assert walls_of(doc)["P3"].axis[0] == pytest.approx((6000, 4500), abs=0.1)
        assert walls_of(doc)["P3"].axis[-1] == pytest.approx((6900, 4500), abs=0.1)
        assert walls_of(doc)["P2"].axis[-1] == pytest.approx((6000, 3000), abs=0.1)

    accepted(doc, wishes, tmp_path, template, [work("end", (6, 3), (7, 3))], ["P2"], look)


def test_a_whole_wall_goes_with_its_door_and_its_base(doc, wishes, tmp_path, template):
    walls, door, _ = build_house(doc)
    names = [door.Name, door.Base.Name, walls["P1"].Name, walls["P1"].Base.Name]
    made = work("remove", (4, 0.125), (4, 5.875), demolished=[((4, 0.125), (4, 0.7)), ((4, 1.6), (4, 5.875))])

    def look():
        assert "P1" not in walls_of(doc) and [doc.getObject(n) for n in names] == [None] * 4

    assert accepted(doc, wishes, tmp_path, template, [made], ["P1"], look) == ["P1"]


@pytest.mark.parametrize("kind", KINDS)
def test_a_wall_between_two_joints_goes(doc, wishes, tmp_path, template, kind):
    """The stretch with the door goes, the rest stays."""
    walls, door, _ = build_house(doc, kind)
    made = work("remove", (4, 0.125), (4, 2.95), demolished=[((4, 0.125), (4, 0.7)), ((4, 1.6), (4, 2.95))])
    name = door.Name

    def look():
        assert walls_of(doc)["P1"].axis[0] == pytest.approx((4000, 2950), abs=0.1) and doc.getObject(name) is None

    accepted(doc, wishes, tmp_path, template, [made], ["P1"], look)


@pytest.mark.parametrize("kind", KINDS)
def test_a_wall_is_parted(doc, wishes, tmp_path, template, kind):
    walls, door, _ = build_house(doc, kind)
    level = doc.addObject("App::DocumentObjectGroup", "Level")
    level.addObject(walls["P1"])
    doc.recompute()

    def look():
        there = walls_of(doc)
        assert there["P1"].axis[0] == pytest.approx((4000, 2500), abs=0.1) and not there["P1"].openings
        part = there["P1 part"]
        assert part.axis == [pytest.approx((4000, 125), abs=0.1), pytest.approx((4000, 2000), abs=0.1)]
        assert spans(part) == [(575, 1475, "door")], "its door went along"
        new = doc.getObject(part.name)
        assert new in level.Group and new.Height.Value == 3000 and marks.bounds(new) == {"x": (-1000, 1000)}

    accepted(doc, wishes, tmp_path, template, [work("remove", (4, 2), (4, 2.5))], ["P1"], look)


def test_a_new_wall_is_built_like_the_others(doc, wishes, tmp_path, template):
    build_house(doc)
    made = work("add", (1.5, 0.125), (1.5, 2.85), demolished=[], built=[((1.5, 0.125), (1.5, 2.85))])

    def look():
        new = walls_of(doc)["New wall"]
        assert new.axis == [pytest.approx((1500, 125)), pytest.approx((1500, 2850))]
        assert (new.thickness, new.height) == (100, 3000)

    accepted(doc, wishes, tmp_path, template, [made], ["P1"], look)


def test_works_stand_on_the_storey_of_their_walls(doc, wishes, tmp_path, template):
    walls, _, _ = build_house(doc)
    lower, upper = Arch.makeFloor(list(walls.values())), Arch.makeFloor([])
    wall_on(doc, "draft", (0, 0), (3000, 0))
    lower.Label, upper.Label = "Lower", "Upper"
    doc.recompute()
    wishes.level = "eye"
    works = [work("open", (5, 3), (6.8, 3)), work("add", (1.5, 0.125), (1.5, 2.85), demolished=[], built=[((1.5, 0.125), (1.5, 2.85))])]

    def look():
        new = next(o for o in doc.Objects if o.Label == "New wall")
        assert document.storey_of(new) == "Lower" and new in lower.Group

    accepted(doc, wishes, tmp_path, template, works, ["P2"], look)


def test_moves_come_before_works(doc, wishes, tmp_path, template):
    from test_accepting import option_with

    walls, _, _ = build_house(doc)
    made, found, moved = option_with(doc, wishes, tmp_path, {("P1", "x"): 300.0})
    works = [work("open", (4.3, 3.2), (4.3, 5))]
    made, found, option = written(doc, wishes, tmp_path, template, works, ["P1"], moved.changes, moved.parameters)
    before = everything(doc)
    doc.clearUndos()
    labels = accept.accept(doc, made, found, option)
    assert labels[0] == "P1" and doc.UndoCount == 1
    there = walls_of(doc)["P1"]
    assert there.axis[0][0] == pytest.approx(4300, abs=0.1) and (3075, 4875, "passage") in spans(there)
    doc.undo()
    doc.recompute()
    assert everything(doc) == before
    works = [work("open", (4, 3.2), (4, 5))]
    made, found, option = written(doc, wishes, tmp_path, template, works, ["P1"], moved.changes, moved.parameters)
    doc.clearUndos()
    with pytest.raises(PluginError, match="no wall of this document stands there"):
        accept.accept(doc, made, found, option)
    assert everything(doc) == before and doc.UndoCount == 0, "the moves are taken back too"


def two_walls(doc):
    """Two walls in line with a gap of 0.9 m between them."""
    for label, a, b in (("A", 0, 2000), ("B", 2900, 6000)):
        wall_on(doc, "draft", (a, 0), (b, 0), label=label)
    doc.recompute()


def test_a_gap_between_two_walls_is_an_opening_too(doc, wishes, tmp_path, template):
    two_walls(doc)
    jambs = [[2, 0], [2.9, 0]]

    def widened():
        assert walls_of(doc)["A"].axis == [(0, 0), (2000, 0)] and walls_of(doc)["B"].axis == [(3800, 0), (6000, 0)]

    made = work("widen", (2, 0), (3.8, 0), demolished=[((2.9, 0), (3.8, 0))], opening=jambs)
    accepted(doc, wishes, tmp_path / "1", template, [made], ["A", "B"], widened)
    doc.undo()
    doc.recompute()

    def closed():
        assert walls_of(doc)["New wall"].axis == [pytest.approx((2000, 0)), pytest.approx((2900, 0))]

    made = work("close", (2, 0), (2.9, 0), demolished=[], built=[((2, 0), (2.9, 0))], opening=jambs)
    accepted(doc, wishes, tmp_path / "2", template, [made], ["A", "B"], closed)
    doc.undo()
    doc.recompute()

    def hung():
        closed()
        assert spans(walls_of(doc)["B"]) == [(1100, 2000, "door")]

    made = work("rehang", (4, 0), (4.9, 0), built=[((2, 0), (2.9, 0))], opening=jambs, filling="door")
    accepted(doc, wishes, tmp_path / "3", template, [made], ["A", "B"], hung)


def test_a_wall_that_is_aligned_by_its_face(doc, wishes, tmp_path, template):
    """The program's axis runs in the middle of the wall, FreeCAD's along its face."""
    wall = wall_on(doc, "draft", (0, 0), (6000, 0), 200, "Left", "P")
    doc.recompute()
    y = wall.Shape.BoundBox.Center.y / 1000
    volume = wall.Shape.Volume

    def look():
        assert spans(walls_of(doc)["P"]) == [(1000, 1900, "door")]
        assert wall.Shape.Volume == pytest.approx(volume - 900 * 200 * 2100, rel=1e-6)
        (door,) = (o for o in doc.Objects if document.kind_of(o) == "Window")
        assert door.Shape.BoundBox.Center.y == pytest.approx(1000 * y, abs=1)

    accepted(doc, wishes, tmp_path, template, [work("door", (1, y), (1.9, y), 0.2, filling="door")], ["P"], look)


def test_several_works_in_one_wall(doc, wishes, tmp_path, template):
    build_house(doc)
    close = work("close", (4, 0.7), (4, 1.6), demolished=[], built=[((4, 0.7), (4, 1.6))], opening=JAMBS)
    works = [close, work("open", (4, 3.2), (4, 4.1)), work("remove", (4, 2), (4, 2.5)), work("end", (6.4, 3), (7, 3))]

    def look():
        there = walls_of(doc)
        assert spans(there["P1"]) == [(700, 1600, "passage")] and spans(there["P1 part"]) == []
        assert there["P2"].axis[-1] == pytest.approx((6400, 3000), abs=0.1)

    accepted(doc, wishes, tmp_path, template, works, ["P1", "P2"], look)


def test_walls_that_freecad_joined_are_cut(doc, wishes, tmp_path, template):
    long = wall_on(doc, "draft", (0, 0), (8000, 0), 200, label="long")
    joined = wall_on(doc, "draft", (3000, 100), (3000, 3000), 100, label="joined")
    doc.recompute()
    Arch.addComponents(joined, long)
    doc.recompute()
    doc.recompute()
    works = [work("open", (3, 1), (3, 1.9)), work("open", (5, 0), (6.8, 0), 0.2)]

    def look():
        there = walls_of(doc)
        assert spans(there["joined"]) == [(900, 1800, "passage")] and spans(there["long"]) == [(5000, 6800, "passage")]

    accepted(doc, wishes, tmp_path / "1", template, works, ["joined", "long"], look)
    doc.undo()
    doc.recompute()

    def gone():
        assert list(walls_of(doc)) == ["long"]

    accepted(doc, wishes, tmp_path / "2", template, [work("remove", (3, 0.1), (3, 3))], ["joined"], gone)


def read_by(program, doc, folder):
    """The openings that the program finds in the document: kind, width, middle in mm."""
    made = job.write(document.study(doc, Wishes())[0], str(folder))
    path = str(folder / "check.json")
    done = subprocess.run([program, "check", made.drawing, "--json", path], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    assert done.returncode in (0, 1)
    with open(path) as f:
        openings = json.load(f)["reading"]["openings"]
    return {(o["kind"], round(o["width_m"], 3), *map(round, o["at"])) for o in openings}


def test_the_program_reads_the_works_in_the_document(doc, wishes, tmp_path, template, program):
    build_house(doc)
    before = read_by(program, doc, tmp_path / "before")
    close = work("close", (4, 0.7), (4, 1.6), demolished=[], built=[((4, 0.7), (4, 1.6))], opening=JAMBS)
    works = [close, work("open", (4, 3.2), (4, 5)), work("door", (4, 1.9), (4, 2.8), filling="door")]
    accepted(doc, wishes, tmp_path / "round", template, works, ["P1"])
    after = read_by(program, doc, tmp_path / "after")
    assert before - after == {("door", 0.9, 4000, 1150)}
    assert after - before == {("passage", 1.8, 4000, 4100), ("door", 0.9, 4000, 2350)}


def test_a_bent_wall_and_a_rectangle(doc, wishes, tmp_path, template):
    base = Draft.make_wire([V(0, 0, 0), V(4000, 0, 0), V(4000, 3000, 0), V(0, 3000, 0)], closed=True, face=False)
    doc.recompute()
    room = Arch.makeWall(base, width=100, height=3000)
    room.Label = "room"
    doc.recompute()

    def look():
        there = walls_of(doc)["room"]
        assert there.axis == [pytest.approx(p) for p in [(3000, 0), (4000, 0), (4000, 3000), (0, 3000), (0, 0), (1000, 0)]]

    accepted(doc, wishes, tmp_path, template, [work("remove", (1, 0), (3, 0))], ["room"], look)


def test_what_cannot_be_made_is_refused_before_anything_changes(doc, wishes, tmp_path, template):
    walls, door, _ = build_house(doc)
    place = App.Placement(V(9000, 2000, 0), App.Rotation())
    arc = Draft.make_circle(1000, place, False, startangle=0, endangle=180)
    rectangle = Draft.make_rectangle(2000, 2000, App.Placement(V(10000, 5000, 0), App.Rotation()), False)
    doc.recompute()
    for base, label in ((arc, "bow"), (rectangle, "block")):
        Arch.makeWall(base, width=200, height=3000).Label = label
    doc.recompute()
    fine = work("open", (5, 3), (6.8, 3))

    def no(made, words):
        refused(doc, wishes, tmp_path, template, [fine, made], words)

    no(work("open", (9.1, 3), (8.9, 3)), "'bow' cannot be changed so .*no straight wall there. Nothing was changed.*take the new drawing file")
    no(work("open", (20, 3), (21, 3)), "no wall of this document stands there")
    no(work("open", (4, 1.2), (4, 2.5)), "'P1': 'Tür 1' stands partly in")
    no(work("shrink", (4, 3), (4, 4)), "does not know such a work; update it")
    no(work("add", (1, 1), (2, 1), demolished=[]), "does not say where a wall is built")
    walls["P1"].Base.setExpression("Placement.Base.z", "0 mm")
    doc.recompute()
    no(work("open", (4, 3.2), (4, 5)), "'P1' cannot be changed: an expression decides where")


def test_an_edited_wall_is_refused(doc, wishes, tmp_path, template):
    walls, _, _ = build_house(doc)
    made, found, option = written(doc, wishes, tmp_path, template, [work("open", (5, 3), (6.8, 3))], ["P2"])
    walls["P2"].Width = 120
    doc.recompute()
    before = everything(doc)
    with pytest.raises(PluginError, match="'P2' was edited"):
        accept.accept(doc, made, found, option)
    assert everything(doc) == before


def test_what_stands_elsewhere_than_the_option_says_is_taken_back(doc, wishes, tmp_path, template, monkeypatch):
    from enfilade import openings

    build_house(doc)
    make = openings.make
    shifted = lambda obj, wall, ends, z, filling: make(obj, wall, [(x + 3, y) for x, y in ends], z, filling)  # noqa: E731
    monkeypatch.setattr(openings, "make", shifted)
    refused(doc, wishes, tmp_path, template, [work("open", (5, 3), (6.8, 3))], "does not stand where the option says")


def test_an_option_that_only_cuts_is_no_option_that_leaves_everything(doc, wishes, tmp_path, template):
    build_house(doc)
    refused(doc, wishes, tmp_path, template, [], "leaves everything as it is")


def test_the_works_of_the_program_itself(doc, tmp_path, program):
    """A flat of three rooms in which nothing is marked: the program cuts openings, and so does the document."""
    corners = [(0, 0), (12000, 0), (12000, 9000), (0, 9000)]
    for label, a, b in zip("SENW", corners, corners[1:] + corners[:1]):
        wall_on(doc, "draft", a, b, 250, label=label)
    walls = {"P": ((6000, 125), (6000, 8875)), "Q": ((6050, 4500), (11875, 4500))}
    walls = {label: wall_on(doc, "draft", *ends, label=label) for label, ends in walls.items()}
    doc.recompute()
    for at, label, turn in (((6000, 700), "P", 90), ((6000, 7000), "P", 90), ((9000, 4500), "Q", 0)):
        door_in(walls[label], at, turn)
    doc.recompute()
    doc.recompute()
    wishes = Wishes(members=2, evaluations=40, spacing_m=0.3)
    made = job.write(document.study(doc, wishes)[0], str(tmp_path))
    path = tmp_path / "plan.enfilade.toml"
    path.write_text(path.read_text().replace("only-marked = true", "only-marked = false"))
    done = subprocess.run([program, "run", made.drawing, "--quiet"], stdin=subprocess.DEVNULL)
    assert done.returncode in (0, 1)
    found = results.latest(made)
    assert any(o.works for o in found.options), [o.words for o in found.options]
    for option in (o for o in found.options if o.works):
        before = everything(doc)
        doc.clearUndos()
        accept.accept(doc, made, found, option)
        assert all(results.worked(made, w) for w in option.works), "every work names its walls"
        there = walls_of(doc)
        wide = sorted(round(o.end - o.start) for w in there.values() for o in w.openings if o.kind == "passage")
        assert wide == sorted(round(w.width) for w in option.works if w.kind in ("open", "widen"))
        doc.undo()
        doc.recompute()
        assert everything(doc) == before
