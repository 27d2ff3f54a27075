"""Elements of a document. Each keeps plain values in ``_s``, so that a rollback can put them back."""

import math

from .dotnet import Int64
from .failures import (
    BuiltInCategory,
    ElementOnPhaseStatus,
    FailureSeverity,
    InvalidObjectException,
    InvalidOperationException,
    PlanViewPlane,
    ViewType,
    StorageType,
    WallKind,
)
from .geometry import Arc, BoundingBoxXYZ, CurveLoop, GeometryElement, GeometryInstance, Line, PlanarFace, Solid, XYZ
from .geometry import downward, prism


class ElementId:
    """Of Python's ``int`` pythonnet cannot say which of the constructors is meant."""

    def __init__(self, id):
        if not isinstance(id, Int64):
            raise TypeError("Multiple targets could match: ElementId(BuiltInParameter), ElementId(Int64), …")
        self._id = int(id)

    @property
    def Value(self):
        return self._id

    def __eq__(self, other):
        return isinstance(other, ElementId) and other._id == self._id

    def __hash__(self):
        return hash(self._id)


ElementId.InvalidElementId = ElementId(Int64(-1))


def id_of(number):
    return ElementId(Int64(-1 if number is None else number))


class Category:
    def __init__(self, kind):
        self._kind = kind

    @property
    def BuiltInCategory(self):
        return self._kind

    @staticmethod
    def GetCategory(document, categoryId):
        return Category(categoryId)


class Parameter:
    def __init__(self, value):
        self._value = value

    @property
    def HasValue(self):
        return self._value is not None

    @property
    def StorageType(self):
        kinds = {bool: StorageType.Integer, float: StorageType.Double, str: StorageType.String}
        return kinds.get(type(self._value), StorageType.ElementId)

    def AsString(self):
        return self._value if isinstance(self._value, str) else None

    def AsValueString(self):
        """As Revit shows it; a Yes/No in the user's language."""
        return {True: "Ja", False: "Nein"}.get(self._value, None if self._value is None else str(self._value))

    def AsInteger(self):
        return int(self._value) if isinstance(self._value, bool) else 0

    def AsDouble(self):
        return self._value if isinstance(self._value, float) else 0.0

    def AsElementId(self):
        return id_of(self._value)


class Element:
    _category = None

    def __init__(self, document, name, **state):
        self._document = document
        self._s = {"name": name, "params": {}, "numbers": {}, "created": 1, "demolished": None, "option": None}
        self._s.update({"group": None, "pinned": False, "view": None, "kind": self._category})
        self._s.update(state)
        self._id = document._add(self)

    def _live(self):
        if self._document._elements.get(self._id) is not self:
            raise InvalidObjectException("The referenced object is not valid, possibly because it has been deleted.")
        return self._s

    @property
    def Id(self):
        return id_of(self._id)

    @property
    def UniqueId(self):
        return f"unique-{self._id:08x}"

    @property
    def Name(self):
        return self._live()["name"]

    @property
    def Category(self):
        kind = self._live()["kind"]
        return None if kind is None else Category(kind)

    @property
    def Pinned(self):
        return self._live()["pinned"]

    @Pinned.setter
    def Pinned(self, lock):
        self._document._modify()
        self._live()["pinned"] = lock

    @property
    def GroupId(self):
        return id_of(self._live()["group"])

    @property
    def DesignOption(self):
        return self._document._elements.get(self._live()["option"])

    @property
    def Location(self):
        return None

    def GetPhaseStatus(self, phaseId):
        s, at = self._live(), self._document._phases.index(phaseId.Value)
        created, gone = s["created"], s["demolished"]
        if created > at:
            return ElementOnPhaseStatus.Future
        if gone is not None and gone <= at:
            here = ElementOnPhaseStatus.Temporary if created == at else ElementOnPhaseStatus.Demolished
            return here if gone == at else ElementOnPhaseStatus.Past
        return ElementOnPhaseStatus.New if created == at else ElementOnPhaseStatus.Existing

    def get_Parameter(self, parameterId):
        numbers = self._live()["numbers"]
        return Parameter(numbers[parameterId]) if parameterId in numbers else None

    def LookupParameter(self, name):
        """Only what is bound to the element's category is there."""
        if self._live()["kind"] not in self._document._bindings.get(name, ((), None))[0]:
            return None
        return Parameter(self._s["params"].get(name))

    def get_Geometry(self, options):
        return None

    def get_BoundingBox(self, A_0):
        z = self._live().get("z")
        if z is None:
            return None
        box = BoundingBoxXYZ()
        box._min, box._max = XYZ(0, 0, z), XYZ(0, 0, z + self._s["height"])
        return box


class ElementType(Element):
    pass


class FamilySymbol(ElementType):
    pass


class WallType(ElementType):
    @property
    def Kind(self):
        return self._live()["wall_kind"]


class Phase(Element):
    pass


class DesignOption(Element):
    @property
    def IsPrimary(self):
        return self._live()["primary"]

    @staticmethod
    def GetActiveDesignOptionId(document):
        return id_of(document._active_option)


class Group(Element):
    pass


class RevitLinkInstance(Element):
    _category = BuiltInCategory.OST_RvtLinks


class ProjectInfo(Element):
    pass


class Level(Element):
    """``ProjectElevation`` counts from the zero point of the coordinates; ``Elevation`` from where the user says."""

    @property
    def Elevation(self):
        return self._live()["elevation"] - 100.0

    @property
    def ProjectElevation(self):
        return self._live()["elevation"]


class GraphicsStyle(Element):
    pass


class PlanViewRange:
    def __init__(self, offsets):
        self._offsets = offsets

    def GetOffset(self, planViewPlane):
        return self._offsets[planViewPlane]


class View(Element):
    @property
    def ViewType(self):
        return self._live()["view_type"]

    @property
    def GenLevel(self):
        return self._document._elements.get(self._live()["level"])

    def _shows(self, element):
        s = element._s
        if s["view"] is not None:
            return s["view"] == self._id
        if element._id in self._s["hidden"] or s["kind"] is None:
            return False
        option = element.DesignOption
        if option is not None and not option.IsPrimary and option._id not in self._s["options"]:
            return False
        if element.GetPhaseStatus(id_of(self._document._phases[-1])) in (
            ElementOnPhaseStatus.Future,
            ElementOnPhaseStatus.Past,
        ):
            return False
        return s.get("z") is None or self._reaches(s["z"], s["z"] + s["height"])

    def _reaches(self, low, high):
        return True


class ViewPlan(View):
    def GetViewRange(self):
        return PlanViewRange(self._s["range"])

    def _reaches(self, low, high):
        zero = self.GenLevel.ProjectElevation
        planes = [zero + self._s["range"][p] for p in (PlanViewPlane.ViewDepthPlane, PlanViewPlane.TopClipPlane)]
        return high > planes[0] and low < planes[1]


class View3D(View):
    pass


class CurveElement(Element):
    _category = BuiltInCategory.OST_Lines

    @property
    def GeometryCurve(self):
        a, b = self._live()["ends"]
        return Line.CreateBound(XYZ(*a, 0), XYZ(*b, 0))

    @property
    def LineStyle(self):
        return self._document._elements.get(self._live()["style"])


class DetailCurve(CurveElement):
    pass


class DetailLine(DetailCurve):
    pass


class Location:
    def __init__(self, element):
        self._element = element


class LocationPoint(Location):
    @property
    def Point(self):
        return XYZ(*self._element._live()["point"], self._element._s["z"])


class LocationCurve(Location):
    @property
    def Curve(self):
        return self._element._curve()

    @Curve.setter
    def Curve(self, curve):
        self._element._take(curve)


def cross(a, b):
    return a[0] * b[1] - a[1] * b[0]


class HostObject(Element):
    def FindInserts(self, addRectOpenings, includeShadows, includeEmbeddedWalls, includeSharedEmbeddedInserts):
        found = [e for e in self._document._elements.values() if e._s.get("host") == self._id]
        if not addRectOpenings:
            found = [e for e in found if not isinstance(e, Opening)]
        if not includeEmbeddedWalls:
            found = [e for e in found if not isinstance(e, Wall)]
        return [e.Id for e in found]


class Wall(HostObject):
    """``zero``, ``heading``, ``ends``: its location line. ``offset``: how far left of it the middle of the wall
    stands. ``arc`` instead: centre, radius, two angles."""

    _category = BuiltInCategory.OST_Walls

    @property
    def Width(self):
        if self.WallType.Kind is not WallKind.Basic:
            raise InvalidOperationException("This wall has no width.")
        return self._live()["width"]

    @property
    def WallType(self):
        return self._document._elements[self._live()["type"]]

    @property
    def IsStackedWall(self):
        return self.WallType.Kind is WallKind.Stacked

    @property
    def IsStackedWallMember(self):
        return self._live()["member_of"] is not None

    def GetStackedWallMemberIds(self):
        return [e.Id for e in self._document._elements.values() if e._s.get("member_of") == self._id]

    @property
    def Location(self):
        return LocationCurve(self)

    def _curve(self):
        s = self._live()
        if s["arc"]:
            (x, y), radius, begin, end = s["arc"]
            return Arc._of(XYZ(x, y, s["z"]), radius, begin, end)
        line = Line._of(XYZ(*s["zero"], s["z"]), XYZ(*s["heading"], 0), *s["ends"])
        line._held = True
        return line

    def _at(self, along, left=0.0):
        (x, y), (u, v) = self._s["zero"], self._s["heading"]
        return (x + along * u - left * v, y + along * v + left * u)

    def _along(self, p):
        (x, y), (u, v) = self._s["zero"], self._s["heading"]
        return (p[0] - x) * u + (p[1] - y) * v

    def _inserts(self):
        return [e for e in self._document._elements.values() if e._s.get("host") == self._id]

    def _take(self, curve):
        """A new location line. Where it has the zero point of the old one, what stands in the wall stays; else it
        does what ``_habits`` says. Ends that are joined are pulled back to what they are joined with."""
        self._document._modify()
        if self._id in self._document._held:
            return
        s, joined = self._live(), [self._joined(end) for end in (0, 1)]
        begin, inserts = s["ends"][0], self._inserts()
        along = [self._along(e._s["point"]) for e in inserts]
        zero, heading = curve.Origin._p[:2], curve.Direction._p[:2]
        is_same = math.dist(zero, s["zero"]) < 1e-9 and math.dist(heading, s["heading"]) < 1e-9
        s["zero"], s["heading"], s["ends"] = zero, heading, tuple(curve._ends)
        for insert, at in zip(inserts, along):
            if is_same or self._document._habits["inserts"] == "start":
                insert._s["point"] = self._at(at if is_same else at - begin + s["ends"][0])
            else:
                insert._s["point"] = self._at(self._along(insert._s["point"]))
        for end, other in enumerate(joined):
            if other is not None and self._document._habits["joins"] == "follow":
                self._stretch_to(end, other)
        self._check_inserts()

    def _check_inserts(self):
        low, high = self._s["ends"]
        for insert in self._inserts():
            if not low <= self._along(insert._s["point"]) <= high:
                self._document._post(FailureSeverity.Error, "Can't cut instance of door or window out of wall.")

    def _joined(self, end):
        """The wall on whose location line an end lies, where joining is allowed."""
        if self._s["arc"] or not self._s["joins"][end]:
            return None
        point = self._at(self._s["ends"][end])
        for other in self._document._elements.values():
            if isinstance(other, Wall) and other is not self and not other._s["arc"]:
                off = abs(cross(other._s["heading"], (point[0] - other._s["zero"][0], point[1] - other._s["zero"][1])))
                low, high = other._s["ends"]
                if off <= other._s["width"] / 2 + 0.01 and low - 0.5 <= other._along(point) <= high + 0.5:
                    return other
        return None

    def _stretch_to(self, end, other):
        """Moves an end along the wall's own line to the location line of another."""
        d = cross(self._s["heading"], other._s["heading"])
        if abs(d) < 1e-9:
            return
        (x, y), (a, b) = self._s["zero"], other._s["zero"]
        at = cross((a - x, b - y), other._s["heading"]) / d
        ends = list(self._s["ends"])
        ends[end] = at
        if ends[1] - ends[0] > 0.1:
            self._s["ends"] = tuple(ends)

    def _outline(self, low, high):
        left, right = (self._s["offset"] + side * self._s["width"] / 2 for side in (1, -1))
        return [self._at(low, right), self._at(high, right), self._at(high, left), self._at(low, left)]

    def get_Geometry(self, options):
        s = self._live()
        if self.WallType.Kind is not WallKind.Basic:
            return GeometryElement([])
        if s["arc"]:
            return GeometryElement([self._bow()])
        cuts, soffits = [], []
        for e in self._inserts():
            at, half = self._along(e._s["point"]), e._s.get("width", 0.0) / 2
            if half:
                soffits.append(PlanarFace._of((0, 0, -1), [downward(self._outline(at - half, at + half), e._s["z"] + 7.0)]))
                if e._s["z"] <= s["z"]:
                    cuts.append((at - half, at + half))
        bounds = [s["ends"][0]] + [v for cut in sorted(cuts) for v in cut] + [s["ends"][1]]
        rings = [self._outline(a, b) for a, b in zip(bounds[::2], bounds[1::2]) if b - a > 0.01]
        solid = prism(rings, s["z"], s["height"])
        return GeometryElement([Solid._of([], 0.0), Solid._of(soffits + solid._faces)])

    def _bow(self):
        (x, y), radius, begin, end = self._s["arc"]
        loop = CurveLoop()
        ends = [Arc._of(XYZ(x, y, self._s["z"]), radius + d, begin, end) for d in (-0.25, 0.25)]
        inner, outer = ends[0], Arc._of(ends[1]._centre, ends[1]._radius, end, begin)
        sides = [(inner.GetEndPoint(1), outer.GetEndPoint(0)), (outer.GetEndPoint(1), inner.GetEndPoint(0))]
        loop._curves = [inner, Line.CreateBound(*sides[0]), outer, Line.CreateBound(*sides[1])]
        return Solid._of([PlanarFace._of((0, 0, -1), [loop])])

    def _carried(self, motion, turn):
        """Moves the wall with what stands in it; walls joined to it follow, as ``_habits`` says."""
        others = [e for e in self._document._elements.values() if isinstance(e, Wall) and e is not self]
        joined = [(o, end) for o in others for end in (0, 1) if o._joined(end) is self]
        s = self._s
        if s["arc"]:
            centre, radius, begin, end = s["arc"]
            s["arc"] = (motion(centre), radius, begin + turn, end + turn)
        else:
            tip = motion((s["zero"][0] + s["heading"][0], s["zero"][1] + s["heading"][1]))
            s["zero"] = motion(s["zero"])
            s["heading"] = (tip[0] - s["zero"][0], tip[1] - s["zero"][1])
        for insert in self._inserts():
            insert._s["point"] = motion(insert._s["point"])
        if self._document._habits["joins"] == "follow":
            for other, end in joined:
                other._stretch_to(end, self)


class Instance(Element):
    pass


class FamilyInstance(Instance):
    """A door, window or void in a wall (``host``), or a column (``ring`` about ``point``)."""

    @property
    def Symbol(self):
        return self._document._elements[self._live()["type"]]

    @property
    def Host(self):
        return self._document._elements.get(self._live()["host"])

    @property
    def SuperComponent(self):
        return self._document._elements.get(self._live().get("part_of"))

    @property
    def Location(self):
        return LocationPoint(self)

    def get_Geometry(self, options):
        """Of a column: the solid of its family, hollow where ``hole`` says so, beside a little foot."""
        s = self._live()
        if "ring" not in s:
            return GeometryElement([])
        ring, foot = (self._placed(s[k]) for k in ("ring", "foot"))
        holes = [self._placed(s["hole"])] if s["hole"] else []
        return GeometryElement([GeometryInstance([prism([foot], s["z"], 0.1), prism([ring], s["z"] + 0.1, s["height"] - 0.1, holes)])])

    def _placed(self, ring):
        c, s, (x, y) = math.cos(self._s["angle"]), math.sin(self._s["angle"]), self._s["point"]
        return [(x + c * u - s * v, y + s * u + c * v) for u, v in ring]

    def _carried(self, motion, turn):
        host, point = self.Host, motion(self._s["point"])
        if host is None:
            self._s["point"], self._s["angle"] = point, self._s["angle"] + turn
            return
        # What stands in a wall stays in it.
        self._s["point"] = host._at(host._along(point))
        host._check_inserts()


class Opening(Element):
    """A rectangular opening in a wall."""

    @property
    def Host(self):
        return self._document._elements.get(self._live()["host"])

    @property
    def IsRectBoundary(self):
        return self._live()["rectangular"]

    @property
    def BoundaryRect(self):
        host, s = self.Host, self._live()
        at = host._along(s["point"])
        low, high = (host._at(at + side * s["width"] / 2) for side in (-1, 1))
        return [XYZ(*low, s["z"]), XYZ(*high, s["z"] + s["height"])]

    def _carried(self, motion, turn):
        self._s["point"] = self.Host._at(self.Host._along(motion(self._s["point"])))
        self.Host._check_inserts()


class ElementTransformUtils:
    @staticmethod
    def MoveElement(document, elementToMove, translation):
        element = _movable(document, elementToMove)
        if element is not None:
            element._carried(lambda p: (p[0] + translation.X, p[1] + translation.Y), 0.0)

    @staticmethod
    def RotateElement(document, elementToRotate, axis, angle):
        element, c, s = _movable(document, elementToRotate), math.cos(angle), math.sin(angle)
        x, y = axis.Origin.X, axis.Origin.Y
        if element is not None:
            element._carried(
                lambda p: (x + c * (p[0] - x) - s * (p[1] - y), y + s * (p[0] - x) + c * (p[1] - y)), angle
            )


def _movable(document, id):
    """What may be moved; ``None`` for what something holds, which Revit leaves in its place without a word."""
    document._modify()
    element = document._elements[id.Value]
    if element.Pinned:
        raise InvalidOperationException("Pinned elements cannot be moved.")
    if element._s["group"] is not None:
        document._post(FailureSeverity.Error, "Changes to groups are allowed only in group edit mode.")
    return None if element._id in document._held else element


class WallUtils:
    @staticmethod
    def DisallowWallJoinAtEnd(wall, end):
        wall._document._modify()
        wall._live()["joins"] = tuple(v and i != end for i, v in enumerate(wall._s["joins"]))

    @staticmethod
    def AllowWallJoinAtEnd(wall, end):
        wall._document._modify()
        wall._live()["joins"] = tuple(v or i == end for i, v in enumerate(wall._s["joins"]))

    @staticmethod
    def IsWallJoinAllowedAtEnd(wall, end):
        return wall._live()["joins"][end]
