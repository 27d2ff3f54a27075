from conftest import wall
from enfilade_common.model import Clause, Study
from enfilade_common.moves import applied, plan_of, why_nothing_moves
from enfilade_common.plane import distance


def table(plan, name, kind):
    return next(t for t in plan.tables if t.name == name and t.clause.kind == kind)


def test_a_wall_takes_the_ends_that_run_along_its_way(house):
    plan = plan_of(house)
    nodes = set(table(plan, "P1", "x").nodes(plan.outlines))
    assert {(4050, 3050), (4050, 2950)} <= nodes, "the end of P2 that stands on P1 follows"
    assert not {(7000, 3050), (7000, 2950)} & nodes, "its other end stays"
    assert table(plan, "P1", "x").followers == ["P2"]


def test_a_wall_across_the_way_stays(house):
    house.element("P1").clauses = [Clause("y", -50, 50)]
    plan = plan_of(house)
    assert table(plan, "P1", "y").followers == []
    assert any("'P1' comes apart from" in n and "'S'" in n for n in plan.notes), plan.notes


def test_a_turn_that_opens_joints_is_said(house):
    house.element("P1").clauses = [Clause("rotate", -10, 10)]
    notes = plan_of(house).notes
    assert any("by turning" in n and "'P2'" in n for n in notes), notes


def test_every_clause_is_a_table_and_doors_come_first(house):
    names = [(t.name, t.clause.kind) for t in plan_of(house).tables]
    assert names == [("Tür 1", "along"), ("P1", "x"), ("P3", "y"), ("P3", "rotate"), ("Säule", "x")]


def test_bounds_end_where_nothing_would_be_left(house):
    house.element("P1").clauses = [Clause("x", -1000, 9000)]
    plan = plan_of(house)
    assert table(plan, "P1", "x").clause.upper == 2950 - 50
    assert any("'P1' moves only -1000 to 2900 mm" in n for n in plan.notes), plan.notes


def test_two_doors_in_one_wall_share_the_piece_between_them():
    from enfilade_common.model import Opening

    w = wall("A", (0, 0), (5000, 0))
    slide = [Clause("along", -3000, 3000)]
    w.openings = [Opening("a", "a", 1000, 1900, clauses=slide), Opening("b", "b", 2900, 3800, clauses=slide)]
    plan = plan_of(Study("t", "d", [w]))
    a, b = (t.clause for t in plan.tables)
    assert (a.lower, a.upper, b.lower, b.upper) == (-950, 475, -475, 1150)
    rings = applied(plan, [a.upper, b.lower])
    assert all(distance(r[0], r[1]) >= 49.9 for r in rings)


def test_a_group_moves_no_farther_than_each_of_its_walls_may():
    walls = [wall("A", (0, 0), (1000, 0), group="g"), wall("B", (0, 1000), (1000, 1000), group="g")]
    walls.append(wall("C", (0, 2000), (1000, 2000), group="g"))
    walls[0].clauses = [Clause("x", -100, 400), Clause("rotate", -5, 5)]
    walls[1].clauses = [Clause("x", -300, 200)]
    (table,) = plan_of(Study("t", "d", walls)).tables
    assert (table.clause.kind, table.clause.lower, table.clause.upper) == ("x", -100, 200)
    assert table.members == ["A", "B", "C"]


def test_walls_of_a_group_move_together_and_disagreement_is_said():
    walls = [wall("A", (0, 0), (1000, 0), group="g"), wall("B", (0, 1000), (1000, 1000), group="g")]
    walls[0].clauses = [Clause("x", -1, 1)]
    walls[1].clauses = [Clause("x", -2, 2)]
    plan = plan_of(Study("t", "d", walls))
    assert [(t.name, len(t.corners), t.clause.upper) for t in plan.tables] == [("g", 8, 1)]
    assert "marked differently" in plan.notes[0]


def test_a_locked_wall_is_not_moved_and_says_why():
    w = wall("A", (0, 0), (1000, 0), clauses=[Clause("x", -1, 1)], locked="its base is locked")
    plan = plan_of(Study("t", "d", [w]))
    assert plan.tables == [] and plan.notes == ["'A' is marked to move but stays: its base is locked."]


def test_corners_that_coincide_but_move_apart_are_written_apart():
    moving = wall("A", (0, 50), (1000, 50), 100, clauses=[Clause("y", -500, 500)])
    fixed = wall("B", (1000, 50), (2000, 50), 100, clauses=[])
    plan = plan_of(Study("t", "d", [moving, fixed]))
    mine, theirs = (set(o.points) for o in plan.outlines)
    assert min(distance(p, q) for p in mine for q in theirs) > 1.0
    assert mine == {(0, 100), (1000, 100), (1000, 0), (0, 0)}, "the moving wall stands exactly"


def test_without_movement_nothing_is_applied(house):
    plan = plan_of(house)
    assert applied(plan, [0.0] * len(plan.tables)) == [o.points for o in plan.outlines]


def test_why_nothing_moves():
    slide = [Clause("x", -1, 1)]
    a = wall("A", (0, 0), (1000, 0))
    assert why_nothing_moves(Study("t", "d", [a])) == ["no wall, column, door or window is marked"]
    a.clauses, a.locked = slide, "it is a clone of another wall"
    b = wall("B", (0, 900), (1000, 900), clauses=slide, keep=True)
    assert why_nothing_moves(Study("t", "d", [a, b])) == [
        "'A' is marked to move but stays: it is a clone of another wall",
        "'B' is marked to move but stays: it is marked 'must stay' too",
    ]
    a.locked = ""
    assert why_nothing_moves(Study("t", "d", [a, b])) == []


def test_a_wall_that_must_stay_does_not_follow(house):
    house.element("P2").keep = True
    plan = plan_of(house)
    assert table(plan, "P1", "x").followers == []
    assert any("'P1' comes apart from" in n and "'P2'" in n for n in plan.notes), plan.notes
