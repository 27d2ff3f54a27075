"""Applying an option: the model's own walls, columns, doors and windows, as one entry of the undo list."""

import math
from typing import Dict, List, Tuple

from enfilade_common import results
from enfilade_common.job import Job
from enfilade_common.model import Column, Movable, PluginError, Wall
from enfilade_common.plane import distance, fit_rigid

from . import reading
from .data import Point

#: Moves below this are none, mm.
NOTHING_MM = 0.01


def apply(host, job: Job, option: results.Option) -> List[str]:
    """Moves the model to an option of a job that we wrote; gives the labels of what moved."""
    changes = results.layout(job, option)
    if not changes:
        raise PluginError("This option leaves everything as it is.")
    present, _ = reading.study(host, job.study.wishes)
    edited = results.edited_since(job, list(present.movables()), changes)
    if edited:
        raise PluginError(
            "The model was changed since the study: " + ", ".join(edited) + ". Nothing was moved; export again."
        )
    _refuse_locked(present, changes)
    with host.transaction_group(f"Enfilade: option {option.number}"):
        with host.transaction("Enfilade: walls and columns"):
            for change in changes:
                _move(host, _exported(job, change.id), change)
        with host.transaction("Enfilade: doors and windows"):
            _move_openings(host, job, changes)
        _check(host, job, changes)
    return [_exported(job, c.id).label for c in changes]


def _refuse_locked(present, changes) -> None:
    now = {e.id: e for e in present.movables()}
    pinned = [f"'{now[c.id].label}': {now[c.id].locked}" for c in changes if now[c.id].locked]
    if pinned:
        raise PluginError("The option moves what cannot be moved: " + "; ".join(pinned) + ". Nothing was changed.")


def _exported(job: Job, id: str) -> Movable:
    element = job.study.element(id)
    if element is None:
        raise PluginError(f"Element {id} is not part of this study.")
    return element


def _move(host, element, change) -> None:
    id = int(change.id)
    if isinstance(element, Column) or element.rings:
        host.move(id, change.motion.angle_rad, (change.motion.dx, change.motion.dy))
    elif any(distance(a, b) > NOTHING_MM for a, b in zip(change.axis_before, change.axis_after)):
        host.set_wall_line(id, change.axis_after[0], change.axis_after[-1])


def _move_openings(host, job: Job, changes) -> None:
    """Revit carries inserts along with their wall; what is missing then is shifted along it."""
    now = {i.element_id: i for i in host.inserts()}
    for change in changes:
        wall = _exported(job, change.id)
        if not isinstance(wall, Wall):
            continue
        for opening in wall.openings:
            motion, insert = change.openings.get(opening.id), now.get(int(opening.id))
            if motion is None or insert is None:
                continue
            target = motion(wall.at((opening.start + opening.end) / 2))
            shift = (target[0] - insert.centre[0], target[1] - insert.centre[1])
            if math.hypot(*shift) > NOTHING_MM:
                host.move(insert.element_id, 0.0, shift)


def _check(host, job: Job, changes) -> None:
    """Everything stands where the option says; else the whole group is rolled back."""
    present, _ = reading.study(host, job.study.wishes)
    now = {e.id: e for e in present.movables()}
    for change in changes:
        element = now.get(change.id)
        if element is None:
            raise PluginError("An element was lost while moving; nothing was changed.")
        exported = _exported(job, change.id)
        if isinstance(element, Column) and isinstance(exported, Column):
            expected, here = [change.motion(p) for p in exported.ring], element.ring
        elif isinstance(element, Wall):
            expected, here = change.axis_after, element.axis
        else:
            raise PluginError(f"'{element.label}' became another kind of element; nothing was changed.")
        if isinstance(element, Wall) and element.rings:
            continue
        if len(here) != len(expected) or any(distance(a, b) > results.FIT_MM for a, b in zip(here, expected)):
            raise PluginError(f"'{element.label}' does not take its new place: Revit holds it; nothing was changed.")


def apply_drawing(host, option: results.Option) -> List[str]:
    """Moves the model to an option of a drawing that Revit itself exported.

    Every line of an element bears Revit's element id; an element moves where all of them move together.
    """
    pairs: Dict[int, Tuple[List[Point], List[Point]]] = {}
    for change in option.changes:
        # Revit carries doors and windows along with their wall.
        if change.get("follows"):
            continue
        id = change.get("host_id") or ""
        if not id.isdigit():
            raise PluginError(f"Option {option.number} moves an element without Revit's id; nothing was changed.")
        before, after = pairs.setdefault(int(id), ([], []))
        before.extend((x * 1000.0, y * 1000.0) for x, y in change["from"])
        after.extend((x * 1000.0, y * 1000.0) for x, y in change["to"])
    motions = {}
    for id, (before, after) in pairs.items():
        motion, residual = fit_rigid(before, after)
        if residual > results.FIT_MM:
            raise PluginError(f"Element {id} does not keep its shape in this option; nothing was changed.")
        motions[id] = motion
    missing = [id for id in motions if not host.exists(id)]
    if missing:
        raise PluginError(f"Elements {missing} are not in this model any more; nothing was changed.")
    with host.transaction_group(f"Enfilade: option {option.number}"):
        with host.transaction("Enfilade: walls"):
            for id, motion in motions.items():
                host.move(id, motion.angle_rad, (motion.dx, motion.dy))
    return [str(id) for id in motions]
