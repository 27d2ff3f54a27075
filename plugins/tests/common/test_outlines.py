import math

import pytest
from conftest import wall
from enfilade_common.model import Opening, Wall
from enfilade_common.outlines import wall_outlines


def test_a_wall_is_a_ring_round_its_axis():
    (ring,) = wall_outlines(wall("A", (0, 0), (1000, 0), 100))
    assert ring.points == [(0, 50), (1000, 50), (1000, -50), (0, -50)]


def test_faces_lie_where_the_justification_puts_them():
    (ring,) = wall_outlines(Wall("A", "A", [(0, 0), (0, 1000)], left=0, right=200))
    assert ring.points == [(0, 0), (0, 1000), (200, 1000), (200, 0)]


def test_doors_are_gaps_and_windows_where_asked():
    w = wall("A", (0, 0), (5000, 0))
    w.openings = [Opening("w", "w", 3000, 4000, "window"), Opening("d", "d", 1000, 1900)]
    spans = [[(o.points[0][0], o.points[1][0]) for o in wall_outlines(w, windows)] for windows in (True, False)]
    assert spans == [[(0, 1000), (1900, 3000), (4000, 5000)], [(0, 1000), (1900, 5000)]]


def test_a_door_at_the_very_end_leaves_no_sliver():
    w = wall("A", (0, 0), (2000, 0))
    w.openings = [Opening("d", "d", 1100, 2000)]
    assert [o.points[1][0] for o in wall_outlines(w)] == [1100]


def test_joints_of_one_wall_are_mitred():
    w = Wall("A", "A", [(0, 0), (1000, 0), (1000, 1000)], 50, 50)
    first, second = wall_outlines(w)
    assert first.points[1:3] == [(950, 50), (1050, -50)]
    assert [second.points[0], second.points[3]] == [(950, 50), (1050, -50)]


def test_a_closed_axis_has_a_quad_a_side_and_no_free_end():
    w = Wall("A", "A", [(0, 0), (4000, 0), (4000, 3000), (0, 3000)], 100, 100, closed=True)
    quads = wall_outlines(w)
    assert len(quads) == 4
    area = sum(abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(q.points, q.points[1:] + q.points[:1]))) / 2 for q in quads)
    assert area == pytest.approx(4200 * 3200 - 3800 * 2800)


def test_a_wall_without_thickness_is_its_axis():
    (line,) = wall_outlines(Wall("A", "A", [(0, 0), (0, 500)], 0, 0))
    assert (line.points, line.is_closed) == ([(0, 0), (0, 500)], False)


def test_a_slanted_wall_keeps_its_thickness():
    (ring,) = wall_outlines(wall("A", (0, 0), (3000, 4000), 300))
    a, b, c, _ = ring.points
    assert math.dist(b, c) == pytest.approx(300, abs=0.01) and math.dist(a, b) == pytest.approx(5000, abs=0.01)


def test_rings_begin_where_no_other_wall_is(house):
    from enfilade_common.outlines import begin_outside, study_outlines
    from enfilade_common.plane import is_inside

    rings = study_outlines(house)
    begin_outside(rings)
    for a in rings:
        assert not any(is_inside(b.points, a.written()[0]) for b in rings if b is not a), a.host_id
        assert a.unwritten(a.written()) == a.points


def test_windows_are_gaps_only_with_both_regions(house):
    from enfilade_common.model import Region
    from enfilade_common.outlines import study_outlines

    def pieces():
        return sum(o.owner == "S" for o in study_outlines(house))

    square = [(0, 0), (1, 0), (1, 1)]
    assert pieces() == 2
    house.regions = [Region("query", square), Region("reference", square)]
    assert pieces() == 3
    house.wishes.level = "knee"
    assert pieces() == 2
