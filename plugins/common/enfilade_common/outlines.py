"""Walls as closed outlines: one quad per straight piece between joints and openings.

A *station* is a place on a wall's axis where a quad begins or ends: a wall's start or end, a mitred joint
of two axis segments, or a jamb. The quad's corners run left-begin, left-end, right-end, right-begin, so
that a station's two corners tell where the axis went when the program has moved them.
"""

from dataclasses import dataclass
from typing import Dict, List, Optional, Tuple

from .model import Study, Wall
from .plane import Point, direction, distance, dot, is_inside, left_of, plus

#: Pieces shorter than this are left out, mm.
PIECE_MIN_MM = 1.0

#: The program takes drawn points nearer than 1 mm for one; ours keep this far apart where they move apart.
APART_MM = 1.5

#: Cell of the grid in which corners are looked up, mm.
CELL_MM = 2000.0


@dataclass(frozen=True)
class Station:
    """Where on the axis: ``corner`` (index of the axis point) or ``jamb`` (id and side of an opening)."""

    kind: str
    index: int
    opening: str = ""


@dataclass
class Outline:
    """A closed outline of one element. ``stations`` are those of a quad's two ends; none for free rings."""

    owner: str
    piece: int
    points: List[Point]
    stations: Optional[Tuple[Station, Station]] = None
    #: Which corner is written first.
    first: int = 0
    #: A chain of lines that does not end where it began, an arc.
    is_open: bool = False

    def written(self, points: Optional[List[Point]] = None) -> List[Point]:
        """The corners (or ``points`` in their place) in the order of the file."""
        points = self.points if points is None else points
        return points[self.first :] + points[: self.first]

    def unwritten(self, points: List[Point]) -> List[Point]:
        """Points in the order of the file back in the order of :attr:`points`."""
        back = len(points) - self.first
        return points[back:] + points[:back]

    @property
    def host_id(self) -> str:
        return f"{self.owner}/{self.piece}"

    def corners_at(self, end: int) -> Tuple[int, int]:
        """Indices of the left and right corner of end 0 or 1 of a quad; the same twice without thickness."""
        if not self.is_closed:
            return (end, end)
        return (0, 3) if end == 0 else (1, 2)

    @property
    def is_closed(self) -> bool:
        """Whether it is a ring; a wall without thickness is drawn as its axis."""
        return len(self.points) > 2 and not self.is_open

    def end_of(self, corner: int) -> int:
        """Which end of a quad a corner belongs to."""
        return 0 if corner in self.corners_at(0) else 1


def study_outlines(study: Study) -> List[Outline]:
    """All outlines in the order in which they are written."""
    out: List[Outline] = []
    for wall in study.walls:
        out.extend(wall_outlines(wall, windows_are_gaps(study)))
    for column in study.columns:
        out.append(Outline(column.id, 0, snapped(column.ring)))
    for drawn in study.drawn:
        for i, stroke in enumerate(drawn.strokes):
            out.append(Outline(drawn.id, i, list(stroke.points), is_open=not stroke.closed))
    return out


def windows_are_gaps(study: Study) -> bool:
    """Whether windows are cut out: at eye level, where both regions are drawn. Without them the program
    looks for the interior, and would take a room with a wide window for outdoors. Regions of a pair do not count:
    what has no name is still measured."""
    kinds = {r.kind for r in study.regions if not r.pair}
    return study.wishes.level == "eye" and {"query", "reference"} <= kinds


def snapped(points: List[Point]) -> List[Point]:
    """Points on whole micrometres, as they are written and as the program reads them."""
    return [(round(x, 3) + 0.0, round(y, 3) + 0.0) for x, y in points]


def wall_outlines(wall: Wall, with_windows: bool = True) -> List[Outline]:
    """Quads of a wall, or its free outlines; ``with_windows`` cuts windows out as it does doors."""
    if wall.rings:
        return [Outline(wall.id, i, snapped(ring)) for i, ring in enumerate(wall.rings)]
    points = wall.corners()
    out: List[Outline] = []
    begun = 0.0
    for i, (a, b) in enumerate(zip(points, points[1:])):
        length = distance(a, b)
        if length == 0.0:
            continue
        for begin, end, stations in _pieces(wall, i, begun, length, with_windows):
            if end - begin < PIECE_MIN_MM:
                continue
            (left_begin, right_begin), (left_end, right_end) = (
                _corners(wall, i, along, station) for along, station in zip((begin, end), stations)
            )
            ring = [left_begin, left_end, right_end, right_begin] if wall.thickness else [left_begin, left_end]
            out.append(Outline(wall.id, len(out), snapped(ring), stations))
        begun += length
    return out


def _pieces(wall: Wall, segment: int, begun: float, length: float, with_windows: bool):
    """Solid pieces ``(begin, end, stations)`` of one axis segment, measured from the segment's start."""
    cuts = sorted((o for o in wall.openings if o.kind != "window" or with_windows), key=lambda o: o.start)
    at, first = 0.0, Station("corner", segment)
    out = []
    for o in cuts:
        begin, end = max(o.start - begun, 0.0), min(o.end - begun, length)
        if begin >= length or end <= 0.0 or end <= at:
            continue
        out.append((at, begin, (first, Station("jamb", 0, o.id))))
        at, first = end, Station("jamb", 1, o.id)
    last = segment + 1
    if wall.closed and last == len(wall.axis):
        last = 0
    out.append((at, length, (first, Station("corner", last))))
    return out


def _corners(wall: Wall, segment: int, along: float, station: Station) -> Tuple[Point, Point]:
    """Left and right corner at ``along`` mm from the start of an axis segment."""
    points = wall.corners()
    u = direction(points[segment], points[segment + 1])
    axis = plus(points[segment], u, along)
    normal = left_of(u)
    if station.kind == "corner":
        axis = wall.axis[station.index]
        normal = mitre(wall, station.index) or normal
    return plus(axis, normal, wall.left), plus(axis, normal, -wall.right)


def mitre(wall: Wall, corner: int) -> Optional[Point]:
    """Offset to the left at a joint of two axis segments, per mm of offset; ``None`` at free ends and where
    the joint is too sharp to be mitred."""
    points = wall.axis
    before = corner - 1 if corner > 0 else (len(points) - 1 if wall.closed else None)
    after = corner + 1 if corner + 1 < len(points) else (0 if wall.closed else None)
    if before is None or after is None:
        return None
    if points[before] == points[corner] or points[corner] == points[after]:
        return None
    n = left_of(direction(points[before], points[corner]))
    m = left_of(direction(points[corner], points[after]))
    size = 1.0 + dot(n, m)
    if size < 0.2:
        return None
    return ((n[0] + m[0]) / size, (n[1] + m[1]) / size)


def keep_apart(outlines: List[Outline], moves_of: List[List[frozenset]]) -> int:
    """Lengthens quads by 1.5 mm where a corner coincides with one that moves differently, which the
    program would take for one point. ``moves_of[i][c]`` is what moves corner ``c`` of outline ``i``.
    Returns how many corners were shifted."""
    shifted = 0
    for _ in range(4):
        clashes = _clashes(outlines, moves_of)
        if not clashes:
            return shifted
        for i, c in clashes:
            outline = outlines[i]
            towards = _outward(outline, c)
            outline.points[c] = snapped([plus(outline.points[c], towards, APART_MM)])[0]
            shifted += 1
    return shifted


def begin_outside(outlines: List[Outline]) -> None:
    """Lets every ring begin at a corner that lies in no other ring. The program takes a ring in which
    another begins for walls round a room; where walls overlap at a corner, both are solid."""
    boxes = []
    cells: Dict[Tuple[int, int], List[Tuple[int, int]]] = {}
    for i, outline in enumerate(outlines):
        xs, ys = [p[0] for p in outline.points], [p[1] for p in outline.points]
        boxes.append((min(xs), min(ys), max(xs), max(ys)))
        for c, p in enumerate(outline.points):
            cells.setdefault((int(p[0] // CELL_MM), int(p[1] // CELL_MM)), []).append((i, c))
    covered = set()
    for j, (x0, y0, x1, y1) in enumerate(boxes):
        if not outlines[j].is_closed:
            continue
        for kx in range(int(x0 // CELL_MM), int(x1 // CELL_MM) + 1):
            for ky in range(int(y0 // CELL_MM), int(y1 // CELL_MM) + 1):
                for i, c in cells.get((kx, ky), ()):
                    if i != j and is_inside(outlines[j].points, outlines[i].points[c]):
                        covered.add((i, c))
    for i, outline in enumerate(outlines):
        if outline.is_closed:
            free = (c for c in range(len(outline.points)) if (i, c) not in covered)
            outline.first = next(free, 0)


def _outward(outline: Outline, corner: int) -> Point:
    points = outline.points
    if outline.stations is None:
        return direction(points[corner - 1], points[corner])
    opposite = {0: 1, 1: 0, 2: 3, 3: 2}[corner]
    if not outline.is_closed:
        opposite = 1 - corner
    return direction(points[opposite], points[corner])


def _clashes(outlines: List[Outline], moves_of: List[List[frozenset]]) -> List[Tuple[int, int]]:
    """Corners within the program's joining distance of one that moves differently; of two the one with
    fewer moves, of equals the later one."""
    cells: Dict[Tuple[int, int], List[Tuple[int, int]]] = {}
    for i, outline in enumerate(outlines):
        for c, p in enumerate(outline.points):
            cells.setdefault((round(p[0] / 2), round(p[1] / 2)), []).append((i, c))
    out = set()
    for (kx, ky), members in cells.items():
        near = [m for dx in (-1, 0, 1) for dy in (-1, 0, 1) for m in cells.get((kx + dx, ky + dy), ())]
        for i, c in members:
            for j, d in near:
                if (i, c) >= (j, d) or distance(outlines[i].points[c], outlines[j].points[d]) > 1.2:
                    continue
                mine, theirs = moves_of[i][c], moves_of[j][d]
                if mine != theirs:
                    out.add((i, c) if len(mine) < len(theirs) else (j, d))
    return sorted(out)
