"""A fake Revit of the shape of :mod:`enfilade_revit.host`: walls that carry their inserts along, an undo list."""

import contextlib
import copy
import os
import sys

import pytest

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
LIB = os.path.join(ROOT, "plugins", "revit", "Enfilade.extension", "lib")
sys.path[:0] = [os.path.join(ROOT, "plugins", "common"), LIB]

from enfilade_common.plane import direction, dot, minus, plus, turn_about  # noqa: E402
from enfilade_revit.data import DetailLine, RevitColumn, RevitInsert, RevitWall  # noqa: E402


class FakeHost:
    """Plays Revit: everything is one document that can be rolled back."""

    def __init__(self, folder):
        self._folder = str(folder)
        self.things = {}
        self.lines = []
        self.undo = []
        self.refuses = None
        self._depth = 0

    def add(self, thing):
        self.things[thing.element_id] = thing
        return thing

    def _of(self, kind):
        return [t for t in self.things.values() if isinstance(t, kind)]

    def document_id(self):
        return "fake"

    def document_folder(self):
        return self._folder

    def document_name(self):
        return "Haus Süd"

    def level_name(self):
        return "Level 1"

    def exists(self, id):
        return id in self.things

    def walls(self):
        return copy.deepcopy(self._of(RevitWall))

    def inserts(self):
        return copy.deepcopy(self._of(RevitInsert))

    def columns(self):
        return copy.deepcopy(self._of(RevitColumn))

    def detail_lines(self):
        return list(self.lines)

    @contextlib.contextmanager
    def transaction_group(self, name):
        before = copy.deepcopy(self.things)
        try:
            yield
        except BaseException:
            self.things = before
            raise
        self.undo.append((name, before))

    @contextlib.contextmanager
    def transaction(self, name):
        assert self._depth == 0, "Revit knows no nested transactions"
        self._depth += 1
        try:
            yield
        finally:
            self._depth -= 1

    def _check_open(self):
        assert self._depth == 1, "Revit changes nothing outside a transaction"

    def set_wall_line(self, id, a, b):
        self._check_open()
        if id == self.refuses:
            return
        wall = self.things[id]
        old = wall.axis
        wall.axis = [a, b]
        for insert in self._of(RevitInsert):
            if insert.host_id == id:
                along = dot(minus(insert.centre, old[0]), direction(*old))
                insert.centre = plus(a, direction(a, b), along)

    def move(self, id, angle_rad, shift):
        self._check_open()
        motion = turn_about((0.0, 0.0), angle_rad, shift)
        thing = self.things[id]
        if isinstance(thing, RevitInsert):
            thing.centre = motion(thing.centre)
        elif isinstance(thing, RevitColumn):
            thing.ring = [motion(p) for p in thing.ring]
        else:
            thing.axis = thing.axis and [motion(p) for p in thing.axis]
            thing.rings = [[motion(p) for p in r] for r in thing.rings]


class FakeWindow:
    """Answers as told; remembers what was said."""

    def __init__(self, *answers):
        self.answers, self.said = list(answers), []

    def tell(self, title, text):
        self.said.append(text)

    def choose(self, title, question, rows):
        return self.answers.pop(0)

    def choose_picture(self, title, rows, report):
        self.rows = rows
        return self.answers.pop(0)

    def choose_folder(self, title, start):
        return self.answers.pop(0)


@pytest.fixture
def window():
    return FakeWindow


@pytest.fixture
def revit(tmp_path):
    """The house of the common tests as Revit has it."""
    host = FakeHost(tmp_path)
    corners = [(0.0, 0.0), (8000.0, 0.0), (8000.0, 6000.0), (0.0, 6000.0)]
    for i, (a, b) in enumerate(zip(corners, corners[1:] + corners[:1])):
        host.add(RevitWall(100 + i, f"Basic Wall {100 + i}", [a, b], 125.0, 125.0))
    marks = {"Enfilade Moves": "x -1000 1m"}
    host.add(RevitWall(201, "Partition", [(4000.0, 125.0), (4000.0, 5875.0)], 50.0, 50.0, parameters=marks))
    host.add(RevitWall(202, "Spur", [(4050.0, 3000.0), (7000.0, 3000.0)], 50.0, 50.0))
    marks = {"Enfilade Moves": "y -700 700; rotate -30° 30°"}
    host.add(RevitWall(203, "Screen", [(6000.0, 4500.0), (6900.0, 4500.0)], 50.0, 50.0, parameters=marks))
    slide = {"Enfilade Moves": "along -300 2000"}
    host.add(RevitInsert(301, "Door", 201, (4000.0, 1000.0), 900.0, False, slide))
    host.add(RevitInsert(302, "Window", 100, (6000.0, 0.0), 1200.0, True))
    ring = [(1800.0, 2900.0), (2000.0, 2900.0), (2000.0, 3100.0), (1800.0, 3100.0)]
    host.add(RevitColumn(401, "Column", ring, {"Enfilade Moves": "x -500 500"}))
    return host


@pytest.fixture
def square():
    """Detail lines of a closed square, drawn in no order."""

    def make(style, x=0.0, side=1000.0):
        c = [(x, 0.0), (x + side, 0.0), (x + side, side), (x, side)]
        return [DetailLine(style, c[0], c[1]), DetailLine(style, c[3], c[2]), DetailLine(style, c[2], c[1]), DetailLine(style, c[0], c[3])]

    return make


@pytest.fixture
def real_program():
    """The program itself; the runner of these tests names it in ENFILADE."""
    path = os.environ.get("ENFILADE", "")
    assert path and os.path.exists(path), "ENFILADE names no built program; run scripts/test-plugins"
    return path
