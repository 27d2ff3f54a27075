"""2D plans: strokes written as they are, moved by whole entities, taken back from the result."""

import math
import subprocess

import pytest
from enfilade_common import drawn, job, preview, results
from enfilade_common.model import Clause, Drawn, PluginError, Stroke, Study, Wishes
from enfilade_common.moves import why_nothing_moves


def line(id, *points, **rest):
    return Drawn(id, id, [Stroke("lines", list(points), rest.pop("closed", False))], **rest)


def plan():
    """Two rooms, a free wall of four lines, a door swing, a table that is stiff."""
    ring = [(5500, 2500), (5600, 2500), (5600, 4500), (5500, 4500), (5500, 2500)]
    may = dict(group="Q", clauses=[Clause("x", -500, 500), Clause("rotate", -15, 15)])
    out = [line("outer", (0, 0), (8000, 0), (8000, 6000), (0, 6000), closed=True)]
    left = [(3950, 5750), (250, 5750), (250, 250), (3950, 250), (3950, 700), (4050, 700), (4050, 250)]
    right = [(7750, 250), (7750, 5750), (4050, 5750), (4050, 1600), (3950, 1600), (3950, 5750)]
    inner = [*left, *right]
    out += [line(f"i{i}", a, b) for i, (a, b) in enumerate(zip(inner, inner[1:]))]
    out += [line(f"q{i}", a, b, **may) for i, (a, b) in enumerate(zip(ring, ring[1:]))]
    out.append(Drawn("swing", "swing", [Stroke("arc", [(4900, 700), (4000, 1600)], False, (4000, 700), 900.0)], "Türen"))
    out.append(line("table", (1000, 4000), (1600, 4000), (1600, 4400), closed=True, is_stiff=True))
    return Study("test", "doc", drawn=out, wishes=Wishes(members=1, evaluations=60))


def test_what_is_written_is_what_is_drawn(tmp_path):
    made = job.write(plan(), str(tmp_path))
    text = open(made.drawing).read()
    assert [text.count(f"\n{kind}\n") for kind in ("LINE", "ARC", "POLYLINE")] == [4 + 12, 1, 1 + 1 + 3]
    assert text.count("\nEF-KEEP\n") == 1 + 3 * 6, "the layer, and the three corners of the table: polyline, vertices, end"
    assert "T\\U+00FCren" in text and "$INSUNITS\n70\n0\n" in text
    settings = open(tmp_path / "plan.enfilade.toml").read()
    assert 'moves = "x -500mm 500mm; rotate -15 15"' in settings and settings.count("[[move]]") == 1
    assert "unit =" not in settings and 'unsure = "optimise"' in settings
    again = job.read(str(tmp_path))
    assert (again.study, again.outlines) == (made.study, made.outlines)


def test_the_program_moves_the_lines_themselves(tmp_path, real_program):
    made = job.write(plan(), str(tmp_path))
    done = subprocess.run([real_program, "run", made.drawing, "--quiet"], stdin=subprocess.DEVNULL)
    assert done.returncode in (0, 1)
    found = results.latest(made)
    layout = found.options[0] if found.options else found.best
    assert found.unit == "mm" and layout is not None, found.notes
    changes = {c.id: c for c in results.layout(made, layout)}
    assert sorted(changes) == ["q0", "q1", "q2", "q3"]
    first = changes["q0"].motion
    for change in changes.values():
        assert change.axis_after == [pytest.approx(first(p), abs=0.1) for p in change.axis_before], "one wall, one motion"
    gone, new = preview.ghosts(made, layout)
    assert len(gone) == len(new) == 4
    assert all(abs(v) <= 500 for by in results.gone(made.plan, found, layout).values() for v in by.values())


def test_a_plan_in_metres_is_scaled(tmp_path):
    study = plan()
    made = job.write(study, str(tmp_path))
    change = {"host_id": "q1/0", "from": [[5600, 2500], [5600, 4500]], "to": [[5600, 2500], [5600, 4000]]}
    option = results.Option(1, "", "", {}, {}, None, True, [], [change], per_metre=1.0)
    (moved,) = results.layout(made, option)
    assert moved.motion is None and moved.axis_after == [(5600, 2500), (5600, 4000)]
    option.changes[0]["from"] = [[5600.001, 2500], [5600, 4500]]
    with pytest.raises(PluginError, match="at another place"):
        results.layout(made, option)


def test_an_arc_stays_an_arc_and_a_stiff_thing_stiff():
    swing, table = plan().drawn[-2:]
    assert drawn.keeps_shape(swing, [[(4900, 1200), (4000, 2100)]], 0.1)
    assert not drawn.keeps_shape(swing, [[(4900, 1200), (4000, 1600)]], 0.1)
    assert not drawn.keeps_shape(table, [[(1000, 4000), (1700, 4000), (1700, 4400)]], 0.1)
    points = drawn.traced(swing.strokes[0])
    assert points[0] == pytest.approx((4900, 700)) and points[-1] == pytest.approx((4000, 1600))
    assert all(math.hypot(x - 4000, y - 700) == pytest.approx(900) for x, y in points)


def test_what_stands_against_moves_is_said():
    study = plan()
    for element in study.drawn:
        element.clauses, element.group = [], ""
    assert why_nothing_moves(study) == ["no line is marked"]
