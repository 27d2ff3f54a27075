"""Walls, what stands in them, columns; how Revit moves them."""

import math

from .elements import Element, Instance, Location
from .failures import BuiltInCategory, FailureSeverity, InvalidOperationException, WallKind
from .geometry import Arc, CurveLoop, GeometryElement, GeometryInstance, Line, PlanarFace, Solid, XYZ, downward, prism


def cross(a, b):
    return a[0] * b[1] - a[1] * b[0]


class LocationPoint(Location):
    @property
    def Point(self):
        return XYZ(*self._element._live()["point"], self._element._s["z"])


class LocationCurve(Location):
    @property
    def Curve(self):
        """What was moved stands elsewhere only when the model is regenerated."""
        return self._element._document._stale.get(self._element._id) or self._element._curve()

    @Curve.setter
    def Curve(self, curve):
        self._element._take(curve)


class HostObject(Element):
    def FindInserts(self, addRectOpenings, includeShadows, includeEmbeddedWalls, includeSharedEmbeddedInserts):
        found = [e for e in self._document._elements.values() if e._s.get("host") == self._id]
        for asked, state in ((includeShadows, "shadow"), (includeSharedEmbeddedInserts, "part_of")):
            found = [e for e in found if asked or not e._s.get(state)]
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
        self._document._stale.pop(self._id, None)
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


class FamilyInstance(Instance):
    """A door, window or void in a wall (``host``), or a column (``ring`` about ``point``)."""

    @property
    def Symbol(self):
        return self._document._elements[self._live()["type"]]

    @property
    def Host(self):
        return self._document._elements.get(self._live()["host"])

    @property
    def Location(self):
        return Location(self) if self._live().get("is_placed_by_line") else LocationPoint(self)

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
    if isinstance(element, Wall):
        document._stale.setdefault(element._id, element._curve())
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
