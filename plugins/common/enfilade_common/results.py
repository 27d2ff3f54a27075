"""Reading a round: options with their numbers, and where every wall of the host stands in them."""

import json
import math
import os
import re
import shutil
from dataclasses import dataclass, field
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple

from . import drawn
from .job import RESULTS, Job
from .model import Built, Column, Drawn, Movable, Opening, PluginError, UNITS, Wall, geometry_hash
from .moves import Plan
from .option import BriefLine, Option
from .outlines import Outline
from .plane import (
    Point,
    Rigid,
    STILL,
    cross,
    direction,
    distance,
    distance_to_segment,
    dot,
    fit_rigid,
    minus,
    plus,
    turn_about,
)
from .shifted import FIT_MM, moved_outlines
from .works import Work, works_of

RESULT_SCHEMA = "enfilade.result/1"

#: The best so far of a stopped run, beside the job.
STOPPED = "stopped"

#: Columns of the table of cells, by measure.
COLUMNS = {"degree": "Degree", "mean-depth": "Visual Mean Depth", "depth": "Depth", "entropy": "Entropy"}


class Note(NamedTuple):
    """Something that the program wants known: ``info`` or worse, where, in its words."""

    severity: str
    place: str
    text: str

    @property
    def is_warning(self) -> bool:
        return self.severity != "info"


@dataclass
class Round:
    """A finished round."""

    folder: str
    number: int
    sha256: str
    initial: Dict[str, float]
    options: List[Option]
    #: Warnings first.
    notes: List[Note]
    stopped_by: str
    spacing_m: float
    lattice_centre: Point
    #: The best layout found, number 0; none where it is one of the options, or nothing is better.
    best: Optional[Option] = None
    #: Name and kind of every move, in the order of the parameters.
    moves: List[Tuple[str, str]] = field(default_factory=list)
    #: Version of the program that wrote it.
    version: str = ""
    #: Whether it is the best so far of a run that was stopped.
    is_so_far: bool = False
    #: The unit of the drawing, and how many units of the host's document are in a metre.
    unit: str = "mm"
    per_metre: float = 1000.0
    #: Units of the host in one of the drawing.
    scale: float = 1.0
    #: What the present layout has of the brief of rooms.
    brief: List[BriefLine] = field(default_factory=list)

    @property
    def report(self) -> str:
        return os.path.join(self.folder, "report.html")

    def initial_picture(self, measure: str) -> str:
        return os.path.join(self.folder, f"initial-{measure}.png")


@dataclass
class Change:
    """How one element stands in an option. ``motion`` where it moves as a whole."""

    id: str
    motion: Optional[Rigid]
    axis_before: List[Point]
    axis_after: List[Point]
    #: Motion of every opening of the wall.
    openings: Dict[str, Rigid]


def round_folders(results_folder: str) -> List[str]:
    """Folders of finished rounds, oldest first."""
    try:
        names = os.listdir(results_folder)
    except OSError:
        return []
    rounds = [(int(m.group(1)), n) for n in names for m in [re.fullmatch(r"round-(\d+)", n)] if m]
    return [os.path.join(results_folder, n) for _, n in sorted(rounds)]


def latest(job: Job) -> Round:
    """The newest results of a job, finished or stopped; refuses those of an earlier export."""
    folders = [*round_folders(job.results_folder)[-1:], os.path.join(job.folder, STOPPED)]
    there = [f for f in folders if os.path.isdir(f)]
    if not there:
        raise PluginError("There are no options yet: run the study first.")
    return _of(job, max(there, key=os.path.getmtime))


def _of(job: Job, folder: str) -> Round:
    found = read(folder, job.scale)
    if found.sha256 != job.sha256:
        raise PluginError("The options belong to an earlier export of this document; run the study again.")
    return found


def made_since(job: Job, before: List[str], version: str) -> Round:
    """The round that a run of this ``version`` has written, when ``before`` were there."""
    made = [f for f in round_folders(job.results_folder) if f not in before]
    if not made:
        raise PluginError("The program ended without writing any result.")
    found = _of(job, made[-1])
    if found.version != version:
        wrote = found.version or "a version that does not say its name"
        raise PluginError(f"Enfilade {version} was started, but the result is of {wrote}. It is not shown; run the study again.")
    return found


def keep_so_far(job: Job, folder: str) -> Round:
    """Puts the best so far of a stopped run aside, where the next run does not write over it."""
    kept = os.path.join(job.folder, STOPPED)
    try:
        shutil.rmtree(kept, ignore_errors=True)
        shutil.copytree(folder, kept)
    except (OSError, shutil.Error) as e:
        raise PluginError(f"The best so far in {folder} cannot be kept: {e}.") from e
    return _of(job, kept)


def read(folder: str, scale: float = 1.0) -> Round:
    """Reads ``result.json`` of a round; ``scale`` are the host's units in one of the drawing."""
    path = os.path.join(folder, "result.json")
    try:
        with open(path, encoding="utf-8") as f:
            data = json.load(f)
    except (OSError, ValueError) as e:
        raise PluginError(f"{path} cannot be read: {e}.") from e
    schema = data.get("schema") if isinstance(data, dict) else None
    if schema != RESULT_SCHEMA:
        raise PluginError(
            f"{path} has the schema {schema!r}, this plugin reads {RESULT_SCHEMA!r}: "
            "plugin and program are of different versions."
        )
    try:
        return _round(folder, data, scale)
    except (KeyError, TypeError, IndexError, ValueError) as e:
        raise PluginError(f"{path} is not complete ({type(e).__name__}: {e}).") from e


def _round(folder: str, data: Dict[str, Any], scale: float) -> Round:
    unit = str(data["input"].get("unit", "mm"))
    per_metre = scale / UNITS[unit]
    options = [_option(folder, i + 1, c, per_metre) for i, c in enumerate(data["candidates"])]
    best = data.get("best")
    centre = data["lattice_centre"]
    notes = [Note(p["severity"], p["place"], p["text"]) for p in data["problems"]]
    notes += [Note("warning", "", q["text"]) for q in data.get("questions") or []]
    numbers = re.findall(r"\d+", os.path.basename(os.path.normpath(folder)))
    return Round(
        folder=folder,
        number=int(numbers[-1]) if numbers else 1 + len(round_folders(os.path.join(os.path.dirname(folder), RESULTS))),
        sha256=data["input"]["sha256"],
        initial=dict(data["initial"]["mean"]),
        options=options,
        best=_option(folder, 0, best, per_metre) if best and best.get("file") and best.get("option") is None else None,
        notes=sorted(notes, key=lambda n: not n.is_warning),
        stopped_by=data["stopped_by"],
        spacing_m=float(data["spacing_m"]),
        lattice_centre=(float(centre[0]), float(centre[1])),
        moves=[(m["name"], m["kind"]) for m in data.get("moves", [])],
        version=str(data.get("version", "")),
        is_so_far=not numbers,
        unit=unit,
        per_metre=per_metre,
        scale=scale,
        brief=_brief(data),
    )


def _brief(data: Dict[str, Any]) -> List[BriefLine]:
    def line(item: Dict[str, Any]) -> BriefLine:
        verdict = str(item["verdict"])
        places = [str(f["words"]) for f in item.get("findings") or [] if f["verdict"] != "pass"]
        return BriefLine(verdict, str(item["ask"]), places if verdict != "pass" else [])

    return [line(item) for item in data.get("brief") or []]


def _option(folder: str, number: int, data: Dict[str, Any], per_metre: float) -> Option:
    name = os.path.basename(data["file"])
    return Option(
        number=number,
        file=os.path.join(folder, name),
        words=data["words"],
        mean=dict(data["mean"]),
        penalty=dict(data["penalty"]),
        score=data["score"],
        within_threshold=bool(data.get("within_threshold", True)),
        parameters=[float(p) for p in data["parameters"]],
        changes=list(data["changes"]),
        per_metre=per_metre,
        gain=dict(data.get("gain", {})),
        works=works_of(data.get("works"), per_metre),
        brief=_brief(data),
    )


def layout(job: Job, option: Option) -> List[Change]:
    """Where every changed element of the host stands in an option, in drawing order."""
    after = {id: to for id, _, to in moved_outlines(job, option)}
    within = FIT_MM * option.per_metre / 1000.0
    by_owner: Dict[str, List[Outline]] = {}
    for outline in job.outlines:
        by_owner.setdefault(outline.owner, []).append(outline)
    out = []
    for element in job.study.movables():
        mine = by_owner.get(element.id, [])
        if any(o.host_id in after for o in mine):
            rings = [after.get(o.host_id, o.points) for o in mine]
            if isinstance(element, Drawn):
                out.append(_drawn_change(element, rings, within))
            else:
                out.append(change_of(element, mine, rings))
    return out


def worked(job: Job, work: Work) -> List[str]:
    """Ids of the elements of the host that draw the wall of a work, as far as the result names them."""
    owners = job.owners()
    named = [owners.get(str(e.get("handle")), "") for e in work.elements]
    return list(dict.fromkeys(id for id in named if job.study.element(id) is not None))


def standing(job: Job, option: Option) -> List[Change]:
    """The elements that the works of an option change where they stand, as changes without a way."""
    ids = dict.fromkeys(id for work in option.works for id in worked(job, work))
    return [Change(id, STILL, [], [], {}) for id in ids]


def _drawn_change(element: Drawn, after: List[List[Point]], within: float) -> Change:
    if not drawn.keeps_shape(element, after, within):
        raise PluginError(f"'{element.label}' does not keep its shape in this option; nothing was taken over.")
    before, to = element.points(), [p for points in after for p in points]
    motion, residual = fit_rigid(before, to)
    return Change(element.id, motion if residual <= within / 2 else None, before, to, {})


def change_of(element: Built, outlines: List[Outline], after: List[List[Point]]) -> Change:
    """Takes moved outlines back to a motion of the element or of its axis."""
    before_all = [p for o in outlines for p in o.points]
    after_all = [p for ring in after for p in ring]
    motion, residual = fit_rigid(before_all, after_all)
    axis = [] if isinstance(element, Column) else list(element.axis)
    if residual <= FIT_MM / 2:
        openings = [] if isinstance(element, Column) else element.openings
        return Change(element.id, motion, axis, [motion(p) for p in axis], {o.id: motion for o in openings})
    if isinstance(element, Column) or element.rings:
        raise PluginError(f"'{element.label}' does not keep its shape in this option; nothing was taken over.")
    return _axis_change(element, outlines, after)


def _axis_change(wall: Wall, outlines: List[Outline], after: List[List[Point]]) -> Change:
    moved = list(wall.axis)
    jambs: Dict[Tuple[str, int], Point] = {}
    for outline, ring in zip(outlines, after):
        for end in (0, 1):
            assert outline.stations is not None, "a wall with an axis is made of quads"
            station = outline.stations[end]
            shift = _axis_shift(wall, outline, ring, end)
            if station.kind == "corner":
                moved[station.index] = plus(wall.axis[station.index], shift)
            else:
                opening = next(o for o in wall.openings if o.id == station.opening)
                along = opening.start if station.index == 0 else opening.end
                jambs[(opening.id, station.index)] = plus(wall.at(along), shift)
        _check_faces(wall, outline, ring)
    body, residual = fit_rigid(wall.axis, moved)
    still = body if residual <= FIT_MM / 2 else STILL
    openings = {o.id: _opening_motion(wall, o, jambs, moved, still) for o in wall.openings}
    motion = body if residual <= FIT_MM / 2 else None
    return Change(wall.id, motion, list(wall.axis), moved, openings)


def _axis_shift(wall: Wall, outline: Outline, ring: List[Point], end: int) -> Point:
    """Shift of the axis point between a station's two corners."""
    left, right = outline.corners_at(end)
    of_left, of_right = (minus(ring[c], outline.points[c]) for c in (left, right))
    share = wall.left / wall.thickness if wall.thickness else 0.0
    return plus(of_left, minus(of_right, of_left), share)


def _check_faces(wall: Wall, outline: Outline, ring: List[Point]) -> None:
    """A wall must stay a wall: its two faces parallel at the old distance."""
    if not outline.is_closed:
        return
    u = direction(ring[0], ring[1])
    thickness = [cross(u, minus(ring[0], ring[c])) * -1.0 for c in (2, 3)]
    if any(abs(abs(t) - wall.thickness) > FIT_MM for t in thickness):
        bent = f"'{wall.label}' would be bent or change its thickness in this option"
        raise PluginError(bent + "; nothing was taken over.")
    for end in (0, 1):
        left, right = outline.corners_at(end)
        before = dot(minus(outline.points[left], outline.points[right]), direction(*outline.points[:2]))
        if abs(dot(minus(ring[left], ring[right]), u) - before) > FIT_MM:
            askew = f"An end of '{wall.label}' would be cut askew in this option"
            raise PluginError(askew + "; nothing was taken over.")


def _opening_motion(
    wall: Wall, opening: Opening, jambs: Dict[Tuple[str, int], Point], moved: List[Point], body: Rigid
) -> Rigid:
    known = [(side, jambs[(opening.id, side)]) for side in (0, 1) if (opening.id, side) in jambs]
    if not known:
        return body
    begin, end = wall.at(opening.start), wall.at(opening.end)
    segment = _segment_at(wall, (opening.start + opening.end) / 2)
    last = (segment + 1) % len(wall.axis)
    old, new = direction(wall.axis[segment], wall.axis[last]), direction(moved[segment], moved[last])
    turn = math.atan2(cross(old, new), dot(old, new))
    motions = [turn_about((begin, end)[side], turn, minus(at, (begin, end)[side])) for side, at in known]
    if len(motions) == 2 and distance(motions[0](end), motions[1](end)) > FIT_MM:
        raise PluginError(f"'{opening.label}' would change its width in this option; nothing was taken over.")
    return motions[0]


def motion_along(change: Change, is_closed: bool, at: Point) -> Tuple[Rigid, float, float]:
    """Motion of a thing in a wall near ``at``: with the wall where it moves as a whole; where it is stretched
    turned with the nearest piece of its axis, in its place along it. With it where ``at`` then lies along that
    piece, and how long the piece is, mm."""
    before, after = (p + p[:1] if is_closed else p for p in (change.axis_before, change.axis_after))
    pieces = [i for i in range(len(before) - 1) if distance(before[i], before[i + 1]) > 0]
    if not pieces:
        assert change.motion is not None, "a wall without an axis only moves as a whole"
        return change.motion, 0.0, 0.0
    i = min(pieces, key=lambda k: distance_to_segment(at, before[k], before[k + 1]))
    (a, b), (c, d) = before[i : i + 2], after[i : i + 2]
    length = distance(c, d)
    if length == 0.0:
        raise PluginError("A wall would vanish in this option; nothing was taken over.")
    motion = change.motion
    if motion is None:
        old, new = direction(a, b), direction(c, d)
        turn = math.atan2(cross(old, new), dot(old, new))
        ends = [turn_about(p, turn, minus(q, p)) for p, q in ((a, c), (b, d))]
        motion = min(ends, key=lambda m: distance(m(at), at))
    return motion, dot(minus(motion(at), c), direction(c, d)), length


def _segment_at(wall: Wall, along: float) -> int:
    points = wall.corners()
    for i, (a, b) in enumerate(zip(points, points[1:])):
        if along <= distance(a, b):
            return i
        along -= distance(a, b)
    return len(points) - 2


def edited_since(job: Job, present: Sequence[Movable], changes: List[Change]) -> List[str]:
    """What happened since the export to the elements of ``changes`` that no longer stand as exported: ``'P' was
    edited``, ``'Q' was deleted``."""
    now = {e.id: e for e in present}
    out = []
    for change in changes:
        element, exported = now.get(change.id), job.study.element(change.id)
        if element is None:
            out.append(f"'{exported.label if exported else change.id}' was deleted")
        elif geometry_hash(element) != job.hashes.get(change.id):
            out.append(f"{_named(element, exported)} was edited")
    return list(dict.fromkeys(out))


def _named(element: Movable, exported: Optional[Movable]) -> str:
    """An element by its label, with that of the export where it has another by now."""
    if exported is None or exported.label == element.label:
        return f"'{element.label}'"
    return f"'{element.label}' (then '{exported.label}')"


def changed_around(job: Job, present: Sequence[Movable], changes: List[Change]) -> List[str]:
    """What happened since the export to the rest of the plan, and to the heights of what moves."""
    now, moved = {e.id: e for e in present}, {c.id for c in changes}
    out = []
    for exported in job.study.movables():
        element = now.pop(exported.id, None)
        if element is None:
            out.append(f"'{exported.label}' was deleted")
        elif exported.id not in moved and geometry_hash(element) != job.hashes.get(exported.id):
            out.append(f"{_named(element, exported)} was edited")
        elif abs(getattr(element, "height", 0.0) - getattr(exported, "height", 0.0)) > FIT_MM:
            out.append(f"{_named(element, exported)} has another height")
    out += [f"'{element.label}' was added" for element in now.values()]
    return list(dict.fromkeys(out))


def lineage_entry(found: Round, option: Option, drawing: str) -> Dict[str, Any]:
    """The ``[[lineage]]`` table that says which option a next round started from."""

    def finite(means: Dict[str, Any]) -> Dict[str, float]:
        return {k: float(v) for k, v in means.items() if v is not None}

    return {
        "drawing": drawing,
        "round": found.number,
        **({"so-far": True} if found.is_so_far else {}),
        "candidate": option.number,
        "initial": finite(found.initial),
        "accepted": finite(option.mean),
    }


def gone(plan: Plan, found: Round, option: Option) -> Dict[str, Dict[str, float]]:
    """How far an option takes what was marked, by id and kind of move, mm or degrees."""
    out: Dict[str, Dict[str, float]] = {}
    tables = list(plan.tables)
    for move, value in zip(found.moves, option.parameters):
        # The program leaves out moves that would do nothing, and may know others that an option does not use.
        at = next((i for i, t in enumerate(tables) if (t.name, t.clause.kind) == move), None)
        if at is None and value == 0.0:
            continue
        if at is None:
            raise PluginError(f"The option has a move of {move[0]!r} that this study never wrote; nothing was taken over.")
        for id in tables[at].members:
            out.setdefault(id, {})[move[1]] = value
        del tables[: at + 1]
    return out
