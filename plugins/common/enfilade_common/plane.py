"""Plane geometry of walls: points are ``(x, y)`` tuples in millimetres."""

import math
from typing import List, NamedTuple, Optional, Sequence, Tuple

Point = Tuple[float, float]


class Rigid(NamedTuple):
    """A turn by ``angle_rad`` about the zero point, then a shift: ``p' = R p + (dx, dy)``."""

    angle_rad: float
    dx: float
    dy: float

    def __call__(self, p: Point) -> Point:
        c, s = math.cos(self.angle_rad), math.sin(self.angle_rad)
        return (c * p[0] - s * p[1] + self.dx, s * p[0] + c * p[1] + self.dy)


STILL = Rigid(0.0, 0.0, 0.0)


def turn_about(centre: Point, angle_rad: float, shift: Point = (0.0, 0.0)) -> Rigid:
    """The turn about ``centre`` followed by ``shift``."""
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    dx = centre[0] - (c * centre[0] - s * centre[1]) + shift[0]
    dy = centre[1] - (s * centre[0] + c * centre[1]) + shift[1]
    return Rigid(angle_rad, dx, dy)


def minus(a: Point, b: Point) -> Point:
    return (a[0] - b[0], a[1] - b[1])


def plus(a: Point, b: Point, factor: float = 1.0) -> Point:
    return (a[0] + factor * b[0], a[1] + factor * b[1])


def dot(a: Point, b: Point) -> float:
    return a[0] * b[0] + a[1] * b[1]


def cross(a: Point, b: Point) -> float:
    return a[0] * b[1] - a[1] * b[0]


def distance(a: Point, b: Point) -> float:
    return math.hypot(a[0] - b[0], a[1] - b[1])


def direction(a: Point, b: Point) -> Point:
    """Unit vector from ``a`` to ``b``; the points must differ."""
    length = distance(a, b)
    if length == 0.0:
        raise ValueError("two equal points have no direction")
    return ((b[0] - a[0]) / length, (b[1] - a[1]) / length)


def left_of(u: Point) -> Point:
    """``u`` turned by 90° anticlockwise."""
    return (-u[1], u[0])


def centroid(points: Sequence[Point]) -> Point:
    return (sum(p[0] for p in points) / len(points), sum(p[1] for p in points) / len(points))


def distance_to_segment(p: Point, a: Point, b: Point) -> float:
    d = minus(b, a)
    length2 = dot(d, d)
    t = 0.0 if length2 == 0.0 else max(0.0, min(1.0, dot(minus(p, a), d) / length2))
    return distance(p, plus(a, d, t))


def line_crossing(a: Point, u: Point, b: Point, v: Point) -> Optional[Point]:
    """Where the lines ``a + s u`` and ``b + t v`` cross; ``None`` for parallel ones."""
    d = cross(u, v)
    if abs(d) < 1e-9:
        return None
    return plus(a, u, cross(minus(b, a), v) / d)


def fit_rigid(before: Sequence[Point], after: Sequence[Point]) -> Tuple[Rigid, float]:
    """The rigid motion nearest to ``before → after`` (least squares) and its largest residual, mm."""
    cb, ca = centroid(before), centroid(after)
    sin_sum = sum(cross(minus(p, cb), minus(q, ca)) for p, q in zip(before, after))
    cos_sum = sum(dot(minus(p, cb), minus(q, ca)) for p, q in zip(before, after))
    angle = math.atan2(sin_sum, cos_sum) if (sin_sum or cos_sum) else 0.0
    if abs(angle) < 1e-9:
        angle = 0.0
    motion = turn_about(cb, angle, minus(ca, cb))
    residual = max(distance(motion(p), q) for p, q in zip(before, after))
    return motion, residual


def is_inside(ring: Sequence[Point], p: Point) -> bool:
    """Whether ``p`` lies inside the closed polygon ``ring``."""
    inside = False
    for a, b in zip(ring, list(ring[1:]) + [ring[0]]):
        if (a[1] > p[1]) != (b[1] > p[1]) and p[0] < (b[0] - a[0]) * (p[1] - a[1]) / (b[1] - a[1]) + a[0]:
            inside = not inside
    return inside


def convex_hull(points: Sequence[Point]) -> List[Point]:
    """Convex hull, anticlockwise, without the first point repeated."""
    unique = sorted(set(points))
    if len(unique) < 3:
        return unique

    def half(run: Sequence[Point]) -> List[Point]:
        out: List[Point] = []
        for p in run:
            while len(out) >= 2 and cross(minus(out[-1], out[-2]), minus(p, out[-2])) <= 0:
                out.pop()
            out.append(p)
        return out[:-1]

    return half(unique) + half(unique[::-1])


def widened(points: Sequence[Point], by: float) -> List[Point]:
    """A convex ring that encloses all ``points`` with at least ``by`` to spare."""
    corners = [(x + sx * by, y + sy * by) for x, y in points for sx in (-1, 1) for sy in (-1, 1)]
    return convex_hull(corners)
