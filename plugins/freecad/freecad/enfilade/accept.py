"""Accepting an option: the document's own walls, columns, doors and windows move, in one undo step."""

from contextlib import contextmanager
from math import hypot
from typing import Dict, List

import FreeCAD as App

from enfilade_common import results
from enfilade_common.job import Job
from enfilade_common.model import Column, Drawn, PluginError, Wall, geometry_hash
from enfilade_common.moves import plan_of
from enfilade_common.plane import STILL, Rigid, distance
from enfilade_common.results import Change

from . import document, hosted, marks, plan2d, works
from .document import Found, Reading, Vector
from .hosted import Going, placement

#: Accepted walls stand where the option says to this, mm.
STAND_MM = 0.1
#: Middles of outlines that are cut anew, curves as chords, lie together to this, mm.
RING_MM = 1.0
#: Sentences about what changed name so many.
NAMED_MAX = 3

NO_UNDO = (
    "Undo is switched off, so accepting could not be taken back. Switch it on in Edit > Preferences > General > "
    "Document ('Using Undo/Redo on documents'), or type App.ActiveDocument.UndoMode = 1 into the Python console. "
    "Nothing was moved."
)


def accept(doc, job: Job, found: results.Round, option: results.Option, on_moved=None) -> List[str]:
    """Moves the document to an option and makes its building works; gives the labels of what moved or changed.

    ``on_moved`` is called inside the transaction, before it is closed. Nothing is changed where anything
    does not fit: an element edited or deleted meanwhile, a base that cannot take the new place.
    """
    if doc.HasPendingTransaction:
        raise PluginError("Another command is still open in this document; finish it first.")
    if not doc.UndoMode:
        raise PluginError(NO_UNDO)
    changes = results.layout(job, option)
    if not changes and not option.works:
        raise PluginError("This option leaves everything as it is.")
    reading = _read(doc, job)
    _refuse_edited(doc, job, reading, [*changes, *results.standing(job, option)])
    locked = [f"'{f.element.label}': {f.element.locked}" for f in _found(reading, changes) if f.element.locked]
    if locked:
        raise PluginError("The option moves what cannot be moved: " + "; ".join(locked) + ". Nothing was changed.")
    if not changes:
        # What cannot be made is refused before anything is touched; behind moves it can only be tried.
        works.plan(reading, job, option)
    gone = results.gone(job.plan or plan_of(job.study), found, option)
    labels = [f.element.label for f in _found(reading, changes)]
    with _one_step(doc, f"Enfilade: option {option.number}"):
        _move_all(doc, job, option, reading, changes)
        _take(reading, gone)
        if option.works:
            labels += works.make(doc, lambda: _read(doc, job), job, option)
        if on_moved is not None:
            on_moved()
    return labels


def _move_all(doc, job: Job, option: results.Option, reading: Reading, changes: List[Change]) -> None:
    """Moves what an option moves; inside a transaction."""
    if not changes:
        return
    before = {e.id: geometry_hash(e) for e in reading.elements()}
    going, bodies = _going(reading, changes), _bodies(reading, changes)
    _move(doc, reading, changes)
    hosted.move(going)
    doc.recompute()
    hosted.settle(doc, going)
    _check(doc, job, before, changes, STAND_MM * min(1.0, option.per_metre / 1000.0))
    _check_bodies(bodies)


@contextmanager
def _one_step(doc, name: str):
    """One undo step of this document, or nothing. FreeCAD writes every step into the active document too, so
    that must be this one."""
    active = App.ActiveDocument
    App.setActiveDocument(doc.Name)
    doc.openTransaction(name)
    try:
        yield
    except Exception as e:
        doc.abortTransaction()
        doc.recompute()
        if isinstance(e, PluginError):
            raise
        raise PluginError(f"FreeCAD could not change the walls ({e}); nothing was changed.") from e
    else:
        doc.commitTransaction()
    finally:
        if active is not None:
            App.setActiveDocument(active.Name)


def _take(reading: Reading, gone: Dict[str, Dict[str, float]]) -> None:
    """Takes the way off what remains of the bounds; a wall of several pieces goes it once."""
    by_object: Dict[str, tuple] = {}
    for id, by in gone.items():
        found = reading.found.get(id)
        obj = found.object if found else reading.openings.get(id)
        if obj is not None:
            by_object[obj.Name] = (obj, by)
    for obj, by in by_object.values():
        marks.take(obj, by)


def _found(reading: Reading, changes: List[Change]) -> List[Found]:
    return [reading.found[c.id] for c in changes]


def _read(doc, job: Job) -> Reading:
    return document.read(doc, job.study.storey, job.study.wishes.level)


def changed_around(doc, job: Job, option: results.Option) -> str:
    """What else changed in the plan since the study, in one sentence; nothing where nothing did."""
    changes = [*results.layout(job, option), *results.standing(job, option)]
    changed = results.changed_around(job, _read(doc, job).elements(), changes)
    if not changed:
        return ""
    more = f", and {len(changed) - NAMED_MAX} more" if len(changed) > NAMED_MAX else ""
    named = ", ".join(changed[:NAMED_MAX]) + more
    return f"The plan has changed since the study ({named}): the numbers were measured on the old one."


def _refuse_edited(doc, job: Job, reading: Reading, changes: List[Change]) -> None:
    edited = results.edited_since(job, reading.elements(), changes)
    if not edited:
        return
    gone = [job.study.element(c.id) for c in changes if c.id not in reading.found]
    for element in gone:
        if element is not None and doc.getObject(element.name) is not None:
            words = f"'{element.label}' is no longer among the walls of this storey's plan"
            edited = [words if e == f"'{element.label}' was deleted" else e for e in edited]
    words = f"The document '{doc.Label}' was changed since the study: " + ", ".join(edited)
    raise PluginError(words + ". Nothing was moved; run the study again.")


def _going(reading: Reading, changes: List[Change]) -> List[Going]:
    """Doors, windows and whatever else goes with the walls that move, each by its wall's motion."""
    out = []
    for change in changes:
        for id, motion in change.openings.items():
            door = reading.openings.get(id)
            if door is not None:
                out.append(Going(door, motion, hosted.corners(door)))
        for obj in reading.hosted.get(change.id, ()):
            out.append(_going_along(reading.found[change.id].element, change, obj))
    return out


def _going_along(wall, change: Change, obj) -> Going:
    before = hosted.corners(obj)
    xs, ys = [p.x for p in before], [p.y for p in before]
    middle = ((min(xs) + max(xs)) / 2, (min(ys) + max(ys)) / 2)
    is_closed = getattr(wall, "closed", False)
    motion, _, _ = results.motion_along(change, is_closed, middle)
    if change.motion is None:
        _refuse_left_behind(wall, change, obj, middle)
    return Going(obj, motion, before)


def _refuse_left_behind(wall, change: Change, obj, middle) -> None:
    """Where a wall is shortened past what stands in it, nothing would be left to stand in."""
    _, along, length = results.motion_along(change, wall.closed, middle)
    before = Change(change.id, STILL, change.axis_before, change.axis_before, {})
    _, along_before, length_before = results.motion_along(before, wall.closed, middle)
    half = max(hypot(p.x - middle[0], p.y - middle[1]) for p in hosted.corners(obj))
    was_in = half <= along_before <= length_before - half
    if was_in and not half - hosted.STAND_MM <= along <= length - half + hosted.STAND_MM:
        words = f"'{obj.Label}' would no longer stand in '{wall.label}' in this option"
        raise PluginError(words + "; nothing was changed.")


def _move(doc, reading: Reading, changes: List[Change]) -> None:
    done = set()
    by_object: Dict[str, List[Change]] = {}
    for change in changes:
        by_object.setdefault(reading.found[change.id].object.Name, []).append(change)
    for name, mine in by_object.items():
        obj = doc.getObject(name)
        element = reading.found[mine[0].id].element
        if isinstance(element, Drawn):
            plan2d.move(obj, element, mine[0])
            continue
        base = getattr(obj, "Base", None)
        mover = base if base is not None else obj
        if mover.Name not in done:
            _move_base(obj, mover, mine, reading)
            done.add(mover.Name)


def _move_base(obj, mover, changes: List[Change], reading: Reading) -> None:
    """Moves what decides where an object stands. Draft lines take their points, never a placement: their
    undo would come back wrong."""
    chains = [f for f in reading.found.values() if f.object.Name == obj.Name]
    motion = changes[0].motion if len(changes) == len(chains) else None
    if motion is not None and any(not _same(motion, c.motion) for c in changes):
        motion = None
    if document.is_attached(mover):
        motion = None
    if document.is_draft_wire(mover) and changes[0].axis_after:
        _move_wire(mover, changes[0], motion)
    elif motion is not None:
        mover.Placement = placement(motion).multiply(mover.Placement)
    elif mover.isDerivedFrom("Sketcher::SketchObject"):
        for change in changes:
            _move_sketch(mover, reading.found[change.id], change)
    elif mover.TypeId == "Part::Line":
        a, b = (mover.Placement.inverse().multVec(_at(p, mover)) for p in changes[0].axis_after)
        mover.X1, mover.Y1, mover.X2, mover.Y2 = a.x, a.y, b.x, b.y
    elif mover is obj and changes[0].axis_after:
        _stretch_bare(obj, changes[0])
    else:
        raise PluginError(f"'{obj.Label}' can only move as a whole; nothing was changed.")


def _same(a: Rigid, b) -> bool:
    if b is None or abs(a.angle_rad - b.angle_rad) > 1e-7:
        return False
    return all(distance(a(p), b(p)) < STAND_MM / 10 for p in ((0.0, 0.0), (1e4, 1e4)))


def _at(point, obj) -> Vector:
    return Vector(point[0], point[1], obj.Placement.Base.z)


def _move_wire(wire, change: Change, motion) -> None:
    place, back = wire.Placement, wire.Placement.inverse()
    if motion is not None:
        whole = placement(motion)
        wire.Points = [back.multVec(whole.multVec(place.multVec(p))) for p in wire.Points]
        return
    points = []
    for p in wire.Points:
        world = place.multVec(p)
        i = min(range(len(change.axis_before)), key=lambda k: distance(change.axis_before[k], (world.x, world.y)))
        x, y = change.axis_after[i]
        points.append(back.multVec(Vector(x, y, world.z)))
    wire.Points = points


def _move_sketch(sketch, found: Found, change: Change) -> None:
    back = sketch.Placement.inverse()
    count = len(change.axis_after)
    for i, segment in enumerate(found.segments):
        ends = (change.axis_after[i], change.axis_after[(i + 1) % count])
        for point, position in zip(ends, (2, 1) if segment.is_reversed else (1, 2)):
            world = sketch.Placement.multVec(sketch.getPoint(segment.geometry, position))
            if distance((world.x, world.y), point) > 1e-6:
                target = back.multVec(Vector(point[0], point[1], world.z))
                try:
                    sketch.movePoint(segment.geometry, position, target, 0)
                except Exception as e:
                    held = f"The constraints of the sketch '{sketch.Label}' hold the wall where it is"
                    raise PluginError(f"{held} ({e}); nothing was changed.") from e


def _stretch_bare(wall, change: Change) -> None:
    """A wall without base: its length and its middle."""
    (ax, ay), (bx, by) = change.axis_after
    wall.Length = distance((ax, ay), (bx, by))
    place = wall.Placement
    wall.Placement = App.Placement(Vector((ax + bx) / 2, (ay + by) / 2, place.Base.z), place.Rotation)


def _check(doc, job: Job, before: Dict[str, str], changes: List[Change], within: float) -> None:
    """Everything stands where the option says, and nothing else moved; else the transaction is given up."""
    now = {e.id: e for e in _read(doc, job).elements()}
    moved = {c.id: c for c in changes}
    for id, hash in before.items():
        element = now.get(id)
        if element is None:
            lost = job.study.element(id)
            raise PluginError(f"'{lost.label if lost else id}' was lost while moving; nothing was changed.")
        if id not in moved:
            if geometry_hash(element) != hash:
                raise PluginError(f"'{element.label}' would move along without being asked; nothing was changed.")
            continue
        if not _stands(element, job.study.element(id), moved[id], within):
            held = f"'{element.label}' does not take its new place: something holds it"
            raise PluginError(held + "; nothing was changed.")


def _bodies(reading: Reading, changes: List[Change]) -> List[Going]:
    """Walls without an axis, by the corners of their solids; those that others are joined to are left to their
    outlines."""
    mine = ((reading.found[c.id], c) for c in changes)
    whole = [(f.object, c) for f, c in mine if getattr(f.element, "rings", None)]
    return [Going(o, c.motion, hosted.corners(o)) for o, c in whole if c.motion and not getattr(o, "Additions", None)]


def _check_bodies(bodies: List[Going]) -> None:
    for body in bodies:
        now = hosted.corners(body.object)
        near = len(now) == len(body.before) and all(
            min((p - q).Length for q in now) <= STAND_MM for p in body.targets()
        )
        if not near:
            held = f"'{body.object.Label}' does not take its new place: something holds it, or an opening in it"
            raise PluginError(held + "; nothing was changed.")


def _stands(element, exported, change: Change, within: float) -> bool:
    def near(points, targets) -> bool:
        return len(points) == len(targets) and all(distance(p, q) <= within for p, q in zip(points, targets))

    if isinstance(element, Drawn):
        return near(element.points(), change.axis_after)
    if isinstance(element, Column):
        return near(element.ring, [change.motion(p) for p in exported.ring])
    if element.rings:
        return _covers(element.rings, exported.rings, change.motion)
    return near(element.axis, change.axis_after) and _openings_stand(element, exported, change)


def _covers(rings, exported, motion: Rigid) -> bool:
    """Rings of curves are cut anew each time, in any order: their middles and sizes tell."""
    left = [document.middle_and_area(r) for r in rings]
    for ring in exported:
        middle, area = document.middle_and_area([motion(p) for p in ring])
        match = (k for k in left if distance(k[0], middle) <= RING_MM and abs(k[1] - area) <= 0.001 * area)
        found = next(match, None)
        if found is None:
            return False
        left.remove(found)
    return not left


def _openings_stand(element: Wall, exported: Wall, change: Change) -> bool:
    now = {o.id: o for o in element.openings}
    for o in exported.openings:
        there, motion = now.get(o.id), change.openings.get(o.id)
        if there is None or motion is None:
            return False
        for along, target in ((there.start, o.start), (there.end, o.end)):
            if distance(element.at(along), motion(exported.at(target))) > STAND_MM:
                return False
    return True
