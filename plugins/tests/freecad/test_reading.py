import time

import Draft
import FreeCAD as App
import Part
import pytest
from conftest import KINDS, V, build_house, door_in, wall_on
from enfilade import document, marks
from enfilade_common.model import Wall


def by_label(reading):
    return {e.label: e for e in reading.elements()}


@pytest.mark.parametrize("kind", KINDS)
def test_axis_and_faces_are_those_of_freecad(doc, kind):
    build_house(doc, kind)
    walls = by_label(document.read(doc))
    for label, ends in (("P1", [(4000, 125), (4000, 5875)]), ("S", [(0, 0), (8000, 0)])):
        wall = walls[label]
        assert wall.rings == []
        assert [wall.axis[0], wall.axis[-1]] == [pytest.approx(p, abs=1e-6) for p in ends]
    assert (walls["P1"].left, walls["P1"].right, walls["S"].thickness) == (50, 50, 250)
    (door,) = walls["P1"].openings
    assert (door.start, door.end, door.kind) == (pytest.approx(575, abs=1), pytest.approx(1475, abs=1), "door")


@pytest.mark.parametrize("align,offset", [("Left", 0), ("Left", 40), ("Right", 0), ("Right", 40), ("Center", 40)])
def test_justification(doc, align, offset):
    wall = wall_on(doc, "draft", (0, 0), (3000, 0), 200, align)
    wall.Offset = offset
    doc.recompute()
    (found,) = document.read(doc).elements()
    box = wall.Shape.BoundBox
    assert (found.left, found.right, found.rings) == (pytest.approx(box.YMax), pytest.approx(-box.YMin), [])


def test_one_sketch_with_many_segments(doc):
    sketch = doc.addObject("Sketcher::SketchObject", "Sketch")
    points = [(0, 0), (4000, 0), (4000, 3000), (9000, 0), (9000, 2000)]
    for a, b in ((0, 1), (1, 2), (3, 4)):
        sketch.addGeometry(Part.LineSegment(V(*points[a], 0), V(*points[b], 0)), False)
    sketch.addGeometry(Part.LineSegment(V(0, 0, 0), V(100, 100, 0)), True)
    doc.recompute()
    import Arch

    wall = Arch.makeWall(sketch, width=200, height=3000)
    marks.mark(wall, {"x": (-500, 500)})
    doc.recompute()
    chains = document.read(doc).elements()
    assert [c.axis for c in chains] == [[(0, 0), (4000, 0), (4000, 3000)], [(9000, 0), (9000, 2000)]]
    assert {c.group for c in chains} == {wall.Label}, "the chains of one wall move together"


def test_a_closed_wire_and_an_arc(doc):
    import Arch

    wire = Draft.make_wire([V(0, 0, 0), V(5000, 0, 0), V(5000, 4000, 0), V(0, 4000, 0)], closed=True, face=False)
    arc = Draft.make_circle(1000, App.Placement(V(9000, 0, 0), App.Rotation()), False, startangle=0, endangle=90)
    doc.recompute()
    room, bow = (Arch.makeWall(base, width=200, height=3000) for base in (wire, arc))
    doc.recompute()
    walls = {e.name: e for e in document.read(doc).elements()}
    assert walls[room.Name].closed and len(walls[room.Name].axis) == 4
    assert len(walls[bow.Name].rings) == 1 and len(walls[bow.Name].rings[0]) > 8


def test_windows_lie_in_their_wall_and_high_ones_do_not_count(doc):
    wall = wall_on(doc, "draft", (0, 0), (6000, 0), 250)
    doc.recompute()
    door_in(wall, (1000, 0), width=1200, kind="Open 1-pane", label="Fenster", sill=900)
    door_in(wall, (3000, 0), width=1000, kind="Open 1-pane", label="oben", sill=1700)
    doc.recompute()
    doc.recompute()
    (found,) = document.read(doc).elements()
    assert [(o.label, o.kind, round(o.end - o.start)) for o in found.openings] == [("Fenster", "window", 1200)]


def test_storeys_are_studied_one_at_a_time(doc):
    import Arch

    low, high = (wall_on(doc, "draft", (0, 0), (3000, 0), label=n) for n in ("low", "high"))
    high.Base.Start, high.Base.End = V(0, 0, 3000), V(3000, 0, 3000)
    floors = [Arch.makeFloor([w]) for w in (low, high)]
    for floor, name in zip(floors, ("Erdgeschoß", "1. Stock")):
        floor.Label = name
    doc.recompute()
    assert document.storeys(doc) == ["Erdgeschoß", "1. Stock"]
    assert [e.label for e in document.read(doc).elements()] == ["low"]
    assert [e.label for e in document.read(doc, "1. Stock").elements()] == ["high"]
    marks.mark(high, {"x": (-1, 1)})
    assert [e.label for e in document.read(doc).elements()] == ["high"], "the storey with marks comes first"
    door = door_in(high, (1000, 0), label="door", sill=3000)
    region = Draft.make_rectangle(1000, 1000)
    doc.recompute()
    marks.mark(door, {"along": (-100, 100)})
    marks.mark_region(region, "query")
    assert document.marked(doc) == {"1. Stock": ["high", "door"], "": [region.Label]}
    assert not any("other storeys" in n for n in document.read(doc, "1. Stock").notes), "regions outside count for all"
    notes = document.read(doc, "Erdgeschoß").notes
    assert "Marked on other storeys and not part of this study: 'high' (1. Stock), 'door' (1. Stock)." in notes


def test_reading_changes_nothing(doc):
    build_house(doc)
    doc.saveAs(App.getTempPath() + "enfilade-reading.FCStd")
    before = [(o.Name, len(o.PropertiesList), o.State) for o in doc.Objects]
    document.read(doc)
    assert before == [(o.Name, len(o.PropertiesList), o.State) for o in doc.Objects]
    assert doc.UndoCount == 0


def test_marks_survive_undo_save_and_reload(doc, tmp_path):
    walls, _, _ = build_house(doc)
    doc.openTransaction("mark")
    marks.mark(walls["P2"], {"x": (-10, 20), "rotate": (-5, 5)}, "Gruppe ä")
    doc.commitTransaction()
    doc.undo()
    assert not hasattr(walls["P2"], "EnfiladeId")
    doc.redo()
    id = walls["P2"].EnfiladeId
    doc.saveAs(str(tmp_path / "Häuschen.FCStd"))
    App.closeDocument(doc.Name)
    again = App.openDocument(str(tmp_path / "Häuschen.FCStd"))
    wall = by_label(document.read(again))["P2"]
    assert (wall.id, wall.group) == (id, "Gruppe ä")
    assert [c.text() for c in wall.clauses] == ["x -10 20", "rotate -5 5"]


def test_five_hundred_walls_are_read(doc):
    for i in range(500):
        a = (i % 25 * 3000, i // 25 * 3000)
        wall_on(doc, "draft", a, (a[0] + 2000, a[1]))
    doc.recompute()
    began = time.perf_counter()
    found = document.read(doc).elements()
    print(f"500 walls read in {time.perf_counter() - began:.2f} s")
    assert len(found) == 500 and all(isinstance(w, Wall) and not w.rings for w in found)
