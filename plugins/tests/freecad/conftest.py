"""Documents for the tests, built in FreeCAD itself; the program; the whole loop without a window."""

import os
import subprocess
import sys
import types

import pytest

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
sys.path[:0] = [os.path.join(ROOT, "plugins", "common"), os.path.join(ROOT, "plugins", "freecad", "freecad")]

import FreeCADGui  # noqa: E402

if not hasattr(FreeCADGui, "UiLoader"):
    # FreeCAD 1.0 makes no window without its GUI: Arch asks DraftGui to do something later.
    later = types.SimpleNamespace(delay=lambda call, argument: call(argument), delayAfter=lambda call, argument: None)
    sys.modules.setdefault("DraftGui", types.SimpleNamespace(todo=later))

import Arch  # noqa: E402
import Draft  # noqa: E402
import FreeCAD as App  # noqa: E402
import Part  # noqa: E402

V = App.Vector
KINDS = ("draft", "draft-placed", "wire", "sketch", "part-line", "bare")


@pytest.fixture
def doc():
    doc = App.newDocument("House")
    doc.UndoMode = 1
    yield doc
    for name in list(App.listDocuments()):
        App.closeDocument(name)


def wall_on(doc, kind, a, b, width=100.0, align="Center", label=None):
    """A wall from ``a`` to ``b`` on a base of the given kind."""
    a, b = V(*a, 0), V(*b, 0)
    along = b.sub(a)
    if kind == "draft":
        base = Draft.make_line(a, b)
    elif kind == "draft-placed":
        base = Draft.make_line(V(0, 0, 0), V(along.Length, 0, 0))
        base.Placement = App.Placement(a, App.Rotation(V(1, 0, 0), along))
    elif kind == "wire":
        base = Draft.make_wire([a, a.add(along * 0.5), b])
    elif kind == "sketch":
        base = doc.addObject("Sketcher::SketchObject", "Sketch")
        base.addGeometry(Part.LineSegment(a, b), False)
    elif kind == "part-line":
        base = doc.addObject("Part::Line", "Line")
        base.X1, base.Y1, base.X2, base.Y2, base.Z2 = a.x, a.y, b.x, b.y, 0
    else:
        wall = Arch.makeWall(None, length=along.Length, width=width, height=3000)
        wall.Placement = App.Placement(a.add(along * 0.5), App.Rotation(V(1, 0, 0), along))
        wall.Label = label or wall.Label
        return wall
    doc.recompute()
    wall = Arch.makeWall(base, width=width, height=3000, align=align)
    wall.Label = label or wall.Label
    return wall


def door_in(wall, at, turn_deg=0.0, width=900, kind="Simple door", label=None, sill=0.0):
    place = App.Placement(V(*at, sill), App.Rotation(V(0, 0, 1), turn_deg).multiply(App.Rotation(V(1, 0, 0), 90)))
    door = Arch.makeWindowPreset(
        kind, width=width, height=2100 - sill, h1=50, h2=50, h3=0, w1=100, w2=50, o1=0, o2=50, placement=place
    )
    door.Hosts = [wall]
    door.Label = label or door.Label
    return door


def build_house(doc, kind="draft"):
    """8 × 6 m: outer walls, partition P1 with a door, wall P2 that ends on it, screen P3, a column."""
    outer = [((0, 0), (8000, 0)), ((8000, 0), (8000, 6000)), ((8000, 6000), (0, 6000)), ((0, 6000), (0, 0))]
    walls = {n: wall_on(doc, "draft", a, b, 250.0, label=n) for n, (a, b) in zip("SENW", outer)}
    walls["P1"] = wall_on(doc, kind, (4000, 125), (4000, 5875), label="P1")
    walls["P2"] = wall_on(doc, kind, (4050, 3000), (7000, 3000), label="P2")
    walls["P3"] = wall_on(doc, kind, (6000, 4500), (6900, 4500), label="P3")
    column = Arch.makeStructure(length=300, width=300, height=3000)
    column.Placement.Base = V(1500, 3000, 0)
    column.Label = "Säule"
    doc.recompute()
    door = door_in(walls["P1"], (4000, 700), 90, label="Tür 1")
    doc.recompute()
    doc.recompute()
    from enfilade import marks

    marks.mark(walls["P1"], {"x": (-1000, 1000)})
    marks.mark(walls["P3"], {"y": (-700, 700), "rotate": (-30, 30)})
    marks.mark(column, {"x": (-800, 800)})
    marks.mark(door, {"along": (-300, 2000)})
    doc.recompute()
    doc.clearUndos()
    return walls, door, column


@pytest.fixture
def wishes():
    from enfilade_common.model import Wishes

    return Wishes(members=2, evaluations=200)


@pytest.fixture
def program():
    path = os.environ.get("ENFILADE", "")
    assert path and os.path.exists(path), "ENFILADE names no built program; run scripts/test-plugins"
    return path


@pytest.fixture
def run_study(program):
    """Exports a document, runs the program, reads the round."""

    def run(doc, wishes, folder):
        from enfilade import document
        from enfilade_common import job, results

        study, _ = document.study(doc, wishes)
        made = job.write(study, str(folder))
        done = subprocess.run([program, "run", made.drawing, "--quiet"], stdin=subprocess.DEVNULL)
        assert done.returncode in (0, 1)
        return made, results.latest(made)

    return run


@pytest.fixture(scope="session")
def template(tmp_path_factory):
    """``result.json`` of a real round."""
    import json

    from enfilade import document
    from enfilade_common import job
    from enfilade_common.model import Wishes

    doc = App.newDocument("Template")
    build_house(doc)
    study, _ = document.study(doc, Wishes(members=1, evaluations=60))
    made = job.write(study, str(tmp_path_factory.mktemp("template")))
    App.closeDocument(doc.Name)
    done = subprocess.run([os.environ["ENFILADE"], "run", made.drawing, "--quiet"], stdin=subprocess.DEVNULL)
    assert done.returncode in (0, 1)
    with open(os.path.join(made.results_folder, "round-01", "result.json")) as f:
        return json.load(f)
