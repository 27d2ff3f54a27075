"""What is shown of an option before it is accepted: lines that go and come, and what every cell measures."""

import csv
from dataclasses import dataclass
from typing import Dict, Iterable, List, Tuple

from . import drawn
from .job import Job
from .model import PluginError
from .option import Option
from .plane import Point, cross, direction, distance, dot, minus, plus
from .results import COLUMNS
from .shifted import FIT_MM, in_document, moved_outlines
from .works import work_outlines

Line = List[Point]


def moved_lines(
    before: List[Point], after: List[Point], is_closed: bool = True, within: float = FIT_MM
) -> Tuple[List[Line], List[Line]]:
    """Lines of an outline that go, and those that come. Of one that is only stretched these are its ends and the
    difference; what stays where it is is neither."""
    back = 1 if is_closed else 0
    if all(distance(a, b) > within for a, b in zip(before, after)):
        return [before + before[:back]], [after + after[:back]]
    gone_lines: List[Line] = []
    new_lines: List[Line] = []
    for i in range(len(before) - 1 if len(before) <= 2 or not is_closed else len(before)):
        old, new = ((ring[i], ring[(i + 1) % len(ring)]) for ring in (before, after))
        lost, made = _differing(old, new, within)
        gone_lines += lost
        new_lines += made
    return gone_lines, new_lines


def _differing(old: Tuple[Point, Point], new: Tuple[Point, Point], within: float) -> Tuple[List[Line], List[Line]]:
    if old[0] == old[1] or any(_off(p, old) > within for p in new):
        return [list(old)], [list(new)]
    u = direction(*old)
    ends = [sorted(dot(minus(p, old[0]), u) for p in edge) for edge in (old, new)]
    lost, made = (_outside(old[0], u, ends[k], ends[1 - k], within) for k in (0, 1))
    return lost, made


def _off(p: Point, edge: Tuple[Point, Point]) -> float:
    return abs(cross(direction(*edge), minus(p, edge[0])))


def _outside(start: Point, u: Point, mine: List[float], other: List[float], within: float) -> List[Line]:
    """Pieces of a stretch of a line that another stretch does not cover."""
    pieces = [(mine[0], min(mine[1], other[0])), (max(mine[0], other[1]), mine[1])]
    return [[plus(start, u, a), plus(start, u, b)] for a, b in pieces if b - a > within]


def _shown(job: Job, option: Option) -> List[Tuple[str, List[Point], List[Point]]]:
    """What an option changes, for a preview: also what the host's own walls take with them."""
    if job.parts:
        return moved_outlines(job, option)
    outlines = {o.host_id: o for o in job.outlines}
    out = []
    for change in option.changes:
        id = str(change.get("host_id"))
        before, after = in_document(change["from"], option), in_document(change["to"], option)
        if id in outlines:
            before, after = outlines[id].unwritten(before), outlines[id].unwritten(after)
        out.append((id, before, after))
    return out


def ghosts(job: Job, option: Option) -> Tuple[List[Line], List[Line]]:
    """Lines of an option that stand no more, and new ones, in units of the drawing: for a preview."""
    outlines = {o.host_id: o for o in job.outlines}
    strokes = {f"{d.id}/{i}": s for d in job.study.drawn for i, s in enumerate(d.strokes)}
    gone_lines: List[Line] = []
    new_lines: List[Line] = []
    within = FIT_MM * option.per_metre / 1000.0
    for id, before, after in _shown(job, option):
        outline, stroke = outlines.get(id), strokes.get(id)
        if stroke is not None and stroke.kind != "lines":
            lost, made = [drawn.traced(stroke)], [drawn.traced(stroke, drawn.motion_of(stroke, after))]
        elif outline is not None:
            lost, made = moved_lines(before, after, outline.is_closed, within)
        else:
            lost, made = moved_lines(before, after)
        gone_lines += lost
        new_lines += made
    for work in option.works:
        lost, made = work_outlines(work)
        gone_lines += lost
        new_lines += made
    return gone_lines, new_lines


@dataclass
class Cells:
    """What every cell of a layout measures: its middle, mm, and a value for each measure."""

    places: List[Point]
    values: Dict[str, List[float]]


def read_cells(table: Iterable[str], scale: float = 1.0) -> Cells:
    """The program's table of cells; cells without a value in any measure are left out. ``scale`` are the host's units
    in one of the drawing."""
    rows = csv.reader(table)
    heads = next(rows, [])
    try:
        x, y, *columns = (heads.index(name) for name in ("x", "y", *COLUMNS.values()))
        kept = [row for row in rows if all(row[c] for c in columns)]
        values = {m: [float(row[c]) for row in kept] for m, c in zip(COLUMNS, columns)}
        return Cells([(float(row[x]) * scale, float(row[y]) * scale) for row in kept], values)
    except (ValueError, IndexError) as e:
        raise PluginError(f"The program's table of cells cannot be read ({e}).") from e
