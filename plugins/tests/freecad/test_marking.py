"""Building works as marks on FreeCAD's objects: written, saved, undone, exported; what may be done with each object."""

import json
import os

import Arch
import FreeCAD as App
import pytest
from conftest import V, build_house, door_in, wall_on
from enfilade import accept, document, marks, offers
from enfilade_common import allowed, job
from enfilade_common.model import Allowed, Wishes
from test_plan2d import draw

OPEN = Allowed("open", 900.0, 2400.0)


def unmarked(doc):
    walls, door, column = build_house(doc)
    for obj in (*walls.values(), door, column):
        marks.unmark(obj)
    doc.recompute()
    doc.clearUndos()
    return walls, door, column


def test_works_are_marks_like_moves(doc, tmp_path):
    walls, door, _ = unmarked(doc)
    doc.openTransaction("mark")
    marks.mark(walls["P1"], {"x": (-100, 100)}, works=[OPEN, Allowed("remove")])
    marks.mark(door, {}, works=[allowed.usual("widen")])
    doc.commitTransaction()
    assert doc.UndoCount == 1 and walls["P1"].EnfiladeWorks == "open 900mm 2400mm; remove"
    assert document.marked(doc) == {"": ["P1", "Tür 1"]}
    path = str(tmp_path / "House.FCStd")
    doc.saveAs(path)
    App.closeDocument(doc.Name)
    again = App.openDocument(path)
    again.UndoMode = 1
    partition = again.getObjectsByLabel("P1")[0]
    assert marks.works(partition) == [OPEN, Allowed("remove")] and marks.bounds(partition) == {"x": (-100, 100)}
    again.openTransaction("remove marks")
    marks.unmark(partition)
    again.commitTransaction()
    assert not marks.is_marked(partition)
    again.undo()
    assert marks.works(partition) == [OPEN, Allowed("remove")]


def test_what_is_written_by_hand_is_read_and_what_cannot_be_is_told(doc):
    walls, door, _ = unmarked(doc)
    marks.mark(walls["P2"], {}, works=[OPEN])
    walls["P2"].EnfiladeWorks = "Open 0.9m; paint; end -1m 0"
    reading = document.read(doc)
    found = reading.found[marks.ids(doc)[walls["P2"].Name]].element
    assert [w.text() for w in found.works] == ["open 900mm 900mm", "end -1000mm 0"]
    said = "'P2': 'paint' is no building work, expected for example 'open 900mm 2400mm; remove'."
    assert said in reading.notes


def test_what_may_be_done_is_named(doc):
    walls, door, column = unmarked(doc)
    window = door_in(walls["N"], (2000, 6000), kind="Open 1-pane", label="Fenster", sill=900.0)
    bow = Arch.makeWall(App.ActiveDocument.addObject("Part::Box", "Box"), height=3000)
    bow.Label = "Klotz"
    bow.Base.Length, bow.Base.Width, bow.Base.Height = 300, 300, 3000
    bow.Base.Placement.Base = V(5500, 1000, 0)
    doc.recompute()
    known = offers.Offers()
    objects = [walls["P1"], door, walls["N"], window, column, bow]
    said = offers.said([(o, known.of(o, None, "eye")) for o in objects]).split("\n")
    assert said[0].startswith("P1 can: move, turn, get an opening, get a door, get glass, get wider doors") and "end" not in said[0]
    assert said[1:4] == [
        "Tür 1 can: slide along the wall, become wider, be walled up, be hung elsewhere in its wall.",
        "N can: move, turn, get a new wall across the room.",
        "Fenster can: slide along the wall.",
    ]
    assert said[4:] == [
        "…",
        "N: outdoors on one side, so nothing is opened or walled up.",
        "Fenster: windows are not rebuilt.",
        "Säule: columns are not rebuilt.",
        "Klotz: has no straight axis, so no part of it is opened.",
    ]


def test_offers_follow_the_document_and_the_marks(doc):
    walls, door, _ = unmarked(doc)
    known = offers.Offers()
    assert "open" in known.of(walls["P1"], None, "eye").works
    marks.mark(walls["P1"], {}, is_kept=True)
    assert known.of(walls["P1"], None, "eye").why == ["kept"], "marks are no change of the plan"
    marks.unmark(walls["P1"])
    walls["P2"].Base.Placement.Base = V(0, 0, 0)
    walls["P2"].setExpression("Placement.Base.x", "1 mm")
    known.forget()
    offer = known.of(walls["P2"], None, "eye")
    said = offers.said([(walls["P2"], offer)])
    assert (offer.moves, offer.works) == ([], []) and said == "P2: stays, since an expression decides where 'P2' stands."


def works_of(found):
    with open(os.path.join(found.folder, "result.json")) as f:
        return [w for c in json.load(f)["candidates"] for w in c["works"]]


@pytest.mark.parametrize("kind", ("draft", "sketch", "bare"))
def test_options_build_what_is_marked_and_nothing_else(doc, tmp_path, run_study, kind):
    walls, door, column = build_house(doc, kind)
    for obj in (*walls.values(), door, column):
        marks.unmark(obj)
    marks.mark(walls["P2"], {}, works=[Allowed("open", 900.0, 1800.0)])
    written, found = run_study(doc, Wishes(members=2, evaluations=60), tmp_path)
    works = works_of(found)
    assert works and {w["kind"] for w in works} == {"open"}, works
    assert all(abs(y - 3.0) < 0.01 for w in works for _, y in w["stretch"]), "in P2 alone"
    doc.clearUndos()
    accept.accept(doc, written, found, found.options[0])
    assert doc.UndoCount == 1 and any(document.kind_of(o) == "Window" and o != door for o in doc.Objects)


def test_a_door_is_rebuilt_where_it_is_marked(doc, tmp_path, run_study):
    walls, door, _ = unmarked(doc)
    marks.mark(door, {}, works=[Allowed("widen", 1200.0, 1800.0)])
    written, found = run_study(doc, Wishes(members=1, evaluations=60), tmp_path)
    assert {w["kind"] for w in works_of(found)} == {"widen"}
    accept.accept(doc, written, found, found.options[0])


def test_lines_carry_works_and_their_pieces_too(doc, tmp_path, run_study):
    made = draw(doc, "draft")
    for obj in made.values():
        marks.unmark(obj)
    lines = [o for n, o in made.items() if n[0] == "P"]
    for line in lines:
        marks.mark(line, {}, works=[Allowed("open", 900.0, 1200.0)])
    written, found = run_study(doc, Wishes(members=1, evaluations=60), tmp_path)
    assert job.read(str(tmp_path)).study.rebuilt() and {w["kind"] for w in works_of(found)} == {"open"}
    before = len([o for o in doc.Objects if marks.works(o)])
    accept.accept(doc, written, found, found.options[0])
    assert len([o for o in doc.Objects if marks.works(o)]) > before, "what a line is cut into keeps its marks"
