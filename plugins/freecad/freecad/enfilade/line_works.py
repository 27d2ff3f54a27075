"""Building works in 2D plans: lines end at the jambs, the jambs are new lines, what goes with a wall goes."""

import re
from dataclasses import dataclass, field
from typing import Dict, List, Optional, Set, Tuple

from enfilade_common.model import Drawn, PluginError, Stroke
from enfilade_common.plane import Point, direction, distance, distance_to_segment, dot, left_of, minus, plus
from enfilade_common.works import NewWall, Work, axis_of, inside

from . import lines
from .document import Found, Reading

#: What was made stands where the work says to this, mm of the building.
WORK_MM = 1.0
#: A leaf stands so far off its opening at most, mm.
BESIDE_MM = 50.0
#: Radii of leaves, mm.
LEAF_MM = (500.0, 1500.0)
#: Names of layers on which glass is drawn.
GLASS = re.compile(r"glaz|glas|verre|vitr|window|wind\b|fenster|fen[eê]tre", re.IGNORECASE)

FILE_HAS_IT = "Nothing was changed. Draw it by hand, or take the new drawing file of the round"

Line = Tuple[Point, Point]


@dataclass
class Piece:
    """A chain of lines that stays of a stroke."""

    points: List[Point]
    closed: bool = False

    def lines(self) -> List[Line]:
        ring = self.points + (self.points[:1] if self.closed else [])
        return list(zip(ring, ring[1:]))


@dataclass
class Sheet:
    """One object with what stays of each of its strokes."""

    found: Found
    #: By stroke; nothing for one that goes.
    stays: List[List[Piece]]
    is_touched: bool = False
    #: New lines and arcs that are drawn like it.
    added: List[Stroke] = field(default_factory=list)

    @property
    def drawn(self) -> Drawn:
        return self.found.element

    def segments(self) -> List[Line]:
        straight = (pieces for s, pieces in zip(self.drawn.strokes, self.stays) if s.kind == "lines")
        out = [s for pieces in straight for p in pieces for s in p.lines()]
        return out + [(s.points[0], s.points[1]) for s in self.added if s.kind == "lines"]


class Plan:
    """What the works of an option do to the lines of a document."""

    def __init__(self, reading: Reading, per_metre: float):
        self.reading = reading
        #: Units of the drawing in a mm of the building.
        self.unit = per_metre / 1000.0
        found = [f for f in reading.found.values() if isinstance(f.element, Drawn)]
        self.sheets: Dict[str, Sheet] = {f.element.id: Sheet(f, [_whole(s) for s in f.element.strokes]) for f in found}
        self.gone: List[Tuple[List[Point], Set[str]]] = []

    def add(self, work: Work, ids: List[str]) -> None:
        """Adds a work; refuses what cannot be drawn here."""
        own = [i for i in ids if i in self.sheets]
        layers = {self.sheets[i].drawn.layer for i in own} or {s.drawn.layer for s in self.sheets.values()}
        if not (work.demolished or work.built):
            raise PluginError(f"{_said(work)}: the result does not say what is cut or built. Nothing was changed.")
        if work.kind in ("close", "widen", "rehang", "remove"):
            self._take_door(work)
        like = self._cut_all(work, layers, own)
        for quad in work.demolished:
            for side in ((quad[0], quad[3]), (quad[1], quad[2])):
                self._close_side(side, layers, like)
        for wall in work.built:
            self._wall(wall, layers, like or self._beside(wall, layers))
        self._fill(work)

    def close(self) -> None:
        """Refuses what cannot be changed."""
        for sheet in self.sheets.values():
            if sheet.is_touched and sheet.drawn.locked:
                raise PluginError(f"'{sheet.drawn.label}' cannot be changed: {sheet.drawn.locked}. Nothing was changed.")

    def _cut_all(self, work: Work, layers: Set[str], own: List[str]) -> Optional[Sheet]:
        """Cuts what is drawn in the stretches that go; gives an object that draws the wall."""
        first = None
        for quad in work.demolished:
            self.gone.append((quad, layers))
            met = [s for s in self.sheets.values() if s.drawn.layer in layers and self._cut(s, quad, s.drawn.id in own)]
            if not met:
                raise PluginError(f"{_said(work)}: no line of this document is drawn there. {FILE_HAS_IT}.")
            first = first or next((s for s in met if s.drawn.id in own), met[0])
        return first or next((self.sheets[i] for i in own), None)

    def _cut(self, sheet: Sheet, quad: List[Point], is_own: bool) -> bool:
        """Cuts one object; whether it is drawn in the stretch at all."""
        is_met = False
        for i, stroke in enumerate(sheet.drawn.strokes):
            if stroke.kind != "lines" or lines.is_curved(sheet.found.object, i):
                if is_own and any(self._span(a, b, quad) for p in sheet.stays[i] for a, b in p.lines()):
                    raise PluginError(f"'{sheet.drawn.label}' is round where it would be cut. {FILE_HAS_IT}.")
                continue
            left: List[Piece] = []
            for piece in sheet.stays[i]:
                parts = self._parts(piece, quad)
                is_met |= parts is not None
                left += [piece] if parts is None else parts
            sheet.stays[i] = left
        sheet.is_touched |= is_met
        return is_met

    def _parts(self, piece: Piece, quad: List[Point]) -> Optional[List[Piece]]:
        """What stays of a chain; ``None`` where nothing of it lies in the stretch."""
        spans = [self._span(a, b, quad) for a, b in piece.lines()]
        if not any(spans):
            return None
        chains: List[List[Point]] = []
        goes_on = False
        for (a, b), span in zip(piece.lines(), spans):
            for part in [(a, b)] if span is None else _outside(a, b, span, self.unit * WORK_MM):
                if goes_on and part[0] == a:
                    chains[-1].append(part[1])
                else:
                    chains.append(list(part))
                goes_on = part[1] == b
            if span is not None and span[1] >= 1.0:
                goes_on = False
        if piece.closed and len(chains) > 1 and chains[-1][-1] == chains[0][0]:
            chains[0] = chains.pop()[:-1] + chains[0]
        return [Piece(c) for c in chains]

    def _span(self, a: Point, b: Point, quad: List[Point]) -> Optional[Tuple[float, float]]:
        """Where a line lies in a stretch that goes, its faces and its ends with it."""
        by = self.unit * WORK_MM
        if distance(a, b) == 0.0:
            return None
        u = direction(*axis_of(quad))
        ends = [[dot(minus(p, quad[0]), w) for p in (a, b)] for w in (u, left_of(u))]
        reach = (distance(quad[0], quad[1]), dot(minus(quad[3], quad[0]), left_of(u)))
        if all(-by <= v <= r + by for vs, r in zip(ends, reach) for v in vs):
            return (0.0, 1.0)
        is_across = abs(ends[0][0] - ends[0][1]) <= by
        if is_across and any(abs(ends[0][0] - e) <= by for e in (0.0, reach[0])):
            # A line along the end that goes on: the face of a wall that the stretch meets.
            return None
        off = left_of(u)
        wide = [plus(quad[0], off, -by), plus(quad[1], off, -by), plus(quad[2], off, by), plus(quad[3], off, by)]
        span = inside(a, b, wide, 0.0)
        return span if span and (span[1] - span[0]) * distance(a, b) > by else None

    def _near(self, layers: Set[str]) -> List[Line]:
        return [s for sheet in self.sheets.values() if sheet.drawn.layer in layers for s in sheet.segments()]

    def _touch(self, p: Point, there: List[Line]) -> bool:
        return any(distance_to_segment(p, a, b) <= self.unit * WORK_MM for a, b in there)

    def _covers(self, side: Line, there: List[Line]) -> bool:
        return any(self._touch(side[0], [s]) and self._touch(side[1], [s]) for s in there)

    def _close_side(self, side: Line, layers: Set[str], like: Optional[Sheet]) -> None:
        """A jamb where a wall goes on, and none at an end that went."""
        there = self._near(layers)
        if like is None or self._covers(side, there) or not all(self._touch(p, there) for p in side):
            return
        like.added.append(Stroke("lines", [self._snapped(p, there) for p in side]))

    def _snapped(self, p: Point, there: List[Line]) -> Point:
        """The end of a line where one lies: the result has whole millimetres."""
        ends = [e for line in there for e in line]
        near = min(ends, key=lambda e: distance(p, e), default=p)
        return near if distance(p, near) <= self.unit * WORK_MM else p

    def _wall(self, wall: NewWall, layers: Set[str], like: Optional[Sheet]) -> None:
        """Both faces of a new wall; jambs that it closes go, a free end gets one."""
        if like is None:
            raise PluginError(f"There is no line that a new wall could be drawn like. {FILE_HAS_IT}.")
        there = self._near(layers)
        right_a, right_b, left_b, left_a = (self._snapped(p, there) for p in wall.outline())
        if wall.thickness == 0.0:
            like.added.append(Stroke("lines", [right_a, right_b]))
            return
        for side in ((right_a, left_a), (right_b, left_b)):
            jambs = self._jambs(side, layers)
            there = [s for s in self._near(layers) if s not in jambs]
            if all(self._touch(p, there) for p in side):
                self._drop(jambs)
            elif not self._covers(side, self._near(layers)):
                like.added.append(Stroke("lines", list(side)))
        like.added += [Stroke("lines", [right_a, right_b]), Stroke("lines", [left_a, left_b])]

    def _jambs(self, side: Line, layers: Set[str]) -> List[Line]:
        """Lines that lie in a side and nowhere else."""
        out = []
        for sheet in (s for s in self.sheets.values() if s.drawn.layer in layers):
            straight = (pieces for s, pieces in zip(sheet.drawn.strokes, sheet.stays) if s.kind == "lines")
            for piece in (p for pieces in straight for p in pieces):
                if all(distance_to_segment(p, *side) <= self.unit * WORK_MM for p in piece.points):
                    out += piece.lines()
        return out

    def _drop(self, jambs: List[Line]) -> None:
        for sheet in self.sheets.values():
            for i, pieces in enumerate(sheet.stays):
                left = [p for p in pieces if not any(s in jambs for s in p.lines())]
                if len(left) != len(pieces):
                    sheet.stays[i], sheet.is_touched = left, True

    def _beside(self, wall: NewWall, layers: Set[str]) -> Optional[Sheet]:
        """The object nearest to a new wall."""
        there = [s for s in self.sheets.values() if s.drawn.layer in layers and s.segments()]
        ends = wall.ends
        return min(there, key=lambda s: min(distance_to_segment(e, *g) for g in s.segments() for e in ends), default=None)

    def _take_door(self, work: Work) -> None:
        """The leaf and the swing of a door that goes."""
        place = work.opening or work.stretch
        reach = _thickness(work) + BESIDE_MM * self.unit
        arcs = [(s, i) for s in self.sheets.values() for i, k in enumerate(s.drawn.strokes) if k.kind == "arc"]
        for sheet, i in arcs:
            arc = sheet.drawn.strokes[i]
            is_leaf = LEAF_MM[0] <= arc.radius / self.unit <= LEAF_MM[1]
            is_here = distance_to_segment(arc.centre, *place) <= reach
            if is_leaf and is_here and any(distance_to_segment(p, *place) <= reach for p in arc.points):
                sheet.stays[i], sheet.is_touched = [], True
                self._take_leaf(arc, reach)

    def _take_leaf(self, arc: Stroke, reach: float) -> None:
        for sheet in self.sheets.values():
            for i, stroke in enumerate(sheet.drawn.strokes):
                points = stroke.points
                is_near = all(distance(p, arc.centre) <= arc.radius + reach for p in points)
                at_hinge = any(distance(p, arc.centre) <= reach for p in points)
                at_end = any(distance(p, e) <= 0.1 * arc.radius for p in points for e in arc.points)
                if stroke.kind == "lines" and len(points) <= 5 and is_near and at_hinge and at_end:
                    sheet.stays[i], sheet.is_touched = [], True

    def _fill(self, work: Work) -> None:
        """A leaf or a pane, drawn like those of the plan."""
        if work.filling == "door" and work.kind in ("door", "rehang", "widen"):
            sheet = next((s for s in self.sheets.values() if self._is_leaf(s)), None)
            if sheet is not None:
                sheet.added += _leaf(work)
        elif work.filling == "glass":
            sheet = next((s for s in self.sheets.values() if GLASS.search(s.drawn.layer)), None)
            if sheet is None:
                said = "this plan has no layer for glass or windows, on which it would be read as glass"
                raise PluginError(f"{_said(work)}: {said}. {FILE_HAS_IT}.")
            sheet.added.append(Stroke("lines", list(work.stretch)))

    def _is_leaf(self, sheet: Sheet) -> bool:
        radii = [s.radius / self.unit for s in sheet.drawn.strokes if s.kind == "arc"]
        return any(LEAF_MM[0] <= r <= LEAF_MM[1] for r in radii)

    def touched(self) -> List[str]:
        return [s.drawn.id for s in self.sheets.values() if s.is_touched or s.added]

    def labels(self) -> List[str]:
        return [s.drawn.label for s in self.sheets.values() if s.is_touched]

    def make(self, doc) -> None:
        """Changes the document. Inside a transaction."""
        for sheet in self.sheets.values():
            if sheet.is_touched or sheet.added:
                lines.redraw(doc, sheet.found, sheet.stays, sheet.added)
        doc.recompute()

    def check(self, now: Reading) -> None:
        """Nothing is drawn any more in what goes, and every new line stands where it should."""
        there = Plan(now, 1000.0 * self.unit)
        for quad, layers in self.gone:
            for sheet in (s for s in there.sheets.values() if s.drawn.layer in layers):
                if any(there._span(a, b, quad) and not self._is_new((a, b)) for a, b in sheet.segments()):
                    raise PluginError(f"'{sheet.drawn.label}' still stands where the option opens the wall; nothing was changed.")
        drawn = [s for sheet in there.sheets.values() for s in sheet.segments()]
        for line in self._wanted():
            if not any(self._same(line, s) for s in drawn):
                raise PluginError("A line does not stand where the option says; nothing was changed.")

    def _wanted(self) -> List[Line]:
        return [g for s in self.sheets.values() if s.is_touched or s.added for g in s.segments()]

    def _is_new(self, line: Line) -> bool:
        added = [(a.points[0], a.points[1]) for s in self.sheets.values() for a in s.added if a.kind == "lines"]
        return any(self._same(line, s) for s in added)

    def _same(self, a: Line, b: Line) -> bool:
        by = self.unit * WORK_MM
        return any(distance(a[0], p) <= by and distance(a[1], q) <= by for p, q in (b, b[::-1]))


def _whole(stroke: Stroke) -> List[Piece]:
    return [Piece(list(stroke.points), stroke.closed)]


def _outside(a: Point, b: Point, span: Tuple[float, float], least: float) -> List[Line]:
    length, d = distance(a, b), minus(b, a)
    low, high = plus(a, d, span[0]), plus(a, d, span[1])
    parts = [(a, low)] if span[0] * length > least else []
    return parts + ([(high, b)] if (1.0 - span[1]) * length > least else [])


def _thickness(work: Work) -> float:
    sides = [distance(q[0], q[3]) for q in work.demolished] + [b.thickness for b in work.built]
    return max(sides, default=0.0)


def _leaf(work: Work) -> List[Stroke]:
    """A leaf that stands open at a right angle, and its swing, on the side of the first room."""
    a, b = work.stretch
    u = direction(*axis_of(work.demolished[0])) if work.demolished else direction(a, b)
    side = -1.0 if not work.rooms or work.rooms[0] is not None else 1.0
    into = (left_of(u)[0] * side, left_of(u)[1] * side)
    hinge, lock = (plus(p, into, _thickness(work) / 2.0) for p in (a, b))
    radius = distance(a, b)
    tip = plus(hinge, into, radius)
    turns_left = dot(left_of(minus(lock, hinge)), minus(tip, hinge)) > 0
    ends = [lock, tip] if turns_left else [tip, lock]
    return [Stroke("lines", [hinge, tip]), Stroke("arc", ends, False, hinge, radius)]


def _said(work: Work) -> str:
    words = work.said()
    return words[:1].upper() + words[1:]
