"""Points, curves, faces, solids. Feet, radians."""

import math

from .failures import ArgumentException


class XYZ:
    def __init__(self, x=0.0, y=0.0, z=0.0):
        self._p = (float(x), float(y), float(z))

    @property
    def X(self):
        return self._p[0]

    @property
    def Y(self):
        return self._p[1]

    @property
    def Z(self):
        return self._p[2]

    def DotProduct(self, source):
        return sum(a * b for a, b in zip(self._p, source._p))

    def Subtract(self, source):
        return XYZ(*(a - b for a, b in zip(self._p, source._p)))


class BoundingBoxXYZ:
    def __init__(self):
        self._min = self._max = XYZ()

    @property
    def Min(self):
        return self._min

    @property
    def Max(self):
        return self._max


class GeometryObject:
    pass


class Curve(GeometryObject):
    pass


#: Revit makes no shorter curve.
SHORTEST = 1.0 / 384.0


class Line(Curve):
    """A line keeps its zero point when its bounds change."""

    def __init__(self):
        raise TypeError("a Line has no constructor")

    @staticmethod
    def _of(origin, direction, begin, end):
        line = Line.__new__(Line)
        line._origin, line._direction, line._ends, line._held = origin, direction, (begin, end), False
        return line

    @staticmethod
    def CreateBound(endpoint1, endpoint2):
        d = endpoint2.Subtract(endpoint1)._p
        length = math.sqrt(sum(v * v for v in d))
        if length < SHORTEST:
            raise ArgumentException("Curve length is too small for Revit's tolerance.")
        return Line._of(endpoint1, XYZ(*(v / length for v in d)), 0.0, length)

    @property
    def Origin(self):
        return self._origin

    @property
    def Direction(self):
        return self._direction

    def Clone(self):
        return Line._of(self._origin, self._direction, *self._ends)

    def MakeBound(self, startParameter, endParameter):
        if self._held or endParameter - startParameter < SHORTEST:
            raise ArgumentException("The curve is read-only, or would be too short.")
        self._ends = (startParameter, endParameter)

    def GetEndPoint(self, index):
        return XYZ(*(o + self._ends[index] * d for o, d in zip(self._origin._p, self._direction._p)))

    def Tessellate(self):
        return [self.GetEndPoint(0), self.GetEndPoint(1)]


class Arc(Curve):
    """Horizontal, anticlockwise where ``end`` is beyond ``begin``."""

    def __init__(self):
        raise TypeError("an Arc has no constructor")

    @staticmethod
    def _of(centre, radius, begin, end):
        arc = Arc.__new__(Arc)
        arc._centre, arc._radius, arc._angles = centre, radius, (begin, end)
        return arc

    def _at(self, share):
        angle = self._angles[0] + share * (self._angles[1] - self._angles[0])
        c = self._centre
        return XYZ(c.X + self._radius * math.cos(angle), c.Y + self._radius * math.sin(angle), c.Z)

    def GetEndPoint(self, index):
        return self._at(float(index))

    def Tessellate(self):
        return [self._at(i / 8.0) for i in range(9)]


class CurveLoop:
    """Iterates over its curves."""

    def __init__(self):
        self._curves = []

    @staticmethod
    def _through(points, z):
        loop = CurveLoop()
        corners = [XYZ(x, y, z) for x, y in points]
        loop._curves = [Line.CreateBound(a, b) for a, b in zip(corners, corners[1:] + corners[:1])]
        return loop

    def __iter__(self):
        return iter(self._curves)

    def IsCounterclockwise(self, normal):
        points = [p for curve in self._curves for p in curve.Tessellate()[:-1]]
        area = sum(a.X * b.Y - b.X * a.Y for a, b in zip(points, points[1:] + points[:1]))
        return area * normal.Z > 0


class Face(GeometryObject):
    pass


class PlanarFace(Face):
    def __init__(self):
        raise TypeError("a PlanarFace has no constructor")

    @staticmethod
    def _of(normal, loops):
        face = PlanarFace.__new__(PlanarFace)
        face._normal, face._loops = XYZ(*normal), loops
        return face

    @property
    def FaceNormal(self):
        return self._normal

    @property
    def Origin(self):
        return next(iter(self._loops[0])).GetEndPoint(0)

    def GetEdgesAsCurveLoops(self):
        return list(self._loops)


class CylindricalFace(Face):
    pass


class Solid(GeometryObject):
    def __init__(self):
        raise TypeError("a Solid has no constructor")

    @staticmethod
    def _of(faces, volume=1.0):
        solid = Solid.__new__(Solid)
        solid._faces, solid._volume = faces, volume
        return solid

    @property
    def Faces(self):
        return list(self._faces)

    @property
    def Volume(self):
        return self._volume


class GeometryElement(GeometryObject):
    def __init__(self, parts):
        self._parts = parts

    def __iter__(self):
        return iter(self._parts)


class GeometryInstance(GeometryObject):
    def __init__(self, parts):
        self._parts = parts

    def GetInstanceGeometry(self):
        return GeometryElement(self._parts)


class Options:
    """Asks for the geometry that no view changes."""


def downward(points, z):
    """A face seen from below: its outer loop runs clockwise seen from above."""
    area = sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(points, points[1:] + points[:1]))
    return CurveLoop._through(points[::-1] if area > 0 else points, z)


def prism(rings, z, height, holes=()):
    """A solid over rings: bottom and top, with holes named before what they are holes of."""
    def loops(at, is_bottom):
        out = []
        for points, is_hole in [(h, True) for h in holes] + [(r, False) for r in rings]:
            loop = downward(points, at)
            if is_hole == is_bottom:
                turned = [c.GetEndPoint(0)._p[:2] for c in loop][::-1]
                loop = CurveLoop._through(turned, at)
            out.append(loop)
        return out

    faces = [PlanarFace._of((0, 0, 1), loops(z + height, False)), CylindricalFace()]
    return Solid._of(faces + [PlanarFace._of((0, 0, -1), loops(z, True))])
