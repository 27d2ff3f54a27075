#!/usr/bin/env python3
"""Does reading grow with the drawing? Makes large and odd drawings, checks each, and says time and memory.

usage: growth.py ENFILADE [NAME...] [--keep FOLDER]

Each case has a limit of seconds (by the clock, so look at the load too) and of memory at its peak. A refusal counts as
held where it is quick and names the limit that the drawing passes. Needs Python alone; ends with 1 where a case fails.
"""

import argparse
import multiprocessing
import os
import pathlib
import random
import resource
import subprocess
import sys
import tempfile
import time

HEAD = "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1024\n9\n$INSUNITS\n70\n6\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n"
TAIL = "0\nENDSEC\n0\nEOF\n"


class Sheet:
    """Entities as text, each with a handle."""

    def __init__(self):
        self.out, self.count = [], 0

    def add(self, kind, layer, *groups):
        self.count += 1
        pairs = "\n".join(f"{code}\n{value}" for code, value in groups)
        self.out.append(f"0\n{kind}\n5\n{self.count + 256:X}\n8\n{layer}\n{pairs}\n")

    def line(self, layer, x, y, u, v):
        self.add("LINE", layer, (10, f"{x:.7g}"), (20, f"{y:.7g}"), (11, f"{u:.7g}"), (21, f"{v:.7g}"))

    def room(self, x, y):
        """The south and the west wall of a room of 5 by 4 m with two faces, a door in each, and its leaf."""
        for d in (0.0, 0.2):
            for a, b in ((0.2, 1.0), (1.9, 5.0)):
                self.line("A-WALL", x + a, y + d, x + b, y + d)
            for a, b in ((0.2, 2.0), (2.9, 4.0)):
                self.line("A-WALL", x + d, y + a, x + d, y + b)
        for a in (1.0, 1.9):
            self.line("A-WALL", x + a, y, x + a, y + 0.2)
        for a in (2.0, 2.9):
            self.line("A-WALL", x, y + a, x + 0.2, y + a)
        self.line("A-DOOR", x + 1.0, y + 0.2, x + 1.0, y + 1.1)
        self.line("A-DOOR", x + 0.2, y + 2.0, x + 1.1, y + 2.0)
        self.add("ARC", "A-DOOR", (10, x + 1.0), (20, y + 0.2), (40, 0.9), (50, 0), (51, 90))
        self.add("ARC", "A-DOOR", (10, x + 0.2), (20, y + 2.0), (40, 0.9), (50, 0), (51, 90))

    def building(self, nx, ny):
        for i in range(nx):
            for j in range(ny):
                self.room(5.0 * i, 4.0 * j)
        w, h = 5.0 * nx, 4.0 * ny
        for d in (0.0, 0.2):
            self.line("A-WALL", 0.2, h + d, w + d, h + d)
            self.line("A-WALL", w + d, 0.2, w + d, h + d)

    def furnish(self, nx, ny, entities):
        """Tiles, tables and chairs line by line until there are so many entities."""
        each = (entities - self.count) // (nx * ny)
        for i in range(nx):
            for j in range(ny):
                x, y, here = 5.0 * i, 4.0 * j, self.count
                for k in range(1, 24):
                    self.line("A-FLOR-PATT", x + 0.2, y + 0.2 + k * 0.158, x + 5.0, y + 0.2 + k * 0.158)
                for k in range(1, 30):
                    self.line("A-FLOR-PATT", x + 0.2 + k * 0.158, y + 0.2, x + 0.2 + k * 0.158, y + 4.0)
                k = 0
                while self.count - here + 4 <= each:
                    self.chair(x + 1.3 + 0.6 * (k % 6), y + 1.3 + 0.55 * (k // 6 % 5), 0.45 - 0.03 * (k // 30))
                    k += 1

    def chair(self, x, y, w):
        for a, b, c, d in ((0, 0, w, 0), (w, 0, w, w), (w, w, 0, w), (0, w, 0, 0)):
            self.line("A-FURN", x + a, y + b, x + c, y + d)

    def polyline(self, layer, points, closed):
        head = [(90, len(points)), (70, int(closed))]
        self.add("LWPOLYLINE", layer, *head, *((c, f"{v:.6g}") for p in points for c, v in zip((10, 20), p)))

    def text(self):
        return HEAD + "".join(self.out) + TAIL


def furnished(nx, ny, entities):
    def made():
        sheet = Sheet()
        sheet.building(nx, ny)
        sheet.furnish(nx, ny, entities)
        return sheet
    return made


def with_house(more):
    def made():
        sheet = Sheet()
        sheet.building(4, 3)
        more(sheet, random.Random(1))
        return sheet
    return made


def winding(layer):
    """A contour line about the house, as a survey brings it."""
    def more(sheet, rng):
        x, y, points = -40.0, -30.0, []
        for k in range(1_000_000):
            x, y = x + 1e-4, y + rng.uniform(-0.01, 0.01)
            points.append((x, y))
        sheet.polyline(layer, points, False)
    return more


def apart(sheet, rng):
    """Pairs of lines all over a wide field: thousands of drawings, most of one wall."""
    for k in range(200_000):
        x, y, w = rng.uniform(0, 4472), rng.uniform(30, 4502), rng.uniform(2, 6)
        for d in (0.0, 0.2):
            sheet.line("A-WALL", *((x, y + d, x + w, y + d) if k % 2 else (x + d, y, x + d, y + w)))


def layers(sheet, rng):
    for k in range(50_000):
        x, y = 1 + 18 * rng.random(), 1 + 10 * rng.random()
        sheet.line(f"L{k}", x, y, x + 0.3, y)


def duplicates(sheet, rng):
    for _ in range(8_000):
        sheet.line("A-WALL", 5.0, 4.0, 8.0, 4.0)


def at_random(sheet, rng):
    for _ in range(20_000):
        sheet.line("A-WALL", *(rng.uniform(0, 40) for _ in range(4)))


def hatch(sheet, rng):
    import math
    groups = [(10, 0), (20, 0), (30, 0), (2, "SOLID"), (70, 1), (71, 0), (91, 1), (92, 2), (72, 0), (73, 1), (93, 20_000)]
    for k in range(20_000):
        t, r = math.tau * k / 20_000, 1.5 + rng.uniform(-0.1, 0.1)
        groups += [(10, f"{10 + r * math.cos(t):.6g}"), (20, f"{6 + r * math.sin(t):.6g}")]
    sheet.add("HATCH", "A-WALL", *groups, (97, 0), (75, 0), (76, 1), (98, 0))


# What is made, seconds, MB.
CASES = {
    "plan": (with_house(lambda sheet, rng: None), 0.1, 100),
    "lines-330000": (furnished(25, 24, 330_000), 2.0, 1000),
    "entities-1000000": (furnished(43, 42, 1_000_000), 10.0, 2000),
    "polyline-walls": (with_house(winding("A-WALL")), 5.0, 500),
    "polyline-site": (with_house(winding("C-TOPO")), 5.0, 500),
    "apart-200000": (with_house(apart), 20.0, 1000),
    "layers-50000": (with_house(layers), 5.0, 500),
    "duplicates-8000": (with_house(duplicates), 5.0, 500),
    "random-20000": (with_house(at_random), 5.0, 500),
    "hatch-20000": (with_house(hatch), 5.0, 500),
}


def checked(exe, path, out):
    """Seconds, MB at the peak, exit status and what was said."""
    began = time.monotonic()
    with open(out, "wb") as file:
        child = subprocess.Popen([exe, "check", path], stdout=file, stderr=subprocess.PIPE)
        said = child.stderr.read().decode(errors="replace")
        _, status, used = os.wait4(child.pid, 0)
    code = os.waitstatus_to_exitcode(status)
    return time.monotonic() - began, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024, code, said


def write(name, path):
    path.write_text(CASES[name][0]().text())


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("enfilade")
    parser.add_argument("names", nargs="*")
    parser.add_argument("--keep", type=pathlib.Path, help="where the drawings are left")
    args = parser.parse_args()
    failed = False
    with tempfile.TemporaryDirectory() as folder:
        folder = args.keep or pathlib.Path(folder)
        folder.mkdir(exist_ok=True)
        for name in args.names or CASES:
            _, seconds, megabytes = CASES[name]
            path = folder / f"{name}.dxf"
            if not path.exists():
                # In a process of its own: the peak of a child counts what its parent held.
                maker = multiprocessing.get_context("spawn").Process(target=write, args=(name, path))
                maker.start()
                maker.join()
            took, cpu, peak, code, said = checked(args.enfilade, path, folder / f"{name}.txt")
            is_held = took <= seconds and peak <= megabytes and code in (0, 1, 2)
            failed |= not is_held
            last = said.strip().splitlines()[-1:] if code else []
            print(f"{'held ' if is_held else 'FAILS'} {name:<18} {path.stat().st_size / 1e6:6.1f} MB  {took:6.2f} s "
                  f"(cpu {cpu:.2f}, limit {seconds:g})  {peak:5.0f} MB (limit {megabytes})  code {code} {''.join(last)[:160]}", flush=True)
    sys.exit(failed)


if __name__ == "__main__":
    main()
