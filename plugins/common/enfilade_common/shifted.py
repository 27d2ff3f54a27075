"""Which outlines of a study an option changes: entities of the drawing, taken apart into the strokes of the host."""

from typing import Any, Dict, List, Tuple

from .job import Job
from .model import PluginError
from .option import Option
from .outlines import Outline
from .patched import Part
from .plane import Point, distance, fit_rigid

#: What moved must fit a wall again to this, mm.
FIT_MM = 0.1


def moved_outlines(job: Job, option: Option) -> List[Tuple[str, List[Point], List[Point]]]:
    """Ids of the outlines that an option changes, with their points before and after, in units of the document."""
    outlines = {o.host_id: o for o in job.outlines}
    after: Dict[str, List[Point]] = {}
    within = FIT_MM * option.per_metre / 1000.0
    for change in option.changes:
        # The host's doors and windows go with their wall by themselves; those of a 2D plan are lines like others.
        if change.get("follows") and not job.study.drawn:
            continue
        id = str(change.get("host_id"))
        if change.get("follows") and change.get("host_id") is None:
            # What fills or names a room in the file behind; no host shows it.
            continue
        before, to = (in_document(change[k], option) for k in ("from", "to"))
        if id in job.parts:
            _split(job.parts[id], outlines, (before, to), after, within)
            continue
        outline = outlines.get(id)
        if outline is None:
            raise PluginError(f"Option {option.number} moves an element {id!r} that this study never wrote.")
        before, to = outline.unwritten(before), outline.unwritten(to)
        if len(before) != len(outline.points) or len(to) != len(before):
            raise PluginError(f"Option {option.number} gives {id} another shape; nothing was taken over.")
        if any(distance(a, b) > within for a, b in zip(before, outline.points)):
            raise PluginError(f"Option {option.number} was made for {id} at another place; run the study again.")
        after[id] = to
    return [(id, outlines[id].points, to) for id, to in after.items()]


def _split(
    parts: List[Part],
    outlines: Dict[str, Outline],
    change: Tuple[List[Point], List[Point]],
    after: Dict[str, List[Point]],
    within: float,
) -> None:
    """Hands the change of an entity of the file behind on to the strokes that it is in the document."""
    before, to = change
    for host_id, point, corner in parts:
        outline = outlines[host_id]
        if point < 0:
            motion, residual = fit_rigid(before, to)
            if residual > within:
                raise PluginError(f"A block of the file changes its shape ({host_id}); nothing was taken over.")
            after[host_id] = [motion(p) for p in outline.points]
            continue
        if corner >= len(to) or distance(before[corner], outline.points[point]) > within:
            raise PluginError(f"The option was made for {host_id} at another place; run the study again.")
        after.setdefault(host_id, list(outline.points))[point] = to[corner]


def in_document(points: Any, option: Option) -> List[Point]:
    """Points of a result in units of the document."""
    return [(float(x) * option.per_metre, float(y) * option.per_metre) for x, y in points]
