"""The objects of a 2D plan drawn anew where building works cut them: what stays keeps its object, what is new is drawn
like it."""

import math
from typing import List

import Draft
import FreeCAD as App
import Part

from enfilade_common import drawn as strokes
from enfilade_common.model import Stroke

from . import document, marks, plan2d
from .document import Found, Vector
from .walls import join_groups, look_like


def is_curved(obj, stroke: int) -> bool:
    """Whether a stroke of lines stands for a curve."""
    if plan2d.is_plain_wire(obj):
        return False
    return obj.Shape.Edges[stroke].Curve.TypeId != "Part::GeomLine"


def redraw(doc, found: Found, stays: List[list], added: List[Stroke]) -> None:
    """Draws an object anew: what stays of each stroke, and what is added on its layer. Inside a transaction."""
    obj = found.object
    z = _height(obj)
    is_whole = all(len(p) == 1 and p[0].points == s.points for p, s in zip(stays, found.element.strokes))
    if obj.TypeId == "Part::Feature" and obj.Shape.ShapeType == "Compound":
        edges = [e for edge, pieces, s in zip(obj.Shape.Edges, stays, found.element.strokes) for e in _edges(edge, pieces, s, z)]
        edges += [_edge(s, z) for s in added]
        if edges:
            obj.Shape = Part.makeCompound(edges)
        else:
            doc.removeObject(obj.Name)
        return
    for stroke in added:
        _take_over(obj, _drawn(obj, stroke, z))
    if not is_whole:
        _redraw_lines(doc, obj, stays, found.element.strokes, z)


def _redraw_lines(doc, obj, stays: List[list], drawn: List[Stroke], z: float) -> None:
    pieces = sorted((p for ps, s in zip(stays, drawn) if s.kind == "lines" for p in ps), key=_length, reverse=True)
    rounds = [s for ps, s in zip(stays, drawn) if s.kind != "lines" and ps]
    is_one = plan2d.is_plain_wire(obj) or obj.TypeId == "Part::Line" or obj.TypeId == "Part::Feature" and not rounds
    rest = pieces[1:] if is_one else pieces
    for piece in rest:
        _take_over(obj, _chain(obj, piece.points, piece.closed, z))
    for stroke in rounds:
        _take_over(obj, _drawn(obj, stroke, z))
    if is_one and pieces:
        _become(obj, pieces[0], z)
    else:
        doc.removeObject(obj.Name)


def _length(piece) -> float:
    return sum(math.dist(a, b) for a, b in piece.lines())


def _height(obj) -> float:
    if plan2d.is_plain_wire(obj):
        return obj.Placement.multVec(obj.Points[0]).z
    return document.shape_of(obj).BoundBox.ZMin


def _take_over(of, made) -> None:
    join_groups(of, made)
    look_like(of, made)
    marks.copy(of, made)
    if of.TypeId == "Part::Feature":
        made.Label = of.Label


def _become(obj, piece, z: float) -> None:
    """The object itself is what stays."""
    points = [Vector(x, y, z) for x, y in piece.points]
    if plan2d.is_plain_wire(obj):
        back = obj.Placement.inverse()
        if obj.Closed and not piece.closed:
            obj.Closed = False
        obj.Points = [back.multVec(p) for p in points]
    elif obj.TypeId == "Part::Line":
        a, b = (obj.Placement.inverse().multVec(p) for p in points)
        obj.X1, obj.Y1, obj.X2, obj.Y2 = a.x, a.y, b.x, b.y
    else:
        obj.Shape = _polyline(points, piece.closed)


def _chain(like, points, closed: bool, z: float):
    """A new object of lines, of the kind of another one."""
    corners = [Vector(x, y, z) for x, y in points]
    if like.TypeId == "Part::Feature":
        made = like.Document.addObject("Part::Feature", "Shape")
        made.Shape = _polyline(corners, closed)
        return made
    if len(corners) == 2:
        return Draft.make_line(*corners)
    return Draft.make_wire(corners, closed=closed, face=False)


def _polyline(points, closed: bool):
    ring = points + points[:1] if closed else points
    edges = [Part.makeLine(a, b) for a, b in zip(ring, ring[1:])]
    return edges[0] if len(edges) == 1 else Part.Wire(edges)


def _drawn(like, stroke: Stroke, z: float):
    if stroke.kind == "lines":
        return _chain(like, stroke.points, stroke.closed, z)
    if like.TypeId == "Part::Feature":
        made = like.Document.addObject("Part::Feature", "Shape")
        made.Shape = _edge(stroke, z)
        return made
    place = App.Placement(Vector(*stroke.centre, z), App.Rotation())
    begin, end = _angles(stroke)
    return Draft.make_circle(stroke.radius, place, False, begin, end)


def _angles(stroke: Stroke):
    if stroke.kind == "circle":
        return 0.0, 360.0
    begin, end = strokes.angles_deg(stroke)
    return begin, end if end > begin else end + 360.0


def _edges(edge, pieces: list, stroke: Stroke, z: float) -> list:
    """What stays of an edge of an imported shape."""
    if len(pieces) == 1 and pieces[0].points == stroke.points:
        return [edge.copy()]
    return [Part.makeLine(Vector(*a, z), Vector(*b, z)) for p in pieces for a, b in p.lines()]


def _edge(stroke: Stroke, z: float):
    if stroke.kind == "lines":
        return Part.makeLine(*(Vector(*p, z) for p in stroke.points))
    return Part.makeCircle(stroke.radius, Vector(*stroke.centre, z), Vector(0, 0, 1), *_angles(stroke))
