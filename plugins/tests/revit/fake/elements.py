"""Elements of a document. Each keeps plain values in ``_s``, so that a rollback can put them back."""

from .dotnet import Int64
from .failures import (
    BuiltInCategory,
    ElementOnPhaseStatus,
    InvalidObjectException,
    PlanViewPlane,
    StorageType,
)
from .geometry import BoundingBoxXYZ, Line, XYZ


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


class Instance(Element):
    pass
