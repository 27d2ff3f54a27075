"""From marks to the program's groups of nodes: which corners move with which parameter.

Every clause of a group becomes one ``[[move]]`` table of its own, so that a wall that joins a moving one can
follow the clause that runs along it and stay in the others. Doors come first: a door slides along its wall
as drawn, then the wall takes it with it.
"""

import math
from dataclasses import dataclass, field
from typing import Dict, List, Set, Tuple

from . import allowed
from .model import Built, Clause, Column, Drawn, Movable, Opening, Study, Wall, number
from .outlines import CELL_MM, Outline, begin_outside, keep_apart, study_outlines
from .plane import Point, Rigid, centroid, cross, direction, distance, distance_to_segment, dot, plus, turn_about

#: What a stretched piece of wall always keeps of its length, mm.
PIECE_KEPT_MM = 50.0

#: A wall end this near to another wall's face is joined to it, mm.
JOIN_MM = 5.0

Corner = Tuple[int, int]


@dataclass
class MoveTable:
    """One ``[[move]]`` of the side-car: a name, one clause, and the corners it moves."""

    name: str
    clause: Clause
    corners: Set[Corner]
    #: Ids of what the user marked: walls and columns, or one door or window.
    members: List[str]
    #: Ids of walls of which one end follows.
    followers: List[str] = field(default_factory=list)

    def nodes(self, outlines: List[Outline]) -> List[Point]:
        """Where the corners stand, each place once, in the order of the file."""
        return list(dict.fromkeys(outlines[i].points[c] for i, c in sorted(self.corners)))


@dataclass
class Plan:
    """A study made ready to be written: outlines, moves, and what the user should know about them."""

    outlines: List[Outline]
    tables: List[MoveTable]
    notes: List[str]


def plan_of(study: Study) -> Plan:
    """Outlines and move tables of a study."""
    outlines = study_outlines(study)
    notes: List[str] = []
    tables = _door_tables(study, outlines) + _group_tables(study, outlines, notes)
    if not study.drawn:
        _clamp(study, tables, outlines, notes)
        keep_apart(outlines, _moves_of(tables, outlines))
        begin_outside(outlines)
    return Plan(outlines, tables, [*notes, *allowed.notes_on(study)])


def why_nothing_moves(study: Study) -> List[str]:
    """Why no part of a study may move; nothing where some may."""
    plan = plan_of(study)
    if plan.tables:
        return []
    marked = [e for e in study.movables() if e.clauses or e.group]
    if not marked:
        where = f" on the storey '{study.storey}'" if study.storey else ""
        what = "line" if study.drawn else "wall, column, door or window"
        return [f"no {what}{where} is marked"]
    return [note.rstrip(".") for note in plan.notes[:5]]


def _moves_of(tables: List[MoveTable], outlines: List[Outline]) -> List[List[frozenset]]:
    sets: Dict[Corner, Set[int]] = {}
    for t, table in enumerate(tables):
        for corner in table.corners:
            sets.setdefault(corner, set()).add(t)
    return [[frozenset(sets.get((i, c), ())) for c in range(len(o.points))] for i, o in enumerate(outlines)]


def _door_tables(study: Study, outlines: List[Outline]) -> List[MoveTable]:
    out = []
    for wall in study.walls:
        for opening in wall.openings:
            corners = {
                (i, c)
                for i, o in enumerate(outlines)
                if o.owner == wall.id and o.stations
                for end in (0, 1)
                if o.stations[end].opening == opening.id
                for c in o.corners_at(end)
            }
            for clause in opening.clauses:
                along = Clause("along", clause.lower, clause.upper, _heading_deg(wall, opening))
                if corners:
                    out.append(MoveTable(opening.label, along, set(corners), [opening.id]))
    return out


def _heading_deg(wall: Wall, opening: Opening) -> float:
    """Direction of the axis where an opening lies."""
    middle = (opening.start + opening.end) / 2
    points = wall.corners()
    for a, b in zip(points, points[1:]):
        if middle <= distance(a, b) or b == points[-1]:
            u = direction(a, b)
            return math.degrees(math.atan2(u[1], u[0]))
        middle -= distance(a, b)
    return 0.0


def _groups(study: Study, notes: List[str]) -> Dict[str, List[Movable]]:
    """Marked elements by their group, in drawing order."""
    out: Dict[str, List[Movable]] = {}
    for element in study.movables():
        if not (element.clauses or element.group):
            continue
        if element.locked:
            notes.append(f"'{element.label}' is marked to move but stays: {element.locked}.")
            continue
        if element.keep:
            notes.append(f"'{element.label}' is marked to move but stays: it is marked 'must stay' too.")
            continue
        out.setdefault(element.group or "\0" + element.id, []).append(element)
    return out


def _group_tables(study: Study, outlines: List[Outline], notes: List[str]) -> List[MoveTable]:
    by_owner: Dict[str, List[int]] = {}
    for i, outline in enumerate(outlines):
        by_owner.setdefault(outline.owner, []).append(i)
    out = []
    near = Neighbours(study)
    for key, members in _groups(study, notes).items():
        marked = [m for m in members if m.clauses]
        clauses = _common(marked)
        name = members[0].label if key.startswith("\0") else key
        if not marked:
            notes.append(f"The group '{name}' has no allowed move; it stays. Mark one of its walls to move.")
            continue
        if any(_ways(m.clauses) != _ways(clauses) for m in marked):
            notes.append(f"The walls of group '{name}' are marked differently: it moves as far as all of them may.")
        ids = [m.id for m in members]
        body = {(i, c) for id in ids for i in by_owner.get(id, ()) for c in range(len(outlines[i].points))}
        for clause in clauses:
            table = MoveTable(name, clause, set(body), ids)
            if not study.drawn:
                _take_followers(near, table, members, outlines, by_owner, notes)
            out.append(table)
    return out


def _ways(clauses: List[Clause]) -> List[Tuple[str, float, float]]:
    return [(c.kind, c.lower, c.upper) for c in clauses]


def _common(marked: List[Movable]) -> List[Clause]:
    """What all of these may do, in the directions of the first."""
    out = []
    for clause in marked[0].clauses if marked else []:
        own = [[c for c in m.clauses if c.kind == clause.kind] for m in marked]
        if all(own):
            lower, upper = max(c[0].lower for c in own), min(c[0].upper for c in own)
            if lower < upper:
                out.append(Clause(clause.kind, lower, upper, clause.direction_deg))
    return out


def heading(clause: Clause) -> Point:
    """Unit direction of a shift."""
    if clause.kind == "rotate":
        raise ValueError("a turn has no direction")
    angle = {"x": 0.0, "y": 90.0}.get(clause.kind, clause.direction_deg)
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    return (round(c, 12) + 0.0, round(s, 12) + 0.0)


def wall_ends(wall: Wall) -> List[Tuple[int, Point, Point]]:
    """Free ends ``(axis index, point, outward direction)`` of a wall with an axis."""
    if wall.closed or wall.rings or len(wall.axis) < 2:
        return []
    a, b, y, z = wall.axis[0], wall.axis[1], wall.axis[-2], wall.axis[-1]
    if a == b or y == z:
        return []
    return [(0, a, direction(b, a)), (len(wall.axis) - 1, z, direction(y, z))]


def touches(point: Point, wall: Built) -> bool:
    """Whether a wall end lies on or in another wall, by its axis and thickness."""
    if isinstance(wall, Column) or wall.rings:
        rings = [wall.ring] if isinstance(wall, Column) else wall.rings
        edges = [(a, b) for r in rings for a, b in zip(r, r[1:] + r[:1])]
        return any(distance_to_segment(point, a, b) <= JOIN_MM for a, b in edges)
    reach = max(wall.left, wall.right) + JOIN_MM
    points = wall.corners()
    return any(distance_to_segment(point, a, b) <= reach for a, b in zip(points, points[1:]))


class Neighbours:
    """Walls near an element, by the boxes of both."""

    def __init__(self, study: Study):
        self._walls = study.walls
        self._boxes = [_box(w) for w in study.walls]
        self._cells: Dict[Tuple[int, int], List[int]] = {}
        for i, box in enumerate(self._boxes):
            for cell in _cells(box):
                self._cells.setdefault(cell, []).append(i)

    def of(self, members: List[Built]) -> List[Wall]:
        """Walls whose box meets that of a member, the members left out, in drawing order."""
        own = {m.id for m in members}
        found: Set[int] = set()
        for member in members:
            box = _box(member)
            for cell in _cells(box):
                found.update(i for i in self._cells.get(cell, ()) if _meet(box, self._boxes[i]))
        return [self._walls[i] for i in sorted(found) if self._walls[i].id not in own]


def _cells(box) -> List[Tuple[int, int]]:
    x0, y0, x1, y1 = (int(v // CELL_MM) for v in box)
    return [(x, y) for x in range(x0, x1 + 1) for y in range(y0, y1 + 1)]


def _meet(a, b) -> bool:
    return a[0] <= b[2] and b[0] <= a[2] and a[1] <= b[3] and b[1] <= a[3]


def _take_followers(near: Neighbours, table: MoveTable, members, outlines, by_owner, notes: List[str]) -> None:
    """Adds the ends of fixed walls that are joined to the moving ones and run along the shift; says which
    joints the clause opens."""
    u = None if table.clause.kind == "rotate" else heading(table.clause)
    loosened = []
    neighbours = near.of(members)
    for wall in neighbours:
        own_turns = any(c.kind == "rotate" for c in wall.clauses)
        for index, point, outward in wall_ends(wall):
            if not any(touches(point, m) for m in members):
                continue
            if u is not None and abs(cross(u, outward)) < 0.02 and not own_turns and not (wall.locked or wall.keep):
                table.corners |= _end_corners(wall, index, outlines, by_owner)
                table.followers.append(wall.id)
            elif u is None or abs(dot(u, outward)) > 0.02:
                loosened.append(wall.label)
    loosened += _own_loose_ends(neighbours, table, members, u)
    if loosened:
        names = ", ".join(f"'{n}'" for n in dict.fromkeys(loosened))
        how = "turning" if u is None else f"moving {table.clause.text().split(' ')[0]}"
        notes.append(f"'{table.name}' comes apart from {names} by {how}: a gap or an overlap can stand there.")


def _own_loose_ends(neighbours: List[Wall], table: MoveTable, members, u) -> List[str]:
    """Labels of fixed walls from which an end of a moving wall comes away."""
    out = []
    for member in members:
        if isinstance(member, Column):
            continue
        for _, point, _ in wall_ends(member):
            for other in neighbours:
                if other.rings or not touches(point, other):
                    continue
                reached = [] if u is None else [plus(point, u, v) for v in (table.clause.lower, table.clause.upper)]
                if u is None or not all(touches(p, other) for p in reached):
                    out.append(other.label)
    return out


def _end_corners(wall: Wall, index: int, outlines, by_owner) -> Set[Corner]:
    return {
        (i, c)
        for i in by_owner.get(wall.id, ())
        if outlines[i].stations
        for end in (0, 1)
        if outlines[i].stations[end].kind == "corner" and outlines[i].stations[end].index == index
        for c in outlines[i].corners_at(end)
    }


def _box(element: Built):
    points = list(element.ring) if isinstance(element, Column) else list(element.axis)
    points += [] if isinstance(element, Column) else [p for r in element.rings for p in r]
    by = 0.0 if isinstance(element, Column) else max(element.left, element.right)
    xs, ys = [p[0] for p in points], [p[1] for p in points]
    by += 2 * JOIN_MM
    return (min(xs) - by, min(ys) - by, max(xs) + by, max(ys) + by)


def _clamp(study: Study, tables: List[MoveTable], outlines: List[Outline], notes: List[str]) -> None:
    """Narrows bounds so that no stretched piece of wall turns inside out, whatever the others do."""
    stretched: Dict[int, List[Tuple[int, float]]] = {}
    for t, table in enumerate(tables):
        if table.clause.kind == "rotate":
            continue
        u = heading(table.clause)
        for i in {i for i, _ in table.corners}:
            outline = outlines[i]
            if outline.stations is None:
                continue
            moved = [(i, outline.corners_at(end)[0]) in table.corners for end in (0, 1)]
            if moved[0] == moved[1]:
                continue
            run = direction(outline.points[0], outline.points[1])
            stretched.setdefault(i, []).append((t, dot(u, run) * (1.0 if moved[1] else -1.0)))
    for i, pulls in stretched.items():
        length = distance(outlines[i].points[0], outlines[i].points[1])
        allowed = max(length - PIECE_KEPT_MM, 0.0) / len(pulls)
        for t, growth in pulls:
            _narrow(study, tables[t], outlines[i].owner, growth, allowed, notes)


def _narrow(study, table: MoveTable, owner: str, growth: float, allowed: float, notes: List[str]) -> None:
    clause = table.clause
    lower = max(clause.lower, -allowed / growth) if growth > 0 else clause.lower
    upper = min(clause.upper, allowed / -growth) if growth < 0 else clause.upper
    if (lower, upper) == (clause.lower, clause.upper):
        return
    table.clause = Clause(clause.kind, round(lower, 3), round(upper, 3), clause.direction_deg)
    element = study.element(owner)
    beside = element.label if element else owner
    reach = f"{number(lower)} to {number(upper)} mm"
    notes.append(f"'{table.name}' moves only {reach}: beyond, nothing is left of '{beside}' beside it.")


def applied(plan: Plan, values: List[float]) -> List[List[Point]]:
    """The outlines at one parameter vector (one value a table), as the program moves them: for a preview."""
    at = [list(o.points) for o in plan.outlines]
    for table, value in zip(plan.tables, values):
        corners = sorted(table.corners)
        if table.clause.kind == "rotate":
            places = dict.fromkeys(plan.outlines[i].points[c] for i, c in corners)
            here = {plan.outlines[i].points[c]: at[i][c] for i, c in reversed(corners)}
            motion = turn_about(centroid([here[p] for p in places]), math.radians(value))
        else:
            motion = Rigid(0.0, *plus((0.0, 0.0), heading(table.clause), value))
        for i, c in corners:
            at[i][c] = motion(at[i][c])
    return at
