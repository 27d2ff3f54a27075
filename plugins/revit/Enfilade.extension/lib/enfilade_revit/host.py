"""Revit itself, behind the few calls the rest needs. Revit counts in feet; we in millimetres.

Nothing of this module has ever run in Revit: it is checked against the published stubs of its API, and
everything behind it is tested with a fake of the same shape (plugins/tests/revit).
"""

import contextlib
import math
import os
from typing import Iterator, List, Optional, Tuple

from Autodesk.Revit.DB import (
    BuiltInCategory,
    BuiltInParameter,
    CurveElement,
    DXFExportOptions,
    ElementId,
    ElementTransformUtils,
    ExportUnit,
    FamilyInstance,
    FilteredElementCollector,
    GeometryInstance,
    IFCExportOptions,
    IFCVersion,
    Line,
    LocationPoint,
    Options,
    PlanarFace,
    Solid,
    Transaction,
    TransactionGroup,
    TransactionStatus,
    Wall,
    WallUtils,
    XYZ,
)

from enfilade_common.model import PluginError
from enfilade_common.plane import direction, left_of, dot, minus

from .data import (
    GROUP_PARAMETER,
    KEEP_PARAMETER,
    MOVES_PARAMETER,
    DetailLine,
    Point,
    RevitColumn,
    RevitInsert,
    RevitWall,
)

FOOT_MM = 304.8

#: Where a door or window keeps its width.
WIDTHS = (BuiltInParameter.DOOR_WIDTH, BuiltInParameter.WINDOW_WIDTH, BuiltInParameter.FAMILY_WIDTH_PARAM)


def element_number(id) -> int:
    """An element id as a number: ``Value`` since Revit 2024, ``IntegerValue`` before."""
    return int(id.Value) if hasattr(id, "Value") else int(id.IntegerValue)


def to_mm(p) -> Point:
    return (p.X * FOOT_MM, p.Y * FOOT_MM)


class Host:
    """The active document and view."""

    def __init__(self, uidoc):
        self._doc = uidoc.Document
        self._view = uidoc.ActiveView

    # -- reading

    def document_id(self) -> str:
        return str(self._doc.ProjectInformation.UniqueId)

    def document_folder(self) -> str:
        path = self._doc.PathName
        return os.path.dirname(path) if path and os.path.isdir(os.path.dirname(path)) else ""

    def document_name(self) -> str:
        return str(self._doc.Title)

    def level_name(self) -> str:
        level = getattr(self._view, "GenLevel", None)
        return str(level.Name) if level is not None else ""

    def exists(self, id: int) -> bool:
        return self._doc.GetElement(ElementId(id)) is not None

    def _visible(self, category) -> Iterator:
        collector = FilteredElementCollector(self._doc, self._view.Id)
        return iter(collector.OfCategory(category).WhereElementIsNotElementType().ToElements())

    def walls(self) -> List[RevitWall]:
        out = []
        for wall in self._visible(BuiltInCategory.OST_Walls):
            if not isinstance(wall, Wall):
                continue
            curve = getattr(wall.Location, "Curve", None)
            axis = [to_mm(curve.GetEndPoint(i)) for i in (0, 1)] if isinstance(curve, Line) else None
            left, right = self._faces(wall, axis)
            rings = [] if axis else self._outlines(wall)
            label = f"{wall.Name} {element_number(wall.Id)}"
            id, pinned = element_number(wall.Id), bool(wall.Pinned)
            out.append(RevitWall(id, label, axis, left, right, rings, self._marks(wall), pinned))
        return out

    def _faces(self, wall, axis: Optional[List[Point]]) -> Tuple[float, float]:
        """Distances of the finish faces from the location line. Its place in the wall is a setting of the
        wall; where the wall really stands is told by its solid."""
        half = wall.Width * FOOT_MM / 2
        if axis is None:
            return half, half
        points = [p for ring in self._outlines(wall) for p in ring]
        if not points:
            return half, half
        normal = left_of(direction(axis[0], axis[1]))
        across = [dot(minus(p, axis[0]), normal) for p in points]
        middle = (max(across) + min(across)) / 2
        return half + middle, half - middle

    def inserts(self) -> List[RevitInsert]:
        out = []
        for category, is_window in ((BuiltInCategory.OST_Doors, False), (BuiltInCategory.OST_Windows, True)):
            for insert in self._visible(category):
                if not isinstance(insert, FamilyInstance) or insert.Host is None:
                    continue
                if not isinstance(insert.Location, LocationPoint):
                    continue
                width = self._width(insert)
                if width is None:
                    continue
                out.append(
                    RevitInsert(
                        element_number(insert.Id),
                        f"{insert.Name} {element_number(insert.Id)}",
                        element_number(insert.Host.Id),
                        to_mm(insert.Location.Point),
                        width,
                        is_window,
                        self._marks(insert),
                    )
                )
        return out

    def _width(self, insert) -> Optional[float]:
        for owner in (insert, insert.Symbol):
            for name in WIDTHS:
                parameter = owner.get_Parameter(name)
                if parameter is not None and parameter.HasValue and parameter.AsDouble() > 0:
                    return parameter.AsDouble() * FOOT_MM
        return None

    def columns(self) -> List[RevitColumn]:
        out = []
        for category in (BuiltInCategory.OST_Columns, BuiltInCategory.OST_StructuralColumns):
            for column in self._visible(category):
                rings = self._outlines(column)
                if rings:
                    id, ring = element_number(column.Id), max(rings, key=len)
                    label = f"{column.Name} {id}"
                    out.append(RevitColumn(id, label, ring, self._marks(column), bool(column.Pinned)))
        return out

    def _outlines(self, element) -> List[List[Point]]:
        """Outer loops of an element's downward faces."""
        options = Options()
        out: List[List[Point]] = []
        for solid in _solids(element.get_Geometry(options)):
            for face in solid.Faces:
                if isinstance(face, PlanarFace) and face.FaceNormal.Z < -0.99:
                    loops = list(face.GetEdgesAsCurveLoops())
                    # A CurveLoop is a sequence of curves; the stub does not say so.
                    curves = list(loops[0])  # type: ignore[call-overload]
                    points = [to_mm(p) for curve in curves for p in list(curve.Tessellate())[:-1]]
                    if len(points) > 2:
                        out.append(points)
        return out

    def detail_lines(self) -> List[DetailLine]:
        out: List[DetailLine] = []
        for line in self._visible(BuiltInCategory.OST_Lines):
            if isinstance(line, CurveElement) and line.LineStyle is not None:
                points = [to_mm(p) for p in line.GeometryCurve.Tessellate()]
                out.extend(DetailLine(str(line.LineStyle.Name), a, b) for a, b in zip(points, points[1:]))
        return out

    def _marks(self, element) -> dict:
        out = {}
        for name in (MOVES_PARAMETER, GROUP_PARAMETER, KEEP_PARAMETER):
            parameter = element.LookupParameter(name)
            if parameter is not None and parameter.HasValue:
                out[name] = str(parameter.AsString() or parameter.AsValueString() or "")
        return out

    # -- changing

    @contextlib.contextmanager
    def transaction_group(self, name: str):
        """One entry of the undo list for all inside; all of it is rolled back when anything fails."""
        group = TransactionGroup(self._doc, name)
        group.Start()
        try:
            yield
        except BaseException:
            group.RollBack()
            raise
        group.Assimilate()

    @contextlib.contextmanager
    def transaction(self, name: str):
        transaction = Transaction(self._doc, name)
        transaction.Start()
        try:
            yield
        except BaseException:
            transaction.RollBack()
            raise
        if transaction.Commit() != TransactionStatus.Committed:
            raise PluginError("Revit refused the new places; nothing was changed.")

    def set_wall_line(self, id: int, a: Point, b: Point) -> None:
        """Gives a wall a new location line. Joins are let go first: they would pull its ends back."""
        wall = self._doc.GetElement(ElementId(id))
        z = wall.Location.Curve.GetEndPoint(0).Z
        allowed = [WallUtils.IsWallJoinAllowedAtEnd(wall, end) for end in (0, 1)]
        for end in (0, 1):
            WallUtils.DisallowWallJoinAtEnd(wall, end)
        start, finish = (XYZ(p[0] / FOOT_MM, p[1] / FOOT_MM, z) for p in (a, b))
        wall.Location.Curve = Line.CreateBound(start, finish)
        for end in (0, 1):
            if allowed[end]:
                WallUtils.AllowWallJoinAtEnd(wall, end)

    def move(self, id: int, angle_rad: float, shift: Point) -> None:
        """Turns an element about the project's zero point, then shifts it."""
        element = ElementId(id)
        if abs(angle_rad) > 1e-9:
            ElementTransformUtils.RotateElement(
                self._doc, element, Line.CreateBound(XYZ(0, 0, 0), XYZ(0, 0, 1)), angle_rad
            )
        if math.hypot(*shift) > 0.0:
            ElementTransformUtils.MoveElement(self._doc, element, XYZ(shift[0] / FOOT_MM, shift[1] / FOOT_MM, 0))

    # -- Revit's own exports

    def export_dxf(self, folder: str, name: str) -> None:
        """The view as DXF: AIA layers, shared coordinates, millimetres."""
        from System.Collections.Generic import List as NetList  # type: ignore[import-untyped]

        options = DXFExportOptions()
        options.LayerMapping = "AIA"
        options.SharedCoords = True
        # The stub gives members of enumerations as numbers.
        options.TargetUnit = ExportUnit.Millimeter  # type: ignore[assignment]
        views = NetList[ElementId]()
        views.Add(self._view.Id)
        if not self._doc.Export(folder, name, views, options):
            raise PluginError(f"Revit did not write {name} to {folder}.")

    def export_ifc(self, folder: str, name: str) -> None:
        """What the view shows as IFC 4. Revit wants an open transaction for it; it is rolled back."""
        options = IFCExportOptions()
        options.FileVersion = IFCVersion.IFC4  # type: ignore[assignment]
        options.FilterViewId = self._view.Id
        transaction = Transaction(self._doc, "Enfilade: IFC export")
        transaction.Start()
        try:
            done = self._doc.Export(folder, name, options)
        finally:
            transaction.RollBack()
        if not done:
            raise PluginError(f"Revit did not write {name} to {folder}.")


def _solids(geometry) -> Iterator:
    for part in geometry or ():
        if isinstance(part, Solid) and part.Volume > 0:
            yield part
        elif isinstance(part, GeometryInstance):
            yield from _solids(part.GetInstanceGeometry())
