"""The DXF file behind the shapes of a host: which of its entities each shape is, found by where they lie.

A host that imports a DXF may lose its layers, blocks and unit. The file still has them.
"""

import math
from dataclasses import dataclass, field
from typing import Dict, Iterable, List, Set, Tuple

from .dxf_file import DxfFile, Line, straight
from .model import Drawn, Stroke
from .plane import Point, distance

#: What lies this near to another thing is it, as a share of the plan.
SAME = 2e-6
#: Share of the shapes, and of what the file draws, that must be found in the other.
SHAPES_MIN, FILE_MIN = 0.6, 0.4
#: Of an insert so much must be found.
INSERT_MIN = 0.2
#: Lines of a file that a scale is tried on.
TRIED = 400
#: Units of $INSUNITS in mm.
INSUNITS = {1: 25.4, 2: 304.8, 4: 1.0, 5: 10.0, 6: 1000.0, 14: 100.0}


#: What an import never leaves out.
PLAIN = ("LINE", "CIRCLE", "ARC")


@dataclass
class Piece:
    """A straight or round piece of a stroke of the document."""

    line: Line
    #: The stroke, and which of its points the ends are.
    host_id: str
    points: Tuple[int, ...]


@dataclass
class Match:
    """A file with the pieces of the document that each of its entities is."""

    file: DxfFile
    #: Units of the document in one of the file.
    scale: float
    #: For each entity and each of its lines the pieces there; none where there are none.
    pieces: List[List[List[Piece]]] = field(default_factory=list)
    #: Those lines, in the same order.
    lines: List[List[Line]] = field(default_factory=list)
    #: Handles of entities that never were there as the file has them: the import lost a part.
    usual: Set[str] = field(default_factory=set)
    #: Owners of strokes that the file does not draw.
    loose_owners: Set[str] = field(default_factory=set)
    #: Strokes that the file draws.
    known: Set[str] = field(default_factory=set)
    #: Shares of the strokes of the document that the file draws, and of the lines of the file that the document has.
    shapes_share: float = 0.0
    file_share: float = 0.0

    @property
    def fits(self) -> bool:
        return self.shapes_share >= SHAPES_MIN and self.file_share >= FILE_MIN

    def is_there(self, index: int) -> bool:
        """Whether what an entity draws is there, or it draws nothing that shows."""
        entity, found = self.file.entities[index], self.pieces[index]
        if entity.handle in self.usual:
            return True
        if entity.kind == "INSERT":
            # FreeCAD draws no more than a part of some blocks; what it drew is one object.
            owners = {p.host_id.rsplit("/", 1)[0] for pieces in found for p in pieces}
            most = sum(1 for pieces in found if pieces) >= INSERT_MIN * len(found)
            return not found or all(found) or most and not owners & self.loose_owners
        # FreeCAD loses arcs of polylines far from the origin: the straight lines of one speak for them.
        straight_ones = [pieces for line, pieces in zip(self.lines[index], found) if line.kind == "line"]
        return all(straight_ones or found)

    def absent(self) -> List[str]:
        """Handles of entities that are not all there."""
        every = range(len(self.file.entities))
        return [self.file.entities[i].handle for i in every if not self.is_there(i) and self.file.entities[i].handle]

    def lost(self) -> List[str]:
        """Handles of those that an import may have lost: all but plain lines and arcs, which it never does."""
        kinds = {e.handle: e.kind for e in self.file.entities}
        found = {e.handle for e, pieces in zip(self.file.entities, self.pieces) if any(pieces)}
        return [h for h in self.absent() if h in found or kinds[h] not in PLAIN]

    def strokes_of(self, index: int) -> List[str]:
        return list(dict.fromkeys(p.host_id for found in self.pieces[index] for p in found))


class Places:
    """Pieces by where their middle lies."""

    def __init__(self, pieces: Iterable[Piece], within: float) -> None:
        self.within = within
        self._cells: Dict[Tuple[int, int], List[Piece]] = {}
        for piece in pieces:
            self.add(piece)

    def add(self, piece: Piece) -> None:
        self._cells.setdefault(self._cell(_key(piece.line)), []).append(piece)

    def _cell(self, p: Point) -> Tuple[int, int]:
        return (math.floor(p[0] / self.within / 8), math.floor(p[1] / self.within / 8))

    def at(self, line: Line, scale: float) -> List[Piece]:
        """The pieces that lie where a line of the file does."""
        there = Line(line.kind, _times(line.ends, scale), _scaled(line.middle, scale), line.radius * scale)
        x, y = _key(there)
        by = self.within
        cells = dict.fromkeys(self._cell((x + sx * by, y + sy * by)) for sx in (-1, 1) for sy in (-1, 1))
        return [p for c in cells for p in self._cells.get(c, ()) if self._is_same(p.line, there)]

    def _is_same(self, here: Line, there: Line) -> bool:
        by = self.within
        if here.kind == "circle" or there.kind == "circle":
            is_both = here.kind == there.kind
            return is_both and distance(here.middle, there.middle) <= by and abs(here.radius - there.radius) <= by
        # A short curve becomes one line.
        is_curve = there.kind == "curve"
        if here.kind == "curve" and not is_curve or is_curve and here.kind == "arc":
            return False
        if not is_curve and distance(here.middle, there.middle) > by:
            return False
        (p, q), (r, s) = here.ends, there.ends
        return max(distance(p, r), distance(q, s)) <= by or max(distance(p, s), distance(q, r)) <= by


def _key(line: Line) -> Point:
    if line.kind == "curve":
        (ax, ay), (bx, by) = line.ends
        return ((ax + bx) / 2, (ay + by) / 2)
    return line.middle


def _scaled(p: Point, scale: float) -> Point:
    return (p[0] * scale, p[1] * scale)


def _times(ends: Tuple[Point, Point], scale: float) -> Tuple[Point, Point]:
    return (_scaled(ends[0], scale), _scaled(ends[1], scale))


def pieces_of(drawn: Iterable[Drawn]) -> List[Piece]:
    return [p for d in drawn for i, s in enumerate(d.strokes) for p in _pieces(f"{d.id}/{i}", s)]


def _pieces(host_id: str, stroke: Stroke) -> List[Piece]:
    points = stroke.points
    if stroke.kind == "circle":
        return [Piece(Line("circle", (stroke.centre, stroke.centre), stroke.centre, stroke.radius), host_id, (0,))]
    if stroke.kind == "arc":
        return [Piece(Line("arc", (points[0], points[1]), _halfway(stroke), stroke.radius), host_id, (0, 1))]
    count = len(points)
    last = count if stroke.closed and count > 2 else count - 1
    pairs = [(i, (i + 1) % count) for i in range(last)]
    out = [Piece(straight(points[i], points[j]), host_id, (i, j)) for i, j in pairs]
    if count > 2:
        # A curve becomes lines too.
        end = points[0] if stroke.closed else points[-1]
        out.append(Piece(Line("curve", (points[0], end), points[count // 2]), host_id, ()))
    return out


def _halfway(stroke: Stroke) -> Point:
    begin, end = (math.atan2(p[1] - stroke.centre[1], p[0] - stroke.centre[0]) for p in stroke.points)
    at = begin + ((end - begin) % (2 * math.pi)) / 2
    return (stroke.centre[0] + stroke.radius * math.cos(at), stroke.centre[1] + stroke.radius * math.sin(at))


def _extent(points: List[Point]) -> float:
    xs, ys = [p[0] for p in points] or [0.0], [p[1] for p in points] or [0.0]
    return math.hypot(max(xs) - min(xs), max(ys) - min(ys))


def match(file: DxfFile, drawn: List[Drawn], usual: Iterable[str] = ()) -> Match:
    """Finds the shapes of a document among the entities of a file."""
    pieces = pieces_of(drawn)
    extent = _extent([p for d in drawn for p in d.points()])
    within = max(extent * SAME, 1e-9)
    places = Places(pieces, within)
    shown = [s for e in file.entities for s in e.lines if s.kind == "circle" or s.kind == "curve" or s.ends[0] != s.ends[1]]
    scale = _scale(file, shown, places, extent)
    made = Match(file, scale, usual=set(usual))
    seen: Set[Tuple[str, Tuple[int, ...]]] = set()
    for entity in file.entities:
        lines, rows = _found(entity.lines, places, scale)
        if entity.kind == "INSERT" and not all(rows):
            other = _found(file.as_host(entity), places, scale)
            lines, rows = max((lines, rows), other, key=lambda v: sum(1 for r in v[1] if r))
        made.lines.append(lines)
        made.pieces.append(rows)
        seen.update((p.host_id, p.points) for found in rows for p in found)
    made.known = _known(drawn, pieces, seen, within)
    made.known |= _inexact(made, pieces, within)
    every = [f"{d.id}/{i}" for d in drawn for i in range(len(d.strokes))]
    made.loose_owners = {s.rsplit("/", 1)[0] for s in every if s not in made.known}
    rows = [found for entity_rows in made.pieces for found in entity_rows]
    made.shapes_share = len(made.known) / len(every) if every else 0.0
    made.file_share = sum(1 for found in rows if found) / len(rows) if rows else 0.0
    return made


def _found(lines: List[Line], places: Places, scale: float) -> Tuple[List[Line], List[List[Piece]]]:
    """The lines of an entity that have a length, and the pieces that lie there."""
    shown = [s for s in lines if s.kind in ("circle", "curve") or distance(*s.ends) * scale > places.within]
    return shown, [places.at(s, scale) for s in shown]


def _inexact(made: Match, pieces: List[Piece], within: float) -> Set[str]:
    """Arcs of the document that end where an arc of a polyline does that FreeCAD lost: it drew it elsewhere."""
    ends = Places([], within)
    for i, lines in enumerate(made.lines):
        arcs_lost = [line for line, found in zip(lines, made.pieces[i]) if line.kind == "arc" and not found]
        is_drawn = bool(arcs_lost) and made.is_there(i)
        for end in (e for line in arcs_lost for e in line.ends if is_drawn):
            at = _scaled(end, made.scale)
            ends.add(Piece(Line("line", (at, at), at), "", ()))
    arcs = [p for p in pieces if p.line.kind == "arc" and p.host_id not in made.known]
    return {p.host_id for p in arcs if any(ends.at(Line("line", (e, e), e), 1.0) for e in p.line.ends)}


def _known(drawn: List[Drawn], pieces: List[Piece], seen: Set[Tuple[str, Tuple[int, ...]]], within: float) -> Set[str]:
    """Strokes all of whose pieces were found, or that are one curve of the file, or no more than a point."""
    shown = [p for p in pieces if p.points and (p.line.kind == "circle" or distance(*p.line.ends) > within)]
    missing = {p.host_id for p in shown if (p.host_id, p.points) not in seen}
    curves = {host_id for host_id, points in seen if not points}
    every = {f"{d.id}/{i}" for d in drawn for i in range(len(d.strokes))}
    return {s for s in every if s in curves or s not in missing}


def _scale(file: DxfFile, shown: List[Line], places: Places, extent: float) -> float:
    """The scale at which most lines of the file lie on shapes."""
    step = max(1, len(shown) // TRIED)
    tried = shown[::step]
    of_file = _extent([p for s in shown for p in s.ends])
    try:
        stated = INSUNITS.get(int(file.variable(b"$INSUNITS") or b"0"), 1.0)
    except ValueError:
        stated = 1.0
    scales = dict.fromkeys([1.0, stated, *INSUNITS.values(), *([extent / of_file] if of_file and extent else [])])
    return max(scales, key=lambda k: sum(1 for s in tried if places.at(s, k)))
