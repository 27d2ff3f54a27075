"""Path of the package under test, a small house, and a stand-in for the program."""

import os
import sys
import textwrap

import pytest

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
sys.path.insert(0, os.path.join(ROOT, "plugins", "common"))

from enfilade_common.model import Clause, Column, Opening, Study, Wall  # noqa: E402


def wall(id, a, b, thickness=250.0, **rest):
    return Wall(id, rest.pop("label", id), [a, b], thickness / 2, thickness / 2, **rest)


@pytest.fixture
def house():
    """8 × 6 m: four outer walls, a partition P1 that moves in x with a door that slides, a wall P2 that ends
    on it, a free screen, a column."""
    partition = wall("P1", (4000, 125), (4000, 5875), 100, clauses=[Clause("x", -1000, 1000)])
    partition.openings = [Opening("D1", "Tür 1", 500, 1400, clauses=[Clause("along", -400, 2000)])]
    south = wall("S", (0, 0), (8000, 0))
    south.openings = [Opening("D2", "Door 2", 1000, 1900), Opening("F", "Fenster", 5000, 6500, "window")]
    screen = wall("P3", (6000, 4500), (6900, 4500), 100)
    screen.clauses = [Clause("y", -700, 700), Clause("rotate", -30, 30)]
    ring = [(1900, 2900), (2100, 2900), (2100, 3100), (1900, 3100)]
    walls = [
        south,
        wall("E", (8000, 0), (8000, 6000)),
        wall("N", (8000, 6000), (0, 6000)),
        wall("W", (0, 6000), (0, 0)),
        partition,
        wall("P2", (4050, 3000), (7000, 3000), 100),
        screen,
    ]
    study = Study("test", "doc", walls, [Column("C", "Säule", ring, clauses=[Clause("x", -500, 500)])])
    study.wishes.evaluations = 300
    study.wishes.members = 2
    return study


@pytest.fixture
def program_that(tmp_path):
    """Makes a program of a Python body, to play every way a real one can behave."""

    def make(body, name="enfilade"):
        path = tmp_path / name
        path.write_text(f"#!{sys.executable}\nimport sys, time, signal, os\n" + textwrap.dedent(body))
        path.chmod(0o755)
        return str(path)

    return make


@pytest.fixture
def real_program():
    """The program itself; the runner of these tests names it in ENFILADE."""
    path = os.environ.get("ENFILADE", "")
    assert path and os.path.exists(path), "ENFILADE names no built program; run scripts/test-plugins"
    return path
