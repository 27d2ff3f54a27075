"""Walls without an axis, as IFC files bring them: where a work is done in one of them."""

from typing import Any, List, Optional, Tuple

from enfilade_common.model import Wall
from enfilade_common.plane import Point, direction, distance, distance_to_segment, dot, is_inside, left_of, minus, plus
from enfilade_common.works import Work

from . import document, hosted
from .document import Found, Reading, Vector

#: What is drawn of a wall may stand so far beside the stretch that removes it, mm.
BESIDE_MM = 30.0
#: Jambs are looked at so far from where they should be, mm.
LOOK_MM = 1.5


def walls(reading: Reading) -> List[Found]:
    return [f for f in reading.found.values() if isinstance(f.element, Wall) and f.element.rings]


def host(reading: Reading, work: Work, a: Point, b: Point) -> Optional[Tuple[Found, Wall]]:
    """The wall in whose body a stretch lies, and that stretch as a wall of its own with the faces that the work tells."""
    thickness = _thickness(work)
    for found in walls(reading) if thickness > 0.0 else ():
        part = stretch(found, a, b, thickness)
        if _is_body(found.element.rings, part, work.opening):
            return found, part
    return None


def _is_body(rings: List[List[Point]], part: Wall, hole) -> bool:
    """Whether a straight stretch has its faces where the wall has them, but for a hole that is there already."""
    a, b = part.axis
    u, half = direction(a, b), part.thickness / 2.0
    places = [p for p in (plus(a, u, LOOK_MM), part.at(part.length() / 2), plus(b, u, -LOOK_MM)) if not _is_in_hole(p, hole)]

    def is_in(p: Point, off: float) -> bool:
        return any(is_inside(ring, plus(p, left_of(u), off)) for ring in rings)

    within = all(is_in(p, side * (half - LOOK_MM)) for p in places for side in (-1, 1))
    return bool(places) and within and not any(is_in(p, side * (half + LOOK_MM)) for p in places for side in (-1, 1))


def _is_in_hole(p: Point, hole) -> bool:
    return hole is not None and distance_to_segment(p, *hole) <= 2 * LOOK_MM


def stretch(found: Found, a: Point, b: Point, thickness: float) -> Wall:
    element = found.element
    half = thickness / 2.0
    return Wall(element.id, element.label, [a, b], half, half, name=element.name, height=element.height)


def _thickness(work: Work) -> float:
    sides = [distance(q[0], q[3]) for q in work.demolished] + [b.thickness for b in work.built]
    return max(sides, default=0.0)


def opening(reading: Reading, a: Point, b: Point, within: float) -> Optional[Tuple[Found, Any]]:
    """The door or window of such a wall whose jambs are the given ones."""
    u, length = direction(a, b), distance(a, b)
    for found in walls(reading):
        for obj in reading.hosted.get(found.element.id, ()):
            points = [(p.x, p.y) for p in hosted.corners(obj)]
            along = [dot(minus(p, a), u) for p in points]
            off = [dot(minus(p, a), left_of(u)) for p in points]
            is_there = abs(min(along)) <= within and abs(max(along) - length) <= within
            if document.kind_of(obj) == "Window" and is_there and max(map(abs, off)) <= length + within:
                return found, obj
    return None


def goes_whole(found: Found, work: Work) -> bool:
    """Whether all of a wall lies in what goes."""
    return all(any(_holds(q, p) for q in work.demolished) for ring in found.element.rings for p in ring)


def _holds(quad: List[Point], p: Point) -> bool:
    u = direction(quad[0], quad[1])
    along, off = dot(minus(p, quad[0]), u), dot(minus(p, quad[0]), left_of(u))
    reach = (distance(quad[0], quad[1]), distance(quad[0], quad[3]))
    return all(-BESIDE_MM <= v <= r + BESIDE_MM for v, r in ((along, reach[0]), (off, reach[1])))


def is_solid(obj, at: Point, z: float) -> bool:
    return document.shape_of(obj).isInside(Vector(at[0], at[1], z), 0.01, True)


def beside(wall: Wall) -> List[Tuple[Point, bool]]:
    """Places just within and just beyond the jambs of a stretch, and whether they are within it."""
    a, b = wall.axis
    u = direction(a, b)
    return [(plus(p, u, way * LOOK_MM), is_within) for p, way, is_within in ((a, 1, True), (b, -1, True), (a, -1, False), (b, 1, False))]
