"""The same numbers as the program's, in Python's own shapes."""

import io
import json

import enfilade
import numpy as np
import pandas as pd
import pytest


def table_of(text):
    """The program's table; −1 is its word for no value."""
    # Python reads a number to its last bit; the reader of tables may not.
    table = pd.read_csv(io.StringIO(text), dtype=str).astype({"Ref": int}).set_index("Ref").astype(float)
    columns = [c for c in table if c not in ("x", "y")]
    table[columns] = table[columns].replace(-1.0, np.nan)
    return table


@pytest.mark.parametrize(
    ("name", "options", "settings"),
    [
        ("gallery.dxf", ["--measures", "all"], {"measures": "all"}),
        ("gallery.dxf", ["--measures", "graph", "--radius", "2"], {"measures": ["graph"], "radius": 2}),
        ("office.dxf", ["--roots", "50", "--seed-point", "1,1"], {"roots": 50, "seed_point": (1, 1)}),
        ("library.dxf", ["--step-from", "1200,1100"], {"step_from": [(1200, 1100)]}),
        ("pavilion.ifc", ["--spacing", "0.4"], {"spacing": 0.4}),
    ],
)
def test_cells_are_those_of_the_program(name, options, settings, sample, enfilade_says):
    path = sample(name)
    expected = table_of(enfilade_says("analyse", path, "--cells", "-", *options))
    found = enfilade.read(path).analyse(coordinates="drawing", **settings)
    pd.testing.assert_frame_equal(found, expected, check_exact=True)


def test_numbers_are_the_memory_of_the_program(sample):
    cells = enfilade.read(sample("gallery.dxf")).analyse(measures="isovist")
    for name in ["x", "Isovist Area", "Depth"]:
        values = cells[name].to_numpy()
        owner = values
        while isinstance(owner.base, np.ndarray):
            owner = owner.base
        assert type(owner.base).__name__ == "PySliceContainer", name


def test_places_are_metres_or_drawing_units(sample):
    plan = enfilade.read(sample("gallery.dxf"))
    metres, drawing = (plan.analyse(measures="Connectivity", coordinates=c) for c in ("metres", "drawing"))
    for axis in ("x", "y"):
        np.testing.assert_allclose(metres[axis], drawing[axis] * plan.metres_per_unit, rtol=1e-12)
    steps = np.diff(np.unique(metres["x"]))
    np.testing.assert_allclose(steps / metres.attrs["spacing_m"], np.rint(steps / metres.attrs["spacing_m"]))
    assert metres.attrs["units"]["Connectivity"] == "cells"
    with pytest.raises(ValueError, match="coordinates"):
        plan.analyse(coordinates="feet")


@pytest.mark.parametrize("name", ["gallery.dxf", "maze.dxf"])
def test_who_sees_whom(name, sample, enfilade_says):
    path = sample(name)
    plan = enfilade.read(path)
    sight, cells = plan.visibility(), plan.analyse()
    assert (sight != sight.T).nnz == 0 and not sight.diagonal().any()
    assert sight.has_sorted_indices
    np.testing.assert_array_equal(np.asarray(sight.sum(axis=1)).ravel(), cells["Connectivity"])
    edges = pd.read_csv(io.StringIO(enfilade_says("analyse", path, "--edges", "-")))
    rows = cells.index.get_indexer(edges["RefFrom"]), cells.index.get_indexer(edges["RefTo"])
    assert len(edges) * 2 == sight.nnz and np.asarray(sight[rows]).all()


def test_the_graph_is_that_of_check(sample, enfilade_says, tmp_path):
    path = sample("pavilion.ifc")
    graph = enfilade.read(path).graph()
    enfilade_says("check", path, "--graph", tmp_path / "graph.json")
    expected = json.loads((tmp_path / "graph.json").read_text(encoding="utf-8"))
    rooms = {n: d for n, d in graph.nodes(data=True) if d["kind"] == "room"}
    assert [d["name"] for d in rooms.values()] == [r["name"] for r in expected["rooms"]]
    walls = [d for *_, d in graph.edges(data=True) if d["kind"] == "wall"]
    assert len(walls) == len(expected["walls"]) > 3
    assert sorted(w["axis"] for w in walls) == sorted(w["axis"] for w in expected["walls"])
    leads = sum(d["kind"] == "leads" for *_, d in graph.edges(data=True))
    assert leads == sum(r is not None for o in expected["openings"] for r in o["rooms"]) > 0
    assert graph.graph["metres_per_unit"] == expected["metres_per_unit"]


@pytest.mark.parametrize("name", ["simple_room", "large_room", "art_gallery", "maze_a"])
def test_reference_plans(name, reference):
    """Values of an independent program, at each spacing that it has measured."""
    expected = json.loads(reference(f"{name}.expected.json").read_text(encoding="utf-8"))
    plan = enfilade.read(reference(f"{name}.dxf"))
    for one in expected.get("initial", [expected]):
        lattice = {"spacing": one["spacing_m"], "lattice_centre": one["lattice_centre"]}
        cells = plan.analyse(measures="Connectivity", **lattice)
        assert len(cells) == one["counts"]["vertices"]
        assert plan.visibility(**lattice).nnz == 2 * one["counts"]["edges"]
        for column in ("Degree", "Depth", "Entropy"):
            assert cells[column].count() == one["counts"]["query"]
            assert cells[column].mean() == pytest.approx(one["mean"][column.lower()], abs=1e-9)
