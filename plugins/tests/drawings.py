"""A small DXF as CAD programs write it: two rooms in metres with layers, polylines and a door as a block."""

import math

OUTER = [(0, 0), (8, 0), (8, 6), (0, 6)]
LEFT = [(3.95, 5.75), (0.25, 5.75), (0.25, 0.25), (3.95, 0.25)]
RIGHT = [(4.05, 0.25), (7.75, 0.25), (7.75, 5.75), (4.05, 5.75)]
#: A free screen.
SCREEN = [(5.5, 2.5), (5.6, 2.5), (5.6, 4.5), (5.5, 4.5)]
#: The partition beside its door: faces and jamb.
PARTITION = [((x, a), (x, b)) for x in (3.95, 4.05) for a, b in ((0.25, 0.7), (1.6, 5.75))]
JAMBS = [((3.95, y), (4.05, y)) for y in (0.7, 1.6)]
WALLS, DOORS, NAMES = "A-WALL", "A-DOOR", "A-TEXT"


class Dxf:
    """Groups of a file of R2000, with handles."""

    def __init__(self, insunits=6):
        self._insunits, self._handle = insunits, 0x100
        self.entities, self.block = [], []

    def _begin(self, kind, layer):
        self._handle += 1
        name = {"LWPOLYLINE": "AcDbPolyline", "INSERT": "AcDbBlockReference"}.get(kind, f"AcDb{kind.capitalize()}")
        return [(0, kind), (5, f"{self._handle:X}"), (100, "AcDbEntity"), (8, layer), (100, name)]

    def line(self, layer, a, b):
        self.entities += self._begin("LINE", layer) + [(10, a[0]), (20, a[1]), (30, 0.0), (11, b[0]), (21, b[1]), (31, 0.0)]
        return f"{self._handle:X}"

    def polyline(self, layer, points):
        self.entities += self._begin("LWPOLYLINE", layer) + [(90, len(points)), (70, 1)]
        self.entities += [g for x, y in points for g in ((10, x), (20, y))]
        return f"{self._handle:X}"

    def text(self, layer, at, words):
        self.entities += self._begin("TEXT", layer) + [(10, at[0]), (20, at[1]), (30, 0.0), (40, 0.2), (1, words)]

    def insert(self, layer, name, at, *rest):
        self.entities += self._begin("INSERT", layer) + [(2, name), (10, at[0]), (20, at[1]), (30, 0.0), *rest]
        return f"{self._handle:X}"

    def write(self, path):
        header = [(9, "$ACADVER"), (1, "AC1015"), (9, "$INSUNITS"), (70, self._insunits), (9, "$HANDSEED"), (5, "FFFF")]
        layers = [g for n in ("0", WALLS, DOORS, NAMES) for g in ((0, "LAYER"), (2, n), (70, 0), (62, 7), (6, "CONTINUOUS"))]
        tables = [(0, "TABLE"), (2, "LAYER"), (70, 4), *layers, (0, "ENDTAB")]
        block = [(0, "BLOCK"), (8, "0"), (2, "DOOR"), (70, 0), (10, 0.0), (20, 0.0), (30, 0.0), (3, "DOOR"), *self.block]
        sections = {"HEADER": header, "TABLES": tables, "BLOCKS": [*block, (0, "ENDBLK"), (8, "0")], "ENTITIES": self.entities}
        groups = []
        for name, inside in sections.items():
            groups += [(0, "SECTION"), (2, name), *inside, (0, "ENDSEC")]
        text = "".join(f"{code}\n{value}\n" for code, value in [*groups, (0, "EOF")])
        with open(path, "w", encoding="ascii") as f:
            f.write(text)
        return str(path)


def two_rooms(path, scale=1.0, insunits=6):
    """Writes the drawing; gives the handles of the partition, the screen, the door."""
    out = Dxf(insunits)

    def times(points):
        return [(x * scale, y * scale) for x, y in points]

    leaf = times([(0, 0), (0.9, 0)])
    out.block = [(0, "LINE"), (8, "0"), (10, leaf[0][0]), (20, leaf[0][1]), (11, leaf[1][0]), (21, leaf[1][1])]
    out.block += [(0, "ARC"), (8, "0"), (10, 0.0), (20, 0.0), (40, 0.9 * scale), (50, 0.0), (51, 90.0)]
    out.polyline(WALLS, times(OUTER))
    for chain in (LEFT, RIGHT):
        for a, b in zip(chain, chain[1:]):
            out.line(WALLS, *times([a, b]))
    partition = [out.line(WALLS, *times(pair)) for pair in [*PARTITION, *JAMBS]]
    screen = out.polyline(WALLS, times(SCREEN))
    door = out.insert(DOORS, "DOOR", times([(4.0, 0.7)])[0])
    for at, words in (((1, 3), "Living"), ((6.5, 1), "Bedroom")):
        out.text(NAMES, times([at])[0], words)
    return out.write(path), {"partition": partition, "screen": screen, "door": door}


def strokes(path, scale=1000.0):
    """What a host that keeps nothing but shapes has of a file: one drawn thing for every line."""
    from enfilade_common.dxf_file import DxfFile
    from enfilade_common.model import Drawn, Stroke

    out = []
    for entity in DxfFile(path).entities:
        for line in entity.lines:
            ends = [(x * scale, y * scale) for x, y in line.ends]
            if line.kind == "line":
                stroke = Stroke("lines", ends)
            else:
                turn = math.radians(45)
                middle, r = (line.middle[0] * scale, line.middle[1] * scale), line.radius * scale
                stroke = Stroke("arc", ends, False, (middle[0] - r * math.cos(turn), middle[1] - r * math.sin(turn)), r)
            out.append(Drawn(f"s{len(out)}", f"Shape{len(out)}", [stroke]))
    return out
