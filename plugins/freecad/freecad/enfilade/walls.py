"""Arch walls and lines made like those that stand already, shortened and split."""

from typing import Any, List, Tuple

import Arch
import Draft
import FreeCAD as App

from enfilade_common.model import PluginError, Wall
from enfilade_common.plane import Point, distance, distance_to_segment
from enfilade_common.works import NewWall

from . import document, marks, openings
from .document import Found
from .wording import say

Vector = App.Vector
Span = Tuple[float, float]
#: A door, a window or a niche, and where its middle lies along its wall.
Standing = Tuple[Any, float]

#: What the part of a wall takes over from the whole, besides its sizes.
TAKEN_OVER = ("Material", "IfcType", "PredefinedType", "Description", "StandardCode", "Offset", "MoveWithHost")
#: How an object looks.
LOOKS = ("LineColor", "LineWidth", "DrawStyle", "PointColor", "PointSize", "ShapeColor", "Transparency", "ShapeAppearance")


def refuse_uncut(found: Found, stays: List[Span]) -> None:
    """Refuses to shorten or split what cannot be."""
    obj, wall = found.object, found.element
    base = getattr(obj, "Base", None)
    others = [o for o in _users(base) if o.Name != obj.Name]
    if others and stays:
        _refuse(wall, f"'{others[0].Label}' stands on the same base line")
    if document.kind_of(obj) == "Wall" and len(document.axes(obj)) > 1:
        _refuse(wall, f"it stands on a base of several lines, '{base.Label}'")
    if stays and not _can_take(base, wall, _parts(wall, stays)):
        _refuse(wall, f"its base '{base.Label if base else obj.Label}' can only lose its ends")


def _refuse(wall: Wall, why: str) -> None:
    to_do = f"Draw '{wall.label}' as a wall on a line of its own, or take the new drawing file of the round"
    raise PluginError(f"'{wall.label}' cannot be cut: {why}. Nothing was changed. {to_do}.")


def _users(base) -> list:
    return [] if base is None else [o for o in base.InList if not hasattr(o, "Group")]


def _can_take(base, wall: Wall, parts: List[List[Point]]) -> bool:
    if base is not None and document.is_draft_wire(base):
        return True
    is_straight = base is None or base.TypeId == "Part::Line" or base.isDerivedFrom("Sketcher::SketchObject")
    return is_straight and not wall.closed and len(_kept(parts)) == len(wall.axis)


def _parts(wall: Wall, stays: List[Span]) -> List[List[Point]]:
    """Corners of the parts of a wall's axis that stay; of a closed one the last and the first are one."""
    parts = [_corners(wall, span) for span in stays]
    if wall.closed and len(parts) > 1 and distance(parts[-1][-1], parts[0][0]) < document.SAME_MM:
        parts[0] = parts.pop()[:-1] + parts[0]
    return parts


def _corners(wall: Wall, span: Span) -> List[Point]:
    out, along, points = [wall.at(span[0])], 0.0, wall.corners()
    for a, b in zip(points, points[1:]):
        along += distance(a, b)
        if span[0] + document.SAME_MM < along < span[1] - document.SAME_MM:
            out.append(b)
    return [*out, wall.at(span[1])]


def _length(points: List[Point]) -> float:
    return sum(distance(a, b) for a, b in zip(points, points[1:]))


def _kept(parts: List[List[Point]]) -> List[Point]:
    """The part that the object itself becomes."""
    return max(parts, key=_length)


def trim(doc, found: Found, stays: List[Span], standing: List[Standing], has_things: bool) -> List[str]:
    """Takes parts of a wall away; gives the names of the objects of what stays. The longest part is the wall itself,
    each other one a new wall, with what stands in it. ``has_things``: whether anything stands in it, or stood there."""
    obj, wall = found.object, found.element
    if not stays:
        remove(obj)
        return []
    parts = _parts(wall, stays)
    kept = _kept(parts)
    # FreeCAD takes along what stands in a wall without a base, once more when that is undone: so it gets one.
    is_replaced = has_things and obj.Base is None
    label, made = obj.Label, []
    for part in parts:
        if part is kept and not is_replaced:
            made.append(obj)
            continue
        piece = _like(doc, obj, part, obj.Width.Value, obj.Align)
        marks.copy(obj, piece)
        for thing, along in standing:
            if _is_on(part, wall.at(along)):
                _rehost(thing, obj, piece)
        made.append(piece)
    if is_replaced:
        remove(obj)
    else:
        _set_axis(found, kept)
        obj.touch()
    for part, piece in zip(parts, made):
        if piece is not obj:
            piece.Label = label if part is kept else say("{} part", label)
    return [piece.Name for piece in made]


def _is_on(points: List[Point], p: Point) -> bool:
    """Whether a point of the axis lies on a part of it."""
    return any(distance_to_segment(p, a, b) < 1.0 for a, b in zip(points, points[1:]))


def _rehost(thing, old, new) -> None:
    if old in (getattr(thing, "Hosts", None) or []):
        thing.Hosts = [new if h is old else h for h in thing.Hosts]
    for name in ("Subtractions", "Additions"):
        if thing in getattr(old, name, []):
            setattr(old, name, [o for o in getattr(old, name) if o is not thing])
            setattr(new, name, [*getattr(new, name), thing])


def remove(obj) -> None:
    """Removes a wall with its base; walls that were joined to it stand for themselves."""
    doc, base = obj.Document, getattr(obj, "Base", None)
    joined = list(getattr(obj, "Additions", []))
    holders = [o for o in obj.InList if obj in getattr(o, "Additions", [])]
    doc.removeObject(obj.Name)
    openings.drop_unused(base)
    for part in joined:
        part.Visibility = True
    for host in holders:
        host.touch()


def _set_axis(found: Found, points: List[Point]) -> None:
    obj = found.object
    base = getattr(obj, "Base", None)
    if base is None:
        (ax, ay), (bx, by) = points
        place = obj.Placement
        obj.Length = distance(*points)
        obj.Placement = App.Placement(Vector((ax + bx) / 2, (ay + by) / 2, place.Base.z), place.Rotation)
    elif document.is_draft_wire(base):
        z, back = base.Placement.multVec(base.Points[0]).z, base.Placement.inverse()
        if base.Closed:
            base.Closed = False
        base.Points = [back.multVec(Vector(x, y, z)) for x, y in points]
    elif base.TypeId == "Part::Line":
        a, b = (base.Placement.inverse().multVec(Vector(*p, base.Placement.Base.z)) for p in points)
        base.X1, base.Y1, base.X2, base.Y2 = a.x, a.y, b.x, b.y
    else:
        _move_ends(base, found, points)


def _move_ends(sketch, found: Found, points: List[Point]) -> None:
    """The two ends of a chain of lines in a sketch."""
    back = sketch.Placement.inverse()
    for segment, point, is_begin in ((found.segments[0], points[0], True), (found.segments[-1], points[-1], False)):
        position = 1 if is_begin != segment.is_reversed else 2
        here = sketch.Placement.multVec(sketch.getPoint(segment.geometry, position))
        if distance((here.x, here.y), point) <= document.SAME_MM:
            continue
        try:
            sketch.movePoint(segment.geometry, position, back.multVec(Vector(*point, here.z)), 0)
        except Exception as e:
            held = f"The constraints of the sketch '{sketch.Label}' hold '{found.element.label}' where it is"
            raise PluginError(f"{held} ({e}); nothing was changed.") from e


def build(doc, new: NewWall, like: Found):
    """A new wall on a line, as high as another one and made like it."""
    # A wall that is one line in the drawing is as thick as the other.
    made = _like(doc, like.object, list(new.ends), new.thickness or like.object.Width.Value, "Center")
    if like.element.rings:
        # A solid is as high as it is, whatever its property says.
        made.Height = like.element.height
    made.Label = say("New wall")
    return made


def _like(doc, like, points: List[Point], width: float, align: str):
    z = like.Base.Shape.BoundBox.ZMin if like.Base is not None else like.Placement.Base.z
    corners = [Vector(x, y, z) for x, y in points]
    base = Draft.make_line(*corners) if len(corners) == 2 else Draft.make_wire(corners, closed=False, face=False)
    doc.recompute([base])
    made = Arch.makeWall(base, width=width, height=like.Height.Value or None, align=align)
    for name in TAKEN_OVER:
        if hasattr(like, name) and hasattr(made, name) and (name not in ("Material", "Offset") or _is_as_thick(like, width)):
            _set(made, name, getattr(like, name))
    made.Height = like.Height.Value
    join_groups(like, made)
    look_like(like, made)
    return made


def _is_as_thick(like, width: float) -> bool:
    """Layers and an offset belong to a thickness."""
    return abs(like.Width.Value - width) < 1.0


def _set(obj, name: str, value) -> None:
    try:
        setattr(obj, name, value)
    except (ValueError, TypeError):
        # A value that the object's own list does not know.
        return


def join_groups(like, made) -> None:
    """Puts an object into the storey, the group and the layer of another one."""
    for group in like.InList:
        if like not in getattr(group, "Group", []) or made in group.Group:
            continue
        if hasattr(group, "addObject"):
            group.addObject(made)
        else:
            group.Group = [*group.Group, made]


def look_like(like, made) -> None:
    """Gives an object the colours and lines of another one; without a window objects have no looks."""
    theirs, mine = getattr(like, "ViewObject", None), getattr(made, "ViewObject", None)
    if theirs is None or mine is None:
        return
    for name in LOOKS:
        if hasattr(theirs, name) and hasattr(mine, name):
            _set(mine, name, getattr(theirs, name))
