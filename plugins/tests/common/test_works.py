"""Building works of a round: read, matched with the job's elements, drawn for a preview."""

import json
import os

import pytest
from enfilade_common import job, preview, results, works
from enfilade_common.model import PluginError
from test_results import round_in

WORK = {
    "kind": "rehang",
    "words": "The door of 0.9 m between hall and room 2 moved along its wall",
    "stretch": [[4, 2], [4, 2.9]],
    "width_m": 0.9,
    "rooms": [1, None],
    "elements": [],
    "demolished": [[[4.05, 2], [4.05, 2.9], [3.95, 2.9], [3.95, 2]]],
    "built": [{"ends": [[4, 0.625], [4, 1.525]], "thickness_m": 0.1}],
    "filling": "door",
    "opening": [[4, 0.625], [4, 1.525]],
}


def read_with(made, *entries):
    """A round whose options have the given ``works``; ``None`` is an option without such a list."""
    folder = os.path.join(made.results_folder, "round-01")
    round_in(folder, made.sha256)
    path = os.path.join(folder, "result.json")
    with open(path) as f:
        data = json.load(f)
    option = {"file": "candidate-1.dxf", "words": "", "mean": {}, "penalty": {}, "score": None, "parameters": [], "changes": []}
    data["candidates"] = [option if e is None else {**option, "works": e} for e in entries]
    with open(path, "w") as f:
        json.dump(data, f)
    return results.latest(made)


def test_works_are_read_in_units_of_the_drawing(house, tmp_path):
    made = job.write(house, str(tmp_path))
    found = read_with(made, None, [], [WORK], [{"kind": "open", "stretch": [[0, 0], [1, 0]], "opening": None, "built": None}])
    assert [len(o.works) for o in found.options] == [0, 0, 1, 1]
    (work,) = found.options[2].works
    assert work.stretch == ((4000, 2000), (4000, 2900)) and work.width == 900 and work.rooms == [1, None]
    assert work.built == [works.NewWall(((4000, 625), (4000, 1525)), 100)] and work.opening == ((4000, 625), (4000, 1525))
    assert work.demolished[0][0] == (4050, 2000) and work.filling == "door"
    assert works.axis_of(work.demolished[0]) == ((4000, 2000), (4000, 2900))
    (bare,) = found.options[3].works
    assert (bare.filling, bare.opening, bare.built, bare.said()) == ("nothing", None, [], "an opening")
    assert work.said().startswith("the door of 0.9 m")
    with pytest.raises(PluginError, match="not complete"):
        read_with(job.write(house, str(tmp_path / "other")), [{"kind": "open", "stretch": [[0, 0]]}])


def test_elements_of_a_work_are_those_of_the_job(house, tmp_path):
    made = job.write(house, str(tmp_path))
    owners = made.owners()
    faces = [h for h, id in owners.items() if id == "P1"]
    assert len(faces) == 12, "two outlines of four corners, each with its head and its end"
    door = next(h for h, id in owners.items() if id == "D1")
    named = [{"handle": h, "record": 1} for h in (faces[1], faces[-1], door)] + [{"handle": "FFFF", "record": 2}, {"record": 3}]
    option = read_with(made, [{**WORK, "elements": named}]).options[0]
    assert results.worked(made, option.works[0]) == ["P1"]
    assert [(c.id, c.axis_before) for c in results.standing(made, option)] == [("P1", [])]
    assert set(made.labels()) == set(owners), "corners bear the label of their wall"


def test_works_are_outlined(house, tmp_path):
    made = job.write(house, str(tmp_path))
    gone, new = preview.ghosts(made, read_with(made, [WORK]).options[0])
    assert gone == [[(4050, 2000), (4050, 2900), (3950, 2900), (3950, 2000), (4050, 2000)]]
    assert new[0] == [(4050, 625), (4050, 1525), (3950, 1525), (3950, 625), (4050, 625)]
    assert new[1] == [(4000, 2000), (4000, 2900)], "a leaf or a pane"


def test_what_stays_of_a_line() -> None:
    assert works.staying(10, [(2, 3), (0, 1), (2.5, 4)], 0.1) == [(1, 2), (4, 10)]
    assert works.staying(10, [(0, 10)], 0.1) == [] and works.staying(10, [(0, 9.95)], 0.1) == []
    square = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)]
    for ring in (square, square[::-1]):
        assert works.inside((-1, 1), (3, 1), ring, 0.0) == (0.25, 0.75)
        assert works.inside((1, 1), (1, 5), ring, 0.0) == (0.0, 0.25)
        assert works.inside((3, -1), (3, 5), ring, 0.0) is None
        assert works.inside((-1, 2.05), (3, 2.05), ring, 0.1) is not None
