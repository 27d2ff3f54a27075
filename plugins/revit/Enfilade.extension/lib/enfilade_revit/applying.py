"""Applying an option: the model's own walls, columns, doors and windows, as one entry of the undo list."""

from dataclasses import dataclass, field
from typing import Dict, List, Optional, Tuple

from enfilade_common import results
from enfilade_common.job import Job
from enfilade_common.model import PluginError
from enfilade_common.plane import Rigid, STILL, centroid, direction, distance, dot, fit_rigid, left_of, minus

from . import reading
from .data import Point, RevitColumn, RevitElement, RevitWall

#: Moves below this are none, mm.
NOTHING_MM = 0.01

#: So often walls are put right; each time their neighbours may follow.
ROUNDS = 3


@dataclass
class Target:
    """Where an element is to stand. ``motion`` where it moves as a whole; ``ends`` of its location line."""

    motion: Optional[Rigid] = None
    ends: List[Point] = field(default_factory=list)
    #: Places of the doors and windows of the wall.
    inserts: Dict[int, Point] = field(default_factory=dict)


def apply(host, job: Job, option: results.Option) -> List[str]:
    """Moves the model to an option of a job that we wrote; gives the labels of what moved."""
    _refuse_works(option)
    changes = {c.id: c for c in results.layout(job, option)}
    if not changes:
        raise PluginError("This option leaves everything as it is.")
    host.bind(job.study.document)
    walls = host.walls([int(w.id) for w in job.study.walls])
    columns = host.columns([int(c.id) for c in job.study.columns])
    present = [e for kind in reading.movables(walls, columns, []) for e in kind]
    edited = results.edited_since(job, present, list(changes.values()))
    if edited:
        raise PluginError(
            "The model was changed since the study: " + ", ".join(edited) + ". Nothing was moved; export again."
        )
    targets: Dict[int, Target] = {}
    for found in [*walls, *columns]:
        change = changes.get(str(found.element_id))
        if change is not None:
            targets[found.element_id] = _target(found, change)
    _refuse_fixed(walls, columns, targets)
    _carry_out(host, f"Enfilade: option {option.number}", walls, columns, targets)
    return [e.label for e in present if e.id in changes]


def _refuse_works(option: results.Option) -> None:
    """Walls are cut and built by hand here."""
    if not option.works:
        return
    works = "; ".join(w.said() for w in option.works)
    raise PluginError(
        f"This option cuts or builds walls ({works}). Enfilade only moves walls in Revit; nothing was changed. "
        f"Draw the works by hand, or link the new drawing file, which has them: {option.file}."
    )


def _target(found: RevitElement, change: results.Change) -> Target:
    target = Target(change.motion)
    if not isinstance(found, RevitWall):
        return target
    target.ends = list(change.axis_after) if found.axis else _moved(change.motion or STILL, found.ends)
    for insert in found.inserts:
        motion = change.openings.get(str(insert.element_id), change.motion)
        if insert.centre is not None and motion is not None:
            target.inserts[insert.element_id] = motion(insert.centre)
    return target


def _moved(motion: Rigid, points: List[Point]) -> List[Point]:
    return [motion(p) for p in points]


def _refuse_fixed(walls: List[RevitWall], columns: List[RevitColumn], targets: Dict[int, Target]) -> None:
    elements: List[RevitElement] = [*walls, *columns]
    fixed = [(e.label, e.fixed) for e in elements if e.element_id in targets]
    for wall in walls:
        places = targets[wall.element_id].inserts if wall.element_id in targets else {}
        fixed += [(i.label, i.fixed) for i in wall.inserts if _is_off(i.centre, places.get(i.element_id), NOTHING_MM)]
    said = [f"'{label}': {why}" for label, why in fixed if why]
    if said:
        raise PluginError("The option moves what cannot be moved: " + "; ".join(said) + ". Nothing was changed.")


def _is_off(here: Optional[Point], there: Optional[Point], by: float) -> bool:
    return here is not None and there is not None and distance(here, there) > by


def _carry_out(host, name: str, walls: List[RevitWall], columns: List[RevitColumn], targets: Dict[int, Target]) -> None:
    """Moves elements and reads them again; all is rolled back unless everything stands where it should.

    ``walls`` are all walls of the plan: those without a target are to stay, whatever Revit takes along.
    """
    elements: List[RevitElement] = [*walls, *columns]
    wanted = {w.element_id: targets.get(w.element_id) or _staying(w) for w in walls}
    with host.transaction_group(name):
        with host.transaction("Enfilade: walls and columns"):
            for element in elements:
                motion = targets.get(element.element_id, Target()).motion
                if motion is not None:
                    about = centroid(element.ends if isinstance(element, RevitWall) else element.ring)
                    host.move(element.element_id, motion, about)
        _put_ends_right(host, wanted)
        _put_inserts_right(host, wanted)
        _check(host, walls, wanted, columns, targets)


def _staying(wall: RevitWall) -> Target:
    inserts = {i.element_id: i.centre for i in wall.inserts if i.centre is not None}
    return Target(STILL, list(wall.ends), inserts)


def _put_ends_right(host, wanted: Dict[int, Target]) -> None:
    """Walls whose length changes get their ends; so do joined walls that Revit let follow, as the option was measured
    with every wall in its own place."""
    for _ in range(ROUNDS):
        off = [w for w in host.walls(list(wanted)) if w.axis and _are_off(w.axis, wanted[w.element_id].ends)]
        if not off:
            return
        with host.transaction("Enfilade: ends of walls"):
            for wall in off:
                host.set_wall_ends(wall.element_id, *wanted[wall.element_id].ends)


def _are_off(here: List[Point], there: List[Point]) -> bool:
    return len(here) != len(there) or any(distance(a, b) > results.FIT_MM for a, b in zip(here, there))


def _put_inserts_right(host, wanted: Dict[int, Target]) -> None:
    """Revit carries inserts along with their wall; what is missing then is shifted along it."""
    off: List[Tuple[int, Point, Point]] = []
    for wall in host.walls(list(wanted)):
        for insert in wall.inserts:
            place = wanted[wall.element_id].inserts.get(insert.element_id)
            if place is not None and insert.centre is not None and distance(insert.centre, place) > NOTHING_MM:
                off.append((insert.element_id, insert.centre, place))
    if off:
        with host.transaction("Enfilade: doors and windows"):
            for id, here, place in off:
                host.move(id, Rigid(0.0, *minus(place, here)), here)


def _check(host, walls, wanted: Dict[int, Target], columns, targets: Dict[int, Target]) -> None:
    """Everything stands where the option says, and all that is to stay stands where it stood."""
    now = {w.element_id: w for w in host.walls(list(wanted))}
    for before in walls:
        wall, target = now.get(before.element_id), wanted[before.element_id]
        if wall is None or _are_off(wall.ends, target.ends):
            raise PluginError(f"'{before.label}' does not take its new place: Revit holds it; nothing was changed.")
        here = {i.element_id: i.centre for i in wall.inserts}
        for insert in before.inserts:
            place = target.inserts.get(insert.element_id)
            if place is not None and (
                insert.element_id not in here or _is_off(here[insert.element_id], place, results.FIT_MM)
            ):
                raise PluginError(
                    f"'{insert.label}' in '{before.label}' is not where the option says; nothing was changed."
                )
    standing = {c.element_id: c for c in host.columns([c.element_id for c in columns])}
    for old in columns:
        moved, column = targets.get(old.element_id, Target(STILL)), standing.get(old.element_id)
        ring = _moved(moved.motion or STILL, old.ring)
        # Revit may begin an outline at another corner.
        if column is None or any(min(distance(p, q) for q in column.ring) > results.FIT_MM for p in ring):
            raise PluginError(f"'{old.label}' does not take its new place: Revit holds it; nothing was changed.")


def apply_drawing(host, option: results.Option) -> List[str]:
    """Moves the model to an option of a drawing that Revit itself exported.

    Every line of an element bears Revit's element id; an element moves where all of them move together.
    """
    _refuse_works(option)
    lines = _lines_of(option)
    walls, columns = host.walls(), host.columns()
    found = {e.element_id: e for e in [*walls, *columns] if not e.left_out}
    missing = [str(id) for id in lines if id not in found]
    if missing:
        raise PluginError(
            f"Not in the plan of this view: {', '.join(missing)}. Open the view that was exported; nothing was changed."
        )
    targets: Dict[int, Target] = {}
    for id, (before, after) in lines.items():
        motion, residual = fit_rigid(before, after)
        if residual > results.FIT_MM:
            raise PluginError(f"'{found[id].label}' does not keep its shape in this option; nothing was changed.")
        if not all(_is_within(found[id], p) for p in before):
            raise PluginError(
                f"'{found[id].label}' stands elsewhere in the drawing than in the model: the model was changed, or the"
                " drawing has other coordinates. Export it again; nothing was changed."
            )
        targets[id] = _moving(found[id], motion)
    standing = [w for w in walls if not w.left_out]
    _refuse_fixed(standing, columns, targets)
    _carry_out(host, f"Enfilade: option {option.number}", standing, [c for c in columns if not c.left_out], targets)
    return [found[id].label for id in targets]


def _lines_of(option: results.Option) -> Dict[int, Tuple[List[Point], List[Point]]]:
    """Points of every element before and after, mm, by Revit's id."""
    out: Dict[int, Tuple[List[Point], List[Point]]] = {}
    for change in option.changes:
        # Revit carries doors and windows along with their wall.
        if change.get("follows"):
            continue
        id = change.get("host_id") or ""
        if not id.isdigit():
            raise PluginError(f"Option {option.number} moves an element without Revit's id; nothing was changed.")
        before, after = out.setdefault(int(id), ([], []))
        before.extend((x * 1000.0, y * 1000.0) for x, y in change["from"])
        after.extend((x * 1000.0, y * 1000.0) for x, y in change["to"])
    return out


def _moving(found: RevitElement, motion: Rigid) -> Target:
    if not isinstance(found, RevitWall):
        return Target(motion)
    places = {i.element_id: motion(i.centre) for i in found.inserts if i.centre is not None}
    return Target(motion, _moved(motion, found.ends), places)


def _is_within(found: RevitElement, p: Point) -> bool:
    """Whether a point of a drawing is one of an element, to the thickness of a wall."""
    if isinstance(found, RevitWall) and found.axis:
        u, thickness = direction(*found.axis), found.left + found.right
        along, across = dot(minus(p, found.axis[0]), u), dot(minus(p, found.axis[0]), left_of(u))
        reach = distance(*found.axis) + thickness
        return -thickness <= along <= reach and -found.right - 1.0 <= across <= found.left + 1.0
    points = [q for r in found.rings for q in r] if isinstance(found, RevitWall) else found.ring
    return all(min(q[k] for q in points) - 1.0 <= p[k] <= max(q[k] for q in points) + 1.0 for k in (0, 1))
