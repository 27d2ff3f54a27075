import os
import re
import subprocess

import pytest
from conftest import LIB
from enfilade_common import job, results
from enfilade_common.model import PluginError, Wishes
from enfilade_common.moves import applied, plan_of
from enfilade_common.plane import distance
from enfilade_revit import applying, reading, work
from enfilade_revit.data import RevitWall


def option_of(host, folder, values):
    """A job and the option of chosen parameters, as the program writes it."""
    study, _ = reading.study(host, Wishes())
    made = job.write(study, str(folder))
    plan = plan_of(study)
    values = [values.get((t.name, t.clause.kind), 0.0) for t in plan.tables]
    metres = lambda points: [[x / 1000, y / 1000] for x, y in points]  # noqa: E731
    changes = [
        {"host_id": o.host_id, "from": metres(o.written()), "to": metres(o.written(ring))}
        for o, ring in zip(plan.outlines, applied(plan, values))
        if ring != o.points
    ]
    return made, results.Option(1, "candidate-1.dxf", "", {}, {}, None, True, values, changes)


MOVES = {("Partition", "x"): 400.0, ("Door", "along"): 700.0, ("Screen", "y"): 200.0, ("Screen", "rotate"): 15.0, ("Column", "x"): -100.0}


def test_the_view_becomes_a_study(revit, square):
    revit.lines = square("EF-QUERY") + square("ef-keep", 3000.0) + square("Thin Lines", 9000.0)
    study, notes = reading.study(revit, Wishes())
    assert notes == [] and len(study.walls) == 7 and study.storey == "Level 1"
    assert [(r.kind, len(r.points)) for r in study.regions] == [("query", 4), ("keep", 4)]
    partition = study.element("201")
    assert [c.text() for c in partition.clauses] == ["x -1000 1000"]
    assert [(o.start, o.end, o.clauses[0].lower) for o in partition.openings] == [(425, 1325, -300)]


def test_line_styles_name_pairs(revit, square):
    revit.lines = square("EF-QUERY-Entrance") + square("EF-REFERENCE-entrance", 3000.0) + square("EF-QUERY-a/b", 9000.0)
    study, notes = reading.study(revit, Wishes())
    assert [(r.kind, r.pair) for r in study.regions] == [("query", "entrance"), ("reference", "entrance")]
    assert len(notes) == 1 and "cannot name a pair" in notes[0]


def test_marks_that_cannot_be_read_are_told():
    notes = []
    assert reading.clauses("x 5 9; up 1 2; rotate -5 5; along -1ft 1ft", 90.0, "W", notes)[1].direction_deg == 90.0
    assert len(notes) == 2 and "'x 5 9'" in notes[0] and "'up 1 2'" in notes[1]
    assert reading.length_mm("-1.5m") == -1500 and reading.length_mm("2ft") == pytest.approx(609.6)


def test_open_detail_lines_are_told(revit, square):
    revit.lines = square("EF-QUERY")[:3]
    _, notes = reading.study(revit, Wishes())
    assert notes == ["Detail lines on EF-QUERY do not close; they were left out."]


def test_an_option_moves_everything_in_one_undo_step(revit, tmp_path):
    made, option = option_of(revit, tmp_path, MOVES)
    applying.apply(revit, made, option)
    assert [name for name, _ in revit.undo] == ["Enfilade: option 1"]
    at = revit.things
    assert at[201].axis == [pytest.approx(p, abs=0.1) for p in [(4400, 125), (4400, 5875)]]
    assert at[202].axis == [pytest.approx(p, abs=0.1) for p in [(4450, 3000), (7000, 3000)]]
    assert at[301].centre == pytest.approx((4400, 1700), abs=0.1), "the door slid and went along"
    assert at[302].centre == (6000, 0), "the window of a wall that stays, stays"
    assert at[401].ring[0] == pytest.approx((1700, 2900), abs=0.1)
    assert distance(*at[203].axis) == pytest.approx(900, abs=0.1)


def test_an_edited_pinned_or_deleted_wall_is_refused(revit, tmp_path):
    made, option = option_of(revit, tmp_path, MOVES)

    def refused(words):
        before = repr(revit.things)
        with pytest.raises(PluginError, match=words):
            applying.apply(revit, made, option)
        assert repr(revit.things) == before and revit.undo == []

    revit.things[203].is_pinned = True
    refused("pinned")
    revit.things[203].is_pinned = False
    revit.things[203].axis[1] = (6950.0, 4500.0)
    refused("'Screen' was edited")
    del revit.things[203]
    refused("'Screen' was deleted")


def test_a_wall_that_revit_holds_rolls_everything_back(revit, tmp_path):
    made, option = option_of(revit, tmp_path, MOVES)
    before = repr(revit.things)
    revit.refuses = 203
    with pytest.raises(PluginError, match="Revit holds it"):
        applying.apply(revit, made, option)
    assert repr(revit.things) == before and revit.undo == []


def test_a_drawing_of_revits_own_is_matched_by_element_id(revit):
    faces = [[[3.95, 0.125], [3.95, 5.875]], [[4.05, 0.125], [4.05, 5.875]]]
    changes = [{"host_id": "201", "from": f, "to": [[x + 0.3, y] for x, y in f]} for f in faces]
    option = results.Option(2, "", "", {}, {}, None, True, [], changes)
    assert applying.apply_drawing(revit, option) == ["201"]
    assert revit.things[201].axis[0] == pytest.approx((4300, 125))
    changes[1]["to"] = changes[1]["from"]
    with pytest.raises(PluginError, match="does not keep its shape"):
        applying.apply_drawing(revit, option)
    changes[1]["host_id"] = None
    with pytest.raises(PluginError, match="without Revit's id"):
        applying.apply_drawing(revit, option)


def test_a_curved_wall_moves_as_a_whole(revit, tmp_path):
    ring = [(1000.0, 5000.0), (1500.0, 5200.0), (1500.0, 5300.0), (1000.0, 5100.0)]
    revit.add(RevitWall(204, "Bow", None, 50.0, 50.0, [ring], {"Enfilade Moves": "x -100 100"}))
    made, option = option_of(revit, tmp_path, {("Bow", "x"): 50.0})
    applying.apply(revit, made, option)
    assert revit.things[204].rings[0][0] == pytest.approx((1050, 5000))


def test_the_buttons_from_marks_to_undo(revit, window, real_program):
    said = window()
    work.describe_marks(revit, said)
    assert "Partition: x -1000 1000" in said.said[0]
    work.guarded(said, lambda: work.candidates(revit, said))
    assert "run one first" in said.said[-1]
    study, _ = reading.study(revit, Wishes(members=2, evaluations=150))
    made = job.write(study, work.job_folder(revit))
    assert subprocess.run([real_program, "run", made.drawing, "--quiet"]).returncode in (0, 1)
    asked = window(0)
    work.candidates(revit, asked)
    assert all(os.path.exists(picture) for _, _, picture in asked.rows)
    assert len(revit.undo) == 1 and "Undo takes all of it back" in asked.said[-1]


def test_every_button_has_its_parts():
    folder = os.path.join(LIB, "..", "Enfilade.tab", "Enfilade.panel")
    buttons = [b for b in os.listdir(folder) if b.endswith(".pushbutton")]
    with open(os.path.join(folder, "bundle.yaml")) as f:
        assert sorted(re.findall(r"- (\w+)", f.read())) == sorted(b.split(".")[0] for b in buttons)
    for button in buttons:
        assert sorted(os.listdir(os.path.join(folder, button))) == ["bundle.yaml", "icon.png", "script.py"]
        with open(os.path.join(folder, button, "script.py")) as f:
            called = re.search(r"work\.(\w+)\(host, window\)", f.read()).group(1)
        assert callable(getattr(work, called))
