"""A DXF file as it lies on the disk: its entities with the strokes that they draw. What is not understood stays as it is.

Only text files are read. All is kept as bytes, so that no encoding is lost.
"""

import math
from dataclasses import dataclass, field
from typing import Dict, Iterator, List, Optional, Tuple

from .model import PluginError
from .plane import Point, minus

#: A group: its code, its value without the line end.
Group = Tuple[int, bytes]

#: Largest file that is read, bytes.
FILE_MAX = 200_000_000
#: Blocks in blocks are followed so far.
NESTED_MAX = 8
#: Copies of one insert, and strokes of a file, at most.
COPIES_MAX, STROKES_MAX = 10_000, 500_000

NO_TEXT = "is no DXF in text form"


@dataclass
class Line:
    """One thing that an entity draws: a line or an arc from end to end, a circle, or a curve known by its ends."""

    kind: str
    ends: Tuple[Point, Point]
    #: Of an arc the point halfway; of a circle its centre.
    middle: Point
    radius: float = 0.0
    #: Which corners of the entity its ends are; none of parts of a block.
    corners: Tuple[int, ...] = ()
    layer: bytes = b"0"


@dataclass
class Entity:
    """An entity of the file, with those that belong to it (vertices, attributes)."""

    kind: str
    #: From where to where it stands among the groups of the file.
    start: int
    end: int
    groups: List[Group]
    lines: List[Line] = field(default_factory=list)

    def first(self, code: int, default: bytes = b"") -> bytes:
        return next((v for c, v in self.groups if c == code), default)

    def real(self, code: int, default: float = 0.0) -> float:
        return _real(self.first(code), default)

    @property
    def layer(self) -> bytes:
        return self.first(8, b"0")

    @property
    def handle(self) -> str:
        return self.first(5).decode("ascii", "replace").strip()


@dataclass
class Block:
    """A block: its name, base point and entities."""

    base: Point
    entities: List[Entity]


class DxfFile:
    """A file of text with its groups, and its entities in model space."""

    def __init__(self, path: str) -> None:
        self.path = path
        self.groups = _groups(_content(path))
        self.sections = _sections(self.groups)
        self.blocks = self._blocks()
        start, end = self.sections.get(b"ENTITIES", (0, 0))
        self.entities = [e for e in _entities(self.groups, start, end) if e.first(67).strip() in (b"", b"0")]
        self._count = 0
        self._inside: Dict[Tuple[bytes, bool], List[Line]] = {}
        for entity in self.entities:
            entity.lines = self._strokes(entity, 0)

    def as_host(self, insert: Entity) -> List[Line]:
        """What an insert draws as FreeCAD does it: scaled alike in all directions, never seen from below."""
        self._count = 0
        return self._strokes(insert, 0, True)

    def variable(self, name: bytes) -> bytes:
        """The first value of a variable of the header."""
        start, end = self.sections.get(b"HEADER", (0, 0))
        for i in range(start, end - 1):
            if self.groups[i] == (9, name):
                return self.groups[i + 1][1].strip()
        return b""

    def _blocks(self) -> Dict[bytes, Block]:
        out: Dict[bytes, Block] = {}
        start, end = self.sections.get(b"BLOCKS", (0, 0))
        head: Optional[Entity] = None
        inside: List[Entity] = []
        for entity in _entities(self.groups, start, end):
            if entity.kind == "BLOCK":
                head, inside = entity, []
            elif entity.kind == "ENDBLK" and head is not None:
                out[head.first(2).strip().upper()] = Block((head.real(10), head.real(20)), inside)
            else:
                inside.append(entity)
        return out

    def _strokes(self, entity: Entity, depth: int, as_host: bool = False) -> List[Line]:
        if entity.kind == "INSERT":
            out = list(self._inserted(entity, depth, as_host))
        else:
            out = _drawn(entity)
        if as_host:
            return out
        if entity.real(230, 1.0) < 0.0 and entity.kind not in ("LINE", "ELLIPSE", "SPLINE"):
            out = [_mapped(s, (-1.0, 0.0, 0.0, 1.0, 0.0, 0.0)) for s in out]
        return out

    def _inserted(self, insert: Entity, depth: int, as_host: bool) -> Iterator[Line]:
        name = insert.first(2).strip().upper()
        block = self.blocks.get(name)
        if block is None or depth > NESTED_MAX:
            return
        if (name, as_host) not in self._inside:
            inside = [s for e in block.entities for s in self._strokes(e, depth + 1, as_host)]
            self._inside[name, as_host] = inside
        for matrix in _places(insert, block.base, as_host):
            for stroke in self._inside[name, as_host]:
                self._count += 1
                if self._count > STROKES_MAX:
                    raise PluginError(f"{self.path} draws more than {STROKES_MAX} lines.")
                made = _mapped(stroke, matrix)
                made.layer = insert.layer if stroke.layer == b"0" else stroke.layer
                made.corners = ()
                yield made


def _content(path: str) -> bytes:
    try:
        with open(path, "rb") as f:
            content = f.read(FILE_MAX + 1)
    except OSError as e:
        raise PluginError(f"{path} cannot be read: {e.strerror or e}.") from e
    if content.startswith(b"AutoCAD Binary DXF") or b"\0" in content[:1024]:
        raise PluginError(f"{path} {NO_TEXT}.")
    if len(content) > FILE_MAX:
        raise PluginError(f"{path} is larger than {FILE_MAX // 1_000_000} MB.")
    return content


def _groups(content: bytes) -> List[Group]:
    lines = content.replace(b"\r\n", b"\n").replace(b"\r", b"\n").split(b"\n")
    out: List[Group] = []
    for code, value in zip(lines[0::2], lines[1::2]):
        try:
            out.append((int(code), value))
        except ValueError:
            break
    return out


def _sections(groups: List[Group]) -> Dict[bytes, Tuple[int, int]]:
    """Where the groups of each section begin and end, without its frame."""
    out: Dict[bytes, Tuple[int, int]] = {}
    name, start = b"", 0
    for i, (code, value) in enumerate(groups):
        if code != 0:
            continue
        if value.strip() == b"SECTION" and i + 1 < len(groups):
            name, start = groups[i + 1][1].strip(), i + 2
        elif value.strip() in (b"ENDSEC", b"EOF") and name:
            out.setdefault(name, (start, i))
            name = b""
    return out


def _entities(groups: List[Group], start: int, end: int) -> Iterator[Entity]:
    """Entities, with the vertices and attributes that follow them."""
    heads = [i for i in range(start, end) if groups[i][0] == 0] + [end]
    open_one: Optional[Entity] = None
    for a, b in zip(heads, heads[1:]):
        kind = groups[a][1].strip().decode("ascii", "replace")
        if open_one is not None and kind in ("VERTEX", "ATTRIB", "SEQEND"):
            open_one.end = b
            if kind == "VERTEX":
                open_one.groups += groups[a:b]
            if kind == "SEQEND":
                yield open_one
                open_one = None
            continue
        if open_one is not None:
            yield open_one
            open_one = None
        made = Entity(kind, a, b, list(groups[a:b]))
        if made.first(66).strip() == b"1" and kind in ("POLYLINE", "INSERT"):
            open_one = made
        else:
            yield made
    if open_one is not None:
        yield open_one


def _real(text: bytes, default: float = 0.0) -> float:
    try:
        value = float(text)
    except ValueError:
        return default
    return value if math.isfinite(value) else default


def _drawn(entity: Entity) -> List[Line]:
    make = {
        "LINE": _line,
        "ARC": _arc,
        "CIRCLE": _circle,
        "LWPOLYLINE": _lwpolyline,
        "POLYLINE": _polyline,
        "ELLIPSE": _ellipse,
        "SPLINE": _spline,
    }.get(entity.kind)
    out = make(entity) if make else []
    for stroke in out:
        stroke.layer = entity.layer
    return out


def straight(a: Point, b: Point, corners: Tuple[int, ...] = ()) -> Line:
    return Line("line", (a, b), ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2), 0.0, corners)


def _line(e: Entity) -> List[Line]:
    return [straight((e.real(10), e.real(20)), (e.real(11), e.real(21)), (0, 1))]


def _on(centre: Point, radius: float, angle: float) -> Point:
    return (centre[0] + radius * math.cos(angle), centre[1] + radius * math.sin(angle))


def _arc(e: Entity) -> List[Line]:
    centre, radius = (e.real(10), e.real(20)), abs(e.real(40))
    begin, end = math.radians(e.real(50)), math.radians(e.real(51))
    sweep = (end - begin) % (2 * math.pi) or 2 * math.pi
    ends = (_on(centre, radius, begin), _on(centre, radius, end))
    return [Line("arc", ends, _on(centre, radius, begin + sweep / 2), radius, (0, 1))]


def _circle(e: Entity) -> List[Line]:
    centre = (e.real(10), e.real(20))
    return [Line("circle", (centre, centre), centre, abs(e.real(40)), (0,))]


def _lwpolyline(e: Entity) -> List[Line]:
    points: List[Point] = []
    bulges: List[float] = []
    for code, value in e.groups:
        if code == 10:
            points.append((_real(value), 0.0))
            bulges.append(0.0)
        elif code == 20 and points:
            points[-1] = (points[-1][0], _real(value))
        elif code == 42 and points:
            bulges[-1] = _real(value)
    return chained(points, bulges, int(e.real(70)) & 1 == 1)


def _polyline(e: Entity) -> List[Line]:
    if int(e.real(70)) & (16 | 64):
        return []
    points: List[Point] = []
    bulges: List[float] = []
    heads = [i for i, g in enumerate(e.groups) if g[0] == 0] + [len(e.groups)]
    for a, b in zip(heads[1:], heads[2:]):
        vertex = Entity("VERTEX", a, b, e.groups[a:b])
        if int(vertex.real(70)) & 16:
            continue
        points.append((vertex.real(10), vertex.real(20)))
        bulges.append(vertex.real(42))
    return chained(points, bulges, int(e.real(70)) & 1 == 1)


def chained(points: List[Point], bulges: List[float], closed: bool) -> List[Line]:
    """The lines and arcs of a polyline, with the corners between which they run."""
    count = len(points)
    out = []
    for i in range(count if closed and count > 1 else count - 1):
        j = (i + 1) % count
        a, b, bulge = points[i], points[j], bulges[i]
        if bulge == 0.0:
            out.append(straight(a, b, (i, j)))
            continue
        d = minus(b, a)
        middle = ((a[0] + b[0]) / 2 + bulge * d[1] / 2, (a[1] + b[1]) / 2 - bulge * d[0] / 2)
        radius = math.hypot(*d) * (1 + bulge * bulge) / (4 * abs(bulge))
        # An arc runs anticlockwise.
        ends, corners = ((a, b), (i, j)) if bulge > 0 else ((b, a), (j, i))
        out.append(Line("arc", ends, middle, radius, corners))
    return out


def _ellipse(e: Entity) -> List[Line]:
    centre, major = (e.real(10), e.real(20)), (e.real(11), e.real(21))
    ratio = e.real(40, 1.0) * (-1.0 if e.real(230, 1.0) < 0 else 1.0)

    def at(t: float) -> Point:
        c, s = math.cos(t), math.sin(t) * ratio
        return (centre[0] + c * major[0] - s * major[1], centre[1] + c * major[1] + s * major[0])

    begin, end = e.real(41), e.real(42, 2 * math.pi)
    return [Line("curve", (at(begin), at(end)), at((begin + end) / 2), 0.0)]


def _spline(e: Entity) -> List[Line]:
    control = _pairs(e, 10, 20)
    points = control if len(control) > 1 else _pairs(e, 11, 21)
    if len(points) < 2:
        return []
    return [Line("curve", (points[0], points[-1]), points[len(points) // 2], 0.0)]


def _pairs(e: Entity, code_x: int, code_y: int) -> List[Point]:
    xs, ys = ([_real(v) for c, v in e.groups if c == code] for code in (code_x, code_y))
    return list(zip(xs, ys))


#: ``x' = a x + c y + e``, ``y' = b x + d y + f`` as ``(a, b, c, d, e, f)``.
Matrix = Tuple[float, float, float, float, float, float]


def _places(insert: Entity, base: Point, as_host: bool) -> Iterator[Matrix]:
    """From the coordinates of a block to those of its copies."""
    sx, sy = insert.real(41, 1.0) or 1.0, insert.real(42, 1.0) or 1.0
    if as_host:
        even = abs(sx * sy * (insert.real(43, 1.0) or 1.0)) ** (1.0 / 3.0)
        sx, sy = math.copysign(even, sx), math.copysign(even, sy)
    turn = math.radians(insert.real(50))
    c, s = math.cos(turn), math.sin(turn)
    columns, rows = (max(1, int(insert.real(code, 1.0))) for code in (70, 71))
    if columns * rows > COPIES_MAX:
        return
    for row in range(rows):
        for column in range(columns):
            x, y = column * insert.real(44), row * insert.real(45)
            at = (insert.real(10) + c * x - s * y, insert.real(20) + s * x + c * y)
            a, b, cc, d = c * sx, s * sx, -s * sy, c * sy
            yield (a, b, cc, d, at[0] - a * base[0] - cc * base[1], at[1] - b * base[0] - d * base[1])


def _mapped(stroke: Line, m: Matrix) -> Line:
    def at(p: Point) -> Point:
        return (m[0] * p[0] + m[2] * p[1] + m[4], m[1] * p[0] + m[3] * p[1] + m[5])

    ends = (at(stroke.ends[0]), at(stroke.ends[1]))
    across, up = math.hypot(m[0], m[1]), math.hypot(m[2], m[3])
    is_even = abs(across - up) <= 1e-9 * max(across, up)
    kind = stroke.kind if stroke.kind in ("line", "curve") or is_even else "curve"
    if stroke.kind == "circle" and kind == "curve":
        first = at((stroke.middle[0] + stroke.radius, stroke.middle[1]))
        return Line("curve", (first, first), at(stroke.middle), 0.0, (), stroke.layer)
    is_mirrored = m[0] * m[3] - m[1] * m[2] < 0 and kind == "arc"
    corners = stroke.corners[::-1] if is_mirrored else stroke.corners
    return Line(kind, ends[::-1] if is_mirrored else ends, at(stroke.middle), stroke.radius * across, corners, stroke.layer)
