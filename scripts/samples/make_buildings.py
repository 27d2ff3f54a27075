#!/usr/bin/env python3
"""Writes three made-up buildings, drawn as real ones are, each as DXF, IFC and GLB from one model in whole millimetres.

    python3 scripts/samples/make_buildings.py [FOLDER]      needs ezdxf 1.4.5 and ifcopenshell

The same input gives the same bytes: no time, no chance, no path goes into a file.
"""
import json
import math
import struct
import sys
import uuid
from pathlib import Path

# ---------------------------------------------------------------------------------------------------- the model

SOLID = ("outer", "party", "bearing")  # drawn on A-WALL; the rest on A-WALL-PART


class Wall:
    def __init__(self, key, kind, x0, y0, x1, y1, high):
        self.key, self.kind, self.high = key, kind, high
        self.x0, self.y0, self.x1, self.y1 = x0, y0, x1, y1
        self.is_x = x1 - x0 >= y1 - y0
        self.lo, self.hi = (x0, x1) if self.is_x else (y0, y1)
        self.side = (y0, y1) if self.is_x else (x0, x1)
        self.thick = self.side[1] - self.side[0]
        self.openings = []

    def at(self, along, across):
        """A point by the way along the wall and the place across it."""
        return (along, across) if self.is_x else (across, along)

    def rect(self, a, b):
        return (*self.at(a, self.side[0]), *self.at(b, self.side[1]))


class Opening:
    def __init__(self, kind, wall, lo, width, sill, head):
        self.kind, self.wall, self.lo, self.hi, self.width = kind, wall, lo, lo + width, width
        self.sill, self.head = sill, head


class Item:
    def __init__(self, kind, x, y, rot):
        self.kind, self.x, self.y, self.rot = kind, x, y, rot


class Building:
    def __init__(self, name, title, high, clear):
        self.name, self.title, self.high, self.clear = name, title, high, clear
        self.walls, self.doors, self.windows, self.rooms, self.items, self.columns = [], [], [], [], [], []
        self.stairs = []
        self.by_key = {}

    def wall(self, key, kind, x0, y0, x1, y1, high=None):
        wall = Wall(key, kind, x0, y0, x1, y1, high or self.high)
        wall.name = f"Wall-{len(self.walls) + 1:03}"
        for other in self.walls:
            assert not (x0 < other.x1 and other.x0 < x1 and y0 < other.y1 and other.y0 < y1), (key, other.key)
        self.walls.append(wall)
        self.by_key[key] = wall

    def column(self, x, y, size):
        self.columns.append((x - size // 2, y - size // 2, x + size // 2, y + size // 2))

    def _opening(self, kind, key, lo, width, sill, head):
        wall = self.by_key[key]
        o = Opening(kind, wall, lo, width, sill, head)
        assert wall.lo <= o.lo and o.hi <= wall.hi, (key, lo)
        for other in wall.openings:
            assert o.hi <= other.lo or other.hi <= o.lo, (key, lo)
        wall.openings.append(o)
        wall.openings.sort(key=lambda q: q.lo)
        return o

    def door(self, key, lo, width, hinge, swing, leaves=1, head=2100):
        """hinge: lo or hi end; swing: + or -, towards larger or smaller coordinates."""
        o = self._opening("door", key, lo, width, 0, head)
        o.hinge, o.swing, o.leaves = hinge, 1 if swing == "+" else -1, leaves
        self.doors.append(o)
        o.name = f"Door-{len(self.doors):02}"

    def window(self, key, lo, width, sill=900, head=2300):
        o = self._opening("window", key, lo, width, sill, head)
        self.windows.append(o)
        o.name = f"Window-{len(self.windows):02}"

    def room(self, number, name, *points, label=None):
        if len(points) == 2:
            (a, b), (c, d) = points
            points = ((a, b), (c, b), (c, d), (a, d))
        area = abs(sum(p[0] * q[1] - q[0] * p[1] for p, q in ring(points))) / 2e6
        xs, ys = [p[0] for p in points], [p[1] for p in points]
        label = label or ((min(xs) + max(xs)) // 2, (min(ys) + max(ys)) // 2)
        self.rooms.append({"number": number, "name": name, "points": list(points), "area": area, "label": label})

    def put(self, kind, x, y, rot=0):
        self.items.append(Item(kind, x, y, rot))


def ring(points):
    return list(zip(points, list(points[1:]) + [points[0]]))


# Things: width, depth, height, low; layer; IFC class and kind; what the block shows, mm. The origin is the middle of the
# back, y points into the room.
def rect(x0, y0, x1, y1):
    return ("poly", [(x0, y0), (x1, y0), (x1, y1), (x0, y1)])


def chair(x, y):
    return [rect(x - 210, y, x + 210, y + 420)]


def table(w, d, chairs):
    """A table with chairs along both sides; the origin is its middle."""
    out = [rect(-w // 2, -d // 2, w // 2, d // 2)]
    for i in range(chairs):
        x = round(w * ((i + 0.5) / chairs - 0.5))
        out += chair(x, d // 2 + 20) + chair(x, -d // 2 - 440)
    return out


THINGS = {
    "WC": (380, 680, 780, "ware", "TOILETPAN",
           [rect(-190, 0, 190, 180), ("bulge", [(-175, 180, 0), (-175, 480, -1), (175, 480, 0), (175, 180, 0)])]),
    "BASIN": (600, 480, 860, "ware", "WASHHANDBASIN", [rect(-300, 0, 300, 480), ("circle", 0, 260, 170), ("circle", 0, 260, 25)]),
    "BASIN-45": (450, 350, 860, "ware", "WASHHANDBASIN", [rect(-225, 0, 225, 350), ("circle", 0, 190, 120)]),
    "BATH": (1700, 750, 560, "ware", "BATH",
             [rect(-850, 0, 850, 750), ("bulge", [(-770, 70, 0), (560, 70, 1), (560, 680, 0), (-770, 680, 0)]), ("circle", -620, 375, 30)]),
    "URINAL": (360, 320, 1100, "ware", "URINAL", [("bulge", [(-180, 0, 0), (-180, 140, -1), (180, 140, 0), (180, 0, 0)])]),
    "SINK": (1000, 600, 900, "ware", "SINK", [rect(-500, 0, 500, 600), rect(-440, 90, 0, 510), rect(60, 90, 440, 510), ("circle", -220, 300, 30)]),
    "HOB": (600, 600, 900, "furn", "HOB",
            [rect(-300, 0, 300, 600)] + [("circle", x, y, 90) for x in (-140, 140) for y in (160, 430)]),
    "FRIDGE": (600, 600, 1450, "furn", "FRIDGE", [rect(-300, 0, 300, 600), ("line", -300, 0, 300, 600)]),
    "UNIT-90": (900, 600, 900, "furn", "KITCHEN UNIT", [rect(-450, 0, 450, 600)]),
    "WASHER": (600, 600, 850, "furn", "WASHING MACHINE", [rect(-300, 0, 300, 600), ("circle", 0, 300, 200)]),
    "BED-180": (1800, 2050, 500, "furn", "BED",
                [rect(-900, 0, 900, 2050), rect(-800, 60, -60, 460), rect(60, 60, 800, 460), ("line", -900, 620, 900, 620)]),
    "BED-90": (900, 2050, 500, "furn", "BED", [rect(-450, 0, 450, 2050), rect(-350, 60, 350, 460), ("line", -450, 620, 450, 620)]),
    "WARDROBE-240": (2400, 600, 1450, "furn", "WARDROBE",
                     [rect(-1200, 0, 1200, 600), ("line", -1160, 300, 1160, 300)] + [("line", x, 80, x + 60, 520) for x in range(-900, 901, 600)]),
    "WARDROBE-120": (1200, 600, 1450, "furn", "WARDROBE",
                     [rect(-600, 0, 600, 600), ("line", -560, 300, 560, 300)] + [("line", x, 80, x + 60, 520) for x in range(-400, 401, 400)]),
    "COATS": (1100, 400, 1450, "furn", "WARDROBE", [rect(-550, 0, 550, 400), ("line", -520, 200, 520, 200)]),
    "SOFA": (2200, 950, 800, "furn", "SOFA",
             [rect(-1100, 0, 1100, 950), rect(-1100, 0, 1100, 200), rect(-1100, 200, -900, 950), rect(900, 200, 1100, 950), ("line", 0, 200, 0, 950)]),
    "SIDEBOARD": (1800, 450, 500, "furn", "SHELF", [rect(-900, 0, 900, 450), ("line", -300, 0, -300, 450), ("line", 300, 0, 300, 450)]),
    "SHELF-180": (1800, 300, 1450, "furn", "SHELF", [rect(-900, 0, 900, 300), ("line", -900, 0, 900, 300)]),
    "CABINET": (1200, 450, 1100, "furn", "FILECABINET", [rect(-600, 0, 600, 450), ("line", 0, 0, 0, 450)]),
    "DESK": (1600, 800, 720, "furn", "DESK", [rect(-800, 0, 800, 800)] + chair(0, 830)),
    "DESK-120": (1200, 600, 720, "furn", "DESK", [rect(-600, 0, 600, 600)] + chair(0, 620)),
    "SCHOOL-DESK": (1300, 550, 720, "furn", "DESK", [rect(-650, 0, 650, 550)] + chair(-320, 570) + chair(320, 570)),
    "BOARD": (4000, 80, 1450, "furn", "BOARD", [rect(-2000, 0, 2000, 80)]),
    "RECEPTION": (2800, 800, 1100, "furn", "DESK", [rect(-1400, 0, 1400, 800), ("line", -1400, 500, 1400, 500)] + chair(0, -460)),
    "AIR-UNIT": (1800, 900, 1450, "furn", "UNIT", [rect(-900, 0, 900, 900), ("line", -900, 0, 900, 900), ("line", -900, 900, 900, 0)]),
    "TABLE-6": (1600, 900, 740, "furn", "TABLE", table(1600, 900, 3)),
    "TABLE-4": (1000, 800, 740, "furn", "TABLE", table(1000, 800, 2)),
    "TABLE-10": (3600, 1200, 740, "furn", "TABLE", table(3600, 1200, 5)),
}
CENTRED = ("TABLE-6", "TABLE-4", "TABLE-10")  # the origin is the middle


def flat():
    b = Building("flat", "Flat on the second floor", 2600, 2600)
    b.wall("S", "outer", 0, 0, 11880, 360)
    b.wall("N", "outer", 0, 9250, 11880, 9610)
    b.wall("W", "party", 0, 360, 240, 9250)
    b.wall("E", "party", 11640, 360, 11880, 9250)
    b.wall("mid", "bearing", 240, 4660, 11640, 4900)
    b.wall("bed-living", "part", 3940, 360, 4040, 4660)
    b.wall("living-kitchen", "part", 9240, 360, 9340, 4660)
    b.wall("bed2", "part", 2740, 4900, 2840, 9250)
    b.wall("hall", "part", 2840, 6150, 9290, 6250)
    b.wall("study-bath", "part", 5840, 6250, 5965, 9250)
    b.wall("bath-wc", "part", 8165, 6250, 8290, 9250)
    b.wall("wc-hall", "part", 9290, 6150, 9390, 9250)
    b.wall("storage", "part", 9390, 7350, 11640, 7450)
    b.door("E", 5000, 1010, "hi", "-")
    b.door("mid", 2940, 885, "hi", "-")
    b.door("mid", 6000, 1260, "lo", "-", leaves=2)
    b.door("mid", 9450, 885, "lo", "-")
    b.door("bed2", 5080, 885, "lo", "-")
    b.door("hall", 4800, 885, "hi", "+")
    b.door("hall", 6075, 760, "lo", "+")
    b.door("hall", 8400, 760, "lo", "+")
    b.door("storage", 10500, 760, "hi", "+")
    b.window("S", 1350, 1510)
    b.window("S", 4900, 2010)
    b.window("S", 7400, 1510)
    b.window("S", 9900, 1260, 1100)
    b.window("N", 860, 1260)
    b.window("N", 3710, 1260)
    b.window("N", 6700, 760, 1300)
    b.window("N", 8535, 510, 1300)
    b.window("N", 10260, 510, 1300)
    b.room("01", "Hall", (2840, 4900), (11640, 4900), (11640, 7350), (9390, 7350), (9390, 6150), (2840, 6150), label=(7240, 5525))
    b.room("02", "Living room", (4040, 360), (9240, 4660), label=(5700, 3500))
    b.room("03", "Kitchen", (9340, 360), (11640, 4660), label=(10150, 2600))
    b.room("04", "Bedroom 1", (240, 360), (3940, 4660), label=(3050, 1100))
    b.room("05", "Bedroom 2", (240, 4900), (2740, 9250), label=(1490, 6850))
    b.room("06", "Study", (2840, 6250), (5840, 9250), label=(4000, 7300))
    b.room("07", "Bath", (5965, 6250), (8165, 9250), label=(7000, 7350))
    b.room("08", "WC", (8290, 6250), (9290, 9250), label=(8790, 8150))
    b.room("09", "Storage", (9390, 7450), (11640, 9250), label=(10200, 8300))
    for kind, x, y, rot in (
        ("BED-180", 240, 2300, 270), ("WARDROBE-240", 1500, 4660, 180),
        ("SOFA", 7000, 2000, 90), ("SIDEBOARD", 4040, 2000, 270), ("TABLE-6", 8080, 2200, 90),
        ("FRIDGE", 11640, 4300, 90), ("UNIT-90", 11640, 3550, 90), ("HOB", 11640, 2800, 90), ("UNIT-90", 11640, 2050, 90), ("SINK", 11640, 1100, 90),
        ("BED-90", 750, 9250, 180), ("WARDROBE-120", 2740, 7400, 90), ("DESK-120", 240, 5900, 270),
        ("DESK", 5840, 8200, 90), ("SHELF-180", 2840, 7900, 270),
        ("BATH", 8165, 8300, 90), ("BASIN", 5965, 7600, 270), ("WC", 5965, 8600, 270), ("WASHER", 8165, 6650, 90),
        ("WC", 8790, 9250, 180), ("BASIN-45", 9290, 7600, 90),
        ("COATS", 11640, 6750, 90), ("SHELF-180", 10515, 9250, 180),
    ):
        b.put(kind, x, y, rot)
    return b


def office():
    b = Building("small-office", "Office floor", 3000, 3000)
    b.wall("S", "outer", 0, 0, 23300, 300)
    b.wall("N", "outer", 0, 11300, 23300, 11600)
    b.wall("W", "outer", 0, 300, 300, 11300)
    b.wall("E", "outer", 23000, 300, 23300, 11300)
    b.wall("lobby", "part", 5300, 300, 5400, 6600)
    lo, starts = 5400, (5400, 8940, 12480, 16020, 19560)
    for i, x in enumerate(starts):
        last = i == len(starts) - 1
        b.wall(f"cs{i + 1}", "part", lo, 4900, 23000 if last else x + 3340, 5000)
        if not last:
            b.wall(f"o{i + 1}{i + 2}", "part", x + 3440, 300, x + 3540, 4800)
            b.column(x + 3490, 4950, 300)
            lo = x + 3640
    b.wall("cn-west", "part", 300, 6600, 9400, 6700)
    b.wall("meeting-tea", "part", 6300, 6700, 6400, 11300)
    b.wall("core-south", "bearing", 9400, 6600, 13925, 6800)
    b.wall("core-west", "bearing", 9400, 6800, 9600, 11300)
    b.wall("core-east", "bearing", 13725, 6800, 13925, 11300)
    b.wall("wc-wc", "part", 11600, 6800, 11725, 11300)
    b.wall("cn-east", "part", 13925, 6600, 23000, 6700)
    b.wall("plant", "part", 16425, 6700, 16600, 11300)
    b.wall("archive", "part", 18600, 6700, 18700, 11300)
    for i, x in enumerate((9600, 11725)):
        b.wall(f"cub{i}", "cubicle", x, 9300, x + 2000, 9350, 2000)
        b.wall(f"div{i}", "cubicle", x + 975, 9350, x + 1025, 11300, 2000)
    b.door("W", 2700, 1800, "lo", "-", leaves=2)
    b.door("lobby", 5290, 1010, "hi", "+")
    for i, x in enumerate(starts):
        b.door(f"cs{i + 1}", x + (100 if i == 0 else 200), 885, "lo", "-")
    b.door("cn-west", 3900, 1010, "hi", "+")
    b.door("cn-west", 6550, 885, "lo", "+")
    b.door("core-south", 9750, 885, "lo", "+")
    b.door("core-south", 12690, 885, "hi", "+")
    b.door("cn-east", 14100, 1010, "lo", "+")
    b.door("cn-east", 16750, 885, "lo", "+")
    b.door("cn-east", 18850, 885, "lo", "+")
    for i, x in enumerate((9600, 11725)):
        b.door(f"cub{i}", x + 140, 700, "lo", "+", head=2000)
        b.door(f"cub{i}", x + 1165, 700, "lo", "+", head=2000)
    for x in (700, 2910):
        b.window("S", x, 2010, 400)
    for x in starts:
        b.window("S", x + 715, 2010)
    for x, w, sill in ((800, 2010, 900), (3310, 2010, 900), (7140, 1510, 1100), (9835, 510, 1300), (12980, 510, 1300), (17095, 1010, 900), (19100, 1510, 900), (21100, 1510, 900)):
        b.window("N", x, w, sill)
    b.window("W", 8250, 1510)
    b.window("E", 1850, 1510)
    b.window("E", 5295, 1010)
    b.window("E", 8250, 1510)
    b.room("101", "Reception", (300, 300), (5300, 6600), label=(3300, 5300))
    b.room("102", "Corridor", (5400, 5000), (9040 - 300, 5000), (8740, 5100), (9040, 5100), (9040, 5000), (12280, 5000), (12280, 5100), (12580, 5100),
           (12580, 5000), (15820, 5000), (15820, 5100), (16120, 5100), (16120, 5000), (19360, 5000), (19360, 5100), (19660, 5100), (19660, 5000),
           (23000, 5000), (23000, 6600), (5400, 6600), label=(14200, 5900))
    for i, x in enumerate(starts):
        left = [(x, 4800 if i else 4900), (x, 300)]
        if i:
            left = [(x + 100, 4900), (x + 100, 4800)] + left
        right = [(x + 3440, 300), (x + 3440, 4900)] if i == 4 else [(x + 3440, 300), (x + 3440, 4800), (x + 3340, 4800), (x + 3340, 4900)]
        b.room(f"{103 + i}", f"Office {i + 1}", *left, *right, label=(x + 1720, 3300))
    b.room("108", "Meeting room", (300, 6700), (6300, 11300), label=(3300, 10400))
    b.room("109", "Tea kitchen", (6400, 6700), (9400, 11300), label=(8000, 7900))
    b.room("110", "WC women", (9600, 6800), (11600, 9300), label=(10600, 8300))
    b.room("111", "WC men", (11725, 6800), (13725, 9300), label=(12725, 8300))
    b.room("112", "Plant room", (13925, 6700), (16425, 11300), label=(15150, 9200))
    b.room("113", "Archive", (16600, 6700), (18600, 11300), label=(17600, 8700))
    b.room("114", "Office 6", (18700, 6700), (23000, 11300), label=(21200, 7600))
    for x in starts:
        b.put("DESK", x + 1720, 1400, 90)
        b.put("DESK", x + 1720, 1400, 270)
        b.put("CABINET", x + 3440, 3900, 90)
    for kind, x, y, rot in (
        ("RECEPTION", 3900, 1700, 90), ("SOFA", 1500, 6600, 180), ("TABLE-10", 3300, 9000, 0), ("SIDEBOARD", 300, 7600, 270),
        ("SINK", 9400, 10500, 90), ("UNIT-90", 9400, 9550, 90), ("FRIDGE", 9400, 8800, 90), ("TABLE-4", 7600, 9600, 0),
        ("BASIN", 11600, 7600, 90), ("BASIN", 11725, 7600, 270),
        ("WC", 10087, 11300, 180), ("WC", 11113, 11300, 180), ("WC", 12212, 11300, 180), ("WC", 13238, 11300, 180),
        ("AIR-UNIT", 15200, 11100, 180), ("SHELF-180", 16600, 9900, 270), ("SHELF-180", 18600, 9900, 90),
        ("DESK", 20850, 9400, 90), ("DESK", 20850, 9400, 270), ("CABINET", 18700, 10300, 270),
    ):
        b.put(kind, x, y, rot)
    return b


def school():
    b = Building("school-wing", "School wing", 3300, 3300)
    b.wall("S", "outer", 0, 0, 36800, 400)
    b.wall("N", "outer", 0, 15590, 36800, 15990)
    b.wall("W", "outer", 0, 400, 400, 15590)
    b.wall("E", "outer", 36400, 400, 36800, 15590)
    b.wall("cs", "bearing", 400, 7600, 36400, 7840)
    b.wall("c12", "part", 9265, 400, 9415, 7600)
    b.wall("c23", "bearing", 18280, 400, 18520, 7600)
    b.wall("c34", "part", 27385, 400, 27535, 7600)
    b.wall("stair-s", "bearing", 400, 10440, 3640, 10680)
    b.wall("stair-e", "bearing", 3400, 10680, 3640, 15590)
    b.wall("cn", "part", 3640, 10440, 26240, 10590)
    b.wall("store-e", "bearing", 26240, 10440, 26480, 15590)
    b.wall("cn2", "part", 26480, 10440, 36400, 10590)
    b.wall("staff-group", "part", 11640, 10590, 11790, 15590)
    b.wall("group-wc", "part", 16790, 10590, 16940, 15590)
    b.wall("wc-wc", "part", 19940, 10590, 20090, 15590)
    b.wall("wc-store", "part", 23090, 10590, 23240, 15590)
    for i, x in enumerate((16940, 20090)):
        b.wall(f"cub{i}", "cubicle", x, 13800, x + 3000, 13850, 2000)
        b.wall(f"div{i}a", "cubicle", x + 950, 13850, x + 1000, 15590, 2000)
        b.wall(f"div{i}b", "cubicle", x + 1950, 13850, x + 2000, 15590, 2000)
    b.door("W", 8240, 1800, "lo", "-", leaves=2, head=2300)
    b.door("E", 8640, 1010, "lo", "+")
    b.door("cs", 8100, 1010, "hi", "-")
    b.door("cs", 9570, 1010, "lo", "-")
    b.door("cs", 18680, 1010, "lo", "-")
    b.door("cs", 35200, 1010, "hi", "-")
    b.door("stair-s", 1200, 1260, "lo", "-", leaves=2)
    b.door("cn", 10300, 1010, "hi", "+")
    b.door("cn", 11950, 1010, "lo", "+")
    b.door("cn", 17100, 885, "lo", "+")
    b.door("cn", 20250, 885, "lo", "+")
    b.door("cn", 23400, 885, "lo", "+")
    b.door("cn2", 26640, 1010, "lo", "+")
    for i, x in enumerate((16940, 20090)):
        for dx in (125, 1125, 2150):
            b.door(f"cub{i}", x + dx, 700, "lo", "+", head=2000)
    rooms = (400, 9415, 18520, 27535)
    for x in rooms:
        for dx in (800, 3430, 6060):
            b.window("S", x + dx, 2010, head=2700)
    for x, w, sill in ((1300, 1260, 1200), (4500, 2010, 900), (8000, 2010, 900), (13285, 2010, 900), (17160, 510, 1300), (18160, 510, 1300), (19185, 510, 1300),
                       (20310, 510, 1300), (21310, 510, 1300), (22335, 510, 1300), (24235, 1010, 1300), (27300, 2010, 900), (30430, 2010, 900), (33560, 2010, 900)):
        b.window("N", x, w, sill, 2700)
    for i, x in enumerate(rooms):
        b.room(f"1.0{i + 1}", f"Classroom {i + 1}", (x, 400), (x + 8865, 7600), label=(x + 4430, 7000))
    b.room("1.05", "Corridor", (400, 7840), (36400, 10440), label=(15000, 9140))
    b.room("1.06", "Stair", (400, 10680), (3400, 15590), label=(1900, 11300))
    b.room("1.07", "Teachers' room", (3640, 10590), (11640, 15590), label=(7000, 11300))
    b.room("1.08", "Group room", (11790, 10590), (16790, 15590), label=(14900, 11500))
    b.room("1.09", "WC girls", (16940, 10590), (19940, 13800), label=(18600, 12600))
    b.room("1.10", "WC boys", (20090, 10590), (23090, 13800), label=(21750, 12600))
    b.room("1.11", "Storage", (23240, 10590), (26240, 15590), label=(24900, 12600))
    b.room("1.12", "Classroom 5", (26480, 10590), (36400, 15590), label=(31440, 11200))
    for i, x in enumerate(rooms):
        west = i % 2 == 0  # the board is at the west wall
        place = (lambda d: x + d) if west else (lambda d: x + 8865 - d)
        rot = 270 if west else 90
        b.put("BOARD", place(0), 3600, rot)
        b.put("DESK", place(1900), 5600, 90 if west else 270)
        for d in (3000, 4800, 6600):
            for y in (1350, 3000, 4650, 6200)[: 4 if d < 6600 else 3]:
                b.put("SCHOOL-DESK", place(d), y, rot)
    b.put("BOARD", 36400, 13090, 90)
    b.put("DESK", 34500, 14300, 270)
    for x in (28600, 31400):
        for y in (12200, 14000):
            b.put("TABLE-6", x, y, 0)
    for kind, x, y, rot in (
        ("TABLE-10", 7200, 13300, 0), ("SHELF-180", 3640, 12000, 270), ("SINK", 11000, 15590, 180), ("CABINET", 3640, 14500, 270),
        ("TABLE-10", 14290, 13500, 0), ("CABINET", 16790, 12500, 90),
        ("WC", 17415, 15590, 180), ("WC", 18415, 15590, 180), ("WC", 19440, 15590, 180), ("BASIN", 19940, 11600, 90), ("BASIN", 19940, 12500, 90),
        ("WC", 20565, 15590, 180), ("WC", 21565, 15590, 180), ("WC", 22590, 15590, 180), ("BASIN", 23090, 11600, 90), ("URINAL", 20090, 12000, 270), ("URINAL", 20090, 12800, 270),
        ("SHELF-180", 26240, 13000, 90), ("SHELF-180", 26240, 14800, 90), ("SHELF-180", 23240, 14400, 270),
    ):
        b.put(kind, x, y, rot)
    # A flight of nine steps along the east wall up to a landing, the second flight back along the west wall.
    b.stairs = [(2000, 11900 + 280 * i, 3400, 12180 + 280 * i, 165 * (i + 1)) for i in range(8)] + [(400, 14140, 3400, 15590, 1485)]
    return b


# ---------------------------------------------------------------------------------------------------- geometry

def pieces(wall):
    """The stretches of a wall that stand at 1.5 m above the floor."""
    at, out = wall.lo, []
    for o in wall.openings:
        if o.lo > at:
            out.append(wall.rect(at, o.lo))
        at = o.hi
    if at < wall.hi:
        out.append(wall.rect(at, wall.hi))
    return out


def outline(rects):
    """The boundary of a union of rectangles as loops, solid on the left."""
    xs = sorted({v for r in rects for v in (r[0], r[2])})
    ys = sorted({v for r in rects for v in (r[1], r[3])})
    full = {(i, j) for r in rects for i in range(xs.index(r[0]), xs.index(r[2])) for j in range(ys.index(r[1]), ys.index(r[3]))}
    nexts = {}
    for i, j in sorted(full):
        a, b, c, d = (xs[i], ys[j]), (xs[i + 1], ys[j]), (xs[i + 1], ys[j + 1]), (xs[i], ys[j + 1])
        for (p, q), beside in (((a, b), (i, j - 1)), ((b, c), (i + 1, j)), ((c, d), (i, j + 1)), ((d, a), (i - 1, j))):
            if beside not in full:
                nexts.setdefault(p, []).append(q)
    loops = []
    while nexts:
        start = min(nexts)
        loop, at, came = [], start, None
        while True:
            ways = nexts[at]
            if len(ways) > 1 and came:  # at a corner that touches: keep to the left, loops stay simple
                ways.sort(key=lambda q: -turn(came, at, q))
            to = ways.pop(0)
            if not ways:
                del nexts[at]
            loop.append(at)
            came, at = at, to
            if at == start:
                break
        loops.append([p for o, p, q in zip([loop[-1]] + loop[:-1], loop, loop[1:] + [loop[0]]) if turn(o, p, q)])
    return loops


def turn(o, p, q):
    v = (p[0] - o[0]) * (q[1] - p[1]) - (p[1] - o[1]) * (q[0] - p[0])
    return (v > 0) - (v < 0)


def minus(segment, others):
    """What of a segment does not lie on others in its line."""
    (ax, ay), (bx, by) = segment
    is_x = ay == by
    lo, hi, line = (min(ax, bx), max(ax, bx), ay) if is_x else (min(ay, by), max(ay, by), ax)
    cuts = []
    for (cx, cy), (dx, dy) in others:
        if (cy == dy) == is_x and (cy if is_x else cx) == line:
            cuts.append((min(cx, dx), max(cx, dx)) if is_x else (min(cy, dy), max(cy, dy)))
    rest = [(lo, hi)]
    for c, d in cuts:
        rest = [p for a, b in rest for p in ((a, min(b, c)), (max(a, d), b)) if p[0] < p[1]]
    flip = (ax, ay) > (bx, by)
    out = [((a, line), (b, line)) if is_x else ((line, a), (line, b)) for a, b in rest]
    return [(b, a) for a, b in reversed(out)] if flip else out


def chains(segments):
    """Segments in their order joined to polylines: points and whether they close."""
    out = []
    for a, b in segments:
        if out and out[-1][-1] == a:
            out[-1].append(b)
        else:
            out.append([a, b])
    if len(out) > 1 and out[-1][-1] == out[0][0]:
        out[0] = out.pop() + out[0][1:]
    return [(c[:-1], True) if c[0] == c[-1] else (c, False) for c in out]


def turned(x, y, rot):
    c, s = {0: (1, 0), 90: (0, 1), 180: (-1, 0), 270: (0, -1)}[rot]
    return x * c - y * s, x * s + y * c


def leaf_axes(door):
    """Of every leaf: hinge at the face of the swing's side, the way along the closed leaf, its width."""
    wall, side = door.wall, door.wall.side[1 if door.swing > 0 else 0]
    width = door.width // door.leaves
    ends = {"lo": (door.lo, 1), "hi": (door.hi, -1)}
    hinges = [ends[door.hinge]] if door.leaves == 1 else [ends["lo"], ends["hi"]]
    for along, way in hinges:
        yield wall.at(along, side), wall.at(way, 0), wall.at(0, door.swing), width


# ---------------------------------------------------------------------------------------------------- DXF

STYLE = {  # unit: name, mm per unit, $INSUNITS; how walls and names are drawn
    "flat": ("mm", 1, 4, "lines"),
    "small-office": ("m", 1000, 6, "mixed"),
    "school-wing": ("cm", 10, 5, "polylines"),
}


def write_dxf(b, path):
    import ezdxf
    from ezdxf import options
    options.write_fixed_meta_data_for_testing = True
    _, per, code, style = STYLE[b.name]
    doc = ezdxf.new("R2000", setup=False)
    doc.header["$INSUNITS"] = code
    doc.header["$MEASUREMENT"] = 1
    for name in ("$TDCREATE", "$TDUPDATE", "$TDUCREATE", "$TDUUPDATE"):
        if name in doc.header:
            doc.header[name] = 2461042.0
    layers = (("A-WALL", 7, 50), ("A-WALL-PART", 8, 35), ("A-WALL-PATT", 253, 13), ("A-COLS", 7, 50), ("A-DOOR", 3, 25), ("A-GLAZ", 4, 25),
              ("A-FURN", 9, 13), ("P-SANR-FIXT", 5, 13), ("A-FLOR-STRS", 8, 18), ("A-AREA-IDEN", 2, 18), ("A-ANNO-DIMS", 1, 13), ("A-ANNO-TTLB", 7, 25))
    used = set()

    def u(v):
        return round(v / per, 4)

    def pt(p):
        return (u(p[0]), u(p[1]))

    msp = doc.modelspace()

    def on(layer):
        used.add(layer)
        return {"layer": layer}

    def draw(space, shapes, attribs):
        for shape in shapes:
            match shape:
                case ("poly", points):
                    space.add_lwpolyline([pt(p) for p in points], close=True, dxfattribs=attribs)
                case ("bulge", points):
                    space.add_lwpolyline([(u(x), u(y), g) for x, y, g in points], format="xyb", close=True, dxfattribs=attribs)
                case ("line", x0, y0, x1, y1):
                    space.add_line(pt((x0, y0)), pt((x1, y1)), dxfattribs=attribs)
                case ("circle", x, y, r):
                    space.add_circle(pt((x, y)), u(r), dxfattribs=attribs)

    def walls(layer, rects, hidden):
        for loop in outline(rects):
            rest = [s for side in ring(loop) for s in minus(side, hidden)]
            if style == "lines" or style == "mixed" and layer == "A-WALL-PART":
                for p, q in rest:
                    msp.add_line(pt(p), pt(q), dxfattribs=on(layer))
            else:
                for points, closed in chains(rest):
                    msp.add_lwpolyline([pt(p) for p in points], close=closed, dxfattribs=on(layer))

    solid = [r for w in b.walls if w.kind in SOLID for r in pieces(w)]
    parts = [r for w in b.walls if w.kind not in SOLID for r in pieces(w)]
    hidden = [s for loop in outline(solid) + [rect(*c)[1] for c in b.columns] for s in ring(loop)]
    walls("A-WALL", solid, [])
    walls("A-WALL-PART", parts, hidden)
    for c in b.columns:
        msp.add_lwpolyline([pt(p) for p in rect(*c)[1]], close=True, dxfattribs=on("A-COLS"))
    if style == "lines":  # bearing walls are filled, a fill for each stretch
        for loop in outline(solid):
            hatch = msp.add_hatch(color=256, dxfattribs=on("A-WALL-PATT"))
            hatch.paths.add_polyline_path([pt(p) for p in loop], is_closed=True)

    for door in b.doors:
        for at, along, swing, width in leaf_axes(door):
            name = f"DOOR-{width}"
            if name not in doc.blocks:
                block = doc.blocks.new(name)
                draw(block, [rect(0, 0, 40, width)], {"layer": "0"})
                block.add_arc((0, 0), u(width), 0, 90, dxfattribs={"layer": "0"})
            angle = round(math.degrees(math.atan2(along[1], along[0]))) % 360
            mirrored = along[0] * swing[1] - along[1] * swing[0] < 0
            extra = {"rotation": angle} | ({"yscale": -1} if mirrored else {})
            msp.add_blockref(name, pt(at), dxfattribs=on("A-DOOR") | extra)
    for window in b.windows:
        thick = window.wall.thick
        name = f"WINDOW-{window.width}-{thick}"
        if name not in doc.blocks:
            block = doc.blocks.new(name)
            inside, w = thick // 2, window.width
            draw(block, [("line", 0, 0, w, 0), ("line", 0, thick, w, thick), rect(0, inside - 35, w, inside + 35), ("line", 0, inside, w, inside)], {"layer": "0"})
        # The block's y runs from the wall's lower face up; in walls along y it is turned about its upper face.
        at = window.wall.at(window.lo, window.wall.side[0 if window.wall.is_x else 1])
        extra = {} if window.wall.is_x else {"rotation": 90}
        msp.add_blockref(name, pt(at), dxfattribs=on("A-GLAZ") | extra)
    for item in b.items:
        name, layer = item.kind, "P-SANR-FIXT" if THINGS[item.kind][3] == "ware" and style != "lines" else "A-FURN"
        if name not in doc.blocks:
            draw(doc.blocks.new(name), THINGS[name][5], {"layer": "0"})
        extra = {"rotation": item.rot} if item.rot else {}
        msp.add_blockref(name, pt((item.x, item.y)), dxfattribs=on(layer) | extra)
    for x0, y0, x1, y1, _ in b.stairs:
        draw(msp, [rect(x0, y0, x1, y1)], on("A-FLOR-STRS"))
    if b.stairs:
        for _, y0, _, _, _ in b.stairs:
            draw(msp, [("line", 400, y0, 1800, y0)], on("A-FLOR-STRS"))
        draw(msp, [("line", 2700, 11700, 2700, 14800), ("line", 2700, 11700, 2600, 11850), ("line", 2700, 11700, 2800, 11850)], on("A-FLOR-STRS"))

    def text(words, at, high, layer="A-AREA-IDEN"):
        t = msp.add_text(words, height=u(high), dxfattribs=on(layer))
        t.set_placement(pt(at), align=ezdxf.enums.TextEntityAlignment.MIDDLE_CENTER)

    for room in b.rooms:
        x, y = room["label"]
        if style == "lines":
            small = room["points"][1][0] - room["points"][0][0] < 1500
            text(f"{room['name']} {room['area']:.1f} m2", (x, y), 90 if small else 140)
        elif style == "mixed":
            words = f"{room['name']}\\P{room['area']:.1f} m2"
            m = msp.add_mtext(words, dxfattribs=on("A-AREA-IDEN") | {"char_height": u(180), "attachment_point": 5})
            m.set_location(pt((x, y)))
        else:
            text(room["number"], (x, y + 350), 180)
            text(room["name"], (x, y), 250)
            text(f"{room['area']:.1f} m2", (x, y - 350), 180)
    low, right = 0, max(w.x1 for w in b.walls)
    text(f"{b.title.upper()}  1:100", (right // 2, low - 2600), 300, "A-ANNO-TTLB")
    # A chain of measures below the plan: lines, ticks and numbers as old drawings have them.
    # The school has one measure alone.
    marks = sorted({0, right} | {v for w in b.walls if w.key == "S" and b.name != "school-wing" for o in w.openings for v in (o.lo, o.hi)})
    draw(msp, [("line", 0, -1000, right, -1000)], on("A-ANNO-DIMS"))
    for v in marks:
        draw(msp, [("line", v - 60, -1060, v + 60, -940)], on("A-ANNO-DIMS"))
    for v, w in zip(marks, marks[1:]):
        text(f"{(w - v) / 1000:.2f}" if per == 1000 else f"{(w - v) // per}", ((v + w) // 2, -850), 120, "A-ANNO-DIMS")
    for name, colour, weight in layers:
        if name in used:
            doc.layers.add(name, color=colour, lineweight=weight)
    doc.header["$EXTMIN"], doc.header["$EXTMAX"] = (0, u(-2800), 0), (u(right), u(max(w.y1 for w in b.walls)), 0)
    import io
    out = io.StringIO()
    doc.write(out)
    path.write_text(out.getvalue(), encoding="utf-8", newline="\n")


# ---------------------------------------------------------------------------------------------------- IFC

def write_ifc(b, path):
    import ifcopenshell
    import ifcopenshell.guid
    f = ifcopenshell.file(schema="IFC4")
    space = uuid.uuid5(uuid.NAMESPACE_URL, "https://example.invalid/enfilade/samples/" + b.name)
    per = 1000 if b.name == "small-office" else 1
    new, seen, points = f.create_entity, {}, {}

    def gid(*what):
        return ifcopenshell.guid.compress(uuid.uuid5(space, "/".join(map(str, what))).hex)

    def n(v):
        return float(round(v / per, 6))

    def point(*xyz):
        key = tuple(n(v) for v in xyz)
        if key not in points:
            points[key] = new("IfcCartesianPoint", key)
        return points[key]

    def once(key, make):
        if key not in seen:
            seen[key] = make()
        return seen[key]

    def direction(*xyz):
        return once(("dir", xyz), lambda: new("IfcDirection", tuple(map(float, xyz))))

    def axis(x=0, y=0, z=0, ref=(1, 0)):
        def make():
            if ref == (1, 0):
                return new("IfcAxis2Placement3D", point(x, y, z))
            return new("IfcAxis2Placement3D", point(x, y, z), direction(0, 0, 1), direction(*ref, 0))
        return once(("axis", x, y, z, ref), make)

    def place(under, x=0, y=0, z=0, ref=(1, 0)):
        return new("IfcLocalPlacement", under, axis(x, y, z, ref))

    def box(x, y, z, w, d, h):
        """A box round the middle x, y of its ground."""
        profile = once(("rect", x, y, w, d), lambda: new(
            "IfcRectangleProfileDef", "AREA", None,
            once(("a2", x, y), lambda: new("IfcAxis2Placement2D", point(x, y))), n(w), n(d)))
        return new("IfcExtrudedAreaSolid", profile, axis(0, 0, z), direction(0, 0, 1), n(h))

    length = new("IfcSIUnit", None, "LENGTHUNIT", None if per == 1000 else "MILLI", "METRE")
    units = [length, new("IfcSIUnit", None, "AREAUNIT", None, "SQUARE_METRE"), new("IfcSIUnit", None, "PLANEANGLEUNIT", None, "RADIAN")]
    model = new("IfcGeometricRepresentationContext", None, "Model", 3, 1e-5, axis())
    body = new("IfcGeometricRepresentationSubContext", "Body", "Model", ParentContext=model, TargetView="MODEL_VIEW")
    axes = new("IfcGeometricRepresentationSubContext", "Axis", "Model", ParentContext=model, TargetView="GRAPH_VIEW")
    project = new("IfcProject", gid("project"), None, b.title, RepresentationContexts=[model], UnitsInContext=new("IfcUnitAssignment", units))
    site_at = place(None)
    site = new("IfcSite", gid("site"), None, "Site", ObjectPlacement=site_at, CompositionType="ELEMENT")
    house_at = place(site_at)
    house = new("IfcBuilding", gid("building"), None, b.title, ObjectPlacement=house_at, CompositionType="ELEMENT")
    floor_at = place(house_at)
    floor = new("IfcBuildingStorey", gid("storey"), None, "Second floor" if b.name == "flat" else "Ground floor", ObjectPlacement=floor_at, CompositionType="ELEMENT", Elevation=0.0)
    for whole, part in ((project, site), (site, house), (house, floor)):
        new("IfcRelAggregates", gid("agg", part.is_a()), None, None, None, whole, [part])

    def shape(*solids):
        return new("IfcShapeRepresentation", body, "Body", "SweptSolid", list(solids))

    contained, types, sets, owners = [], {}, {}, {}

    def properties(name, values, product):
        key = (name, tuple(values.items()))
        def make():
            props = []
            for k, v in values.items():
                kind = "IfcBoolean" if isinstance(v, bool) else "IfcLabel"
                props.append(once(("prop", k, v), lambda: new("IfcPropertySingleValue", k, None, new(kind, v))))
            return []
        if key not in sets:
            make()
            sets[key] = (new("IfcPropertySet", gid("pset", *map(str, key)), None, name, None, [seen[("prop", k, v)] for k, v in values.items()]), [])
        sets[key][1].append(product)

    def typed(key, cls, product, **more):
        if key not in types:
            types[key] = (new(cls, gid("type", *key), None, key[-1], **more), [])
        types[key][1].append(product)
        return types[key][0]

    def mapped(key, cls, solids, **more):
        """A product's shape by the map of its type."""
        if key not in types:
            source = new("IfcRepresentationMap", axis(), shape(*solids()))
            types[key] = (new(cls, gid("type", *key), None, key[-1], RepresentationMaps=[source], **more), [])
        source = types[key][0].RepresentationMaps[0]
        target = once("target", lambda: new("IfcCartesianTransformationOperator3D", None, None, point(0, 0, 0), 1.0))
        item = once(("item", key), lambda: new("IfcMappedItem", source, target))
        return once(("mapped", key), lambda: new("IfcProductDefinitionShape", None, None, [new("IfcShapeRepresentation", body, "Body", "MappedRepresentation", [item])]))

    names = {"outer": "External wall", "party": "Party wall", "bearing": "Bearing wall", "part": "Partition", "cubicle": "Cubicle partition"}
    stuff = {"outer": "Brick", "party": "Sand-lime brick", "bearing": "Concrete", "part": "Plasterboard", "cubicle": "Laminate"}
    usages = {}
    for wall in b.walls:
        along = (1, 0) if wall.is_x else (0, 1)
        middle = sum(wall.side) / 2
        at = place(floor_at, *wall.at(wall.lo, middle), 0, along)
        long = wall.hi - wall.lo
        line = new("IfcPolyline", [point(0, 0), point(long, 0)])
        shapes = [new("IfcShapeRepresentation", axes, "Axis", "Curve2D", [line]), shape(box(long / 2, 0, 0, long, wall.thick, wall.high))]
        product = new("IfcWall", gid("wall", wall.key), None, wall.name, ObjectType=f"{names[wall.kind]} {wall.thick} mm", ObjectPlacement=at,
                      Representation=new("IfcProductDefinitionShape", None, None, shapes), Tag=wall.name[5:],
                      PredefinedType="PARTITIONING" if wall.kind in ("part", "cubicle") else "SOLIDWALL")
        wall.ifc, wall.ifc_at = product, at
        contained.append(product)
        typed(("wall", wall.kind, f"{names[wall.kind]} {wall.thick} mm"), "IfcWallType", product, PredefinedType="PARTITIONING" if wall.kind in ("part", "cubicle") else "SOLIDWALL")
        values = {"IsExternal": wall.kind == "outer", "LoadBearing": wall.kind in SOLID}
        if wall.kind == "party":
            values |= {"FireRating": "REI 90", "Compartmentation": True}
        if b.name == "school-wing" and wall.key.startswith("stair"):
            values |= {"FireRating": "REI 90", "Compartmentation": True}
        properties("Pset_WallCommon", values, product)
        key = (wall.kind, wall.thick)
        if key not in usages:
            material = once(("material", wall.kind), lambda: new("IfcMaterial", stuff[wall.kind]))
            layers = new("IfcMaterialLayerSet", [new("IfcMaterialLayer", material, n(wall.thick), None)], f"{names[wall.kind]} {wall.thick} mm")
            usages[key] = (new("IfcMaterialLayerSetUsage", layers, "AXIS2", "POSITIVE", n(-wall.thick / 2)), [])
        usages[key][1].append(product)
        for o in wall.openings:
            h = o.head - o.sill
            opening_at = place(at, o.lo - wall.lo, 0, o.sill)
            hole = new("IfcOpeningElement", gid("hole", o.name), None, f"Opening {o.name}", ObjectPlacement=opening_at,
                       Representation=new("IfcProductDefinitionShape", None, None, [shape(box(o.width / 2, 0, 0, o.width, wall.thick + 20, h))]), PredefinedType="OPENING")
            new("IfcRelVoidsElement", gid("void", o.name), None, None, None, product, hole)
            if o.kind == "window":
                fill_at = place(opening_at)
                kind = ("window", f"Window {o.width} x {h}")
                looks = mapped(kind, "IfcWindowType", lambda: [box(o.width / 2, 0, 0, o.width, 60, h)],
                               PredefinedType="WINDOW", PartitioningType="SINGLE_PANEL")
                fill = new("IfcWindow", gid("window", o.name), None, o.name, ObjectPlacement=fill_at, Representation=looks, Tag=o.name[7:],
                           OverallHeight=n(h), OverallWidth=n(o.width), PredefinedType="WINDOW", PartitioningType="SINGLE_PANEL")
            else:
                # In the wall's frame x runs along it and y to its left: +y of a wall along x, -x of one along y.
                left = o.swing > 0 if wall.is_x else o.swing < 0
                fill_at = place(opening_at) if left else place(opening_at, o.width, 0, 0, (-1, 0))
                hand = "LEFT" if (o.hinge == "lo") == left else "RIGHT"
                swing = "DOUBLE_DOOR_SINGLE_SWING" if o.leaves == 2 else f"SINGLE_SWING_{hand}"
                kind = ("door", swing, f"Door {o.width} x {h}" + (" double" if o.leaves == 2 else ""))
                looks = mapped(kind, "IfcDoorType", lambda: [box(o.width / 2, 0, 0, o.width, 40, h)], PredefinedType="DOOR", OperationType=swing)
                fill = new("IfcDoor", gid("door", o.name), None, o.name, ObjectPlacement=fill_at, Representation=looks, Tag=o.name[5:],
                           OverallHeight=n(h), OverallWidth=n(o.width), PredefinedType="DOOR", OperationType=swing)
            types[kind][1].append(fill)
            outside = wall.kind == "outer"
            properties("Pset_WindowCommon" if o.kind == "window" else "Pset_DoorCommon", {"IsExternal": outside}, fill)
            o.ifc = fill
            new("IfcRelFillsElement", gid("fill", o.name), None, None, None, hole, fill)
            contained.append(fill)
    for i, (x0, y0, x1, y1) in enumerate(b.columns):
        at = place(floor_at, (x0 + x1) // 2, (y0 + y1) // 2)
        looks = mapped(("column", "Column 300 x 300"), "IfcColumnType", lambda: [box(0, 0, 0, x1 - x0, y1 - y0, b.high)], PredefinedType="COLUMN")
        product = new("IfcColumn", gid("column", i), None, f"Column-{i + 1:02}", ObjectPlacement=at, Representation=looks, PredefinedType="COLUMN")
        types[("column", "Column 300 x 300")][1].append(product)
        properties("Pset_ColumnCommon", {"LoadBearing": True}, product)
        contained.append(product)
    counts = {}
    for item in b.items:
        w, d, h, group, what, _ = THINGS[item.kind]
        counts[item.kind] = counts.get(item.kind, 0) + 1
        name = f"{item.kind.lower()}-{counts[item.kind]:02}"
        at = place(floor_at, item.x, item.y, 0, turned(1, 0, item.rot))
        kind = (group, item.kind)
        y = 0 if item.kind in CENTRED else d / 2
        solids = lambda: [box(0, y, 0, w, d, h)]
        if group == "ware":
            looks = mapped(kind, "IfcSanitaryTerminalType", solids, PredefinedType=what)
            product = new("IfcSanitaryTerminal", gid("item", name), None, name, ObjectPlacement=at, Representation=looks, PredefinedType=what)
        else:
            known = what if what in ("BED", "SOFA", "SHELF", "FILECABINET", "DESK", "TABLE") else "USERDEFINED"
            own = {} if known == what else {"ElementType": what}
            looks = mapped(kind, "IfcFurnitureType", solids, AssemblyPlace="NOTDEFINED", PredefinedType=known, **own)
            product = new("IfcFurniture", gid("item", name), None, name, ObjectType=what if own else None, ObjectPlacement=at, Representation=looks, PredefinedType=known)
        types[kind][1].append(product)
        contained.append(product)
    if b.stairs:
        steps = [box((x0 + x1) / 2, (y0 + y1) / 2, 0, x1 - x0, y1 - y0, h) for x0, y0, x1, y1, h in b.stairs]
        contained.append(new("IfcStair", gid("stair"), None, "Stair-01", ObjectPlacement=place(floor_at),
                             Representation=new("IfcProductDefinitionShape", None, None, [shape(*steps)]), PredefinedType="HALF_TURN_STAIR"))
    right, top = max(w.x1 for w in b.walls), max(w.y1 for w in b.walls)
    slab = new("IfcSlab", gid("slab"), None, "Slab-01", ObjectPlacement=place(floor_at),
               Representation=new("IfcProductDefinitionShape", None, None, [shape(box(right / 2, top / 2, -200, right, top, 200))]), PredefinedType="FLOOR")
    contained.append(slab)
    spaces = []
    for room in b.rooms:
        corners = [point(*p) for p in room["points"]]
        profile = new("IfcArbitraryClosedProfileDef", "AREA", None, new("IfcPolyline", corners + corners[:1]))
        solid = new("IfcExtrudedAreaSolid", profile, axis(), direction(0, 0, 1), n(b.clear))
        product = new("IfcSpace", gid("space", room["number"]), None, room["number"], ObjectPlacement=floor_at, LongName=room["name"],
                      Representation=new("IfcProductDefinitionShape", None, None, [shape(solid)]), CompositionType="ELEMENT", PredefinedType="INTERNAL")
        area = new("IfcQuantityArea", "NetFloorArea", None, None, round(room["area"], 3))
        amounts = new("IfcElementQuantity", gid("qto", room["number"]), None, "Qto_SpaceBaseQuantities", None, None, [area])
        new("IfcRelDefinesByProperties", gid("relqto", room["number"]), None, None, None, [product], amounts)
        spaces.append(product)
        if b.name == "flat":
            bounds(b, f, gid, room, product)
    new("IfcRelAggregates", gid("agg", "spaces"), None, None, None, floor, spaces)
    new("IfcRelContainedInSpatialStructure", gid("contained"), None, None, None, contained, floor)
    for key, (pset, products) in sets.items():
        new("IfcRelDefinesByProperties", gid("relpset", *map(str, key)), None, None, None, products, pset)
    for key, (kind, products) in types.items():
        new("IfcRelDefinesByType", gid("reltype", *key), None, None, None, products, kind)
    for key, (usage, products) in usages.items():
        new("IfcRelAssociatesMaterial", gid("relmat", *key), None, None, None, products, usage)
    head = ("ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('ViewDefinition [ReferenceView_V1.2]'),'2;1');\n"
            f"FILE_NAME('{path.name}','2026-01-01T00:00:00',(''),(''),'','Enfilade samples','');\nFILE_SCHEMA(('IFC4'));\nENDSEC;\n")
    path.write_text(head + "DATA;" + f.to_string().split("\nDATA;", 1)[1], encoding="ascii", newline="\n")


def bounds(b, f, gid, room, product):
    """Which walls, doors and windows a room borders on."""
    for wall in b.walls:
        sides = [((wall.x0, wall.y0), (wall.x1, wall.y0)), ((wall.x0, wall.y1), (wall.x1, wall.y1)),
                 ((wall.x0, wall.y0), (wall.x0, wall.y1)), ((wall.x1, wall.y0), (wall.x1, wall.y1))]
        edges = ring(room["points"])
        shared = [s for s in sides if sum(length(p) for p in minus(s, edges)) < length(s)]
        if not shared:
            continue
        where = "EXTERNAL" if wall.kind in ("outer", "party") else "INTERNAL"
        f.create_entity("IfcRelSpaceBoundary", gid("bound", room["number"], wall.key), None, None, None, product, wall.ifc, None, "PHYSICAL", where)
        for o in wall.openings:
            faces = [(wall.at(o.lo, s), wall.at(o.hi, s)) for s in wall.side]
            if any(not minus(face, edges) for face in faces):
                f.create_entity("IfcRelSpaceBoundary", gid("bound", room["number"], o.name), None, None, None, product, o.ifc, None, "PHYSICAL", where)


def length(segment):
    (a, b), (c, d) = segment
    return abs(c - a) + abs(d - b)


# ---------------------------------------------------------------------------------------------------- GLB

def blocks(xs, zs, depth, is_full):
    """The hull of a body that is cells of a grid in x and z, all of one depth in y: vertices and triangles."""
    vertices, triangles = {}, []

    def v(x, y, z):
        return vertices.setdefault((x, y, z), len(vertices))

    def quad(a, b, c, d):
        p = [v(*q) for q in (a, b, c, d)]
        triangles.append((p[0], p[1], p[2]))
        triangles.append((p[0], p[2], p[3]))

    y0, y1 = depth
    full = {(i, k) for i in range(len(xs) - 1) for k in range(len(zs) - 1) if is_full(xs[i], xs[i + 1], zs[k], zs[k + 1])}
    for i, k in sorted(full):
        x0, x1, z0, z1 = xs[i], xs[i + 1], zs[k], zs[k + 1]
        quad((x0, y0, z0), (x1, y0, z0), (x1, y0, z1), (x0, y0, z1))
        quad((x1, y1, z0), (x0, y1, z0), (x0, y1, z1), (x1, y1, z1))
        if (i - 1, k) not in full:
            quad((x0, y1, z0), (x0, y0, z0), (x0, y0, z1), (x0, y1, z1))
        if (i + 1, k) not in full:
            quad((x1, y0, z0), (x1, y1, z0), (x1, y1, z1), (x1, y0, z1))
        if (i, k - 1) not in full:
            quad((x0, y1, z0), (x1, y1, z0), (x1, y0, z0), (x0, y0, z0))
        if (i, k + 1) not in full:
            quad((x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1))
    return list(vertices), triangles


def simple_box(x0, y0, z0, x1, y1, z1):
    return blocks([x0, x1], [z0, z1], (y0, y1), lambda *_: True)


def prism(points, high):
    """A room: its outline, cut into triangles by ears, pulled up."""
    if sum(p[0] * q[1] - q[0] * p[1] for p, q in ring(points)) < 0:
        points = points[::-1]
    n, left, ground = len(points), list(range(len(points))), []
    while len(left) > 3:
        for k in range(len(left)):
            i, j, m = left[k - 1], left[k], left[(k + 1) % len(left)]
            a, b, c = points[i], points[j], points[m]
            others = [points[o] for o in left if o not in (i, j, m)]
            if turn(a, b, c) > 0 and not any(turn(a, b, p) >= 0 and turn(b, c, p) >= 0 and turn(c, a, p) >= 0 for p in others):
                ground.append((i, j, m))
                left.pop(k)
                break
        else:
            raise AssertionError(points)
    ground.append(tuple(left))
    vertices = [(x, y, 0) for x, y in points] + [(x, y, high) for x, y in points]
    triangles = [(c, b, a) for a, b, c in ground] + [(a + n, b + n, c + n) for a, b, c in ground]
    for i in range(n):
        j = (i + 1) % n
        triangles += [(i, j, j + n), (i, j + n, i + n)]
    return vertices, triangles


def write_glb(b, path):
    nodes, meshes, accessors, positions, indices = [], [], [], bytearray(), bytearray()
    materials = [("Masonry", (0.82, 0.8, 0.77, 1)), ("Plasterboard", (0.95, 0.95, 0.93, 1)), ("Wood", (0.72, 0.53, 0.34, 1)),
                 ("Glass", (0.7, 0.85, 0.95, 0.35)), ("Ceramic", (0.97, 0.97, 1, 1)), ("Screed", (0.6, 0.6, 0.6, 1)), ("Air", (0.6, 0.75, 1, 0.08))]
    index = {name: i for i, (name, _) in enumerate(materials)}
    shared = {}

    def mesh(name, body, material):
        vertices, triangles = body
        assert len(vertices) < 65536
        # Z up to y up, metres.
        points = [tuple(struct.unpack("<f", struct.pack("<f", v / 1000))[0] for v in (x, z, -y)) for x, y, z in vertices]
        short = [[f32(v) for v in c] for c in ([min(p[i] for p in points) for i in range(3)], [max(p[i] for p in points) for i in range(3)])]
        accessors.append({"bufferView": 0, "byteOffset": len(positions), "componentType": 5126, "count": len(points), "type": "VEC3", "min": short[0], "max": short[1]})
        for p in points:
            positions.extend(struct.pack("<3f", *p))
        accessors.append({"bufferView": 1, "byteOffset": len(indices), "componentType": 5123, "count": 3 * len(triangles), "type": "SCALAR"})
        for t in triangles:
            indices.extend(struct.pack("<3H", *t))
        if len(indices) % 4:
            indices.extend(b"\0\0")
        meshes.append({"name": name, "primitives": [{"attributes": {"POSITION": len(accessors) - 2}, "indices": len(accessors) - 1, "material": index[material]}]})
        return len(meshes) - 1

    def once(key, make):
        if key not in shared:
            shared[key] = make()
        return shared[key]

    def f32(v):
        return float(f"{v:.9g}") or 0.0

    def node(name, number, x=0, y=0, z=0, rot=0, **more):
        out = {"name": name, "mesh": number}
        if (x, y, z) != (0, 0, 0):
            out["translation"] = [x / 1000, z / 1000, -y / 1000]
        if rot:  # about the upright axis; halves of the angle's sine and cosine
            h = math.radians(rot) / 2
            out["rotation"] = [0, round(math.sin(h), 15), 0, round(math.cos(h), 15)]
        nodes.append(out | more)

    for wall in b.walls:
        long, half = wall.hi - wall.lo, wall.thick / 2
        holes = [(o.lo - wall.lo, o.hi - wall.lo, o.sill, o.head) for o in wall.openings]
        us = sorted({0, long} | {v for h in holes for v in h[:2]})
        zs = sorted({0, wall.high} | {v for h in holes for v in h[2:]})
        solid = lambda u0, u1, z0, z1: not any(h[0] <= u0 and u1 <= h[1] and h[2] <= z0 and z1 <= h[3] for h in holes)
        vertices, triangles = blocks(us, zs, (-half, half), solid)
        if not wall.is_x:
            vertices = [(-y, x, z) for x, y, z in vertices]
        material = "Masonry" if wall.kind in SOLID else "Plasterboard"
        middle = sum(wall.side) / 2
        node(wall.name, mesh(wall.name, (vertices, triangles), material), *wall.at(wall.lo, middle),
             extras={"IsExternal": wall.kind == "outer", "LoadBearing": wall.kind in SOLID})
    for o in b.doors + b.windows:
        h = o.head - o.sill
        thick, material = (40, "Wood") if o.kind == "door" else (60, "Glass")

        def leaf(is_x=o.wall.is_x, w=o.width):
            size = (0, -thick / 2, 0, w, thick / 2, h) if is_x else (-thick / 2, 0, 0, thick / 2, w, h)
            return mesh(f"{o.kind.capitalize()} {w} x {h}", simple_box(*size), material)

        number = once((o.kind, o.width, h, o.wall.is_x), leaf)
        node(o.name, number, *o.wall.at(o.lo, sum(o.wall.side) / 2), o.sill)
    for i, (x0, y0, x1, y1) in enumerate(b.columns):
        s = (x1 - x0) / 2
        number = once("column", lambda: mesh("Column 300 x 300", simple_box(-s, -s, 0, s, s, b.high), "Masonry"))
        node(f"Column-{i + 1:02}", number, x0 + s, y0 + s)
    counts = {}
    for item in b.items:
        w, d, h, group, _, _ = THINGS[item.kind]
        counts[item.kind] = counts.get(item.kind, 0) + 1
        y = -d / 2 if item.kind in CENTRED else 0
        number = once(item.kind, lambda: mesh(item.kind.lower(), simple_box(-w / 2, y, 0, w / 2, y + d, h), "Ceramic" if group == "ware" else "Wood"))
        node(f"{item.kind.lower()}-{counts[item.kind]:02}", number, item.x, item.y, 0, item.rot)
    for i, (x0, y0, x1, y1, h) in enumerate(b.stairs):
        node(f"Stair-{i + 1:02}", mesh(f"Step {i + 1}", simple_box(x0, y0, 0, x1, y1, h), "Screed"))
    right, top = max(w.x1 for w in b.walls), max(w.y1 for w in b.walls)
    node("Slab-01", mesh("Slab-01", simple_box(0, 0, -200, right, top, 0), "Screed"))
    for room in b.rooms:
        node(f"IfcSpace/{room['name']}", mesh(room["name"], prism(room["points"], b.clear), "Air"))
    total = len(positions) + len(indices)
    scene = {
        "asset": {"version": "2.0", "generator": "Enfilade samples"}, "scene": 0, "scenes": [{"name": b.title, "nodes": list(range(len(nodes)))}],
        "nodes": nodes, "meshes": meshes,
        "materials": [{"name": name, "pbrMetallicRoughness": {"baseColorFactor": list(c), "metallicFactor": 0}} | ({"alphaMode": "BLEND"} if c[3] < 1 else {}) for name, c in materials],
        "accessors": accessors,
        "bufferViews": [{"buffer": 0, "byteLength": len(positions), "byteStride": 12, "target": 34962},
                        {"buffer": 0, "byteOffset": len(positions), "byteLength": len(indices), "target": 34963}],
        "buffers": [{"byteLength": total}],
    }
    text = json.dumps(scene, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    data = bytes(positions + indices)
    assert len(data) % 4 == 0
    whole = 12 + 8 + len(text) + 8 + len(data)
    path.write_bytes(struct.pack("<III", 0x46546C67, 2, whole) + struct.pack("<II", len(text), 0x4E4F534A) + text
                     + struct.pack("<II", len(data), 0x004E4942) + data)


def main():
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    for make in (flat, office, school):
        b = make()
        write_dxf(b, folder / f"{b.name}.dxf")
        write_ifc(b, folder / f"{b.name}.ifc")
        write_glb(b, folder / f"{b.name}.glb")
        print(b.name, f"{sum(r['area'] for r in b.rooms):.1f} m2 in {len(b.rooms)} named rooms, {len(b.walls)} walls, {len(b.doors)} doors, {len(b.windows)} windows")


if __name__ == "__main__":
    main()
