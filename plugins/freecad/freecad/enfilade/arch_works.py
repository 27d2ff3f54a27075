"""Building works in Arch walls: what must be done to which object, found before anything changes, and then done."""

from dataclasses import dataclass, field
from typing import Any, Dict, List, Optional, Tuple

from enfilade_common.model import Column, Opening, PluginError, Wall
from enfilade_common.plane import Point, Rigid, direction, distance, dot, is_inside, left_of, minus, plus
from enfilade_common.works import NewWall, Work, axis_of, staying

from . import document, hosted, openings, solids, walls
from .document import Found, Reading

#: What was made stands where the work says to this, mm.
WORK_MM = 1.0
#: An opening is the one that a work names where its jambs lie so near, mm.
SAME_JAMB_MM = 20.0

FILE_HAS_IT = "Nothing was changed. Draw it by hand, or take the new drawing file of the round"

Span = Tuple[float, float]


@dataclass
class Pierce:
    """A new opening in a wall, from where to where along it."""

    found: Found
    #: The wall; of one without an axis the stretch that is opened.
    wall: Wall
    span: Span
    filling: str
    #: The door or opening that it takes the place of.
    like: Any = None
    made: Any = None

    @property
    def is_in_solid(self) -> bool:
        return self.wall is not self.found.element


@dataclass
class Slide:
    """A door or an opening goes along its wall to another place."""

    found: Found
    opening: Opening
    span: Span


@dataclass
class Trim:
    """Parts of a wall go; what stays, by where it begins and ends along it."""

    found: Found
    cuts: List[Span] = field(default_factory=list)
    stays: List[Span] = field(default_factory=list)
    #: Name of the object of each part that stays.
    made: List[str] = field(default_factory=list)


@dataclass
class Build:
    """A new wall, like another one."""

    wall: NewWall
    like: Found
    made: Any = None


class Plan:
    """What the works of an option do to the walls of a document."""

    def __init__(self, reading: Reading):
        self.reading = reading
        self.pierced: List[Pierce] = []
        self.slid: List[Slide] = []
        self.trimmed: Dict[str, Trim] = {}
        self.built: List[Build] = []
        #: Doors, windows and whatever else stands in what goes, by name.
        self.removed: Dict[str, Any] = {}
        #: Openings of walls without an axis that are walled up.
        self.shut: List[Tuple[Found, Wall]] = []
        #: Walls without an axis that go.
        self.lost: List[Found] = []

    def add(self, work: Work, ids: List[str]) -> None:
        """Adds a work; refuses what cannot be made here."""
        site = Site(self.reading, work, ids)
        if work.kind == "add":
            self._build(site)
        elif work.kind in ("end", "remove"):
            self._cut(site)
            self._build(site)
        elif work.kind in ("close", "widen", "rehang"):
            self._change_opening(site)
        elif work.kind in ("open", "door", "glaze"):
            self._pierce(site, None)
        else:
            raise PluginError(f"{_said(work)}: this plugin does not know such a work; update it. Nothing was changed.")

    def close(self) -> None:
        """Puts together what several works do to one wall."""
        for trim in self.trimmed.values():
            walls.refuse_uncut(trim.found, trim.stays)
            self._take_with(trim)

    def _pierce(self, site: "Site", like) -> None:
        solid = site.solid(*site.work.stretch)
        if solid is not None:
            found, wall = solid
            self.pierced.append(Pierce(found, wall, (0.0, wall.length()), site.work.filling, like))
            return
        found, span = site.host(*site.work.stretch)
        wall = found.element
        for opening in wall.openings:
            self._clear(site, found, opening, span, like)
        for obj in self.reading.hosted.get(wall.id, ()):
            self._refuse_within(obj, wall, span)
        self.pierced.append(Pierce(found, wall, span, site.work.filling, like))

    def _clear(self, site: "Site", found: Found, opening: Opening, span: Span, like) -> None:
        """What lies within the new opening goes; what reaches beyond it is in the way."""
        obj = self.reading.openings[opening.id]
        low, high = max(opening.start, span[0]), min(opening.end, span[1])
        if high - low <= WORK_MM or obj is like or obj.Name in self.removed:
            return
        if low - opening.start > WORK_MM or opening.end - high > WORK_MM:
            raise PluginError(
                f"'{found.element.label}': '{opening.label}' stands partly in {site.work.said()}. {FILE_HAS_IT}."
            )
        self.removed[obj.Name] = obj

    def _refuse_within(self, obj, wall: Wall, span: Span) -> None:
        """A high window or a niche would hang in the air."""
        low, high = document.span_of([(p.x, p.y) for p in hosted.corners(obj)], wall)
        if min(high, span[1]) - max(low, span[0]) > WORK_MM:
            raise PluginError(
                f"'{wall.label}': '{obj.Label}' stands where the option opens the wall. Nothing was changed. "
                f"Move '{obj.Label}' and run the study again."
            )

    def _change_opening(self, site: "Site") -> None:
        there = site.opening()
        work = site.work
        solid = site.solid_opening() if there is None else None
        if solid is not None:
            self._change_solid(site, *solid)
            return
        if there is None:
            # A gap between two walls.
            self._build(site)
            if work.kind == "rehang":
                self._pierce(site, None)
            else:
                self._cut(site)
            return
        found, opening = there
        _refuse_locked(found)
        obj = self.reading.openings[opening.id]
        if document.lock(obj):
            raise PluginError(f"'{obj.Label}' cannot be changed: {document.lock(obj)}. Nothing was changed.")
        if work.kind == "rehang" and self._slides(site, found, opening):
            return
        self.removed[obj.Name] = obj
        if work.kind != "close":
            self._pierce(site, obj)

    def _change_solid(self, site: "Site", found: Found, obj) -> None:
        """A door in a wall without an axis goes; where it is moved or widened another one comes."""
        _refuse_locked(found)
        if document.lock(obj):
            raise PluginError(f"'{obj.Label}' cannot be changed: {document.lock(obj)}. Nothing was changed.")
        a, b = site.work.opening or site.work.stretch
        self.removed[obj.Name] = obj
        if site.work.kind in ("close", "rehang"):
            thickness = max([w.thickness for w in site.work.built], default=0.0)
            self.shut.append((found, solids.stretch(found, a, b, thickness)))
        if site.work.kind != "close":
            self._pierce(site, obj)

    def _slides(self, site: "Site", found: Found, opening: Opening) -> bool:
        """Whether the very door can go to its new place."""
        host, span = site.host(*site.work.stretch)
        is_as_wide = abs((span[1] - span[0]) - (opening.end - opening.start)) <= WORK_MM
        if host is not found or not is_as_wide:
            return False
        obj = self.reading.openings[opening.id]
        for other in found.element.openings:
            self._clear(site, found, other, span, obj)
        self.slid.append(Slide(found, opening, span))
        return True

    def _cut(self, site: "Site") -> None:
        for quad in site.work.demolished:
            a, b = axis_of(quad)
            solid = site.solid(a, b) if distance(a, b) > WORK_MM else None
            if distance(a, b) <= WORK_MM or solid and self._loses(site, solid[0]):
                continue
            found, span = site.host(a, b)
            trim = self.trimmed.setdefault(found.element.id, Trim(found))
            trim.cuts.append(span)
            parts = staying(found.element.length(), trim.cuts, WORK_MM)
            trim.stays = [p for p in parts if not (site.is_hidden(found.element, p) or _is_lintel(found.element, p))]

    def _loses(self, site: "Site", found: Found) -> bool:
        """Whether a wall without an axis goes as a whole."""
        if not solids.goes_whole(found, site.work):
            raise PluginError(
                f"'{found.element.label}': only the whole wall could be removed here, as it stands on no line. {FILE_HAS_IT}."
            )
        if found not in self.lost:
            self.lost.append(found)
            self.removed.update({o.Name: o for o in self.reading.hosted.get(found.element.id, ())})
        return True

    def _take_with(self, trim: Trim) -> None:
        """Doors and whatever else stands in what goes, go too."""
        wall = trim.found.element
        things = [(self.reading.openings[o.id], (o.start, o.end)) for o in wall.openings]
        for obj in self.reading.hosted.get(wall.id, ()):
            plan = [(p.x, p.y) for p in hosted.corners(obj)]
            things.append((obj, document.span_of(plan, wall)))
        for obj, (low, high) in things:
            if any(a - WORK_MM <= low and high <= b + WORK_MM for a, b in trim.stays):
                continue
            if any(min(high, b) - max(low, a) > WORK_MM for a, b in trim.stays):
                raise PluginError(f"'{obj.Label}' stands partly in what goes of '{wall.label}'. {FILE_HAS_IT}.")
            self.removed[obj.Name] = obj

    def _build(self, site: "Site") -> None:
        built = site.work.built
        if not built and site.work.kind in ("add", "close"):
            raise PluginError(f"{_said(site.work)}: the result does not say where a wall is built. Nothing was changed.")
        for wall in built:
            self.built.append(Build(wall, site.like(wall)))

    def touched(self) -> List[str]:
        """Ids of the walls that are changed where they stand."""
        found = [s.found for s in [*self.pierced, *self.slid, *self.trimmed.values()]]
        found += [f for f, _ in self.shut] + self.lost
        return [f.element.id for f in found] + self._hosts_of_removed()

    def _hosts_of_removed(self) -> List[str]:
        out = []
        for found in self.reading.found.values():
            wall = found.element
            if isinstance(wall, Wall):
                mine = [self.reading.openings[o.id].Name for o in wall.openings]
                out += [wall.id for name in mine if name in self.removed]
        return out

    def labels(self) -> List[str]:
        touched = [self.reading.found[id].element.label for id in self.touched()]
        return list(dict.fromkeys(touched))

    def make(self, doc) -> None:
        """Changes the document. Inside a transaction."""
        for pierce in self.pierced:
            self._open(pierce)
        for slide in self.slid:
            self._slide(slide)
        for build in self.built:
            build.made = walls.build(doc, build.wall, build.like)
        standing = {id: self._standing(trim.found) for id, trim in self.trimmed.items()}
        for obj in self.removed.values():
            openings.remove(obj)
        for found in self.lost:
            walls.remove(found.object)
        for id, trim in self.trimmed.items():
            has_things = bool(trim.found.element.openings or self.reading.hosted.get(id))
            trim.made = walls.trim(doc, trim.found, trim.stays, standing[id], has_things)
        doc.recompute()
        doc.recompute()

    def _standing(self, found: Found) -> List[walls.Standing]:
        """What stands in a wall once openings are made and removed, and where along it."""
        wall = found.element
        out = [(self.reading.openings[o.id], (o.start + o.end) / 2) for o in wall.openings]
        for obj in self.reading.hosted.get(wall.id, ()):
            span = document.span_of([(p.x, p.y) for p in hosted.corners(obj)], wall)
            out.append((obj, sum(span) / 2))
        gone = set(self.removed)
        slid = {self.reading.openings[s.opening.id].Name: sum(s.span) / 2 for s in self.slid}
        out = [(obj, slid.get(obj.Name, at)) for obj, at in out if obj.Name not in gone]
        return out + [(p.made, sum(p.span) / 2) for p in self.pierced if p.found is found]

    def _open(self, pierce: Pierce) -> None:
        wall = pierce.wall
        sill, head = openings.heights(self.reading, wall, pierce.filling, pierce.like)
        foot = document.foot_of(wall, self.reading)
        ends = tuple(wall.at(s) for s in pierce.span)
        pierce.made = openings.make(pierce.found.object, wall, ends, (foot + sill, foot + head), pierce.filling)

    def _slide(self, slide: Slide) -> None:
        wall, obj = slide.found.element, self.reading.openings[slide.opening.id]
        (x, y) = minus(wall.at(slide.span[0]), wall.at(slide.opening.start))
        obj.Placement = hosted.placement(Rigid(0.0, x, y)).multiply(obj.Placement)
        slide.found.object.touch()


class Site:
    """Where a work is done."""

    def __init__(self, reading: Reading, work: Work, ids: List[str]):
        self.reading, self.work = reading, work
        self.ids = ids

    def _walls(self) -> List[Found]:
        return [f for f in self.reading.found.values() if isinstance(f.element, Wall) and not f.element.rings]

    def solid(self, a: Point, b: Point) -> Optional[Tuple[Found, Wall]]:
        """The wall without an axis in whose body a stretch lies; none where a wall with one does."""
        if next(self._spans(a, b), None) is not None:
            return None
        there = solids.host(self.reading, self.work, a, b)
        if there is not None:
            _refuse_locked(there[0])
        return there

    def solid_opening(self) -> Optional[Tuple[Found, Any]]:
        return solids.opening(self.reading, *(self.work.opening or self.work.stretch), SAME_JAMB_MM)

    def host(self, a: Point, b: Point) -> Tuple[Found, Span]:
        """The wall in which a stretch lies, and from where to where along it; those that the work names first."""
        best = min(self._spans(a, b), key=lambda s: s[0], default=None)
        if best is None:
            raise PluginError(self._no_wall(a, b))
        _, found, span = best
        _refuse_locked(found)
        return found, span

    def _spans(self, a: Point, b: Point):
        for found in self._walls():
            wall, begun = found.element, 0.0
            for p, q in zip(wall.corners(), wall.corners()[1:]):
                length = distance(p, q)
                span = _along(wall, (p, q), (a, b)) if length > 0 else None
                if span is not None:
                    missing = distance(a, b) - (span[1] - span[0])
                    away = missing + (0.0 if wall.id in self.ids else distance(a, b))
                    yield away, found, (begun + span[0], begun + span[1])
                begun += length

    def _no_wall(self, a: Point, b: Point) -> str:
        middle = ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
        for found in self.reading.found.values():
            element = found.element
            rings = [element.ring] if isinstance(element, Column) else element.rings
            if any(is_inside(r, middle) for r in rings):
                why = "it is a link" if document.is_link(found.object) else "it is no straight wall there"
                return f"'{element.label}' cannot be changed so ({self.work.said()}): {why}. {FILE_HAS_IT}."
        return f"{_said(self.work)}: no wall of this document stands there. {FILE_HAS_IT}."

    def opening(self) -> Optional[Tuple[Found, Opening]]:
        """The door or opening that the work changes; none where it is a gap between walls."""
        a, b = self.work.opening or self.work.stretch
        best = None
        for found in self._walls():
            for opening in found.element.openings:
                ends = [found.element.at(s) for s in (opening.start, opening.end)]
                off = min(max(distance(a, p), distance(b, q)) for p, q in (ends, ends[::-1]))
                if off <= SAME_JAMB_MM + found.element.thickness and (best is None or off < best[0]):
                    best = (off, found, opening)
        return best[1:] if best else None

    def is_hidden(self, wall: Wall, part: Span) -> bool:
        """Whether a part lies within the body of another wall, as the end of a partition that begins at its axis."""
        ends = [wall.at(s) for s in part]
        return any(
            f.element.id != wall.id and all(_is_in_body(f.element, p) for p in ends) for f in self._walls()
        )

    def like(self, new: NewWall) -> Found:
        """The wall that a new one is made like: one of those that the work names, else the nearest in thickness."""
        named = [f for f in self._walls() if f.element.id in self.ids]
        there = named or self._walls() or [f for f in solids.walls(self.reading) if not document.is_link(f.object)]
        if not there:
            raise PluginError(f"{_said(self.work)}: there is no wall that it could be like. {FILE_HAS_IT}.")
        return min(there, key=lambda f: abs(f.element.thickness - new.thickness))


def _said(work: Work) -> str:
    words = work.said()
    return words[:1].upper() + words[1:]


def _refuse_locked(found: Found) -> None:
    if found.element.locked:
        words = f"'{found.element.label}' cannot be changed: {found.element.locked}"
        raise PluginError(words + ". Nothing was changed.")


def _along(wall: Wall, piece: Tuple[Point, Point], stretch: Tuple[Point, Point]) -> Optional[Span]:
    """Where a stretch lies along a straight piece of a wall, if it lies within its faces."""
    u = direction(*piece)
    offs = [dot(minus(p, piece[0]), left_of(u)) for p in stretch]
    if any(not -wall.right - WORK_MM <= off <= wall.left + WORK_MM for off in offs):
        return None
    at = sorted(dot(minus(p, piece[0]), u) for p in stretch)
    low, high = max(at[0], 0.0), min(at[1], distance(*piece))
    # The program's axes may reach to the far face of a wall that is met.
    is_beside = at[0] < -wall.thickness - WORK_MM or at[1] > distance(*piece) + wall.thickness + WORK_MM
    return None if high - low <= WORK_MM or is_beside else (low, high)


def _is_lintel(wall: Wall, part: Span) -> bool:
    """Whether a part is what hangs over an opening."""
    return any(o.start - WORK_MM <= part[0] and part[1] <= o.end + WORK_MM for o in wall.openings)


def _is_in_body(wall: Wall, p: Point) -> bool:
    for a, b in zip(wall.corners(), wall.corners()[1:]):
        if distance(a, b) == 0.0:
            continue
        u = direction(a, b)
        along, off = dot(minus(p, a), u), dot(minus(p, a), left_of(u))
        if -WORK_MM <= along <= distance(a, b) + WORK_MM and -wall.right - WORK_MM <= off <= wall.left + WORK_MM:
            return True
    return False
