"""Building works of an option in the document: found possible before anything changes, made, and looked at again."""

from typing import Dict, List, Set

from enfilade_common import results
from enfilade_common.job import Job
from enfilade_common.model import Drawn, PluginError, Wall, geometry_hash
from enfilade_common.plane import Point, direction, distance, left_of, plus

from . import arch_works, document, line_works, solids
from .arch_works import WORK_MM
from .document import Reading


def plan(reading: Reading, job: Job, option: results.Option):
    """What the works of an option do to the objects of a document; refuses the whole where one cannot be made."""
    is_drawn = any(isinstance(f.element, Drawn) for f in reading.found.values())
    made = line_works.Plan(reading, option.per_metre) if is_drawn else arch_works.Plan(reading)
    for work in option.works:
        made.add(work, results.worked(job, work))
    made.close()
    return made


def make(doc, read, job: Job, option: results.Option) -> List[str]:
    """Makes the works of an option in its document; gives the labels of the walls that they change. Inside a
    transaction: where anything stands elsewhere than the option says, the error says so."""
    before = read()
    planned = plan(before, job, option)
    hashes = {e.id: geometry_hash(e) for e in before.elements()}
    labels = planned.labels()
    wanted = Wanted(planned) if isinstance(planned, arch_works.Plan) else None
    touched = set(planned.touched())
    planned.make(doc)
    now = read()
    _check_rest(now, before, hashes, touched)
    if wanted is not None:
        wanted.check(now)
    else:
        planned.check(now)
    return labels


def _check_rest(now: Reading, before: Reading, hashes: Dict[str, str], touched: Set[str]) -> None:
    """Nothing else has changed."""
    there = {e.id: e for e in now.elements()}
    for id, hash in hashes.items():
        if id in touched:
            continue
        label = before.found[id].element.label
        if id not in there:
            raise PluginError(f"'{label}' was lost while the works were made; nothing was changed.")
        if geometry_hash(there[id]) != hash:
            raise PluginError(f"'{label}' would change along without being asked; nothing was changed.")


class Wanted:
    """Where everything is to stand once works in Arch walls are made."""

    def __init__(self, planned: arch_works.Plan):
        self.planned = planned
        # Before anything changes: the walls and doors of the reading are those of then.
        self.holes = [(p, tuple(p.wall.at(s) for s in p.span)) for p in planned.pierced if not p.is_in_solid]
        self.solid = [(p, self._beside(p.found, p.wall)) for p in planned.pierced if p.is_in_solid]
        self.slid = [
            (planned.reading.openings[s.opening.id].Name, s.opening.label, tuple(s.found.element.at(a) for a in s.span))
            for s in planned.slid
        ]
        self.shut = self._shut()
        self.parts = [(t, [tuple(t.found.element.at(s) for s in part) for part in t.stays]) for t in planned.trimmed.values()]

    def _shut(self):
        """Middles of the openings that are walled up."""
        out = []
        for found in self.planned.reading.found.values():
            wall = found.element
            for o in getattr(wall, "openings", []):
                name = self.planned.reading.openings[o.id].Name
                middle = (o.start + o.end) / 2
                is_open = any(p.found is found and p.span[0] <= middle <= p.span[1] for p in self.planned.pierced)
                trim = self.planned.trimmed.get(wall.id)
                if name in self.planned.removed and trim is None and not is_open:
                    out.append((found, o.label, middle))
        return out

    def check(self, now: Reading) -> None:
        for pierce, ends in self.holes:
            self._check_hole(now, pierce.made.Name, pierce.found.element.label, ends)
            self._check_solid(pierce.found, sum(pierce.span) / 2, False)
        for pierce, there in self.solid:
            self._check_beside(pierce, there)
        for found, wall in self.planned.shut:
            _check_body(found, wall.at(wall.length() / 2), True)
        for found in self.planned.lost:
            if found.element.id in now.found:
                raise PluginError(f"'{found.element.label}' still stands where the option removes it; nothing was changed.")
        for name, label, ends in self.slid:
            self._check_hole(now, name, label, ends)
        for found, label, middle in self.shut:
            self._check_solid(found, middle, True)
        for trim, parts in self.parts:
            self._check_parts(now, trim, parts)
        for build in self.planned.built:
            _check_axis(now, build.made.Name, build.wall.ends, "The new wall")

    def _check_hole(self, now: Reading, name: str, label: str, ends) -> None:
        for wall in (e for e in now.elements() if isinstance(e, Wall)):
            for o in wall.openings:
                there = [wall.at(s) for s in (o.start, o.end)]
                if o.name == name and _same(there, ends):
                    return
        raise PluginError(f"The opening in '{label}' does not stand where the option says; nothing was changed.")

    def _check_solid(self, found, along: float, is_solid: bool) -> None:
        """Whether the wall's very body is open, or closed, in its middle."""
        wall = found.element
        if wall.id in self.planned.trimmed:
            return
        u = direction(*_piece_at(wall, along))
        _check_body(found, plus(wall.at(along), left_of(u), (wall.left - wall.right) / 2), is_solid)

    def _beside(self, found, wall: Wall):
        """What is solid on both sides of the jambs to come."""
        return [(p, is_within, solids.is_solid(found.object, p, _eye(found))) for p, is_within in solids.beside(wall)]

    def _check_beside(self, pierce, there) -> None:
        for p, is_within, was_solid in there:
            if solids.is_solid(pierce.found.object, p, _eye(pierce.found)) != (was_solid and not is_within):
                label = pierce.found.element.label
                raise PluginError(f"The opening in '{label}' does not stand where the option says; nothing was changed.")

    def _check_parts(self, now: Reading, trim, parts) -> None:
        label = trim.found.element.label
        if not parts:
            if trim.found.element.id in now.found:
                raise PluginError(f"'{label}' still stands where the option removes it; nothing was changed.")
            return
        ends = [_ends(e) for e in now.elements() if isinstance(e, Wall) and e.name in trim.made and not e.rings]
        for part in _joined(parts, trim.found.element):
            if not any(_same(end, part) or _same(end[::-1], part) for end in ends):
                raise PluginError(f"'{label}' does not end where the option says; nothing was changed.")


def _eye(found) -> float:
    """Height at which a wall is cut for the plan."""
    return document.shape_of(found.object).BoundBox.ZMin + min(document.EYE_MM, found.element.height / 2)


def _check_body(found, at: Point, is_solid: bool) -> None:
    """Whether the very body of a wall is closed, or open, at a place."""
    if solids.is_solid(found.object, at, _eye(found)) != is_solid:
        said = "stays open" if is_solid else "stays closed"
        raise PluginError(f"'{found.element.label}' {said} where the option changes it; nothing was changed.")


def _piece_at(wall: Wall, along: float):
    points = wall.corners()
    for a, b in zip(points, points[1:]):
        if along <= distance(a, b):
            return a, b
        along -= distance(a, b)
    return points[-2], points[-1]


def _ends(wall: Wall) -> List[Point]:
    return [wall.axis[0], wall.axis[-1]]


def _joined(parts, wall: Wall):
    """Of a closed wall the last part goes on in the first."""
    if wall.closed and len(parts) > 1 and distance(parts[-1][1], parts[0][0]) < WORK_MM:
        return [(parts[-1][0], parts[0][1]), *parts[1:-1]]
    return parts


def _same(there, ends) -> bool:
    return all(distance(p, q) <= WORK_MM for p, q in zip(there, ends))


def _check_axis(now: Reading, name: str, ends, label: str) -> None:
    axes = [e.axis for e in now.elements() if isinstance(e, Wall) and e.name == name]
    if not any(_same(axis, ends) for axis in axes):
        raise PluginError(f"{label} does not stand where the option says; nothing was changed.")
