"""What one does with it: reading, settings, errors, options, pictures, stopping."""

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import enfilade
import matplotlib.pyplot as plt
import numpy as np
import pytest

HERE = Path(__file__).resolve().parent


def test_a_plan_says_what_it_is(sample, enfilade_says):
    path = sample("gallery.dxf")
    plan = enfilade.read(path)
    said = json.loads(enfilade_says("check", path, "--json"))
    assert (plan.unit, plan.walls) == (said["unit"]["name"], said["walls_understood"])
    assert plan.confidence == said["reading"]["confidence"]
    assert [f["text"] for f in plan.findings] == [p["text"] for p in said["problems"]]
    assert all(set(f) == {"code", "severity", "file", "line", "entity", "text"} for f in plan.findings)
    text = repr(plan)
    for part in ("gallery.dxf", f": {plan.unit}, ", f"{plan.area_m2:.1f} m²", f"{plan.walls} walls", " % confidence"):
        assert part in text, text
    cells = plan.analyse(measures="Connectivity")
    assert plan.area_m2 == pytest.approx(cells["Degree"].count() * cells.attrs["spacing_m"] ** 2, rel=0.2)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(enfilade.Error) as raised:
        enfilade.read(tmp_path / "none.dxf")
    assert (raised.value.code, Path(raised.value.file).name) == ("no-such-file", "none.dxf")
    assert "none.dxf" in str(raised.value) and raised.value.line is None


def test_errors_have_their_line(sample):
    path = sample("gallery.dxf")
    path.with_name("gallery.enfilade.toml").write_text("unit = \"m\"\nspacin = 1\n", encoding="utf-8")
    with pytest.raises(enfilade.Error) as raised:
        enfilade.read(path)
    error = raised.value
    assert (Path(error.file).name, error.line, error.entity) == ("gallery.enfilade.toml", 2, "column 1")
    assert "did you mean `spacing`" in str(error)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"spacin": 0.1}, "did you mean `spacing`?"),
        ({"wal_layer": "A"}, "did you mean `wall_layer`?"),
        ({"spacing": "wide"}, "spacing: found string"),
        ({"spacing": 0}, "spacing"),
        ({"unit": "furlong"}, "expected mm, cm, m, in or ft"),
        ({"level": "hip"}, "level: unknown variant `hip`"),
        ({"roots": 1}, "roots: found 1"),
        ({"radius": -1}, "radius: found -1"),
        ({"measures": "Conectivity"}, "Connectivity"),
    ],
)
def test_wrong_settings_are_told(wrong, said, sample):
    plan = enfilade.read(sample("gallery.dxf"))
    with pytest.raises(enfilade.Error) as raised:
        plan.analyse(**wrong)
    assert said in str(raised.value) and raised.value.code
    with pytest.raises(TypeError, match="a setting is"):
        plan.analyse(spacing=object())


def test_settings_of_numpy_and_of_reading_hold(sample):
    plan = enfilade.read(sample("gallery.dxf"), spacing=np.float64(1.0), threads=np.int64(1))
    assert plan.analyse().attrs["spacing_m"] == 1.0
    assert plan.analyse(spacing=2).attrs["spacing_m"] == 2.0
    assert plan.analyse().attrs["spacing_m"] == 1.0


def test_options_are_those_of_the_program(sample, enfilade_says, tmp_path):
    path = sample("gallery.dxf")
    stages = []
    asked = {"evaluations": 150, "seed": 3, "members": 2}
    found = enfilade.read(path).optimise(out=tmp_path / "here", progress=stages.append, **asked)
    options = [f"--{name}={value}" for name, value in asked.items()]
    enfilade_says("run", path, "--out", tmp_path / "there", *options)
    [theirs] = (tmp_path / "there").rglob("round-01")
    assert found.options and found.number == 1
    for option in [*found.options, found.best]:
        assert option.file.read_bytes() == (theirs / option.file.name).read_bytes()
        assert option.gains and all(g.low <= g.share <= g.high for g in option.gains.values())
    assert {f.name for f in found.files} == {f.name for f in theirs.iterdir() if f.is_file()}
    assert {s["stage"] for s in stages} >= {"read", "measure"}
    first = found.options[0]
    share = found.gains().loc[(1, next(iter(first.gains))), "share"]
    assert share == next(iter(first.gains.values())).share
    new = first.accept()
    assert new.is_file() and new == first.accept()
    assert new.with_name(new.stem + ".enfilade.toml").is_file()
    assert enfilade.read(new).walls > 0


def test_a_pinned_option_stays(sample):
    plan = enfilade.read(sample("gallery.dxf"), evaluations=100, seed=1)
    first = plan.optimise().options[0]
    second = plan.optimise(pin=[1])
    assert second.number == 2
    np.testing.assert_allclose(second.options[0].data["parameters"], first.data["parameters"], atol=1e-6)
    with pytest.raises(enfilade.Error, match="number 99"):
        plan.optimise(pin=[99])
    with pytest.raises(enfilade.Error, match="number 99"):
        plan.accept(2, 99)


def test_what_progress_raises_ends_the_call(sample):
    def progress(_):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        enfilade.read(sample("gallery.dxf")).optimise(evaluations=100_000, progress=progress)


def test_the_picture_has_cells_walls_and_a_scale(sample, tmp_path):
    plan = enfilade.read(sample("gallery.dxf"))
    cells = plan.analyse(measures="isovist")
    axes = plan.show("isovist area")
    [image] = axes.images
    shown = np.ma.masked_invalid(image.get_array()).compressed()
    np.testing.assert_array_equal(np.sort(shown), np.sort(cells["Isovist Area"].dropna()))
    left, right, bottom, top = image.get_extent()
    half = cells.attrs["spacing_m"] / 2
    assert [left, right] == pytest.approx([cells["x"].min() - half, cells["x"].max() + half])
    assert [bottom, top] == pytest.approx([cells["y"].min() - half, cells["y"].max() + half])
    # Each cell lies where its value is.
    row, column = (cells["y"] - bottom) // (2 * half), (cells["x"] - left) // (2 * half)
    drawn = image.get_array()[row.astype(int), column.astype(int)]
    np.testing.assert_array_equal(np.ma.filled(drawn, np.nan), cells["Isovist Area"])
    assert tuple(image.get_cmap()(0.0)[:3]) == pytest.approx((0x44 / 255, 0x01 / 255, 0x54 / 255))
    assert any(c.get_paths() for c in axes.collections)
    assert [line.get_label() for line in axes.lines] == ["scale bar"]
    assert axes.texts[0].get_text().endswith(" m")
    axes.figure.savefig(tmp_path / "map.png")
    angle = plan.show("Isovist Drift Angle").images[0]
    assert angle.get_clim() == (0.0, 360.0)
    assert not plan.show(None).images and plan.show().images
    with pytest.raises(enfilade.Error, match="measures"):
        plan.show("colour")
    plt.close("all")


def python(code, *args, **more):
    return subprocess.Popen([sys.executable, "-c", code, *map(str, args)], stdout=subprocess.PIPE, text=True, **more)


def test_nothing_is_imported_before_it_is_needed(sample):
    code = """
import sys, enfilade
plan = enfilade.read(sys.argv[1])
repr(plan)
print([m for m in ("pandas", "networkx", "scipy", "matplotlib") if m in sys.modules])
sys.modules["pandas"] = None
try:
    plan.analyse()
except ImportError as error:
    print(error)
"""
    said = python(code, sample("gallery.dxf")).communicate()[0].splitlines()
    assert said == ["[]", "analyse() needs pandas: pip install pandas"]


STOPPED = """
import sys, enfilade
plan = enfilade.read(sys.argv[1])
def progress(p):
    if p["stage"] not in ("read",):
        print("works", flush=True)
try:
    getattr(plan, sys.argv[2])(progress=progress, **eval(sys.argv[3]))
    print("done", flush=True)
except KeyboardInterrupt:
    print("stopped", flush=True)
    print(plan, flush=True)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGINT for another process")
@pytest.mark.parametrize(
    ("method", "settings"), [("optimise", "{'evaluations': 10**8}"), ("analyse", "{'measures': 'all', 'spacing': 0.1}")]
)
def test_ctrl_c_stops_at_once(method, settings, sample):
    path = sample("office.dxf")
    child = python(STOPPED, path, method, settings)
    assert child.stdout.readline() == "works\n"
    time.sleep(0.3)
    asked = time.monotonic()
    child.send_signal(signal.SIGINT)
    said = next(line for line in child.stdout if line != "works\n")
    # Neither ends by itself in that time; the grace is a second, the rest is for a busy machine.
    assert said == "stopped\n" and time.monotonic() - asked < 15
    assert child.stdout.read().startswith("Plan(") and child.wait(60) == 0
    assert not list(path.parent.rglob("round-*"))


def test_the_notebook_runs(tmp_path, monkeypatch):
    nbformat = pytest.importorskip("nbformat")
    client = pytest.importorskip("nbclient")
    monkeypatch.setenv("MPLBACKEND", "Agg")
    notebook = nbformat.read(HERE.parent / "notebook.ipynb", as_version=4)
    nbformat.validate(notebook)
    client.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(HERE.parent)}}).execute()
    shown = [o for c in notebook.cells if c.cell_type == "code" for o in c.outputs]
    assert len(shown) >= 5
    assert not [c for c in nbformat.read(HERE.parent / "notebook.ipynb", as_version=4).cells if c.get("outputs")]
