"""From a Revit view to a study."""

import math
import re
from typing import Dict, List, Optional, Tuple

from enfilade_common.allowed import OF_OPENINGS, is_work, length_mm, works_in
from enfilade_common.model import Allowed, Clause, Column, Opening, PluginError, Region, Study, Wall, Wishes, pair_name
from enfilade_common.plane import distance, direction, dot, minus

from .data import (
    GROUP_PARAMETER,
    KEEP_PARAMETER,
    LINE_STYLES,
    MOVES_PARAMETER,
    DetailLine,
    Point,
    RevitColumn,
    RevitInsert,
    RevitWall,
)

#: Ends of detail lines nearer than this meet, mm.
MEET_MM = 2.0

#: So many names stand in a sentence about what was left out.
NAMED = 5


def study(host, wishes: Wishes) -> Tuple[Study, List[str]]:
    """The study of the host's view, and sentences about what was left out."""
    notes: List[str] = []
    walls, columns = host.walls(), host.columns()
    _tell_apart("Left out", [(e.label, e.left_out) for e in walls + columns if e.left_out], notes)
    _tell_apart("Left out", [(name, "linked model") for name in host.links()], notes)
    closed = [(i.label, i.closed) for w in walls if not w.left_out for i in w.inserts if i.closed]
    _tell_apart("Taken as closed", closed, notes)
    made = Study("revit", host.document_id(), *movables(walls, columns, notes))
    if not made.walls:
        raise PluginError("\n".join(["The view shows no wall of the plan. Open a floor plan and try again.", *notes]))
    made.regions, made.wishes, made.storey = regions(host.detail_lines(), notes), wishes, host.level_name()
    return made, notes


def movables(walls: List[RevitWall], columns: List[RevitColumn], notes: List[str]) -> Tuple[List[Wall], List[Column]]:
    """What of Revit's walls and columns is part of a plan."""
    made = [_wall(found, notes) for found in walls if not found.left_out]
    standing = [_column(found, notes) for found in columns if not found.left_out]
    return [wall for wall in made if wall is not None], standing


def _tell_apart(head: str, found: List[Tuple[str, str]], notes: List[str]) -> None:
    """One sentence for each reason, with the first names."""
    by_reason: Dict[str, List[str]] = {}
    for label, reason in found:
        by_reason.setdefault(reason, []).append(f"'{label}'")
    for reason, labels in by_reason.items():
        more = f" and {len(labels) - NAMED} more" if len(labels) > NAMED else ""
        notes.append(f"{head} ({reason}): {', '.join(labels[:NAMED])}{more}.")


def _wall(found: RevitWall, notes: List[str]) -> Optional[Wall]:
    id = str(found.element_id)
    if found.axis is None and not found.rings:
        notes.append(f"Left out (neither a straight location line nor an outline): '{found.label}'.")
        return None
    if found.axis is None:
        points = [p for ring in found.rings for p in ring]
        axis = [(min(p[0] for p in points), min(p[1] for p in points))]
        axis.append((max(p[0] for p in points), max(p[1] for p in points)))
        wall = Wall(id, found.label, axis, 0.0, 0.0, rings=found.rings)
    else:
        wall = Wall(id, found.label, list(found.axis), found.left, found.right)
    heading = direction(wall.axis[0], wall.axis[-1])
    _take_marks(wall, found, math.degrees(math.atan2(heading[1], heading[0])), notes)
    wall.works = works(found.parameters.get(MOVES_PARAMETER, ""), found.label, notes)
    for insert in found.inserts:
        if not insert.closed and not wall.rings:
            _add_opening(wall, insert, notes)
    return wall


def _column(found: RevitColumn, notes: List[str]) -> Column:
    column = Column(str(found.element_id), found.label, list(found.ring))
    _take_marks(column, found, 0.0, notes)
    return column


def _take_marks(element, found, heading_deg: float, notes: List[str]) -> None:
    element.group = found.parameters.get(GROUP_PARAMETER, "").strip()
    element.keep = found.parameters.get(KEEP_PARAMETER, "") == "1"
    element.clauses = clauses(found.parameters.get(MOVES_PARAMETER, ""), heading_deg, found.label, notes)
    element.locked = found.fixed


def _add_opening(wall: Wall, insert: RevitInsert, notes: List[str]) -> None:
    u = direction(wall.axis[0], wall.axis[-1])
    assert insert.centre is not None, "an opening has a place"
    along = dot(minus(insert.centre, wall.axis[0]), u)
    start, end = along - insert.width / 2, along + insert.width / 2
    if start < 0.0 or end > wall.length():
        notes.append(f"Taken as closed (reaches beyond '{wall.label}'): '{insert.label}'.")
        return
    kind = "window" if insert.is_window else "door"
    opening = Opening(str(insert.element_id), insert.label, start, end, kind)
    text = insert.parameters.get(MOVES_PARAMETER, "")
    opening.clauses = [c for c in clauses(text, 0.0, insert.label, notes) if c.kind == "along"]
    opening.works = [w for w in works(text, insert.label, notes) if w.kind in OF_OPENINGS and not insert.is_window]
    if insert.fixed and opening.clauses:
        notes.append(f"'{insert.label}' is marked to move but stays: {insert.fixed}.")
        opening.clauses = []
    wall.openings.append(opening)


def clauses(text: str, heading_deg: float, label: str, notes: List[str]) -> List[Clause]:
    """Clauses of a parameter's text: ``x -500 500; rotate -15 15; along -1m 2ft``.

    ``along`` without a direction is along the element's own axis. What cannot be read is told in ``notes``.
    """
    out = []
    for part in (p.strip() for p in re.split(r"[;\n]", text)):
        if not part or part.lower().startswith("name ") or is_work(part):
            continue
        clause = _clause(part.split(), heading_deg)
        if clause is None:
            notes.append(f"'{label}': {part!r} is no move; expected for example 'x -500 500; rotate -15 15'.")
        else:
            out.append(clause)
    return out


def works(text: str, label: str, notes: List[str]) -> List[Allowed]:
    """Building works of a parameter's text, beside the moves: ``open 900 2400; remove``."""
    mine = [p.strip() for p in re.split(r"[;\n]", text) if is_work(p.strip())]
    found, unread = works_in("; ".join(mine))
    for part in unread:
        notes.append(f"'{label}': {part!r} is no building work; expected for example 'open 900 2400; remove'.")
    return found


def _clause(words: List[str], heading_deg: float) -> Optional[Clause]:
    kind, values = words[0].lower(), words[1:]
    try:
        if kind == "along" and len(values) == 3:
            heading_deg, values = float(values[0]), values[1:]
        if kind not in ("x", "y", "along", "rotate") or len(values) != 2:
            return None
        lower, upper = (float(v.rstrip("°")) if kind == "rotate" else length_mm(v) for v in values)
    except ValueError:
        return None
    if not lower <= 0.0 <= upper or lower == upper:
        return None
    return Clause(kind, lower, upper, heading_deg if kind == "along" else 0.0)


def regions(lines: List[DetailLine], notes: List[str]) -> List[Region]:
    """Closed chains of detail lines on our line styles; ``EF-QUERY-entrance`` is one of the pair ``entrance``."""
    out = []
    for style in dict.fromkeys(line.style for line in lines):
        kind, pair = _region_of(style, notes)
        rest = [(line.a, line.b) for line in lines if kind and line.style == style]
        rings = []
        while rest:
            rings.append(_chain(rest))
        out += [Region(kind, ring, pair=pair) for ring in rings if ring is not None]
        if None in rings:
            notes.append(f"Detail lines on {style} do not close; they were left out.")
    return out


def _region_of(style: str, notes: List[str]) -> Tuple[str, str]:
    """What a line style marks, and the pair it names; nothing for a style of somebody else's."""
    for head, kind in LINE_STYLES.items():
        if style.upper() == head:
            return kind, ""
        if style.upper().startswith(head + "-") and kind != "keep":
            try:
                return kind, pair_name(style[len(head) + 1 :])
            except PluginError as e:
                notes.append(f"Detail lines on {style} were left out: {e}")
    return "", ""


def _chain(rest: List[Tuple[Point, Point]]) -> Optional[List[Point]]:
    """Takes one chain out of ``rest``; its corners if it closes."""
    points = list(rest.pop(0))
    while distance(points[0], points[-1]) > MEET_MM:
        tip = points[-1]
        meets = (i for i, (a, b) in enumerate(rest) if min(distance(tip, a), distance(tip, b)) <= MEET_MM)
        at = next(meets, None)
        if at is None:
            return None
        a, b = rest.pop(at)
        points.append(b if distance(points[-1], a) <= MEET_MM else a)
    return points[:-1] if len(points) > 3 else None
