"""Ten documents as people really have them: a sentence that helps, and nothing half done."""

import time

import FreeCAD as App
import pytest
from conftest import V, build_house, wall_on
from enfilade import accept, document, marks
from enfilade_common import job, program as runner
from enfilade_common.model import PluginError, Wishes
from test_accepting import MOVES, option_with, state


def refused(doc, made, found, option, words):
    before, undo = state(doc), doc.UndoCount
    with pytest.raises(PluginError, match=words):
        accept.accept(doc, made, found, option)
    assert state(doc) == before and doc.UndoCount == undo and not doc.HasPendingTransaction


def test_1_copied_walls_get_ids_of_their_own(doc, wishes, tmp_path):
    walls, _, _ = build_house(doc)
    copy = doc.copyObject(walls["P3"], True)
    copy.Base.Start, copy.Base.End = V(6000, 1500, 0), V(6900, 1500, 0)
    doc.recompute()
    assert copy.EnfiladeId == walls["P3"].EnfiladeId, "FreeCAD copies the property"
    ids = {e.name: e.id for e in document.read(doc).elements()}
    assert ids[walls["P3"].Name] == walls["P3"].EnfiladeId and ids[copy.Name] == copy.Name
    made, found, option = option_with(doc, wishes, tmp_path, {(copy.Label, "y"): 100.0})
    assert accept.accept(doc, made, found, option) == [copy.Label]
    marks.mark(copy, {"y": (-1, 1)})
    assert copy.EnfiladeId != walls["P3"].EnfiladeId and walls["P3"].EnfiladeId == ids[walls["P3"].Name]


def test_2_a_wall_deleted_after_the_export(doc, wishes, tmp_path):
    walls, _, _ = build_house(doc)
    made, found, option = option_with(doc, wishes, tmp_path, MOVES)
    doc.removeObject(walls["P2"].Name)
    doc.recompute()
    refused(doc, made, found, option, "'P2' was deleted")


def test_3_a_wall_edited_after_the_export(doc, wishes, tmp_path):
    walls, _, _ = build_house(doc)
    made, found, option = option_with(doc, wishes, tmp_path, MOVES)
    walls["P3"].Width = 120
    doc.recompute()
    refused(doc, made, found, option, "'P3' was edited")


def test_4_a_wall_moved_into_a_group(doc, wishes, tmp_path):
    walls, _, _ = build_house(doc)
    made, found, option = option_with(doc, wishes, tmp_path, MOVES)
    group = doc.addObject("App::DocumentObjectGroup", "Group")
    group.addObject(walls["P3"])
    doc.recompute()
    assert "P3" in accept.accept(doc, made, found, option), "a folder moves nothing"
    part = doc.addObject("App::Part", "Part")
    part.Placement.Base = V(1000, 0, 0)
    part.addObject(walls["P3"])
    doc.recompute()
    assert "position of its own" in {e.label: e.locked for e in document.read(doc).elements()}["P3"]


def test_5_an_empty_document(doc, wishes):
    with pytest.raises(PluginError, match="draw walls with the Arch"):
        document.study(doc, wishes)


def test_6_five_hundred_walls(doc, tmp_path):
    walls = []
    first = time.thread_time()
    for i in range(500):
        a = (i % 25 * 3000, i // 25 * 3000)
        walls.append(wall_on(doc, "draft", a, (a[0] + 2000, a[1])))
    doc.recompute()
    began = time.thread_time()
    doc.openTransaction("mark")
    marks.mark_all(walls, {"x": (-300, 300), "y": (-300, 300)})
    doc.commitTransaction()
    marked = time.thread_time()
    study, _ = document.study(doc, Wishes())
    made = job.write(study, str(tmp_path))
    done = time.thread_time()
    print(f"500 walls: marked in {marked - began:.2f} s of work, exported in {done - marked:.2f} s of work")
    # Against FreeCAD's own work on the same machine: what grows with the square of the walls costs more than drawing.
    assert len(made.outlines) == 500 and done - began < began - first


def test_7_a_locked_base(doc, wishes, tmp_path):
    walls, _, _ = build_house(doc)
    made, found, option = option_with(doc, wishes, tmp_path, MOVES)
    walls["P3"].Base.setEditorMode("Placement", 1)
    doc.recompute()
    refused(doc, made, found, option, "'P3': the position of .* is locked")
    study, _ = document.study(doc, wishes)
    assert any("'P3' is marked to move but stays" in n for n in job.write(study, str(tmp_path)).notes)


def test_7b_a_sketch_held_by_its_constraints(doc, wishes, tmp_path):
    import Arch
    import Part
    import Sketcher

    sketch = doc.addObject("Sketcher::SketchObject", "Sketch")
    sketch.addGeometry(Part.LineSegment(V(500, 1000, 0), V(3000, 1000, 0)), False)
    for c in (("Coincident", 0, 1, -1, 1), ("Horizontal", 0), ("DistanceX", 0, 1, 0, 2, 2500.0)):
        sketch.addConstraint(Sketcher.Constraint(*c))
    doc.recompute()
    held = Arch.makeWall(sketch, width=100, height=3000)
    held.Label = "held"
    mover = wall_on(doc, "draft", (2550, -1000), (2550, 1000), label="mover")
    doc.recompute()
    marks.mark(mover, {"x": (-500, 500)})
    made, found, option = option_with(doc, wishes, tmp_path, {("mover", "x"): 300.0})
    assert len(option.changes) == 2
    refused(doc, made, found, option, "nothing was changed")


def test_8_labels_in_every_script(doc, wishes, tmp_path, run_study):
    walls, door, _ = build_house(doc)
    for name, label in (("P1", "Wand „Süd“ 壁 №1"), ("P2", 'a"b\\c\n;x 1 2'), ("P3", "стена 😀")):
        walls[name].Label = label
    door.Label = "Tür; x -9 9"
    made, found = run_study(doc, wishes, tmp_path)
    assert accept.accept(doc, made, found, found.options[0])


def test_9_two_documents_open(doc, wishes, tmp_path):
    build_house(doc)
    made, found, option = option_with(doc, wishes, tmp_path, MOVES)
    other = App.newDocument("Other")
    other.UndoMode = 1
    wall_on(other, "draft", (0, 0), (1000, 0), label="O")
    other.recompute()
    before = state(other)
    refused(other, made, found, option, "was deleted")
    App.setActiveDocument(other.Name)
    accept.accept(doc, made, found, option)
    assert state(other) == before and doc.UndoCount == 1
    assert other.UndoCount == 0 and App.ActiveDocument.Name == other.Name, "nothing to undo in the other document"


def test_10_the_program_is_missing(doc, wishes, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("ENFILADE")
    with pytest.raises(PluginError, match="Install it, or say where it is"):
        runner.find()


def test_an_open_command_is_not_swallowed(doc, wishes, tmp_path):
    walls, _, _ = build_house(doc)
    made, found, option = option_with(doc, wishes, tmp_path, MOVES)
    doc.openTransaction("something else")
    walls["P2"].Label = "renamed"
    with pytest.raises(PluginError, match="still open"):
        accept.accept(doc, made, found, option)
    doc.abortTransaction()
    assert walls["P2"].Label == "P2"


@pytest.mark.parametrize("path", ("Start.x", "Placement.Base.x", "X1", "wall", "door"))
def test_11_a_place_that_an_expression_decides(doc, wishes, tmp_path, path):
    from conftest import door_in

    kind = {"X1": "part-line", "wall": "bare"}.get(path, "draft")
    wall = wall_on(doc, kind, (5000, 1000), (5000, 3000), label="held")
    doc.recompute()
    if path == "wall":
        wall.setExpression("Placement.Base.x", "5000 mm")
    elif path == "door":
        door = door_in(wall, (5000, 1500), 90, label="door")
        doc.recompute()
        door.setExpression("Placement.Base.x", "0 mm")
    else:
        wall.Base.setExpression(path, "0 mm" if path.startswith("P") else "5000 mm")
    doc.recompute()
    marks.mark(wall, {"x": (-500, 500)})
    study, _ = document.study(doc, wishes)
    made = job.write(study, str(tmp_path))
    assert made.plan.tables == []
    assert any("'held' is marked to move but stays" in n and "an expression decides" in n for n in made.notes), made.notes


def test_12_undo_is_switched_off(doc, wishes, tmp_path):
    build_house(doc)
    made, found, option = option_with(doc, wishes, tmp_path, MOVES)
    doc.UndoMode = 0
    refused(doc, made, found, option, "Undo is switched off.*Preferences")
    doc.UndoMode = 1
    assert accept.accept(doc, made, found, option)


def test_13_the_plan_around_was_changed(doc, wishes, tmp_path):
    walls, _, _ = build_house(doc)
    made, found, option = option_with(doc, wishes, tmp_path, {("P3", "y"): 100.0})
    assert accept.changed_around(doc, made, option) == ""
    walls["P2"].Base.Points = [V(4050, 2000, 0), V(7000, 2000, 0)]
    walls["P3"].Height = 2000
    doc.removeObject(walls["W"].Name)
    wall_on(doc, "draft", (2500, 500), (3500, 500), label="new")
    doc.recompute()
    assert accept.changed_around(doc, made, option) == (
        "The plan has changed since the study ('W' was deleted, 'P2' was edited, 'P3' has another height, and 1 more): "
        "the numbers were measured on the old one."
    )
    assert accept.accept(doc, made, found, option) == ["P3"]


def test_14_sentences_name_the_document_and_what_happened(doc, wishes, tmp_path):
    import Arch

    walls, _, _ = build_house(doc)
    made, found, option = option_with(doc, wishes, tmp_path, MOVES)
    floor = Arch.makeFloor([o for n, o in walls.items() if n != "P3"])
    floor.Label = "EG"
    walls["P1"].Width, walls["P1"].Label = 120, "renamed"
    doc.recompute()
    made.study.storey = "EG"
    with pytest.raises(PluginError) as said:
        accept.accept(doc, made, found, option)
    for words in ("The document 'House'", "'renamed' (then 'P1') was edited", "'P3' is no longer among the walls"):
        assert words in str(said.value)


def test_15_walls_in_a_part_stand_where_they_stand(doc, wishes, tmp_path):
    from conftest import door_in

    wall = wall_on(doc, "draft", (2000, 1000), (2000, 3000), label="P")
    doc.recompute()
    door = door_in(wall, (2000, 1500), 90, label="door")
    doc.recompute()
    doc.recompute()
    part = doc.addObject("App::Part", "Part")
    for obj in (wall, wall.Base, door, door.Base):
        part.addObject(obj)
    part.Placement = App.Placement(V(4000, 0, 0), App.Rotation(V(0, 0, 1), 90))
    doc.recompute()
    marks.mark(wall, {"x": (-500, 500)})
    study, _ = document.study(doc, wishes)
    (found,) = study.walls
    assert [tuple(round(v, 6) for v in p) for p in found.axis] == [(3000, 2000), (1000, 2000)]
    assert [(round(o.start), round(o.end)) for o in found.openings] == [(500, 1400)]
    assert any("'P' is marked to move but stays: it stands in a part" in n for n in job.write(study, str(tmp_path)).notes)
    part.Placement = App.Placement(V(0, 0, 0), App.Rotation(V(1, 0, 0), 30))
    doc.recompute()
    assert document.read(doc).notes == ["'P' stands in a tilted part and was left out."]


def test_16_links_stand_in_the_plan_and_hold_what_they_show(doc, wishes, tmp_path):
    wall = wall_on(doc, "draft", (2000, 1000), (2000, 3000), label="P")
    link = doc.addObject("App::Link", "LinkP")
    link.LinkedObject = wall
    link.Placement.Base = V(2000, 1000, 0)
    marks.mark(wall, {"x": (-500, 500)})
    doc.recompute()
    first, second = document.read(doc).elements()
    xs, ys = zip(*second.rings[0])
    assert (min(xs), max(xs), min(ys), max(ys)) == (3950, 4050, 2000, 4000) and not second.clauses
    assert first.locked == "the link 'LinkP' shows it in another place and would move along"
    assert second.locked == "it is a link to another object"


def test_17_low_walls_stop_no_sight(doc, wishes):
    import Arch

    wall_on(doc, "draft", (0, 0), (3000, 0), label="high")
    base = wall_on(doc, "draft", (0, 2000), (3000, 2000), label="parapet").Base
    doc.getObjectsByLabel("parapet")[0].Height = 1000
    doc.recompute()
    study, reading = document.study(doc, wishes)
    assert [w.label for w in study.walls] == ["high"]
    assert reading.notes == ["'parapet' is lower than eye height (1.5 m): it stops no sight and was left out of the plan."]
    wishes.level = "knee"
    study, reading = document.study(doc, wishes)
    assert [w.label for w in study.walls] == ["high", "parapet"] and reading.notes == []
    base.Placement.Base = V(0, 0, 1000)
    doc.recompute()
    assert len(document.read(doc).elements()) == 2, "it stands on something and reaches over the eye"
