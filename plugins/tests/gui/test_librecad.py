"""What someone sees who opens our drawings in LibreCAD."""

import os
import shutil
import subprocess
import time

import pytest
from conftest import ROOT, shots_folder

#: The drawing area of a maximised window on the test's screen.
AREA = "1200x690+46+105"


@pytest.fixture
def librecad(screen, tmp_path):
    """Opens a drawing in LibreCAD, shows all of it, and keeps a picture; gives the colours in it."""

    def show(drawing, name):
        home = tmp_path / "home"
        (home / ".config" / "LibreCAD").mkdir(parents=True, exist_ok=True)
        (home / ".config" / "LibreCAD" / "LibreCAD.conf").write_text("[Startup]\nFirstLoad=0\n")
        env = {**os.environ, "HOME": str(home), "DISPLAY": screen, "QT_QPA_PLATFORM": "xcb"}
        opened = tmp_path / (name + ".dxf")
        shutil.copy(drawing, opened)
        process = subprocess.Popen(["librecad", opened.name], cwd=tmp_path, env=env, stdin=subprocess.DEVNULL)
        try:
            words = ["xdotool", "search", "--onlyvisible", "--name", opened.name]
            end = time.monotonic() + 300
            while subprocess.run(words, env=env, stdout=subprocess.DEVNULL).returncode:
                assert process.poll() is None and time.monotonic() < end, "LibreCAD does not show the drawing"
                time.sleep(0.3)
            time.sleep(2)
            subprocess.run(words + ["windowmove", "0", "0", "windowsize", "1600", "1000"], env=env, check=True)
            time.sleep(1)
            for keys in (["key", "Escape"], ["mousemove", "600", "400"], *2 * [["type", "za"], ["key", "Return"]]):
                subprocess.run(["xdotool", *keys], env=env, check=True)
                time.sleep(0.6)
            time.sleep(1.5)
            os.makedirs(shots_folder(), exist_ok=True)
            path = os.path.join(shots_folder(), name + ".png")
            grab = ["import", "-window", "root", "-crop", AREA, "+repage", path]
            subprocess.run(grab, env=env, check=True)
        finally:
            process.kill()
            process.wait()
        said = subprocess.run(["convert", path, "-unique-colors", "txt:-"], stdout=subprocess.PIPE, check=True)
        return {line.split()[2] for line in said.stdout.decode().splitlines()[1:]}

    return show


def heat_on_top(drawing):
    """Colours, as the file states them, of the heat map drawn last: it covers the ones below it."""
    lines = [line.strip() for line in drawing.read_text(errors="replace").splitlines()]
    records = []
    for code, value in zip(lines[::2], lines[1::2]):
        if code == "0":
            records.append({})
        elif records:
            records[-1].setdefault(code, value)
    heat = [r for r in records if r.get("8", "").startswith("EF-HEAT-") and "420" in r]
    return {"#%06X" % int(r["420"]) for r in heat if r["8"] == heat[-1]["8"]}


def test_the_marker_template_shows_every_layer(librecad):
    colours = librecad(os.path.join(ROOT, "samples", "marker-template.dxf"), "librecad-template")
    assert {"#FF0000", "#0000FF", "#00FF00"} <= colours, "moves, query, reference"


def test_an_option_shows_heat_map_and_moved_walls(librecad, tmp_path):
    program = os.environ["ENFILADE"]
    drawing = os.path.join(ROOT, "samples", "gallery.dxf")
    words = [program, "run", drawing, "--out", str(tmp_path / "out"), "--evaluations", "600", "--members", "2", "--quiet"]
    assert subprocess.run(words, stdin=subprocess.DEVNULL).returncode in (0, 1)
    option = tmp_path / "out" / "gallery.enfilade" / "round-01" / "candidate-1.dxf"
    shown = librecad(option, "librecad-option")
    wanted = heat_on_top(option)
    missing = wanted - shown
    assert len(wanted) > 5 and not missing, f"of {sorted(wanted)}, LibreCAD does not draw {sorted(missing)}"
