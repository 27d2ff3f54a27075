"""2D plans: lines of Draft and shapes of an imported DXF are read like a drawing and moved themselves."""

import os
import subprocess

import Draft
import FreeCAD as App
import Part
import pytest
from conftest import ROOT, V, wall_on
from enfilade import accept, document, marks, plan2d
from enfilade_common import job, results
from enfilade_common.model import PluginError, Wishes

SHARED = os.path.join(ROOT, "..", "shared", "data", "dxf")


def plan_lines():
    """A room of 8 × 6 m with a partition (P…) that has a door with its swing, and a free screen (Q…), by name."""
    out = {"outer": [(0, 0), (8000, 0), (8000, 6000), (0, 6000), (0, 0)]}
    inner = [(3950, 5750), (250, 5750), (250, 250), (3950, 250)]
    out.update({f"W{i}": list(pair) for i, pair in enumerate(zip(inner, inner[1:]))})
    inner = [(4050, 250), (7750, 250), (7750, 5750), (4050, 5750)]
    out.update({f"E{i}": list(pair) for i, pair in enumerate(zip(inner, inner[1:]))})
    for name, y0, y1, end in (("P0", 250, 700, 700), ("P1", 1600, 5750, 1600)):
        out[name + "l"], out[name + "r"] = [(3950, y0), (3950, y1)], [(4050, y0), (4050, y1)]
        out[name + "j"] = [(3950, end), (4050, end)]
    ring = [(5500, 2500), (5600, 2500), (5600, 4500), (5500, 4500), (5500, 2500)]
    out.update({f"Q{i}": list(pair) for i, pair in enumerate(zip(ring, ring[1:]))})
    return out


def draw(doc, kind):
    made = {}
    for name, points in plan_lines().items():
        points = [V(*p, 0) for p in points]
        if kind == "draft":
            closed = points[0] == points[-1]
            obj = Draft.make_wire(points[:-1], closed=True, face=False) if closed else Draft.make_wire(points)
        else:
            obj = doc.addObject("Part::Feature", "Shape")
            edges = [Part.makeLine(a, b) for a, b in zip(points, points[1:])]
            obj.Shape = edges[0] if len(edges) == 1 else Part.makeCompound(edges)
        obj.Label = name
        made[name] = obj
    place = App.Placement(V(4000, 700, 0), App.Rotation())
    made["swing"] = Draft.make_circle(900, place, False, 0, 90)
    made["swing"].Label = "swing"
    doc.recompute()
    marks.mark_all([o for n, o in made.items() if n[0] == "Q"], {"y": (-500, 500), "rotate": (-15, 15)}, "Q")
    marks.mark_all([o for n, o in made.items() if n[0] == "P"], {"x": (-500, 500)}, "P")
    doc.clearUndos()
    return made


def places(doc):
    """Ends of every edge, to a micrometre."""
    seen = (o for o in doc.Objects if hasattr(o, "Shape"))
    return {o.Name: [[round(c, 3) + 0.0 for c in v.Point] for v in o.Shape.Vertexes] for o in seen}


@pytest.mark.parametrize("kind", ("draft", "shapes"))
def test_lines_are_read_like_a_drawing_and_moved_themselves(doc, tmp_path, run_study, kind):
    made = draw(doc, kind)
    assert plan2d.is_plan(doc)
    written, found = run_study(doc, Wishes(members=2, evaluations=150), tmp_path)
    assert found.unit == "mm" and found.options, found.notes
    assert {m[0] for m in found.moves} == {"P", "Q"}
    before = places(doc)
    for option in found.options:
        doc.clearUndos()
        moved = accept.accept(doc, written, found, option)
        changes = {c.id: c for c in results.layout(written, option)}
        assert moved and doc.UndoCount == 1
        now = {e.id: e for e in document.read(doc).elements()}
        for id, change in changes.items():
            assert now[id].points() == [pytest.approx(p, abs=0.1) for p in change.axis_after], id
        after = places(doc)
        assert after != before
        doc.undo()
        doc.recompute()
        assert places(doc) == before
        doc.redo()
        doc.recompute()
        assert places(doc) == after
        doc.undo()
        doc.recompute()
    # A wall whose partition moves is stretched, so that it still meets it.
    shift = found.options[0].parameters[[m[0] for m in found.moves].index("P")]
    assert abs(shift) > 1, "the partition gains"
    accept.accept(doc, written, found, found.options[0])
    assert made["W0"].Shape.BoundBox.XMax == pytest.approx(3950 + shift, abs=0.1)
    assert made["W0"].Shape.BoundBox.XMin == pytest.approx(250, abs=0.1)
    assert made["swing"].Placement.Base.x == pytest.approx(4000 + shift, abs=0.1), "the door's swing goes with its wall"
    assert marks.used(made["P0l"], "x") == pytest.approx(shift)


def test_in_two_rounds_no_line_leaves_its_first_bounds(doc, tmp_path, run_study):
    made = draw(doc, "draft")
    for _ in range(2):
        written, found = run_study(doc, Wishes(members=1, evaluations=80), tmp_path)
        layout = found.best or next(iter(found.options), None)
        if layout is not None:
            accept.accept(doc, written, found, layout)
    x = made["P1l"].Shape.BoundBox.Center.x
    assert 3450 - 0.2 <= x <= 4450 + 0.2 and x != 3950


def test_walls_win_over_lines(doc):
    draw(doc, "draft")
    wall_on(doc, "draft", (0, 7000), (3000, 7000), label="wall")
    doc.recompute()
    assert not plan2d.is_plan(doc)
    assert [e.label for e in document.read(doc).elements()] == ["wall"]


def test_what_is_hidden_or_ours_is_no_line(doc):
    made = draw(doc, "draft")
    made["E0"].Visibility = False
    marks.mark_region(made["outer"], "query")
    labels = {e.label for e in document.read(doc).elements()}
    assert "E0" not in labels and "outer" not in labels and "E1" in labels


def test_a_line_edited_since_is_refused(doc, tmp_path, run_study):
    made = draw(doc, "draft")
    written, found = run_study(doc, Wishes(members=1, evaluations=80), tmp_path)
    made["P1l"].Points = [V(3950, 1600, 0), V(3950, 5700, 0)]
    doc.recompute()
    before = places(doc)
    option = found.options[0]
    assert "P1l" in [written.study.element(c.id).label for c in results.layout(written, option)]
    with pytest.raises(PluginError, match="'P1l' was edited"):
        accept.accept(doc, written, found, option)
    assert places(doc) == before


def test_curves_and_what_others_decide_stay(doc, tmp_path):
    made = draw(doc, "draft")
    rectangle = Draft.make_rectangle(600, 400, App.Placement(V(1000, 1000, 0), App.Rotation()), False)
    doc.recompute()
    rectangle.Label = "table"
    written = job.write(document.study(doc, Wishes())[0], str(tmp_path))
    element = next(e for e in written.study.drawn if e.label == "table")
    assert element.is_stiff and len(element.strokes) == 4
    swing = next(e for e in written.study.drawn if e.label == "swing")
    assert [s.kind for s in swing.strokes] == ["arc"] and swing.strokes[0].radius == 900
    again = job.read(str(tmp_path))
    assert again.study == written.study and made
    text = open(written.drawing).read()
    assert text.count("\nARC\n") == 1 and text.count("\nEF-KEEP\n") >= 4


def test_a_plan_drawn_in_metres_keeps_its_scale(doc, tmp_path, run_study):
    """FreeCAD takes metres for millimetres: bounds are those of the building, lines move in their own unit."""
    made = draw(doc, "shapes")
    for obj in made.values():
        if obj.TypeId == "Part::Feature":
            obj.Shape = obj.Shape.scaled(0.001)
    made["swing"].Radius, made["swing"].Placement.Base = 0.9, V(4, 0.7, 0)
    doc.recompute()
    written, found = run_study(doc, Wishes(members=1, evaluations=80, unit="m"), tmp_path)
    assert found.unit == "m" and found.per_metre == pytest.approx(1)
    option = found.options[0]
    shift = option.parameters[[m[0] for m in found.moves].index("P")]
    assert 1 < abs(shift) <= 500
    accept.accept(doc, written, found, option)
    assert made["P1l"].Shape.BoundBox.Center.x == pytest.approx(3.95 + shift / 1000, abs=1e-4)


def imported(doc, name, grouped=False):
    import importDXF

    path = os.path.join(SHARED, name)
    if not os.path.exists(path):
        pytest.skip("the drawings of shared/data are not here")
    draft = App.ParamGet("User parameter:BaseApp/Preferences/Mod/Draft")
    draft.SetBool("dxfShowDialog", False)
    draft.SetBool("groupLayers", grouped)
    importDXF.insert(path, doc.Name)
    doc.recompute()
    doc.clearUndos()


@pytest.mark.parametrize("name", ("gama_house_librecad.dxf", "olymp_librecad.dxf", "potynobg_pianta_house.dxf"))
def test_an_imported_drawing_is_read_as_the_file_is(doc, tmp_path, program, name):
    """What FreeCAD makes of a DXF measures as the DXF does, as far as its importer keeps the drawing."""
    import json

    imported(doc, name, grouped=True)
    written = job.write(document.study(doc, Wishes())[0], str(tmp_path))
    for path, out in ((os.path.join(SHARED, name), "file"), (written.drawing, "ours")):
        words = [program, "check", path, "--json", str(tmp_path / (out + ".json"))]
        assert subprocess.run(words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL).returncode in (0, 1)
    file, ours = (json.load(open(tmp_path / (n + ".json"))) for n in ("file", "ours"))
    print(name, [(len(d["reading"]["walls"]), d["reading"]["unit"]["name"], len(d["reading"]["openings"])) for d in (file, ours)])
    assert len(ours["reading"]["walls"]) >= len(file["reading"]["walls"]) / 2
