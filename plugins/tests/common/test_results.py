import json
import math
import os
import subprocess

import pytest
from conftest import wall
from enfilade_common import job, preview, program, results
from enfilade_common.model import Clause, PluginError, Study, Wall, geometry_hash
from enfilade_common.moves import applied, plan_of
from enfilade_common.plane import distance


def near(a, b, within=0.1):
    return all(distance(p, q) < within for p, q in zip(a, b)) and len(a) == len(b)


def option_of(study, values, tmp_path):
    """A job and the option that the program would write for a parameter vector."""
    made = job.write(study, str(tmp_path))
    plan = plan_of(study)
    changes = []
    for outline, ring in zip(plan.outlines, applied(plan, values)):
        if ring != outline.points:
            metres = lambda points: [[x / 1000, y / 1000] for x, y in points]  # noqa: E731
            changes.append({
                "host_id": outline.host_id,
                "from": metres(outline.written()),
                "to": metres(outline.written(ring)),
            })
    return made, results.Option(1, "candidate-1.dxf", "", {}, {}, None, True, values, changes)


def test_a_shift_and_its_follower(house, tmp_path):
    made, option = option_of(house, [0, 300, 0, 0, 0], tmp_path)
    changes = {c.id: c for c in results.layout(made, option)}
    assert sorted(changes) == ["P1", "P2"]
    assert near(changes["P1"].axis_after, [(4300, 125), (4300, 5875)])
    assert near([changes["P1"].openings["D1"]((4000, 1000))], [(4300, 1000)])
    assert changes["P2"].motion is None and near(changes["P2"].axis_after, [(4350, 3000), (7000, 3000)])


def test_a_door_slides_while_its_wall_moves(house, tmp_path):
    made, option = option_of(house, [700, -250, 0, 0, 0], tmp_path)
    changes = {c.id: c for c in results.layout(made, option)}
    assert near(changes["P1"].axis_after, [(3750, 125), (3750, 5875)])
    assert near([changes["P1"].openings["D1"]((4000, 1075))], [(3750, 1775)])


def test_a_shift_then_a_turn(house, tmp_path):
    made, option = option_of(house, [0, 0, 200, 25, -120], tmp_path)
    changes = {c.id: c for c in results.layout(made, option)}
    c, s = 450 * math.cos(math.radians(25)), 450 * math.sin(math.radians(25))
    assert near(changes["P3"].axis_after, [(6450 - c, 4700 - s), (6450 + c, 4700 + s)])
    assert near([changes["C"].motion((2000, 3000))], [(1880, 3000)])


def test_a_mitred_wall_moves_as_a_whole(tmp_path):
    w = Wall("A", "A", [(0, 0), (2000, 0), (2000, 1000)], 100, 0, clauses=[Clause("rotate", -90, 90)])
    made, option = option_of(Study("t", "d", [w]), [30.0], tmp_path)
    (change,) = results.layout(made, option)
    assert change.motion.angle_rad == pytest.approx(math.radians(30))
    assert distance(*change.axis_after[:2]) == pytest.approx(2000)


def test_the_far_end_of_a_bent_wall_follows(tmp_path):
    bent = Wall("B", "B", [(0, 0), (0, 2000), (3000, 2000)], 50, 50)
    moving = wall("A", (3050, 1000), (3050, 3000), 100, clauses=[Clause("x", -500, 500)])
    made, option = option_of(Study("t", "d", [bent, moving]), [400.0], tmp_path)
    change = next(c for c in results.layout(made, option) if c.id == "B")
    assert near(change.axis_after, [(0, 0), (0, 2000), (3400, 2000)])


def test_a_bent_wall_is_refused(house, tmp_path):
    made, option = option_of(house, [0, 300, 0, 0, 0], tmp_path)
    change = next(c for c in option.changes if c["host_id"] == "P1/0")
    change["to"][0][0] += 0.05
    with pytest.raises(PluginError, match="'P1' would be bent"):
        results.layout(made, option)


def test_a_stranger_and_an_older_place_are_refused(house, tmp_path):
    made, option = option_of(house, [0, 300, 0, 0, 0], tmp_path)
    strange = dict(option.changes[0], host_id="nobody/0")
    with pytest.raises(PluginError, match="never wrote"):
        results.layout(made, results.Option(**{**option.__dict__, "changes": [strange]}))
    made.outlines[[o.host_id for o in made.outlines].index("P1/0")].points[0] = (1.0, 2.0)
    with pytest.raises(PluginError, match="at another place"):
        results.layout(made, option)


def test_what_was_edited_meanwhile_is_named(house, tmp_path):
    made, option = option_of(house, [0, 300, 0, 0, 0], tmp_path)
    changes = results.layout(made, option)
    assert results.edited_since(made, list(house.movables()), changes) == []
    house.element("P1").openings[0].start += 1
    house.walls = [w for w in house.walls if w.id != "P2"]
    assert results.edited_since(made, list(house.movables()), changes) == ["'P1' was edited", "'P2' was deleted"]


def test_the_hash_sees_geometry_and_nothing_else(house):
    w = house.element("P1")
    before = geometry_hash(w)
    w.label, w.clauses, w.group, w.axis = "other", [], "g", [(4000.001, 125), (4000, 5875)]
    assert geometry_hash(w) == before
    w.right += 1
    assert geometry_hash(w) != before


def test_another_schema_and_half_a_file_are_refused(tmp_path):
    folder = tmp_path / "round-01"
    folder.mkdir()
    for text, words in (
        (json.dumps({"schema": "enfilade.result/2"}), "different versions"),
        (json.dumps({"schema": "enfilade.result/1", "candidates": []}), "not complete"),
        ('{"schema": "enf', "cannot be read"),
        ("[]", "different versions"),
    ):
        (folder / "result.json").write_text(text)
        with pytest.raises(PluginError, match=words):
            results.read(str(folder))


def test_rounds_are_ordered_by_number(tmp_path):
    for name in ("round-10", "round-9", "round-02", "analysis", "round-x"):
        (tmp_path / name).mkdir()
    assert [os.path.basename(p) for p in results.round_folders(str(tmp_path))] == ["round-02", "round-9", "round-10"]


def run_to_end(path, made):
    ended = subprocess.run([path, *program.arguments(made.drawing)], stderr=subprocess.PIPE, timeout=240)
    assert ended.returncode in (0, 1), ended.stderr


def test_the_program_gives_back_what_was_asked(house, tmp_path, real_program):
    """The real program: its options match by id, to a tenth of a millimetre of its own parameters."""
    made = job.write(house, str(tmp_path))
    run_to_end(real_program, made)
    found = results.latest(job.read(str(tmp_path)))
    assert len(found.options) == 2
    plan = plan_of(house)
    for option in found.options:
        expected = applied(plan, option.parameters)
        told = {c["host_id"]: c["to"] for c in option.changes}
        for outline, ring in zip(plan.outlines, expected):
            corners = told.get(outline.host_id)
            there = outline.unwritten([(1000 * x, 1000 * y) for x, y in corners]) if corners else outline.points
            assert near(there, ring, 0.1), outline.host_id
        assert results.layout(made, option)
        assert [v for by in results.gone(plan, found, option).values() for v in by.values()] == option.parameters
        for measure in ("degree", "mean-depth"):
            assert option.change(measure) in option.words, "panel, terminal and drawing say the same"
    assert found.best is None or found.best.change("degree") in found.best.words
    assert found.version == program.version(real_program)


def test_an_older_round_is_not_taken_for_a_newer_export(house, tmp_path, real_program):
    made = job.write(house, str(tmp_path))
    run_to_end(real_program, made)
    house.element("P2").axis[1] = (6800, 3000)
    with pytest.raises(PluginError, match="earlier export"):
        results.latest(job.write(house, str(tmp_path)))


def test_the_cells_of_an_option_are_those_of_the_round(house, tmp_path, real_program):
    made = job.write(house, str(tmp_path))
    run_to_end(real_program, made)
    found = results.latest(made)
    for drawing, mean in [("initial.dxf", found.initial)] + [(o.file, o.mean) for o in found.options]:
        words = program.cells_arguments(
            os.path.join(found.folder, drawing), str(tmp_path / "cells"), "eye", found.unit, found.spacing_m, found.lattice_centre
        )
        said = subprocess.run([real_program, *words], stdout=subprocess.PIPE, check=True).stdout.decode()
        cells = preview.read_cells(said.splitlines())
        for measure in ("degree", "mean-depth", "depth", "entropy"):
            values = cells.values[measure]
            assert sum(values) / len(values) == pytest.approx(mean[measure], rel=1e-9), (drawing, measure)
        assert len(set(cells.values["degree"])) > 50, "values, not a dozen colours"
        assert all(-200 < x < 8200 for x, _ in cells.places)


def test_cells_without_a_value_are_left_out():
    table = ["Ref,x,y,Degree,Visual Mean Depth,Depth,Entropy", "1,0,0,5,1.5,3,0.2", "2,1,0,1,,1,0"]
    cells = preview.read_cells(table)
    assert (cells.places, cells.values["mean-depth"]) == ([(0.0, 0.0)], [1.5])
    with pytest.raises(PluginError, match="cannot be read"):
        preview.read_cells([])


def test_only_what_moved_is_outlined(house, tmp_path):
    made, option = option_of(house, [700, 0, 0, 0, 0], tmp_path)
    gone, new = preview.ghosts(made, option)
    ys = [y for line in [*gone, *new] for _, y in line]
    assert 600 < min(ys) and max(ys) < 2300, "a door slides from 625 to 1325 mm: nothing else of its wall is drawn"
    assert any(line == [(3950, 625), (3950, 1325)] for line in new), "wall where the door was"
    made, option = option_of(house, [0, 300, 0, 0, 0], tmp_path)
    gone, new = preview.ghosts(made, option)
    assert any(len(line) == 5 for line in new), "what moves as a whole is outlined as a whole"
    assert all(x < 4500 for line in [*gone, *new] for x, _ in line), "of the wall that follows, its end alone"


def test_what_was_gone_is_told_by_what_was_marked(house, tmp_path):
    made, option = option_of(house, [700, -250, 200, 25, -120], tmp_path)
    plan = plan_of(house)
    moves = [(t.name, t.clause.kind) for t in plan.tables]
    found = results.Round("", 1, "", {}, [], [], "", 1.0, (0, 0), moves=moves)
    everything = {"D1": {"along": 700}, "P1": {"x": -250}, "P3": {"y": 200, "rotate": 25}, "C": {"x": -120}}
    assert results.gone(plan, found, option) == everything
    # What would do nothing is no move to the program.
    del found.moves[2], option.parameters[2]
    assert results.gone(plan, found, option) == {**everything, "P3": {"rotate": 25}}
    found.moves[1] = ("stranger", "x")
    with pytest.raises(PluginError, match="'stranger'"):
        results.gone(plan, found, option)
    option.parameters[1] = 0.0
    assert results.gone(plan, found, option) == {"D1": {"along": 700}, "P3": {"rotate": 25}, "C": {"x": -120}}


def round_in(folder, sha256, version="0.1.0 (a)", problems=()):
    os.makedirs(folder)
    data = {
        "schema": "enfilade.result/1", "version": version, "input": {"sha256": sha256}, "initial": {"mean": {}},
        "candidates": [], "moves": [], "problems": list(problems), "stopped_by": "", "spacing_m": 1, "lattice_centre": [0, 0],
    }
    with open(os.path.join(folder, "result.json"), "w") as f:
        json.dump(data, f)


def test_a_run_that_writes_nothing_or_another_version_is_no_result(house, tmp_path):
    made = job.write(house, str(tmp_path))
    first, second = (os.path.join(made.results_folder, n) for n in ("round-01", "round-02"))
    round_in(first, made.sha256)
    with pytest.raises(PluginError, match="without writing any result"):
        results.made_since(made, [first], "0.1.0 (a)")
    round_in(second, made.sha256, "0.1.0 (b)")
    with pytest.raises(PluginError, match=r"Enfilade 0.1.0 \(a\) was started, but the result is of 0.1.0 \(b\)"):
        results.made_since(made, [first], "0.1.0 (a)")
    assert results.made_since(made, [first], "0.1.0 (b)").number == 2


def test_the_best_so_far_is_put_aside_and_found_again(house, tmp_path):
    made = job.write(house, str(tmp_path))
    first, so_far = (os.path.join(made.results_folder, n) for n in ("round-01", "so-far"))
    round_in(first, made.sha256)
    round_in(so_far, made.sha256)
    os.utime(first, (1, 1))
    kept = results.keep_so_far(made, so_far)
    assert kept.is_so_far and kept.number == 2 and kept.folder != so_far
    assert results.latest(made).folder == kept.folder
    entry = results.lineage_entry(kept, results.Option(1, "", "", {}, {}, None, True, [], []), "plan.dxf")
    assert entry["so-far"] is True and entry["round"] == 2
    os.utime(kept.folder, (0, 0))
    assert results.latest(made).number == 1
    with pytest.raises(PluginError, match="cannot be kept"):
        results.keep_so_far(made, os.path.join(made.results_folder, "nothing"))


def test_warnings_come_before_notes(tmp_path):
    problems = [{"severity": s, "place": "p", "text": s} for s in ("info", "warning", "info")]
    round_in(str(tmp_path / "round-01"), "", problems=problems)
    notes = results.read(str(tmp_path / "round-01")).notes
    assert [n.text for n in notes] == ["warning", "info", "info"] and [n.is_warning for n in notes] == [True, False, False]


def test_changes_are_told_as_the_program_tells_them() -> None:
    def option(measure: str, share: float, low: float, high: float, sense: str) -> results.Option:
        gain = {measure: {"share": share, "low": low, "high": high, "sense": sense}}
        return results.Option(1, "", "", {}, {}, None, True, [], [], gain)

    for change, words in (
        (option("degree", 0.09, 0.07, 0.11, "max"), "+9 % (7 to 11 %)"),
        (option("degree", 0.04, 0.032, 0.041, "min"), "−4.0 % (−4.1 to −3.2 %)"),
        (option("degree", 0.004, -0.012, 0.02, "max"), "unchanged (−2 to 2 %)"),
        (option("degree", -0.05, -0.08, -0.02, "min"), "+5 % (2 to 8 %)"),
        (option("degree", 0.01, 0.001, 0.02, "min"), "−1.0 % (−2.0 to −0.1 %)"),
        (option("degree", 0.0, -0.0001, 0.0, "max"), "unchanged (−0.1 to 0.0 %)"),
    ):
        assert change.change("degree") == words
        assert change.change("entropy") == ""
    assert option("score", 0.09, 0.07, 0.11, "max").change("score") == "+0.09 (0.07 to 0.11)"
