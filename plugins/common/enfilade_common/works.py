"""Building works of an option: what is cut out of walls, walled up or newly built."""

from dataclasses import dataclass, field
from typing import Any, Dict, List, Optional, Sequence, Tuple

from .plane import Point, direction, dot, left_of, minus, plus

#: What each kind of work is called where the program gives it no words.
KINDS = {
    "open": "an opening",
    "door": "a door",
    "widen": "a wider opening",
    "close": "an opening walled up",
    "rehang": "a door moved along its wall",
    "end": "a wall taken back at its end",
    "remove": "a wall removed",
    "glaze": "glass in a wall",
    "add": "a new wall",
}


@dataclass
class NewWall:
    """A stretch that is walled up or built: its axis and its thickness, units of the drawing."""

    ends: Tuple[Point, Point]
    thickness: float

    def outline(self) -> List[Point]:
        """From end to end along the right face, back along the left."""
        a, b = self.ends
        off = left_of(direction(a, b))
        half = self.thickness / 2.0
        return [plus(a, off, -half), plus(b, off, -half), plus(b, off, half), plus(a, off, half)]


@dataclass
class Work:
    """One building work. Lengths and places in units of the drawing."""

    kind: str
    #: As the program says it: ``An opening of 1.8 m between kitchen and living room``.
    words: str
    #: Ends on the wall's axis: of a new opening, of what goes, of what is built.
    stretch: Tuple[Point, Point]
    width: float
    #: Rooms on both sides, ``None`` for outdoors.
    rooms: List[Optional[int]] = field(default_factory=list)
    #: What draws the wall: ``handle`` and ``record`` of the drawing.
    elements: List[Dict[str, Any]] = field(default_factory=list)
    #: Outlines of what goes: along the right face, back along the left.
    demolished: List[List[Point]] = field(default_factory=list)
    built: List[NewWall] = field(default_factory=list)
    #: What stands in the new opening: ``nothing``, ``door`` or ``glass``.
    filling: str = "nothing"
    #: Jambs of the opening that is closed or widened, or from which a door is moved.
    opening: Optional[Tuple[Point, Point]] = None

    def said(self) -> str:
        """Its words, as the middle of a sentence."""
        words = self.words or KINDS.get(self.kind, "a building work")
        return words[:1].lower() + words[1:]


def works_of(data: Optional[Sequence[Dict[str, Any]]], per_metre: float) -> List[Work]:
    """The works of a candidate in ``result.json``; none where it has no such list."""
    return [_work(w, per_metre) for w in data or []]


def _work(data: Dict[str, Any], per_metre: float) -> Work:
    def points(rows: Any) -> List[Point]:
        return [(float(x) * per_metre, float(y) * per_metre) for x, y in rows]

    def pair(rows: Any) -> Tuple[Point, Point]:
        a, b = points(rows)
        return a, b

    built = [NewWall(pair(b["ends"]), float(b["thickness_m"]) * per_metre) for b in data.get("built") or []]
    kind, opening = str(data["kind"]), data.get("opening")
    stretch = pair(data["stretch"])
    return Work(
        kind=kind,
        words=str(data.get("words") or ""),
        stretch=stretch,
        width=float(data.get("width_m") or 0.0) * per_metre,
        rooms=[None if r is None else int(r) for r in data.get("rooms") or []],
        elements=[dict(e) for e in data.get("elements") or []],
        demolished=[points(q) for q in data.get("demolished") or []],
        built=built,
        filling=str(data.get("filling") or _filling(kind)),
        opening=pair(opening) if opening else None,
    )


def _filling(kind: str) -> str:
    return {"door": "door", "rehang": "door", "glaze": "glass"}.get(kind, "nothing")


def axis_of(quad: Sequence[Point]) -> Tuple[Point, Point]:
    """The middle line of an outline of four corners, from its first end to its second."""
    a, b, c, d = quad
    return ((a[0] + d[0]) / 2, (a[1] + d[1]) / 2), ((b[0] + c[0]) / 2, (b[1] + c[1]) / 2)


def work_outlines(work: Work) -> Tuple[List[List[Point]], List[List[Point]]]:
    """Lines of what goes and of what is new, each closed: for a preview."""
    gone = [q + q[:1] for q in work.demolished]
    new = [ring + ring[:1] for ring in (b.outline() for b in work.built)]
    if work.filling != "nothing":
        new.append(list(work.stretch))
    return gone, new


def staying(length: float, cuts: Sequence[Tuple[float, float]], least: float) -> List[Tuple[float, float]]:
    """The parts of a line from 0 to ``length`` outside the ``cuts``, none shorter than ``least``."""
    out, at = [], 0.0
    for low, high in [*sorted(cuts), (length, length)]:
        if low - at > least:
            out.append((at, low))
        at = max(at, high)
    return out


def inside(a: Point, b: Point, quad: Sequence[Point], by: float) -> Optional[Tuple[float, float]]:
    """Where a line from ``a`` to ``b`` lies in a convex outline that is ``by`` wider, as shares of its length."""
    turn = 1.0 if _area(quad) > 0 else -1.0
    low, high = 0.0, 1.0
    for p, q in zip(quad, [*quad[1:], quad[0]]):
        # Outwards of this side.
        u = direction(p, q)
        out = (turn * u[1], turn * -u[0])
        start, way = dot(minus(a, p), out) - by, dot(minus(b, a), out)
        if abs(way) < 1e-12:
            if start > 0:
                return None
        elif way > 0:
            high = min(high, -start / way)
        else:
            low = max(low, -start / way)
    return (low, high) if high > low else None


def _area(ring: Sequence[Point]) -> float:
    return sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(ring, [*ring[1:], ring[0]]))
