"""2D plans: lines of Draft and the shapes that a DXF import leaves. A document without walls is read by them, as
the drawing that they make; accepting moves these very objects."""

import math
from typing import List

import FreeCAD as App
import Part

from enfilade_common import drawn as strokes
from enfilade_common.model import Drawn, PluginError, Stroke
from enfilade_common.plane import Rigid, distance

from . import document, hosted, marks

Vector = App.Vector

#: What Draft draws.
DRAFT = ("Wire", "Fillet", "Rectangle", "Polygon", "Circle", "Ellipse", "BSpline", "BezCurve")
#: Layers of ours in a drawing that was imported; FreeCAD writes ``_`` in their names.
OURS = ("EF-", "EF_")


def is_plan(doc) -> bool:
    """Whether a document has lines and no walls."""
    return not any(document.kind_of(o) == "Wall" and document.is_solid(o) for o in doc.Objects) and any(is_line(o) for o in doc.Objects)


def lines(doc) -> List:
    """What is drawn in a document and seen, but for regions and what we drew."""
    return [o for o in doc.Objects if is_line(o)]


def is_line(obj) -> bool:
    if document.is_link(obj) or not obj.Visibility or marks.region_kind(obj):
        return False
    is_draft = document.kind_of(obj) in DRAFT
    if not (is_draft or obj.TypeId in ("Part::Feature", "Part::Line")):
        return False
    shape = obj.Shape
    if shape.isNull() or not shape.Edges or shape.Solids or shape.Faces and not is_draft:
        return False
    return shape.BoundBox.ZLength <= document.SAME_MM and not layer_of(obj).startswith(OURS)


def layer_of(obj) -> str:
    """The layer or group that an object lies in; what was imported in layers bears its name itself."""
    if obj.TypeId == "Part::Feature" and obj.Shape.ShapeType == "Compound" and not obj.Label.startswith("Shape"):
        return obj.Label
    groups = (p for p in obj.InList if document.kind_of(p) == "Layer" or p.isDerivedFrom("App::DocumentObjectGroup"))
    return next((p.Label for p in groups), "0")


def add_all(out, doc, storey, many: bool, ids) -> None:
    for obj in lines(doc):
        if not many or document.storey_of(obj) == storey:
            made = element(obj, ids[obj.Name])
            out.notes += marks.unread(obj)
            out.found[made.id] = document.Found(made, obj)


def element(obj, id: str) -> Drawn:
    made = Drawn(id, obj.Label, strokes_of(obj), layer_of(obj), obj.Name)
    made.clauses, made.group, made.keep = marks.clauses(obj, heading_deg(obj)), marks.group(obj), marks.keep(obj)
    made.locked, made.works = document.lock(obj), marks.works(obj)
    curves = any(e.Curve.TypeId not in ("Part::GeomLine", "Part::GeomCircle") for e in obj.Shape.Edges)
    can_stretch = is_plain_wire(obj) or obj.TypeId in ("Part::Feature", "Part::Line")
    # An arc or a circle only ever moves as a whole.
    made.is_stiff = curves or not can_stretch and any(s.kind == "lines" for s in made.strokes)
    return made


def is_plain_wire(obj) -> bool:
    """A Draft line or wire that is what its points say."""
    is_wire = document.kind_of(obj) == "Wire" and document.is_draft_wire(obj) and len(obj.Points) > 1
    return is_wire and all(e.Curve.TypeId == "Part::GeomLine" for e in obj.Shape.Edges) and not obj.Subdivisions


def heading_deg(obj) -> float:
    """Direction of the longest line."""
    pairs = [p for s in strokes_of(obj) if s.kind == "lines" for p in zip(s.points, s.points[1:])]
    (ax, ay), (bx, by) = max(pairs, key=lambda p: distance(*p), default=((0.0, 0.0), (1.0, 0.0)))
    return math.degrees(math.atan2(by - ay, bx - ax))


def strokes_of(obj) -> List[Stroke]:
    outer = hosted.outer_placement(obj)
    if is_plain_wire(obj):
        place = outer.multiply(obj.Placement)
        points = [flat(place.multVec(p)) for p in obj.Points]
        return [Stroke("lines", points, bool(obj.Closed) and len(points) > 2)]
    return [_stroke(e) for e in document.shape_of(obj).Edges]


def flat(p: Vector):
    return (round(p.x, 7) + 0.0, round(p.y, 7) + 0.0)


def _stroke(edge) -> Stroke:
    curve = edge.Curve
    if curve.TypeId == "Part::GeomLine":
        return Stroke("lines", [flat(v.Point) for v in edge.Vertexes])
    if curve.TypeId != "Part::GeomCircle":
        return Stroke("lines", [flat(p) for p in edge.discretize(Deflection=document.CHORD_MM)])
    centre = flat(curve.Center)
    if edge.isClosed():
        return Stroke("circle", [centre], True, centre, curve.Radius)
    ends = [flat(edge.valueAt(t)) for t in (edge.FirstParameter, edge.LastParameter)]
    return Stroke("arc", ends if curve.Axis.z > 0 else ends[::-1], False, centre, curve.Radius)


def move(obj, made: Drawn, change) -> None:
    """Moves what is drawn. Draft lines take their points, never a placement: their undo would come back wrong."""
    after = list(change.axis_after)
    rings = [[after.pop(0) for _ in s.points] for s in made.strokes]
    if is_plain_wire(obj):
        z = obj.Placement.multVec(obj.Points[0]).z
        back = obj.Placement.inverse()
        obj.Points = [back.multVec(Vector(x, y, z)) for x, y in rings[0]]
    elif change.motion is not None:
        obj.Placement = hosted.placement(change.motion).multiply(obj.Placement)
    elif obj.TypeId == "Part::Line":
        a, b = (obj.Placement.inverse().multVec(Vector(*p, 0)) for p in rings[0])
        obj.X1, obj.Y1, obj.X2, obj.Y2 = a.x, a.y, b.x, b.y
    elif obj.TypeId == "Part::Feature" and not made.is_stiff:
        obj.Shape = _stretched(obj.Shape, made, rings)
    else:
        raise PluginError(f"'{obj.Label}' can only move as a whole; nothing was changed.")


def _stretched(shape, made: Drawn, rings):
    edges = [_moved(edge, stroke, ring) for edge, stroke, ring in zip(shape.Edges, made.strokes, rings)]
    if shape.ShapeType == "Edge":
        return edges[0]
    return Part.Wire(edges) if shape.ShapeType == "Wire" else Part.makeCompound(edges)


def _moved(edge, stroke: Stroke, ring):
    if ring == stroke.points:
        return edge.copy()
    if stroke.kind == "lines":
        z = edge.Vertexes[0].Point.z
        return Part.makeLine(*(Vector(x, y, z) for x, y in ring))
    motion: Rigid = strokes.motion_of(stroke, ring)
    out = edge.copy()
    out.Placement = hosted.placement(motion).multiply(out.Placement)
    return out
