"""A plan that FreeCAD imported: the file behind it, how it is read, and a question that one click answers."""

import os
import sys

import pytest
from conftest import ROOT

sys.path.insert(0, os.path.join(ROOT, "plugins", "tests"))
from drawings import Dxf, two_rooms  # noqa: E402


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("drawings")
    other = Dxf()
    for y in range(20):
        other.line("A-WALL", (0, y * 0.37), (5, y * 0.41))
    wrong = other.write(folder / "wrong.dxf")
    right, _ = two_rooms(folder / "right.dxf", 1.0, 6)
    return {"wrong": wrong, "right": right}


def read(window):
    return window.wait_for("read", lambda words: words.startswith("Read in"), 60)


def test_01_no_file_fits_and_the_panel_says_so(window, files):
    window.ask("imported", files["right"])
    read(window)
    assert window.ask("text", "EnfiladeDrawingLabel") == "No DXF file fits these shapes. Layers and unit are unknown."
    window.shot("40-no-file")


def test_02_the_file_chosen_is_used(window, files):
    window.ask("use_file", files["right"])
    assert read(window).startswith("Read in m: ") and ", 1 door, 2 rooms." in read(window)
    assert window.ask("text", "EnfiladeDrawingLabel") == "Layers, blocks and unit from right.dxf."
    window.shot("41-file-behind")


def test_03_another_file_is_refused(window, files):
    window.ask("use_file", files["wrong"])
    assert window.ask("text", "EnfiladeDrawingLabel") == "Layers, blocks and unit from right.dxf."
    assert "wrong.dxf does not fit these shapes: only " in window.ask("panel")["status"]


def test_04_how_wide_is_this_door_is_one_click(window, files):
    window.ask("imported", files["right"])
    window.ask("use_file", files["right"])
    read(window)
    window.ask("drawn_in", "cm")
    window.press("EnfiladeReadAgain")
    said = window.wait_for("read", lambda words: "is the unit right?" in words, 60)
    assert said.startswith("Read in cm"), said
    assert window.ask("text", "EnfiladeDoorAsked") == "How wide is this door?"
    answers = window.ask("answers")
    assert "0.90 m" in answers, answers
    window.shot("42-how-wide")
    window.press(f"EnfiladeAnswer_{answers.index('0.90 m')}")
    said = window.wait_for("read", lambda words: words.startswith("Read in m:"), 60)
    assert "is the unit right?" not in said and window.ask("panel")["status"] == "The drawing is in m."
    assert window.ask("answers") == []
