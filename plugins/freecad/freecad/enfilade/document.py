"""From a FreeCAD document to a study: walls, columns, doors, regions, storeys, as they stand now.

Lengths are FreeCAD's own millimetres; the drawing frame is the document's XY plane.
"""

from dataclasses import dataclass, field
from typing import Any, Dict, List, Optional, Tuple

import FreeCAD as App

from enfilade_common.model import Column, Drawn, Movable, Opening, PluginError, Region, Study, Wall, pair_name
from enfilade_common.outlines import wall_outlines
from enfilade_common.plane import (
    Point,
    cross,
    direction,
    distance,
    distance_to_segment,
    dot,
    is_inside,
    minus,
)

from . import hosted, marks, plan2d

#: Height of the sight lines above the foot of a wall, mm.
EYE_MM = 1500.0
#: How far computed faces may lie from FreeCAD's own before its outline is taken instead, mm.
FACES_MM = 1.0
#: Chords of curved outlines stay this near to the curve, mm.
CHORD_MM = 2.0
#: Points nearer than this are one axis point, mm.
SAME_MM = 0.01

#: Properties that decide where an object stands.
DECIDING = ("Placement", "Points", "Start", "End", "X1", "X2", "Y1", "Y2")

Vector = App.Vector


@dataclass
class Segment:
    """Where one straight piece of a base keeps its two points: geometry index of a sketch, and whether
    the chain runs against it."""

    geometry: int
    is_reversed: bool


@dataclass
class Found:
    """A wall or column of the model with the objects it came from."""

    element: Movable
    object: Any
    #: Sketch geometry of the axis, for walls on sketches.
    segments: List[Segment] = field(default_factory=list)


@dataclass
class Reading:
    """All that was understood of a document."""

    found: Dict[str, Found] = field(default_factory=dict)
    openings: Dict[str, Any] = field(default_factory=dict)
    #: What goes with a wall without being a gap in it, by the wall's id.
    hosted: Dict[str, List[Any]] = field(default_factory=dict)
    regions: List[Region] = field(default_factory=list)
    #: Sentences about what was left out.
    notes: List[str] = field(default_factory=list)
    storeys: List[str] = field(default_factory=list)
    #: The storey that was read; empty where the document has none.
    storey: str = ""

    def elements(self) -> List[Movable]:
        return [f.element for f in self.found.values()]


def kind_of(obj) -> str:
    """``Wall``, ``Structure``, ``Window`` … as FreeCAD's own tools name it."""
    proxy = getattr(obj, "Proxy", None)
    return str(getattr(proxy, "Type", "")) if proxy is not None and not isinstance(proxy, int) else ""


def is_column(obj) -> bool:
    if kind_of(obj) != "Structure":
        return False
    if getattr(obj, "IfcType", "") in ("Column", "Pile", "Footing"):
        return True
    box = obj.Shape.BoundBox
    return getattr(obj, "IfcType", "") not in ("Slab", "Beam") and box.ZLength > max(box.XLength, box.YLength)


def storey_of(obj) -> str:
    """Label of the storey an object stands on, or nothing."""
    seen, todo = set(), list(obj.InList)
    while todo:
        parent = todo.pop(0)
        if parent.Name in seen:
            continue
        seen.add(parent.Name)
        is_storey = getattr(parent, "IfcType", "") == "Building Storey" or kind_of(parent) == "Floor"
        if is_storey and obj in parent.OutListRecursive:
            return parent.Label
        if hasattr(parent, "Group"):
            todo.extend(parent.InList)
    return ""


def storey_at(obj) -> str:
    """Label of the storey on which a door or window stands with its wall, and anything else by itself."""
    hosts = getattr(obj, "Hosts", None) or []
    return storey_of(obj) or (storey_of(hosts[0]) if hosts else "")


def marked(doc) -> Dict[str, List[str]]:
    """Labels of all that is marked in a document, by the storey on which it stands."""
    out: Dict[str, List[str]] = {}
    for obj in doc.Objects:
        if not is_link(obj) and (marks.is_marked(obj) or marks.region_kind(obj)):
            out.setdefault(storey_at(obj), []).append(obj.Label)
    return out


def marked_elsewhere(doc, storey: str) -> List[str]:
    """What is marked on other storeys: ``'P' (Upper floor)``. Regions outside any level count for all."""
    regions = {o.Label for o in doc.Objects if not is_link(o) and marks.region_kind(o)}
    return [
        f"'{label}' ({at})" if at else f"'{label}'"
        for at, labels in marked(doc).items()
        for label in labels
        if at != storey and (at or label not in regions)
    ]


def storeys(doc) -> List[str]:
    """Labels of the storeys that hold walls, or the lines of a 2D plan, lowest first; nothing is the label of what
    stands outside any level."""
    heights: Dict[str, float] = {}
    walls = [o for o in doc.Objects if kind_of(o) == "Wall" and is_solid(o)]
    for obj in walls or plan2d.lines(doc):
        label = storey_of(obj)
        foot = shape_of(obj).BoundBox.ZMin
        heights[label] = min(foot, heights.get(label, foot))
    return sorted(heights, key=lambda s: heights[s])


def pairs(doc) -> List[str]:
    """Names of the pairs of regions marked in a document, sorted; what is no name is left to :func:`read` to tell."""
    named = [o for o in doc.Objects if not is_link(o) and marks.region_kind(o) in ("query", "reference")]
    return sorted({_pair([], o) for o in named} - {""})


def read(doc, storey: Optional[str] = None, level: str = "eye") -> Reading:
    """Reads one storey; without a name the one with marks, else the lowest. At ``eye`` level what is lower is
    left out, at ``knee`` level it counts."""
    out = Reading(storeys=storeys(doc))
    if storey not in out.storeys:
        storey = default_storey(doc, out.storeys)
    out.storey = storey or ""
    ids = marks.ids(doc)
    many = len(out.storeys) > 1
    elsewhere = marked_elsewhere(doc, out.storey) if many else []
    if elsewhere:
        out.notes.append(f"Marked on other storeys and not part of this study: {', '.join(elsewhere)}.")
    solids = []
    for obj in doc.Objects:
        region = "" if is_link(obj) else marks.region_kind(obj)
        if region:
            _add_region(out, obj, region, many, storey)
            continue
        kind = _kind_in_plan(out, obj)
        if not kind or many and storey_of(obj) != storey:
            continue
        if not is_solid(obj):
            out.notes.append(f"'{obj.Label}' has no shape and was left out; recompute the document.")
        elif not _is_upright(obj):
            out.notes.append(f"'{obj.Label}' stands in a tilted part and was left out.")
        else:
            solids.append((obj, kind))
    floor = _floor([obj for obj, _ in solids])
    for obj, kind in solids:
        if level == "eye" and _is_low(obj, floor):
            low = f"'{obj.Label}' is lower than eye height ({EYE_MM / 1000:g} m): it stops no sight"
            out.notes.append(low + " and was left out of the plan.")
            continue
        add = _add_link if is_link(obj) else _add_wall if kind == "Wall" else _add_column
        add(out, obj, ids[obj.Name])
    if not out.found and plan2d.is_plan(doc):
        plan2d.add_all(out, doc, storey, many, ids)
        return out
    _add_openings(out, doc, ids)
    _add_parts(out)
    _share_bases(out)
    _hold_linked(out)
    return out


def is_link(obj) -> bool:
    """Whether an object only shows another one, whose properties, marks too, then seem to be its own."""
    return obj.isDerivedFrom("App::Link")


def _kind_in_plan(out: Reading, obj) -> str:
    """``Wall`` or ``Column``, of links what they show; nothing for all else."""
    if not is_link(obj):
        return "Wall" if kind_of(obj) == "Wall" else "Column" if is_column(obj) else ""
    shown = obj.getLinkedObject(True)
    if shown is None or shown is obj:
        return ""
    is_one = not getattr(obj, "ElementCount", 0)
    kind = "Wall" if kind_of(shown) == "Wall" else "Column" if is_solid(shown) and is_column(shown) else ""
    inside = [o for o in getattr(shown, "OutListRecursive", []) if kind_of(o) == "Wall"]
    if not (kind and is_one) and (kind or hasattr(shown, "Group") and inside):
        out.notes.append(f"The link '{obj.Label}' shows walls a second time; these were left out.")
    return kind if is_one else ""


def shape_of(obj):
    """An object's shape where it stands in the document."""
    outer = hosted.outer_placement(obj)
    if outer.isIdentity():
        return obj.Shape
    shape = obj.Shape.copy()
    shape.Placement = outer.multiply(shape.Placement)
    return shape


def _is_upright(obj) -> bool:
    up = hosted.outer_placement(obj).Rotation.multVec(Vector(0, 0, 1))
    return (up - Vector(0, 0, 1)).Length < 1e-9


def _floor(objects) -> float:
    """Height on which most of them stand."""
    feet = sorted(shape_of(o).BoundBox.ZMin for o in objects)
    return feet[(len(feet) - 1) // 2] if feet else 0.0


def _is_low(obj, floor: float) -> bool:
    box = shape_of(obj).BoundBox
    return box.ZLength < EYE_MM - SAME_MM and box.ZMax - floor < EYE_MM - SAME_MM


def study(doc, wishes, storey: Optional[str] = None, lineage=()) -> Tuple[Study, Reading]:
    """The study of a document's storey as it stands now."""
    reading = read(doc, storey, wishes.level)
    elements = reading.elements()
    made = Study(
        host="freecad",
        document=str(getattr(doc, "Uid", "") or doc.Name),
        walls=[e for e in elements if isinstance(e, Wall)],
        columns=[e for e in elements if isinstance(e, Column)],
        drawn=[e for e in elements if isinstance(e, Drawn)],
        regions=reading.regions,
        wishes=wishes,
        storey=reading.storey,
        lineage=list(lineage),
    )
    if not (made.walls or made.drawn):
        raise PluginError(
            "There is nothing to measure in this document: draw walls with the Arch (BIM) workbench, or a plan of lines."
        )
    return made, reading


def default_storey(doc, labels: List[str]) -> Optional[str]:
    """The storey with marks, else the lowest."""
    for obj in doc.Objects:
        if not is_link(obj) and (marks.bounds(obj) or marks.works(obj)) and storey_at(obj) in labels:
            return storey_at(obj)
    return labels[0] if labels else None


def is_solid(obj) -> bool:
    shape = getattr(obj, "Shape", None)
    return shape is not None and not shape.isNull() and bool(shape.Faces)


def _walls_by_object(out: Reading) -> Dict[str, List[Wall]]:
    by_object: Dict[str, List[Wall]] = {}
    for found in out.found.values():
        if isinstance(found.element, Wall):
            by_object.setdefault(found.object.Name, []).append(found.element)
    return by_object


def _add_openings(out: Reading, doc, ids: Dict[str, str]) -> None:
    """Doors and windows in the walls of their hosts, and in the walls joined to these."""
    by_object = _walls_by_object(out)
    for obj in doc.Objects:
        if kind_of(obj) != "Window":
            continue
        hosts = _with_additions(getattr(obj, "Hosts", None) or [])
        walls = [w for host in hosts for w in by_object.get(host.Name, ())]
        if walls:
            _add_opening(out, obj, walls, ids)


def _add_parts(out: Reading) -> None:
    """Niches and additions of walls go with them, but for walls and columns, which stand for themselves, and
    roofs, under which walls end wherever they stand."""
    own = {f.object.Name for f in out.found.values()}
    by_object = _walls_by_object(out)
    for name, walls in by_object.items():
        host = out.found[walls[0].id].object
        for part in [*(getattr(host, "Subtractions", None) or []), *(getattr(host, "Additions", None) or [])]:
            if part.Name in own or kind_of(part) in ("Wall", "Window", "Roof") or not hosted.corners(part):
                continue
            plan = [(p.x, p.y) for p in hosted.corners(part)]
            _add_part(out, part, min(walls, key=lambda w: _away(plan, w)))


def _add_part(out: Reading, part, wall: Wall) -> None:
    hosts = {o.Name for o in part.InList if part in [*getattr(o, "Subtractions", []), *getattr(o, "Additions", [])]}
    if len(hosts) > 1:
        if wall.clauses or wall.group:
            out.notes.append(f"'{part.Label}' belongs to '{wall.label}' and to other walls: it stays where it stands.")
        return
    _hold_with(out, wall, part)
    out.hosted.setdefault(wall.id, []).append(part)


def _with_additions(hosts) -> List[Any]:
    """Hosts and what was joined to them, each once."""
    out: Dict[str, Any] = {}
    todo = list(hosts)
    while todo:
        host = todo.pop(0)
        if host.Name not in out:
            out[host.Name] = host
            todo.extend(getattr(host, "Additions", None) or [])
    return list(out.values())


def _add_region(out: Reading, obj, kind: str, many: bool, storey) -> None:
    if many and storey_of(obj) not in ("", storey):
        return
    shape = getattr(obj, "Shape", None)
    wires = [w for w in shape_of(obj).Wires if w.isClosed()] if shape is not None and not shape.isNull() else []
    if not wires:
        out.notes.append(f"The region '{obj.Label}' is not closed and was left out.")
        return
    for wire in wires[:1]:
        out.regions.append(Region(kind, _ring(wire), obj.Name, _pair(out.notes, obj)))


def _pair(notes: List[str], obj) -> str:
    try:
        return pair_name(marks.region_pair(obj))
    except PluginError as e:
        notes.append(f"The region '{obj.Label}' counts as one without a name: {e}")
        return ""


def _ring(wire) -> List[Point]:
    """Corners of a closed wire; curves as chords."""
    if all(e.Curve.TypeId == "Part::GeomLine" for e in wire.Edges):
        points = [v.Point for v in wire.OrderedVertexes]
    else:
        points = wire.discretize(Deflection=CHORD_MM)
    out = [(p.x, p.y) for p in points]
    return out[:-1] if len(out) > 1 and distance(out[0], out[-1]) < SAME_MM else out


def _add_column(out: Reading, obj, id: str) -> None:
    rings = _slice(obj)
    if not rings:
        out.notes.append(f"'{obj.Label}' is not cut at eye height and was left out.")
        return
    rings.sort(key=lambda r: middle_and_area(r)[1], reverse=True)
    column = Column(id, obj.Label, rings[0], obj.Name)
    column.clauses, column.group, column.keep = marks.clauses(obj, 0.0), marks.group(obj), marks.keep(obj)
    column.locked = lock(obj)
    out.found[id] = Found(column, obj)


def middle_and_area(ring: List[Point]) -> Tuple[Point, float]:
    """Centre of gravity and size of the area in a ring, mm and mm²; however its points are strewn along it."""
    x0, y0 = ring[0]
    pairs = [((a[0] - x0, a[1] - y0), (b[0] - x0, b[1] - y0)) for a, b in zip(ring, ring[1:] + ring[:1])]
    crosses = [cross(a, b) for a, b in pairs]
    twice = sum(crosses)
    if abs(twice) < 1e-9:
        return (x0, y0), 0.0
    x, y = (sum((a[k] + b[k]) * c for (a, b), c in zip(pairs, crosses)) / (3 * twice) for k in (0, 1))
    return (x0 + x, y0 + y), abs(twice) / 2


def _slice(obj) -> List[List[Point]]:
    """Outlines of an object at eye height, or at half its own if it is lower."""
    shape = shape_of(obj)
    z = shape.BoundBox.ZMin + min(EYE_MM, shape.BoundBox.ZLength / 2)
    return [_ring(w) for w in shape.slice(Vector(0, 0, 1), z) if w.isClosed()]


def _add_wall(out: Reading, obj, id: str) -> None:
    chains = axes(obj)
    faces = _faces(obj)
    walls: List[Found] = []
    out.notes += marks.unread(obj)
    for i, (points, closed, segments) in enumerate(chains):
        wall_id = id if len(chains) == 1 else f"{id}.{i}"
        wall = Wall(wall_id, obj.Label, points, *faces, closed=closed, name=obj.Name)
        walls.append(Found(wall, obj, segments))
    if walls and _fits([w.element for w in walls], obj):
        outer = hosted.outer_placement(obj)
        for found in walls:
            found.element.axis = [(p.x, p.y) for p in (outer.multVec(Vector(*q, 0)) for q in found.element.axis)]
    else:
        walls = _as_rings(out, obj, id)
    for found in walls:
        wall = found.element
        heading = 0.0 if wall.rings else _heading_deg(wall)
        wall.clauses, wall.group, wall.keep = marks.clauses(obj, heading), marks.group(obj), marks.keep(obj)
        wall.locked, wall.height = lock(obj), round(obj.Shape.BoundBox.ZLength, 2)
        wall.works = marks.works(obj)
        if len(walls) > 1 and not wall.group and wall.clauses:
            wall.group = obj.Label
            wall.clauses = walls[0].element.clauses
        out.found[wall.id] = found


def _as_rings(out: Reading, obj, id: str) -> List[Found]:
    """A wall by its outlines at eye height."""
    rings = _slice(obj)
    if not rings:
        out.notes.append(f"'{obj.Label}' is not cut at eye height and was left out.")
        return []
    box = shape_of(obj).BoundBox
    axis = [(box.XMin, box.YMin), (box.XMax, box.YMax)]
    return [Found(Wall(id, obj.Label, axis, 0.0, 0.0, name=obj.Name, rings=rings), obj)]


def _add_link(out: Reading, obj, id: str) -> None:
    """A link stands in the plan, and stays: it has no marks of its own."""
    for found in _as_rings(out, obj, id):
        wall = found.element
        wall.locked, wall.height = "it is a link to another object", round(obj.Shape.BoundBox.ZLength, 2)
        out.found[id] = found


def _hold_linked(out: Reading) -> None:
    """What a link shows cannot move alone: the link would show it moved."""
    for link in (f.object for f in out.found.values() if is_link(f.object)):
        shown = link.getLinkedObject(True)
        for found in out.found.values():
            if found.object.Name == shown.Name and not found.element.locked:
                found.element.locked = f"the link '{link.Label}' shows it in another place and would move along"


def _heading_deg(wall: Wall) -> float:
    import math

    u = direction(wall.axis[0], wall.axis[1])
    return math.degrees(math.atan2(u[1], u[0]))


def _faces(obj) -> Tuple[float, float]:
    """Distance of the left and the right face from the axis."""
    width, offset = obj.Width.Value, obj.Offset.Value
    if obj.Align == "Left":
        return -offset, width + offset
    if obj.Align == "Right":
        return width + offset, -offset
    return width / 2, width / 2


def _fits(walls: List[Wall], obj) -> bool:
    """Whether the computed faces lie where FreeCAD's do."""
    bare = [Wall(w.id, "", w.axis, w.left, w.right, w.closed) for w in walls]
    corners = [p for w in bare for o in wall_outlines(w) for p in o.points]
    if not corners or getattr(obj, "Additions", None):
        # Walls joined to this one stand in its shape too; they are read as walls of their own.
        return bool(corners)
    box = obj.Shape.BoundBox
    mine = (min(p[0] for p in corners), min(p[1] for p in corners))
    mine += (max(p[0] for p in corners), max(p[1] for p in corners))
    theirs = (box.XMin, box.YMin, box.XMax, box.YMax)
    return all(abs(a - b) <= FACES_MM for a, b in zip(mine, theirs))


def axes(obj) -> List[Tuple[List[Point], bool, List[Segment]]]:
    """Chains of straight axis pieces of a wall: points, whether closed, where a sketch keeps them.

    Nothing for walls that have no such axis: arcs, splines, faces, solids.
    """
    base = obj.Base
    if base is None:
        if obj.Length.Value <= 0:
            return []
        half = obj.Length.Value / 2
        ends = [obj.Placement.multVec(Vector(x, 0, 0)) for x in (-half, half)]
        return [([(p.x, p.y) for p in ends], False, [])]
    shape = getattr(base, "Shape", None)
    if shape is None or shape.isNull() or shape.Solids or any(e.Curve.TypeId != "Part::GeomLine" for e in shape.Edges):
        return []
    if any(abs(v.Point.z - shape.Vertexes[0].Point.z) > SAME_MM for v in shape.Vertexes):
        return []
    if base.isDerivedFrom("Sketcher::SketchObject"):
        return _sketch_chains(base)
    if is_draft_wire(base):
        plain = not _length(base, "FilletRadius") and not _length(base, "ChamferSize")
        if not plain or getattr(base, "Subdivisions", 0):
            return []
        points = [base.Placement.multVec(p) for p in base.Points]
        return [(_distinct([(p.x, p.y) for p in points]), bool(base.Closed) and len(points) > 2, [])]
    if base.TypeId == "Part::Line":
        return [([(v.Point.x, v.Point.y) for v in shape.Vertexes], False, [])]
    return []


def _length(obj, name: str) -> float:
    value = getattr(obj, name, 0.0)
    return float(getattr(value, "Value", value) or 0.0)


def _distinct(points: List[Point]) -> List[Point]:
    return [p for i, p in enumerate(points) if i == 0 or distance(p, points[i - 1]) > SAME_MM]


def is_draft_wire(base) -> bool:
    return hasattr(base, "Points") and hasattr(base, "Start") and hasattr(base, "Closed")


def _sketch_chains(sketch):
    """Chains of a sketch's drawn lines, each in the direction of its first line."""
    lines = []
    for index, geometry in enumerate(sketch.Geometry):
        if geometry.TypeId != "Part::GeomLineSegment" or sketch.getConstruction(index):
            continue
        a, b = (sketch.Placement.multVec(p) for p in (geometry.StartPoint, geometry.EndPoint))
        lines.append((index, (a.x, a.y), (b.x, b.y)))
    chains = []
    while lines:
        index, a, b = lines.pop(0)
        points, segments = [a, b], [Segment(index, False)]
        while _grow(points, segments, lines):
            pass
        closed = len(points) > 3 and distance(points[0], points[-1]) < SAME_MM
        chains.append((points[:-1] if closed else points, closed, segments))
    return chains


def _grow(points, segments, lines) -> bool:
    """Lengthens a chain by one line at its end or its start; joints of three lines end it."""
    for at_end in (True, False):
        tip = points[-1] if at_end else points[0]
        touching = [line for line in lines if min(distance(tip, line[1]), distance(tip, line[2])) < SAME_MM]
        if len(touching) != 1 or distance(points[0], points[-1]) < SAME_MM:
            continue
        index, a, b = touching[0]
        lines.remove(touching[0])
        starts_here = distance(tip, a) < SAME_MM
        if at_end:
            points.append(b if starts_here else a)
            segments.append(Segment(index, not starts_here))
        else:
            points.insert(0, b if starts_here else a)
            segments.insert(0, Segment(index, starts_here))
        return True
    return False


def _add_opening(out: Reading, door, walls: List[Wall], ids: Dict[str, str]) -> None:
    """A door or window as a gap in that of its host's chains on which it lies; what is no gap at eye height
    only goes with the wall."""
    points = hosted.corners(door)
    if not points:
        out.notes.append(f"'{door.Label}' has no shape and is taken as closed.")
        return
    plan = [(p.x, p.y) for p in points]
    best = min((_span(plan, w) for w in walls if not w.rings), key=lambda s: s[0], default=None)
    is_in_axis = best is not None and best[0] <= best[1].thickness + 200.0 and best[3] - best[2] >= 1.0
    wall = best[1] if is_in_axis else min(walls, key=lambda w: _away(plan, w))
    _hold_with(out, wall, door)
    slides = [c for c in marks.clauses(door, 0.0) if c.kind == "along"]
    if not is_in_axis:
        if slides:
            out.notes.append(f"'{door.Label}' does not slide: its wall '{wall.label}' has no straight axis here.")
        if not wall.rings:
            out.notes.append(f"'{door.Label}' does not stand in its wall '{wall.label}' and is taken as closed.")
        out.hosted.setdefault(wall.id, []).append(door)
        return
    _, _, start, end = best
    foot, low, high = foot_of(wall, out), min(p.z for p in points), max(p.z for p in points)
    if not low - foot < EYE_MM < high - foot:
        out.hosted.setdefault(wall.id, []).append(door)
        if slides:
            out.notes.append(f"'{door.Label}' is not cut at eye height: it does not slide, it only goes with its wall.")
        return
    opening = Opening(ids[door.Name], door.Label, start, end, _kind_of_opening(door, low - foot), door.Name)
    opening.clauses, opening.works = slides, marks.works(door)
    out.notes += marks.unread(door)
    wall.openings.append(opening)
    out.openings[opening.id] = door


def _kind_of_opening(obj, sill: float) -> str:
    """``passage`` without a leaf, ``door``, or ``window``."""
    type = getattr(obj, "IfcType", "")
    if type.startswith("Opening"):
        return "passage"
    return "door" if type == "Door" or sill < 100.0 else "window"


def _hold_with(out: Reading, wall: Wall, part) -> None:
    """A wall cannot move if what stands in it cannot go along."""
    held = lock(part)
    if held and not wall.locked:
        wall.locked = f"'{part.Label}' in it cannot go along: {held}"


def _away(points: List[Point], wall: Wall) -> float:
    """How far the middle of a thing lies from a wall's body."""
    middle = _middle(points)
    if any(is_inside(ring, middle) for ring in wall.rings):
        return 0.0
    rings = [r + r[:1] for r in wall.rings] or [wall.corners()]
    return min(distance_to_segment(middle, a, b) for r in rings for a, b in zip(r, r[1:]))


def _middle(points: List[Point]) -> Point:
    xs, ys = [p[0] for p in points], [p[1] for p in points]
    return ((min(xs) + max(xs)) / 2, (min(ys) + max(ys)) / 2)


def foot_of(wall: Wall, out: Reading) -> float:
    """Height of the foot of a wall in the document."""
    found = out.found.get(wall.id)
    return shape_of(found.object).BoundBox.ZMin if found else 0.0


def span_of(points: List[Point], wall: Wall) -> Tuple[float, float]:
    """From where to where along a wall a thing lies, mm."""
    _, _, start, end = _span(points, wall)
    return start, end


def _span(points: List[Point], wall: Wall):
    """How far a door lies from a wall's axis, and from where to where along it."""
    middle = _middle(points)
    best, begun, corners = None, 0.0, wall.corners()
    for a, b in zip(corners, corners[1:]):
        u, length = direction(a, b), distance(a, b)
        along = [dot(minus(p, a), u) for p in points]
        low, high = max(min(along), 0.0), min(max(along), length)
        off = abs((middle[0] - a[0]) * u[1] - (middle[1] - a[1]) * u[0])
        off += max(0.0, min(along) - length, -max(along))
        if best is None or off < best[0]:
            best = (off, wall, round(begun + low, 4), round(begun + high, 4))
        begun += length
    return best


def _share_bases(out: Reading) -> None:
    """Walls that stand on one base can only move together: they become one group."""
    by_base: Dict[str, List[Found]] = {}
    for found in out.found.values():
        base = getattr(found.object, "Base", None)
        if isinstance(found.element, Wall) and base is not None and not is_link(found.object):
            by_base.setdefault(base.Name, []).append(found)
    for shared in by_base.values():
        if len({f.object.Name for f in shared}) < 2 or not any(f.element.clauses for f in shared):
            continue
        first = next(f for f in shared if f.element.clauses)
        for f in shared:
            f.element.group = first.element.group or first.object.Label
            f.element.clauses = f.element.clauses or first.element.clauses


def lock(obj) -> str:
    """Why an object cannot be moved by us; nothing where it can."""
    base = getattr(obj, "Base", None)
    for part in (obj, base):
        if part is None:
            continue
        if any(path.lstrip(".").startswith(DECIDING) for path, _ in part.ExpressionEngine):
            return f"an expression decides where '{part.Label}' stands"
        if "ReadOnly" in part.getPropertyStatus("Placement") or "Immutable" in part.getPropertyStatus("Placement"):
            return f"the position of '{part.Label}' is locked"
        if (part is base or kind_of(part) == "") and is_attached(part) and not part.isDerivedFrom("Sketcher::SketchObject"):
            return f"'{part.Label}' is attached to another object"
    if getattr(obj, "CloneOf", None) is not None:
        return "it is a clone of another wall"
    if _in_moved_part(obj):
        return "it stands in a part with a position of its own"
    return ""


def is_attached(base) -> bool:
    """Whether another object decides the placement; the points of a sketch can still be moved."""
    return getattr(base, "MapMode", "Deactivated") not in ("Deactivated", "")


def _in_moved_part(obj) -> bool:
    return any(
        p.isDerivedFrom("App::Part") and not p.Placement.isIdentity() and obj in p.OutListRecursive
        for p in obj.InListRecursive
    )
