"""Models for the tests, in millimetres."""

import math

from . import document, elements, walls
from .failures import BuiltInCategory, BuiltInParameter, PlanViewPlane, ViewType, WallKind

MM = 1.0 / 304.8
#: The level stands this high, feet: not at zero, where many a mistake would not show.
LEVEL_FT = 20.0
SHARED = "their-shared-parameters.txt"
BOUND = tuple(c for c in BuiltInCategory if c.name not in ("OST_Lines", "OST_RvtLinks", "OST_GenericModel"))


def feet(points):
    return [(x * MM, y * MM) for x, y in points]


class Model:
    """A document with a storey, phases, types and a floor plan."""

    def __init__(self, title="Haus Süd", path="", guid="11111111-2222-3333-4444-555555555555"):
        self.doc = document.Document(document.Application(SHARED), title, path, guid)
        for name in ("Enfilade Moves", "Enfilade Group", "Enfilade Keep"):
            self.doc._bindings[name] = (BOUND, "")
        self.phases = [elements.Phase(self.doc, name) for name in ("Existing", "New")]
        self.doc._phases = [p._id for p in self.phases]
        self.level = elements.Level(self.doc, "Level 1", elevation=LEVEL_FT)
        self.plan = self.view("Level 1 plan")
        self.types = {kind: elements.WallType(self.doc, kind.name, wall_kind=kind) for kind in WallKind}
        self.door_type = elements.FamilySymbol(self.doc, "Door 900", numbers={BuiltInParameter.DOOR_WIDTH: 900 * MM})
        self.plain_type = elements.FamilySymbol(self.doc, "Plain")

    def uidoc(self, view=None):
        return document.UIDocument(self.doc, view or self.plan)

    def view(self, name, kind=elements.ViewPlan, view_type=ViewType.FloorPlan, **more):
        offsets = {
            PlanViewPlane.CutPlane: 4.0,
            PlanViewPlane.TopClipPlane: 7.5,
            PlanViewPlane.BottomClipPlane: 0.0,
            PlanViewPlane.ViewDepthPlane: -1.0,
        }
        state = {"level": self.level._id, "range": offsets, "hidden": (), "options": (), "view_type": view_type}
        numbers = {BuiltInParameter.VIEW_PHASE: self.phases[-1]._id}
        return kind(self.doc, name, numbers=numbers, **{**state, **more})

    def wall(self, name, a=(0, 0), b=(1000, 0), thickness=100.0, marks=None, kind=WallKind.Basic, **more):
        (a, b), length = feet([a, b]), math.dist(a, b) * MM
        heading = ((b[0] - a[0]) / length, (b[1] - a[1]) / length)
        state = {"zero": a, "heading": heading, "ends": (0.0, length), "joins": (True, True), "arc": None}
        state.update(offset=0.0, width=thickness * MM, z=LEVEL_FT, height=10.0, member_of=None, host=None)
        state.update(type=self.types[kind]._id, params=dict(marks or {}), **more)
        return walls.Wall(self.doc, name, **state)

    def insert(self, name, host, at, category=BuiltInCategory.OST_Doors, width=None, marks=None, sill=0.0, **more):
        numbers = {} if width is None else {BuiltInParameter.DOOR_WIDTH: width * MM}
        state = {"kind": category, "host": host._id, "point": feet([at])[0], "type": self.door_type._id, "height": 7.0}
        state.update(z=host._s["z"] + sill, numbers=numbers, params=dict(marks or {}), width=(width or 900) * MM)
        return walls.FamilyInstance(self.doc, name, **{**state, **more})

    def opening(self, name, host, at, width, sill=0.0, **more):
        state = {"host": host._id, "point": feet([at])[0], "width": width * MM, "z": host._s["z"] + sill}
        return walls.Opening(self.doc, name, **{**state, "height": 6.0, "rectangular": True, **more})

    def column(self, name, at, side=200.0, marks=None, hole=None, **more):
        def square(size):
            return feet([(size * x, size * y) for x, y in ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))])

        state = {"kind": BuiltInCategory.OST_Columns, "host": None, "point": feet([at])[0], "angle": 0.0, "z": LEVEL_FT}
        state.update(ring=square(side), foot=square(2 * side), hole=square(hole) if hole else None, height=10.0)
        state.update(params=dict(marks or {}), type=self.plain_type._id)
        return walls.FamilyInstance(self.doc, name, **{**state, **more})

    def lines(self, style, points, view=None):
        """Detail lines round a ring, in no order."""
        made = elements.GraphicsStyle(self.doc, style)
        ring = feet(points)
        for a, b in list(zip(ring, ring[1:] + ring[:1]))[::-1]:
            elements.DetailLine(self.doc, "Lines", ends=(a, b), style=made._id, view=(view or self.plan)._id)


def square(x=0.0, side=1000.0):
    return [(x, 0.0), (x + side, 0.0), (x + side, side), (x, side)]


def house(title="Haus Süd", path=""):
    """The house of the common tests as Revit has it; its elements by name."""
    model = Model(title, path)
    corners = [(0.0, 0.0), (8000.0, 0.0), (8000.0, 6000.0), (0.0, 6000.0)]
    walls = {n: model.wall(n, a, b, 250.0) for n, a, b in zip("NESW", corners, corners[1:] + corners[:1])}
    at = dict(walls)
    at["Partition"] = model.wall("Partition", (4000, 0), (4000, 6000), marks={"Enfilade Moves": "x -1000 1m"})
    at["Spur"] = model.wall("Spur", (4000, 3000), (7000, 3000))
    screen = {"Enfilade Moves": "y -700 700; rotate -30° 30°"}
    at["Screen"] = model.wall("Screen", (6000, 4500), (6900, 4500), marks=screen)
    at["Door"] = model.insert("Door", at["Partition"], (4000, 1000), marks={"Enfilade Moves": "along -300 2000"})
    at["Window"] = model.insert("Window", at["N"], (6000, 0), BuiltInCategory.OST_Windows, 1200.0, sill=3.0)
    at["Column"] = model.column("Column", (1900, 3000), marks={"Enfilade Moves": "x -500 500"})
    return model, at
