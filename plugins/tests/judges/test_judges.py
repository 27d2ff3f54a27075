"""Three programs that are not ours read the drawing a plugin writes: ezdxf, LibreCAD, FreeCAD."""

import os
import shutil
import subprocess
import sys

import pytest

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
sys.path.insert(0, os.path.join(ROOT, "plugins", "common"))

from enfilade_common import job  # noqa: E402
from enfilade_common.model import Clause, Column, Opening, Region, Study, Wall  # noqa: E402


@pytest.fixture
def drawing(tmp_path):
    """A small plan with everything that a drawing of ours can hold."""
    corners = [(0, 0), (8000, 0), (8000, 6000), (0, 6000)]
    walls = [Wall(f"w{i}", f"Wand ä{i}", [a, b], 125, 125) for i, (a, b) in enumerate(zip(corners, corners[1:] + corners[:1]))]
    walls[0].openings = [Opening("d", "Tür", 1000, 1900), Opening("f", "Fenster", 4000, 5000, "window")]
    walls.append(Wall("m", "壁", [(4000, 125), (4000, 3000)], 50, 50, clauses=[Clause("x", -500, 500)]))
    walls.append(Wall("z", "thin", [(6000, 2000), (7000, 2000)], 0, 0, keep=True))
    column = Column("c", "Säule", [(1900, 1900), (2100, 1900), (2100, 2100), (1900, 2100)])
    square = [(300, 300), (7700, 300), (7700, 5700), (300, 5700)]
    regions = [Region(kind, square) for kind in ("query", "reference")]
    return job.write(Study("test", "doc", walls, [column], regions=regions), str(tmp_path))


def test_ezdxf_finds_no_fault_and_reads_the_ids(drawing):
    code = (
        "import sys, ezdxf\n"
        "doc = ezdxf.readfile(sys.argv[1]); audit = doc.audit()\n"
        "print(len(audit.errors), len(audit.fixes))\n"
        "ids = [e.get_xdata('ENFILADE')[0].value for e in doc.modelspace() if e.has_xdata('ENFILADE') and e.dxf.layer in ('A-WALL', 'A-COLS')]\n"
        "print(' '.join(ids)); print(doc.units)\n"
        "print([e.dxf.text for e in doc.modelspace().query('TEXT')])\n"
    )
    python = os.path.join(ROOT, ".venv", "bin", "python")
    said = subprocess.run([python, "-c", code, drawing.drawing], stdout=subprocess.PIPE, check=True).stdout.decode().splitlines()
    assert said[0] == "0 0"
    assert said[1].split() == [o.host_id for o in drawing.outlines]
    assert said[2] == "4", "millimetres"
    assert "x -500 500" in said[3]


def test_librecad_opens_it(drawing, tmp_path):
    folder = tmp_path / "librecad"
    folder.mkdir()
    shutil.copy(drawing.drawing, folder / "plan.dxf")
    env = {**os.environ, "HOME": str(tmp_path), "QT_QPA_PLATFORM": "offscreen"}
    words = ["librecad", "dxf2pdf", "-a", "-m", "-p", "420x297", "plan.dxf"]
    subprocess.run(words, cwd=folder, env=env, stdin=subprocess.DEVNULL, timeout=60, check=True)
    assert (folder / "plan.pdf").stat().st_size > 2000


def test_freecad_reads_every_edge_back(drawing, tmp_path):
    code = (
        "import os, sys, FreeCAD as App, importDXF\n"
        "draft = App.ParamGet('User parameter:BaseApp/Preferences/Mod/Draft')\n"
        "draft.SetBool('dxfShowDialog', False); draft.SetBool('groupLayers', True)\n"
        "doc = App.newDocument('d'); importDXF.insert(os.environ['DRAWING'], 'd'); doc.recompute()\n"
        "edges = {o.Label: (len(o.Shape.Edges), o.Shape.BoundBox.XMax) for o in doc.Objects if o.Name.startswith('A_') or o.Label.startswith('A')}\n"
        "open(os.environ['ANSWER'], 'w').write(repr(edges)); sys.stdout.flush(); os._exit(0)\n"
    )
    answer = tmp_path / "answer"
    env = {**os.environ, "HOME": str(tmp_path), "DRAWING": drawing.drawing, "ANSWER": str(answer)}
    done = subprocess.run(["freecadcmd", "-c", code], env=env, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    assert answer.exists(), done.stdout.decode()[-2000:]
    edges = eval(answer.read_text(), {"__builtins__": {}})
    walls = [o for o in drawing.outlines if o.owner != "c"]
    expected = sum(4 if o.is_closed else 1 for o in walls)
    (found,) = [v for k, v in edges.items() if "WALL" in k]
    assert found[0] == expected and found[1] == pytest.approx(8125, abs=1e-3)
    (column,) = [v for k, v in edges.items() if "COLS" in k]
    assert column[0] == 4
