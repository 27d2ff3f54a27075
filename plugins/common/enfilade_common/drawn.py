"""2D plans: their strokes as a drawing that the program reads like any other, and back from its result."""

import math
from typing import Any, Dict, List, Tuple

from .dxf_r12 import Drawing
from .model import Clause, Drawn, Stroke, Study
from .moves import Plan
from .plane import STILL, Point, Rigid, fit_rigid

#: Lines of a preview keep this near to a curve: degrees of an arc.
STEP_DEG = 10.0
#: Half the side of the mark round a point that stays, as a share of the plan.
HELD = 1.0 / 4000.0


def draw(out: Drawing, study: Study) -> Dict[str, str]:
    """Draws every stroke on its layer, with its id; gives the handle of each."""
    handles = {}
    for drawn in study.drawn:
        for i, stroke in enumerate(drawn.strokes):
            id = f"{drawn.id}/{i}"
            handles[id] = draw_stroke(out, drawn.layer, stroke, (id, drawn.label))
    draw_kept(out, study)
    return handles


def draw_kept(out: Drawing, study: Study) -> None:
    """Marks round the points that stay."""
    every = [p for drawn in study.drawn for p in drawn.points()]
    by = HELD * max((max(p[k] for p in every) - min(p[k] for p in every) for k in (0, 1) if every), default=0.0)
    for drawn in study.drawn:
        if drawn.keep or drawn.locked or drawn.is_stiff and not (drawn.clauses or drawn.group):
            for x, y in dict.fromkeys(drawn.points()):
                out.polyline("EF-KEEP", [(x + by * sx, y + by * sy) for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))])


def draw_stroke(out: Drawing, layer: str, stroke: Stroke, ids) -> str:
    if stroke.kind == "circle":
        return out.circle(layer, stroke.centre, stroke.radius, ids)
    if stroke.kind == "arc":
        return out.arc(layer, stroke.centre, stroke.radius, angles_deg(stroke), ids)
    if len(stroke.points) == 2:
        return out.line(layer, stroke.points[0], stroke.points[1], ids)
    return out.polyline(layer, stroke.points, stroke.closed, ids)


def angles_deg(stroke: Stroke) -> Tuple[float, float]:
    """Where an arc begins and ends, anticlockwise from east."""
    a, b = (math.degrees(math.atan2(p[1] - stroke.centre[1], p[0] - stroke.centre[0])) % 360.0 for p in stroke.points)
    return a, b


def move_tables(plan: Plan, handles: Dict[str, str]) -> List[Dict[str, Any]]:
    """``[[move]]`` tables by whole entities. Lengths are those of the building, whatever the unit of the drawing."""
    out: Dict[Tuple[str, ...], Dict[str, Any]] = {}
    for table in plan.tables:
        members = set(table.members)
        named = list(dict.fromkeys(handles[o.host_id] for o in plan.outlines if o.owner in members))
        known = out.setdefault((table.name, *table.members), {"name": table.name, "moves": "", "handles": named})
        known["moves"] += ("; " if known["moves"] else "") + _in_mm(table.clause)
    return list(out.values())


def _in_mm(clause: Clause) -> str:
    *head, lower, upper = clause.text().split(" ")
    unit = "" if clause.kind == "rotate" else "mm"
    return " ".join([*head, lower + unit, upper + unit])


def keeps_shape(drawn: Drawn, after: List[List[Point]], within: float) -> bool:
    """Whether arcs stay arcs, and what is stiff moves as a whole."""
    pairs = list(zip(drawn.strokes, after))
    if drawn.is_stiff and fit_rigid(drawn.points(), [p for points in after for p in points])[1] > within:
        return False
    return all(s.kind == "lines" or fit_rigid(s.points, points)[1] <= within for s, points in pairs)


def motion_of(stroke: Stroke, after: List[Point]) -> Rigid:
    """How an arc or a circle goes."""
    return fit_rigid(stroke.points, after)[0]


def traced(stroke: Stroke, motion: Rigid = STILL) -> List[Point]:
    """An arc or a circle as lines, for a preview."""
    begin, end = (0.0, 360.0) if stroke.kind == "circle" else angles_deg(stroke)
    sweep = (end - begin) % 360.0 or 360.0
    count = max(2, math.ceil(sweep / STEP_DEG))
    at = (math.radians(begin + sweep * i / count) for i in range(count + 1))
    around = [(stroke.centre[0] + stroke.radius * math.cos(t), stroke.centre[1] + stroke.radius * math.sin(t)) for t in at]
    return [motion(p) for p in around]
