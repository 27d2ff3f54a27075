"""What is drawn over the 3D view without touching the document: arrows of marks, heat map, ghost walls.

Everything hangs in one Coin node of the view; nothing can be picked, saved or undone.
"""

import math
from typing import List, Tuple

from pivy import coin

from enfilade_common.moves import heading
from enfilade_common.plane import Point
from enfilade_common.preview import Cells

from . import document, marks, plan2d

ORANGE = (1.0, 0.45, 0.0)
RED = (0.85, 0.0, 0.0)
MOVED = (0.85, 0.0, 0.38)
BEFORE = (0.1, 0.1, 0.12)
BEST = (0.0, 0.45, 0.85)
REGION_COLOURS = {"query": (0.1, 0.3, 0.9), "reference": (0.1, 0.6, 0.2), "keep": (0.5, 0.5, 0.5)}

#: The program's colours from little to much, evenly spread.
RAMP = tuple(
    tuple(int(c[i : i + 2], 16) / 255 for i in (0, 2, 4))
    for c in ("440154", "482878", "3e4989", "31688e", "26828e", "1f9e89", "35b779", "6ece58", "b5de2b", "fde725")
)

#: Above the floor and above the walls, mm, so that nothing flickers.
CLEAR_MM = 15.0
HEAD_MM = 140.0
ARC_MM = 700.0


class Overlay:
    """Our node in one view."""

    def __init__(self, view):
        self._scene = view.getSceneGraph()
        self._root = coin.SoSeparator()
        self._root.setName("EnfiladeOverlay")
        picking = coin.SoPickStyle()
        picking.style = coin.SoPickStyle.UNPICKABLE
        light = coin.SoLightModel()
        light.model = coin.SoLightModel.BASE_COLOR
        self._root.addChild(picking)
        self._root.addChild(light)
        self._parts = {}
        for name in ("marks", "heat", "ghost", "best"):
            self._parts[name] = coin.SoSeparator()
            self._root.addChild(self._parts[name])
        self._scene.addChild(self._root)

    def remove(self) -> None:
        if self._scene is not None and self._scene.findChild(self._root) >= 0:
            self._scene.removeChild(self._root)
        self._scene = None

    def clear(self, *names: str) -> None:
        for name in names or self._parts:
            self._parts[name].removeAllChildren()

    def is_empty(self, name: str) -> bool:
        return self._parts[name].getNumChildren() == 0

    def show_marks(self, doc, scale: float) -> None:
        """Arrows and arcs of every marked object, dashes along what may be rebuilt, outlines of regions; ``scale`` are
        units of the document in a mm of the building."""
        part = self._parts["marks"]
        part.removeAllChildren()
        lines, groups, rebuilt = [], set(), []
        for obj in doc.Objects:
            if document.is_link(obj):
                continue
            region = marks.region_kind(obj)
            if region and hasattr(obj, "Shape") and not obj.Shape.isNull():
                z = obj.Shape.BoundBox.ZMax + CLEAR_MM
                rings = [document._ring(w) for w in obj.Shape.Wires if w.isClosed()]
                _add_lines(part, [r + r[:1] for r in rings], z, REGION_COLOURS[region], 3)
            elif hasattr(obj, "EnfiladeId") and getattr(obj, "Shape", None) is not None:
                # Lines of one group are mostly one wall: its arrows once.
                group = marks.group(obj) if plan2d.is_line(obj) else ""
                lines.append((obj, [] if group and group in groups else arrows(obj, scale)))
                groups.add(group)
                rebuilt += _middles(obj) if marks.works(obj) else []
        top = max((o.Shape.BoundBox.ZMax for o, _ in lines), default=0.0) + CLEAR_MM
        _add_lines(part, [line for _, many in lines for line in many], top, ORANGE, 3)
        _add_lines(part, rebuilt, top + CLEAR_MM, RED, 4, 0xFF00)

    def show_heat(self, cells: Cells, measure: str, span: Tuple[float, float], size: float, z: float) -> None:
        """A coloured square for every cell, ``size`` mm wide, just above the floor."""
        part = self._parts["heat"]
        part.removeAllChildren()
        half, values = size / 2, cells.values[measure]
        material = coin.SoMaterial()
        material.diffuseColor.setValues(0, len(values), [list(colour(v, span)) for v in values])
        material.transparency.setValue(0.1)
        binding = coin.SoMaterialBinding()
        binding.value = coin.SoMaterialBinding.PER_FACE
        coordinates = coin.SoCoordinate3()
        corners = ((-half, -half), (half, -half), (half, half), (-half, half))
        points = [[x + dx, y + dy, z + CLEAR_MM] for x, y in cells.places for dx, dy in corners]
        coordinates.point.setValues(0, len(points), points)
        faces = coin.SoFaceSet()
        faces.numVertices.setValues(0, len(values), [4] * len(values))
        hints = coin.SoShapeHints()
        hints.vertexOrdering = coin.SoShapeHints.UNKNOWN_ORDERING
        for node in (hints, material, binding, coordinates, faces):
            part.addChild(node)

    def show_ghosts(self, before: List[List[Point]], after: List[List[Point]], z: float, colour) -> None:
        """Lines that stand there now and would go (dashed), and lines that would come."""
        part = self._parts["ghost"]
        part.removeAllChildren()
        _add_lines(part, before, z + CLEAR_MM, BEFORE, 2, 0xF0F0)
        _add_lines(part, after, z + 2 * CLEAR_MM, colour, 4)

    def show_best(self, lines: List[List[Point]], z: float, colour) -> None:
        """Lines of the best layout so far."""
        part = self._parts["best"]
        part.removeAllChildren()
        _add_lines(part, lines, z + 3 * CLEAR_MM, colour, 3)


def colour(value: float, span: Tuple[float, float]) -> Tuple[float, float, float]:
    """Red, green, blue of a value between the least and the most."""
    low, high = span
    at = (value - low) / (high - low) * (len(RAMP) - 1) if high > low else 0.0
    i = max(0, min(int(at), len(RAMP) - 2))
    share = max(0.0, min(at - i, 1.0))
    a, b = RAMP[i], RAMP[i + 1]
    return (a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2]))


def _add_lines(part, lines, z: float, colour, width: int, pattern: int = 0xFFFF) -> None:
    lines = [line for line in lines if len(line) > 1]
    if not lines:
        return
    group = coin.SoSeparator()
    base = coin.SoBaseColor()
    base.rgb = colour
    style = coin.SoDrawStyle()
    style.lineWidth, style.linePattern = width, pattern
    coordinates = coin.SoCoordinate3()
    points = [[x, y, z] for line in lines for x, y in line]
    coordinates.point.setValues(0, len(points), points)
    strips = coin.SoLineSet()
    strips.numVertices.setValues(0, len(lines), [len(line) for line in lines])
    for node in (base, style, coordinates, strips):
        group.addChild(node)
    part.addChild(group)


def arrows(obj, scale: float = 1.0) -> List[List[Point]]:
    """Lines that show the allowed moves of an object from its middle."""
    if obj.Shape.isNull():
        return []
    box = obj.Shape.BoundBox
    middle = (box.Center.x, box.Center.y)
    out: List[List[Point]] = []
    for clause in marks.clauses(obj, _direction_deg(obj)):
        if clause.kind == "rotate":
            for end in (clause.lower, clause.upper):
                out += _arc(middle, end, scale)
            continue
        u = heading(clause)
        for value in (clause.lower, clause.upper):
            if value:
                way = value * scale
                out += _arrow(middle, (middle[0] + u[0] * way, middle[1] + u[1] * way), scale)
    return out


def _middles(obj) -> List[List[Point]]:
    """Lines along an object: its axis, what is drawn of it, or the longer way across it."""
    if document.kind_of(obj) == "Wall" and document.axes(obj):
        return [points + points[:1] if closed else points for points, closed, _ in document.axes(obj)]
    if plan2d.is_line(obj):
        return [s.points for s in plan2d.strokes_of(obj) if s.kind == "lines"]
    box = obj.Shape.BoundBox
    c = box.Center
    if box.XLength > box.YLength:
        return [[(box.XMin, c.y), (box.XMax, c.y)]]
    return [[(c.x, box.YMin), (c.x, box.YMax)]]


def _direction_deg(obj) -> float:
    """Direction of a wall's axis, or of the wall a door stands in."""
    hosts = getattr(obj, "Hosts", None) or []
    wall = hosts[0] if hosts else obj
    if document.kind_of(wall) != "Wall":
        return plan2d.heading_deg(obj) if plan2d.is_line(obj) else 0.0
    chains = document.axes(wall)
    if not chains:
        return 0.0
    (ax, ay), (bx, by) = chains[0][0][:2]
    return math.degrees(math.atan2(by - ay, bx - ax))


def _arrow(a: Point, b: Point, scale: float) -> List[List[Point]]:
    angle = math.atan2(b[1] - a[1], b[0] - a[0])
    size = min(HEAD_MM * scale, math.dist(a, b))
    wings = [(b[0] - size * math.cos(angle + s), b[1] - size * math.sin(angle + s)) for s in (-0.45, 0.45)]
    return [[a, b], [wings[0], b, wings[1]]]


def _arc(middle: Point, end_deg: float, scale: float) -> List[List[Point]]:
    """An arc from the east towards ``end_deg`` with an arrow head."""
    if not end_deg:
        return []
    count = max(2, int(abs(end_deg) / 5) + 1)
    angles = [math.radians(end_deg * i / count) for i in range(count + 1)]
    size = ARC_MM * scale
    points = [(middle[0] + size * math.cos(a), middle[1] + size * math.sin(a)) for a in angles]
    return [points, *_arrow(points[-2], points[-1], scale)[1:]]
