"""A DXF R12 writer: millimetres, handles, XDATA of ours, marker layers. Every CAD program reads it."""

from typing import Dict, Iterable, List, Sequence, Tuple

from . import APPLICATION
from .model import number
from .plane import Point

#: Layers and their colours (AutoCAD colour index), as in the program's marker template.
LAYERS = (
    ("0", 7),
    ("A-WALL", 7),
    ("A-COLS", 7),
    ("A-DOOR", 3),
    ("A-GLAZ", 4),
    ("EF-QUERY", 5),
    ("EF-REFERENCE", 3),
    ("EF-NOTE", 1),
    ("EF-KEEP", 8),
)


class Drawing:
    """Entities in the order in which they are added, each of which gives its handle; ``file_text()`` gives the file.
    ``digits`` behind the point are written; ``is_mm`` says in the file that its unit is mm."""

    def __init__(self, digits: int = 3, is_mm: bool = True, scale: float = 1.0) -> None:
        self._digits, self._is_mm = digits, is_mm
        #: Units of the host in one of the drawing.
        self._scale = scale
        self._entities: List[str] = []
        self._points: List[Point] = []
        self._layers = dict(LAYERS)
        self._handle = 0x20

    def next_handle(self) -> str:
        self._handle += 1
        return f"{self._handle:X}"

    def _begin(self, kind: str, layer: str) -> List[str]:
        self._handle += 1
        # The layer of a pair of regions is one more, in the colour of those without a name.
        colour = next((c for name, c in LAYERS if layer.startswith(name + "-")), 7)
        self._layers.setdefault(layer, colour)
        return ["0", kind, "5", f"{self._handle:X}", "8", escaped(layer)]

    def polyline(self, layer: str, points: Sequence[Point], closed: bool = True, ids: Iterable[str] = ()) -> str:
        """A polyline; ``ids`` become its XDATA strings."""
        out = self._begin("POLYLINE", layer)
        handle = out[3]
        out += ["66", "1", "70", "1" if closed else "0", "10", "0.0", "20", "0.0", "30", "0.0", *xdata(ids)]
        for p in points:
            out += self._begin("VERTEX", layer) + self._point(p, 0)
        out += self._begin("SEQEND", layer)
        self._add(out, points)
        return handle

    def line(self, layer: str, a: Point, b: Point, ids: Iterable[str] = ()) -> str:
        return self._add(self._begin("LINE", layer) + self._point(a, 0) + self._point(b, 1) + xdata(ids), (a, b))

    def circle(self, layer: str, centre: Point, radius: float, ids: Iterable[str] = ()) -> str:
        out = self._begin("CIRCLE", layer) + self._point(centre, 0) + ["40", self._real(radius / self._scale)]
        return self._add(out + xdata(ids), (centre,))

    def arc(self, layer: str, centre: Point, radius: float, angles_deg: Point, ids: Iterable[str] = ()) -> str:
        """An arc between two angles, anticlockwise."""
        out = self._begin("ARC", layer) + self._point(centre, 0) + ["40", self._real(radius / self._scale)]
        out += self._angles_begin()
        out += [v for code, angle in zip(("50", "51"), angles_deg) for v in (code, f"{angle:.9f}")]
        return self._add(out + xdata(ids), (centre,))

    def text(self, layer: str, at: Point, height: float, words: str) -> None:
        """A line of text, anchored at its lower left."""
        out = self._begin("TEXT", layer) + self._point(at, 0) + ["40", number(height / self._scale), "1", escaped(words)]
        self._add(out, (at,))

    def _add(self, groups: List[str], points: Iterable[Point]) -> str:
        self._entities += groups
        self._points += list(points)
        return groups[3]

    def _point(self, p: Point, index: int) -> List[str]:
        """Group codes 10/20/30 (or 11/21/31) of a point."""
        x, y = (self._real(v / self._scale) for v in p)
        return [f"1{index}", x, f"2{index}", y, f"3{index}", "0.0"]

    def _angles_begin(self) -> List[str]:
        """What comes between the circle of an arc and its angles."""
        return []

    def _real(self, value: float) -> str:
        """At least one decimal as R12 readers expect."""
        text = f"{value:.{self._digits}f}".rstrip("0")
        text = text + "0" if text.endswith(".") else text
        return "0.0" if text == "-0.0" else text

    def file_text(self) -> str:
        """The whole file, line ends as on the drawing boards of R12: CR LF."""
        groups = [*self._header(), *_tables(self._layers), "0", "SECTION", "2", "ENTITIES", *self._entities]
        groups += ["0", "ENDSEC", "0", "EOF"]
        return "\r\n".join(groups) + "\r\n"

    def _header(self) -> List[str]:
        xs, ys = [p[0] for p in self._points] or [0.0], [p[1] for p in self._points] or [0.0]
        out = ["0", "SECTION", "2", "HEADER", "9", "$ACADVER", "1", "AC1009"]
        out += ["9", "$INSUNITS", "70", "4" if self._is_mm else "0", "9", "$MEASUREMENT", "70", "1", "9", "$HANDLING", "70", "1"]
        out += ["9", "$HANDSEED", "5", f"{self._handle + 1:X}"]
        for name, x, y in (("$EXTMIN", min(xs), min(ys)), ("$EXTMAX", max(xs), max(ys))):
            out += ["9", name, *self._point((x, y), 0)]
        return [*out, "0", "ENDSEC"]


def _tables(layers: Dict[str, int]) -> List[str]:
    out = ["0", "SECTION", "2", "TABLES", "0", "TABLE", "2", "LTYPE", "70", "1"]
    out += ["0", "LTYPE", "2", "CONTINUOUS", "70", "0", "3", "Solid line", "72", "65", "73", "0", "40", "0.0"]
    out += ["0", "ENDTAB", "0", "TABLE", "2", "LAYER", "70", str(len(layers))]
    for name, colour in layers.items():
        out += ["0", "LAYER", "2", escaped(name), "70", "0", "62", str(colour), "6", "CONTINUOUS"]
    out += ["0", "ENDTAB", "0", "TABLE", "2", "STYLE", "70", "1"]
    out += ["0", "STYLE", "2", "STANDARD", "70", "0", "40", "0.0", "41", "1.0", "50", "0.0", "71", "0"]
    out += ["42", "2.5", "3", "txt", "4", "", "0", "ENDTAB", "0", "TABLE", "2", "APPID", "70", "2"]
    for name in ("ACAD", APPLICATION):
        out += ["0", "APPID", "2", name, "70", "0"]
    return [*out, "0", "ENDTAB", "0", "ENDSEC"]


def xdata(ids: Iterable[str]) -> List[str]:
    values = [v for id in ids for v in ("1000", escaped(id)[:255])]
    return ["1001", APPLICATION, *values] if values else []


def escaped(words: str) -> str:
    """Text for a file without an encoding: other than ASCII as ``\\U+00FC``, no line ends."""
    flat = " ".join(words.split())
    return "".join(c if " " <= c <= "~" else "".join(_unit(u) for u in _utf16(c)) for c in flat)


def _utf16(c: str) -> Tuple[int, ...]:
    data = c.encode("utf-16-be", "surrogatepass")
    return tuple(data[i] << 8 | data[i + 1] for i in range(0, len(data), 2))


def _unit(value: int) -> str:
    return f"\\U+{value:04X}"
