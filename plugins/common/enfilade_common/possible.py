"""What may be done with an element of a study, by its kind and where it stands: moves, building works, and why no others.

The program has the last word: it knows rooms. Here only what is never possible is left out.
"""

import math
from dataclasses import dataclass, field
from typing import Dict, List, Optional, Tuple, Union

from .model import KINDS, Column, Drawn, Opening, Study, Wall
from .moves import touches, wall_ends
from .plane import Point, cross, direction, distance, is_inside, left_of, minus, plus
from .works import KINDS as WORKS

#: An opening of 0.9 m stands 0.1 m beside other walls.
OPENED_MIN_MM = 1100.0
#: Glass is at least 1.2 m wide.
GLAZED_MIN_MM = 1400.0
#: A free end goes back by half a metre or more, and something stays.
ENDED_MIN_MM = 600.0

#: Rays that look for the outside from beside a wall, and the share of them that none but the outside lets go.
RAYS, OUTSIDE_SHARE = 48, 0.15
#: So far from a face they begin, mm.
OFF_MM = 50.0

#: Why something is not offered.
KEPT, LOCKED, REGION, OUTER, ROUND, SHORT, WINDOW, COLUMN = (
    "kept",
    "locked",
    "region",
    "outer",
    "round",
    "short",
    "window",
    "column",
)


@dataclass
class Possible:
    """What an element may be allowed; ``why`` are codes of what stands against the rest."""

    moves: List[str] = field(default_factory=list)
    works: List[str] = field(default_factory=list)
    why: List[str] = field(default_factory=list)


class Site:
    """A study in which elements are asked for; what is looked up is kept."""

    def __init__(self, study: Study):
        self.study = study
        self._keeps = [r.points for r in study.regions if r.kind == "keep"]
        self._lines = [line for w in study.walls for line in _lines(w)]
        self._sides: Dict[str, List[bool]] = {}

    def of(self, id: str) -> Optional[Possible]:
        """What may be done with the wall, column, opening or line of an id; nothing where none is known."""
        for wall in self.study.walls:
            opening = next((o for o in wall.openings if o.id == id), None)
            if opening is not None:
                return self._of_opening(wall, opening)
        element = self.study.element(id)
        if element is None:
            return None
        out = Possible(list(KINDS))
        if isinstance(element, Column):
            # It has no length to slide along.
            out.moves.remove("along")
            out.why.append(COLUMN)
        elif isinstance(element, Drawn):
            # A line does not tell what its wall has; the program reads that.
            out.works = list(WORKS)
        else:
            self._of_wall(element, out)
        return self._held(element, out)

    def _held(self, element: Union[Wall, Column, Drawn], out: Possible) -> Possible:
        """Without what is kept from it."""
        if element.locked:
            return Possible(why=[LOCKED])
        if any(all(is_inside(ring, p) for p in _corners(element)) for ring in self._keeps):
            return Possible(why=[REGION])
        if element.keep:
            return Possible(out.moves, [], [KEPT])
        return out

    def _of_opening(self, wall: Wall, opening: Opening) -> Possible:
        out = Possible([] if wall.rings else ["along"])
        if opening.kind == "window":
            out.why.append(WINDOW)
        elif any(self.outside(wall)):
            out.why.append(OUTER)
        elif not wall.rings:
            out.works = ["widen", "close", "rehang"]
        return self._held(wall, out)

    def _of_wall(self, wall: Wall, out: Possible) -> None:
        is_outer, is_beyond = any(self.outside(wall)), all(self.outside(wall))
        if is_outer:
            out.why.append(OUTER)
            out.works = [] if is_beyond or wall.rings else ["add"]
            return
        if wall.rings:
            # Nothing tells where along a curve or a solid a jamb would stand.
            out.why.append(ROUND)
            out.works = ["remove"]
            return
        free = longest_free(wall)
        out.works += [k for k, least in (("open", OPENED_MIN_MM), ("door", OPENED_MIN_MM), ("glaze", GLAZED_MIN_MM)) if free >= least]
        if free < OPENED_MIN_MM:
            out.why.append(SHORT)
        if any(o.kind != "window" for o in wall.openings):
            out.works += ["widen", "close", "rehang"]
        if self._has_free_end(wall):
            out.works.append("end")
        out.works += ["remove", "add"]

    def _has_free_end(self, wall: Wall) -> bool:
        others = [w for w in self.study.walls if w.id != wall.id] + self.study.columns
        pieces = [distance(a, b) for a, b in zip(wall.axis, wall.axis[1:])]
        ends = [(point, pieces[0] if index == 0 else pieces[-1]) for index, point, _ in wall_ends(wall)]
        return any(length >= ENDED_MIN_MM and not any(touches(p, o) for o in others) for p, length in ends)

    def outside(self, wall: Wall) -> List[bool]:
        """Whether all of the left and of the right side of a wall looks out of the building."""
        if wall.id not in self._sides:
            sides = [[], []]  # type: List[List[bool]]
            points = [] if wall.rings else wall.corners()
            for a, b in zip(points, points[1:]):
                off = left_of(direction(a, b))
                for side, by in enumerate((wall.left + OFF_MM, -wall.right - OFF_MM)):
                    middles = [plus(a, minus(b, a), t) for t in (0.2, 0.5, 0.8)]
                    sides[side] += [self._is_outside(plus(m, off, by)) for m in middles]
            self._sides[wall.id] = [bool(s) and all(s) for s in sides]
        return self._sides[wall.id]

    def _is_outside(self, at: Point) -> bool:
        """Whether much is seen past all walls. Doors and windows count as closed."""
        free = 0
        for i in range(RAYS):
            angle = 2.0 * math.pi * (i + 0.5) / RAYS
            u = (math.cos(angle), math.sin(angle))
            free += not any(_is_hit(at, u, a, b) for a, b in self._lines)
            if free > OUTSIDE_SHARE * RAYS:
                return True
        return False


def _corners(element: Union[Wall, Column, Drawn]) -> List[Point]:
    if isinstance(element, Column):
        return element.ring
    if isinstance(element, Drawn):
        return element.points()
    return [p for r in element.rings for p in r] or element.axis


def _lines(wall: Wall) -> List[Tuple[Point, Point]]:
    rings = wall.rings or [wall.corners()]
    closed = [r + r[:1] if wall.rings else r for r in rings]
    return [pair for r in closed for pair in zip(r, r[1:])]


def _is_hit(at: Point, u: Point, a: Point, b: Point) -> bool:
    """Whether a ray meets a line."""
    to_a, along = minus(a, at), minus(b, a)
    turn = cross(u, along)
    if abs(turn) < 1e-9:
        return False
    return cross(to_a, along) / turn >= 0.0 and 0.0 <= cross(to_a, u) / turn <= 1.0


def longest_free(wall: Wall) -> float:
    """The longest straight stretch of a wall without an opening, mm."""
    best, begun = 0.0, 0.0
    points = wall.corners()
    for a, b in zip(points, points[1:]):
        at, end = begun, begun + distance(a, b)
        for opening in sorted(wall.openings, key=lambda o: o.start):
            if at <= opening.start < end:
                best, at = max(best, opening.start - at), opening.end
        best, begun = max(best, end - at), end
    return best
