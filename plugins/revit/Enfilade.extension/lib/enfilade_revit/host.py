"""Revit itself, behind the few calls the rest needs. Revit counts in feet; we in millimetres.

Nothing of this module has ever run in Revit. Its calls are checked against the published stubs of Revit's API, and
each of its lines runs in tests over a fake of that API (plugins/tests/revit/fake).

A wall that keeps its length is moved by ``ElementTransformUtils``, as the Move and Rotate commands do it: doors,
windows and all else that it carries go along, and its joins stay. Its location line is only given new bounds, and only
where its length changes: a new line in its place makes Revit work out anew where everything in the wall stands.
"""

import contextlib
import math
import os
import shutil
import tempfile
import uuid
from typing import Callable, Dict, Iterator, List, Optional, Tuple

from Autodesk.Revit.DB import (
    BuiltInCategory,
    BuiltInParameter,
    Category,
    CategorySet,
    CurveElement,
    DesignOption,
    DXFExportOptions,
    ElementId,
    ElementOnPhaseStatus,
    ElementTransformUtils,
    ExportUnit,
    ExternalDefinitionCreationOptions,
    FailureProcessingResult,
    FailureSeverity,
    FamilyInstance,
    FilteredElementCollector,
    GeometryInstance,
    GroupTypeId,
    IFailuresPreprocessor,
    IFCExportOptions,
    IFCVersion,
    InstanceBinding,
    Line,
    LocationPoint,
    Opening,
    Options,
    PlanarFace,
    PlanViewPlane,
    RevitLinkInstance,
    Solid,
    SpecTypeId,
    StorageType,
    Transaction,
    TransactionGroup,
    TransactionStatus,
    ViewPlan,
    ViewType,
    Wall,
    WallKind,
    WallUtils,
    XYZ,
)
from Autodesk.Revit.Exceptions import ApplicationException as RevitException
from System import Guid, Int64  # type: ignore[import-untyped]
from System.Collections.Generic import List as NetList  # type: ignore[import-untyped]

from enfilade_common.model import PluginError
from enfilade_common.plane import Rigid, centroid, cross, direction, distance, dot, left_of, minus, turn_about

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

#: Where a door or window keeps its width: ``DOOR_WIDTH`` is that of windows and families too.
WIDTHS = (BuiltInParameter.DOOR_WIDTH, BuiltInParameter.FAMILY_ROUGH_WIDTH_PARAM)

#: Faces nearer than this in height are one; an opening with its sill higher is no passage, feet.
LEVEL_FT, SILL_FT = 0.01, 0.4

#: Our shared parameters, what they hold, and the names by which other models know them again.
# The stubs put the classes inside ``SpecTypeId`` beside it.
PARAMETERS = (
    (MOVES_PARAMETER, SpecTypeId.String.Text, "4f0d1b55-8f0c-4b12-9d5e-5a3d6c1be001"),  # type: ignore[attr-defined]
    (GROUP_PARAMETER, SpecTypeId.String.Text, "4f0d1b55-8f0c-4b12-9d5e-5a3d6c1be002"),  # type: ignore[attr-defined]
    (KEEP_PARAMETER, SpecTypeId.Boolean.YesNo, "4f0d1b55-8f0c-4b12-9d5e-5a3d6c1be003"),  # type: ignore[attr-defined]
)
BOUND_TO = (
    BuiltInCategory.OST_Walls,
    BuiltInCategory.OST_Doors,
    BuiltInCategory.OST_Windows,
    BuiltInCategory.OST_Columns,
    BuiltInCategory.OST_StructuralColumns,
)


class _Failures(IFailuresPreprocessor):
    """Warnings are kept to be told at the end; errors roll back. No dialog opens in the middle of an option."""

    # pythonnet makes a .NET type of this class each time Python reads it; two of one name are an error.
    __namespace__ = "Enfilade" + uuid.uuid4().hex

    said: List[str] = []

    def PreprocessFailures(self, failuresAccessor):
        result = FailureProcessingResult.Continue
        for failure in list(failuresAccessor.GetFailureMessages()):
            self.said.append(str(failure.GetDescriptionText()))
            if failure.GetSeverity() == FailureSeverity.Warning:
                failuresAccessor.DeleteWarning(failure)
            else:
                result = FailureProcessingResult.ProceedWithRollBack
        return result


#: One for all transactions: Revit was seen to hang on objects of Python that were handed to it and then dropped.
_FAILURES = _Failures()


def element_id(number: int) -> ElementId:
    """Python's ``int`` fits three constructors, so the kind of number is named."""
    return ElementId(Int64(number))


def element_number(id) -> int:
    return int(id.Value)


def to_mm(p) -> Point:
    return (p.X * FOOT_MM, p.Y * FOOT_MM)


@contextlib.contextmanager
def _plainly():
    """What Revit throws, as a sentence."""
    try:
        yield
    except RevitException as e:  # type: ignore[misc]
        raise PluginError(f"Revit refuses: {e.Message} Nothing was changed.") from e


class Host:
    """One document and one plan view of it: those that are active when it is made."""

    def __init__(self, uidoc):
        if uidoc is None or uidoc.Document.IsFamilyDocument:
            raise PluginError("Open a project first.")
        self._doc, self._view = uidoc.Document, uidoc.ActiveView
        #: What Revit warned of in our transactions.
        self.warnings: List[str] = []
        kinds = (ViewType.FloorPlan, ViewType.EngineeringPlan)
        if not isinstance(self._view, ViewPlan) or self._view.ViewType not in kinds:
            raise PluginError(f"'{self._view.Name}' is no floor plan. Open the floor plan of one storey and try again.")

    # -- which

    def document_id(self) -> str:
        """The document and the view that it is seen through."""
        return f"{self._doc.CreationGUID}/{self._view.UniqueId}"

    def bind(self, document: str) -> None:
        """Looks through the view of an earlier :meth:`document_id`; refuses that of another document."""
        model, _, view = document.partition("/")
        if model != str(self._doc.CreationGUID):
            raise PluginError(
                f"The study is of another model than '{self._doc.Title}'. Open that model, or export this one again."
            )
        found = self._doc.GetElement(view)
        if not isinstance(found, ViewPlan):
            raise PluginError("The plan view of the study is gone. Export again.")
        self._view = found

    def document_folder(self) -> str:
        path = self._doc.PathName
        return os.path.dirname(path) if path and os.path.isdir(os.path.dirname(path)) else ""

    def document_name(self) -> str:
        return str(self._doc.Title)

    def level_name(self) -> str:
        return str(self._view.GenLevel.Name)

    # -- reading

    def _visible(self, category) -> List:
        collector = FilteredElementCollector(self._doc, self._view.Id)
        return list(collector.OfCategory(category).WhereElementIsNotElementType().ToElements())

    def _those(self, ids) -> List:
        found = (self._doc.GetElement(element_id(id)) for id in ids)
        return [element for element in found if element is not None]

    def walls(self, ids: Optional[List[int]] = None) -> List[RevitWall]:
        """Walls that the view shows; those of ``ids`` whether or not it shows them."""
        found: Dict[int, object] = {}
        for element in self._visible(BuiltInCategory.OST_Walls) if ids is None else self._those(ids):
            parts = [element]
            if isinstance(element, Wall) and element.IsStackedWall:
                parts = [self._doc.GetElement(id) for id in element.GetStackedWallMemberIds()]
            found.update((element_number(part.Id), part) for part in parts)
        out = [self._wall(element) for element in found.values()]
        # A wall of glass in a wall is an opening of that wall.
        inside = {insert.element_id for wall in out for insert in wall.inserts}
        return [wall for wall in out if wall.element_id not in inside]

    def _wall(self, wall) -> RevitWall:
        id = element_number(wall.Id)
        made = RevitWall(id, f"{wall.Name} {id}", left_out=self._left_out(wall), fixed=self._fixed(wall))
        if not isinstance(wall, Wall):
            made.left_out = "built in place"
        elif wall.WallType.Kind == WallKind.Curtain:
            made.left_out = "curtain wall"
        if made.left_out:
            return made
        curve = wall.Location.Curve
        made.ends = [to_mm(curve.GetEndPoint(i)) for i in (0, 1)]
        if isinstance(curve, Line):
            made.axis = list(made.ends)
        outlines = self._outlines(wall, min)
        made.left, made.right = self._faces(wall, made.axis, outlines)
        made.rings = [] if made.axis else outlines
        made.parameters = self._marks(wall)
        made.inserts = [self._insert(wall, self._doc.GetElement(i)) for i in wall.FindInserts(True, False, True, False)]
        if wall.IsStackedWallMember:
            made.fixed = made.fixed or "it is part of a stacked wall"
        return made

    def _left_out(self, element) -> str:
        """Why an element is no part of the plan; empty where it is."""
        phase = self._view.get_Parameter(BuiltInParameter.VIEW_PHASE).AsElementId()
        if element.GetPhaseStatus(phase) not in (ElementOnPhaseStatus.New, ElementOnPhaseStatus.Existing):
            return "not standing in the phase of this view"
        option = element.DesignOption
        if option is not None and not option.IsPrimary and not self._is_edited(option):
            return "in a design option that is neither primary nor being edited"
        box = element.get_BoundingBox(None)
        if box is None:
            return "without a body"
        # The cut plane is the level's; ``ProjectElevation`` counts from where Z does.
        cut = self._cut()
        if box.Max.Z <= cut:
            return "below the cut plane of this view"
        return "above the cut plane of this view" if box.Min.Z >= cut else ""

    def _cut(self) -> float:
        """Height of the cut plane, feet."""
        offset = self._view.GetViewRange().GetOffset(PlanViewPlane.CutPlane)
        return self._view.GenLevel.ProjectElevation + offset

    def _is_edited(self, option) -> bool:
        return element_number(DesignOption.GetActiveDesignOptionId(self._doc)) == element_number(option.Id)

    def _fixed(self, element) -> str:
        """Why an element cannot be moved; empty where it can."""
        if element.Pinned:
            return "it is pinned in Revit"
        group = self._doc.GetElement(element.GroupId)
        if group is not None:
            return f"it is in the group '{group.Name}'"
        option = element.DesignOption
        if option is not None and not self._is_edited(option):
            return f"it is in the design option '{option.Name}', which is not being edited"
        return ""

    def _faces(self, wall, axis: Optional[List[Point]], outlines: List[List[Point]]) -> Tuple[float, float]:
        """Distances of the finish faces from the location line. Its place in the wall is a setting of the
        wall; where the wall really stands, its solid says."""
        half = wall.Width * FOOT_MM / 2
        points = [p for ring in outlines for p in ring]
        if axis is None or not points:
            return half, half
        normal = left_of(direction(axis[0], axis[1]))
        across = [dot(minus(p, axis[0]), normal) for p in points]
        middle = (max(across) + min(across)) / 2
        return half + middle, half - middle

    def _insert(self, wall, insert) -> RevitInsert:
        id = element_number(insert.Id)
        made = RevitInsert(id, f"{insert.Name} {id}", element_number(wall.Id), None, 0.0, False)
        made.fixed, made.closed = self._fixed(insert), self._left_out(insert)
        if isinstance(insert, Wall):
            made.is_window = True
            curve = insert.Location.Curve  # type: ignore[attr-defined]
            _span(made, [curve.GetEndPoint(0), curve.GetEndPoint(1)])
        elif isinstance(insert, Opening) and insert.IsRectBoundary:
            corners = list(insert.BoundaryRect)
            made.is_window = min(p.Z for p in corners) > wall.get_BoundingBox(None).Min.Z + SILL_FT
            _span(made, corners)
        elif isinstance(insert, FamilyInstance) and isinstance(insert.Location, LocationPoint):
            made.centre, made.parameters = to_mm(insert.Location.Point), self._marks(insert)
            kind = insert.Category.BuiltInCategory
            made.is_window, made.width = kind == BuiltInCategory.OST_Windows, self._width(insert)
            if kind not in (BuiltInCategory.OST_Doors, BuiltInCategory.OST_Windows):
                made.closed = made.closed or "no door or window"
            elif not made.width:
                made.closed = made.closed or "without a width"
        else:
            made.closed = made.closed or "neither rectangle nor door nor window"
        return made

    def _width(self, insert) -> float:
        for owner in (insert, insert.Symbol):
            for name in WIDTHS:
                parameter = owner.get_Parameter(name)
                if parameter is not None and parameter.HasValue and parameter.AsDouble() > 0:
                    return parameter.AsDouble() * FOOT_MM
        return 0.0

    def columns(self, ids: Optional[List[int]] = None) -> List[RevitColumn]:
        """Columns that the view shows; those of ``ids`` whether or not it shows them."""
        kinds = (BuiltInCategory.OST_Columns, BuiltInCategory.OST_StructuralColumns)
        found = [c for kind in kinds for c in self._visible(kind)] if ids is None else self._those(ids)
        return [self._column(column) for column in found]

    def _column(self, column) -> RevitColumn:
        id = element_number(column.Id)
        made = RevitColumn(id, f"{column.Name} {id}", [], self._marks(column), self._fixed(column))
        # Above its foot, where it has one.
        rings = self._outlines(column, max)
        made.ring = max(rings, key=_area) if rings else []
        made.left_out = self._left_out(column) or ("" if rings else "without an outline")
        return made

    def _outlines(self, element, which: Callable) -> List[List[Point]]:
        """Outer loops of the lowest (``min``) or highest (``max``) downward faces below the cut plane. Soffits of
        doors and windows are such faces too."""
        solids = _solids(element.get_Geometry(Options()))
        planes = [face for solid in solids for face in solid.Faces if isinstance(face, PlanarFace)]
        faces = [face for face in planes if face.FaceNormal.Z < -0.99 and face.Origin.Z < self._cut()]
        if not faces:
            return []
        level = which(face.Origin.Z for face in faces)
        out: List[List[Point]] = []
        for face in faces:
            loops = face.GetEdgesAsCurveLoops() if abs(face.Origin.Z - level) < LEVEL_FT else []
            for loop in loops:
                if loop.IsCounterclockwise(face.FaceNormal):
                    # A CurveLoop is a sequence of curves; the stub does not say so.
                    curves = list(loop)  # type: ignore[call-overload]
                    out.append([to_mm(p) for curve in curves for p in list(curve.Tessellate())[:-1]])
        return out

    def detail_lines(self) -> List[DetailLine]:
        out: List[DetailLine] = []
        for line in self._visible(BuiltInCategory.OST_Lines):
            if isinstance(line, CurveElement) and line.LineStyle is not None:
                points = [to_mm(p) for p in line.GeometryCurve.Tessellate()]
                out.extend(DetailLine(str(line.LineStyle.Name), a, b) for a, b in zip(points, points[1:]))
        return out

    def links(self) -> List[str]:
        """Names of the linked models that the view shows."""
        found = self._visible(BuiltInCategory.OST_RvtLinks)
        return [str(link.Name) for link in found if isinstance(link, RevitLinkInstance)]

    def _marks(self, element) -> Dict[str, str]:
        out = {}
        for name in (MOVES_PARAMETER, GROUP_PARAMETER, KEEP_PARAMETER):
            parameter = element.LookupParameter(name)
            if parameter is not None and parameter.HasValue:
                # A Yes/No is shown in the user's language.
                is_number = parameter.StorageType == StorageType.Integer
                out[name] = str(parameter.AsInteger()) if is_number else str(parameter.AsString() or "")
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
        else:
            group.Assimilate()
        finally:
            group.Dispose()

    @contextlib.contextmanager
    def transaction(self, name: str):
        transaction = Transaction(self._doc, name)
        options = transaction.GetFailureHandlingOptions()
        options.SetFailuresPreprocessor(_FAILURES)
        options.SetClearAfterRollback(True)
        transaction.SetFailureHandlingOptions(options)
        _FAILURES.said.clear()
        try:
            with _plainly():
                transaction.Start()
                yield
                status = transaction.Commit()
        finally:
            if transaction.HasStarted() and not transaction.HasEnded():
                transaction.RollBack()
            transaction.Dispose()
        if status != TransactionStatus.Committed:
            why = " ".join(dict.fromkeys(_FAILURES.said))
            raise PluginError(f"Revit refuses the new places: {why} Nothing was changed.")
        self.warnings.extend(_FAILURES.said)

    def move(self, id: int, motion: Rigid, about: Point) -> None:
        """Moves an element with all that it carries. Turned about a point of its own, it is never far away."""
        element, to = element_id(id), motion(about)
        if abs(motion.angle_rad) > 1e-9:
            x, y = about[0] / FOOT_MM, about[1] / FOOT_MM
            axis = Line.CreateBound(XYZ(x, y, 0), XYZ(x, y, 1))
            ElementTransformUtils.RotateElement(self._doc, element, axis, motion.angle_rad)
        if to != about:
            shift = XYZ((to[0] - about[0]) / FOOT_MM, (to[1] - about[1]) / FOOT_MM, 0)
            ElementTransformUtils.MoveElement(self._doc, element, shift)

    def set_wall_ends(self, id: int, a: Point, b: Point) -> None:
        """Lets a straight wall begin and end elsewhere. Joins are let go first: they would pull its ends back."""
        wall = self._doc.GetElement(element_id(id))
        joined = [end for end in (0, 1) if WallUtils.IsWallJoinAllowedAtEnd(wall, end)]
        for end in joined:
            WallUtils.DisallowWallJoinAtEnd(wall, end)
        self._bring_into_line(id, wall, a, b)
        # A copy of its line, which keeps the zero point of the old one; the line itself may be read-only.
        line = wall.Location.Curve.Clone()
        zero, heading = to_mm(line.Origin), direction(a, b)
        line.MakeBound(*(dot(minus(p, zero), heading) / FOOT_MM for p in (a, b)))
        wall.Location.Curve = line
        for end in joined:
            WallUtils.AllowWallJoinAtEnd(wall, end)

    def _bring_into_line(self, id: int, wall, a: Point, b: Point) -> None:
        """Turns and shifts a wall sideways until it stands on the line through two points."""
        line = wall.Location.Curve
        old = [to_mm(line.GetEndPoint(i)) for i in (0, 1)]
        was, heading = direction(old[0], old[1]), direction(a, b)
        sideways, aside = left_of(heading), dot(minus(a, old[0]), left_of(heading))
        turn = math.atan2(cross(was, heading), dot(was, heading))
        shift = (aside * sideways[0], aside * sideways[1])
        if abs(turn) > 1e-9 or distance(shift, (0.0, 0.0)) > 1e-6:
            self.move(id, turn_about(old[0], turn, shift), old[0])
            self._doc.Regenerate()

    def add_parameters(self) -> List[str]:
        """Gives walls, columns, doors and windows those of our parameters that they lack; their names."""
        there, bindings = set(), self._doc.ParameterBindings.ForwardIterator()
        while bindings.MoveNext():
            there.add(str(bindings.Key.Name))
        missing = [p for p in PARAMETERS if p[0] not in there]
        if missing:
            with self._own_parameter_file() as group, self.transaction("Enfilade: parameters"):
                for name, kind, guid in missing:
                    self._bind_parameter(group, name, kind, guid)
        return [name for name, _, _ in missing]

    def _bind_parameter(self, group, name: str, kind, guid: str) -> None:
        wanted = ExternalDefinitionCreationOptions(name, kind)
        wanted.GUID = Guid(guid)
        wanted.Description = "How Enfilade may move this element"
        categories = CategorySet()
        for category in BOUND_TO:
            categories.Insert(Category.GetCategory(self._doc, category))
        definition = group.Definitions.Create(wanted)
        self._doc.ParameterBindings.Insert(definition, InstanceBinding(categories), GroupTypeId.Data)

    @contextlib.contextmanager
    def _own_parameter_file(self):
        """A group in a shared parameter file of our own; the user's file is set again afterwards."""
        application = self._doc.Application
        kept = application.SharedParametersFilename
        folder = tempfile.mkdtemp()
        path = os.path.join(folder, "Enfilade.txt")
        with open(path, "w"):
            pass
        try:
            with _plainly():
                application.SharedParametersFilename = path
                yield application.OpenSharedParameterFile().Groups.Create("Enfilade")
        finally:
            application.SharedParametersFilename = kept
            shutil.rmtree(folder, ignore_errors=True)

    # -- Revit's own exports

    def export_dxf(self, folder: str, name: str) -> None:
        """The view as DXF: AIA layers, millimetres, the coordinates in which we move its elements."""
        options = DXFExportOptions()
        options.LayerMapping = "AIA"
        options.SharedCoords = False
        # The stub gives members of enumerations as numbers.
        options.TargetUnit = ExportUnit.Millimeter  # type: ignore[assignment]
        views = NetList[ElementId]()
        views.Add(self._view.Id)
        with _plainly():
            done = self._doc.Export(folder, name, views, options)
        _written(done, folder, name)

    def export_ifc(self, folder: str, name: str) -> None:
        """What the view shows as IFC 4. Revit wants an open transaction for it; it is rolled back."""
        options = IFCExportOptions()
        options.FileVersion = IFCVersion.IFC4  # type: ignore[assignment]
        options.FilterViewId = self._view.Id
        # Revit's exporter: 3 are the internal coordinates, in which we move elements.
        options.AddOption("SitePlacement", "3")
        transaction = Transaction(self._doc, "Enfilade: IFC export")
        with _plainly():
            transaction.Start()
            try:
                done = self._doc.Export(folder, name, options)
            finally:
                transaction.RollBack()
                transaction.Dispose()
        _written(done, folder, name)


def _written(done: bool, folder: str, name: str) -> None:
    if not done:
        raise PluginError(f"Revit did not write {name} to {folder}.")


def _span(insert: RevitInsert, corners) -> None:
    """Middle and width of what reaches from one corner to another."""
    a, b = (to_mm(p) for p in corners)
    insert.centre, insert.width = centroid([a, b]), distance(a, b)


def _area(ring: List[Point]) -> float:
    return abs(sum(cross(a, b) for a, b in zip(ring, ring[1:] + ring[:1])))


def _solids(geometry) -> Iterator:
    for part in geometry or ():
        if isinstance(part, Solid) and part.Volume > 0:
            yield part
        elif isinstance(part, GeometryInstance):
            yield from _solids(part.GetInstanceGeometry())
