"""Building works that marks allow: read, written into the job, and understood by the program."""

import json
import subprocess

import pytest
from conftest import wall
from enfilade_common import allowed, job
from enfilade_common.model import Allowed, Drawn, Opening, Region, Stroke, Study
from enfilade_common.moves import plan_of


def test_works_are_read_as_people_write_them():
    for text, written in (
        ("open 0.9m 2.4m", "open 900mm 2400mm"),
        ("Open 900", "open 900mm 900mm"),
        (" remove ;\n glaze 4ft", "remove; glaze 1219.2mm 1219.2mm"),
        ("end −1m 0", "end -1000mm 0"),
        ("end -500", "end -500mm 0"),
        ("door; close; rehang; add; widen", "door; close; rehang; add; widen"),
        ("", ""),
    ):
        works, unread = allowed.works_in(text)
        assert (allowed.text_of(works), unread) == (written, []), text
        assert allowed.works_in(written)[0] == works, "what is written reads the same"
    for wrong in ("open 2m 1m", "open -1m", "open wide", "open 1 2 3", "end 1m 2m", "paint"):
        assert allowed.works_in(wrong) == ([], [wrong]), wrong
    assert allowed.usual("open").text() == "open 900mm 2400mm" and allowed.usual("end").text() == "end -1000mm 0"
    assert allowed.usual("remove").text() == "remove"


def still(study):
    for element in study.movables():
        element.clauses = []
    for opening in (o for w in study.walls for o in w.openings):
        opening.clauses = []
    return study


def works_of(real_program, made):
    """Kinds and places of the works that the program allows, and its warnings."""
    done = subprocess.run([real_program, "works", made.drawing, "--json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    said = done.stderr.decode()
    assert "warning" not in said, said
    return [(w["kind"], w["width_m"], w["stretch"]) for w in json.loads(done.stdout)["works"] if w["is_allowed"]]


def test_the_program_allows_what_is_marked_on_a_wall(house, tmp_path, real_program):
    still(house).element("P2").works = [Allowed("open", 1000.0, 1800.0), Allowed("end", None, 500.0)]
    found = works_of(real_program, job.write(house, str(tmp_path)))
    assert {(kind, width) for kind, width, _ in found} == {("open", 1.0), ("open", 1.2), ("open", 1.8)}
    assert all(abs(y - 3.0) < 1e-6 for _, _, stretch in found for _, y in stretch), "in this wall alone"


def test_of_two_doors_in_a_wall_only_the_marked_one_is_changed(house, tmp_path, real_program):
    partition = still(house).element("P1")
    partition.openings.append(Opening("D3", "Tür 3", 4200, 5100))
    partition.openings[0].works = [Allowed("widen", 1200.0, 1800.0), Allowed("close")]
    found = works_of(real_program, job.write(house, str(tmp_path / "a")))
    assert {kind for kind, _, _ in found} == {"widen", "close"}
    assert all(y < 3.0 for _, _, stretch in found for _, y in stretch), "the lower door"
    # A door that is hung elsewhere may come anywhere in its wall.
    partition.openings[0].works, partition.openings[1].works = [], [Allowed("rehang"), Allowed("widen")]
    found = works_of(real_program, job.write(house, str(tmp_path / "b")))
    assert {"rehang", "widen"} == {kind for kind, _, _ in found}


def test_a_run_offers_the_marked_works(house, tmp_path, real_program):
    still(house).element("P1").works = [Allowed("open", 900.0, 1200.0)]
    made = job.write(house, str(tmp_path))
    assert subprocess.run([real_program, "run", made.drawing, "--quiet"], stdin=subprocess.DEVNULL).returncode == 0
    with open(tmp_path / "plan.enfilade" / "round-01" / "result.json") as f:
        works = [w for c in json.load(f)["candidates"] for w in c["works"]]
    assert works and {w["kind"] for w in works} == {"open"}
    assert all(0.9 <= w["width_m"] <= 1.2 + 1e-9 for w in works)


def test_moves_and_works_stand_side_by_side(house, tmp_path, real_program):
    """Each says nothing of the other; texts lie in the boxes they are of."""
    partition = house.element("P1")
    partition.works = [Allowed("remove"), Allowed("open", 900.0, 2400.0)]
    partition.openings[0].works = [allowed.usual(k) for k in allowed.OF_OPENINGS]
    made = job.write(house, str(tmp_path))
    said = subprocess.run([real_program, "check", made.drawing, "--json"], stdout=subprocess.PIPE, check=True)
    problems = json.loads(said.stdout)["problems"]
    assert [p for p in problems if "EF-" in p["text"] and p["code"] != "interior-closed"] == []
    assert job.read(str(tmp_path)).study == house
    text = (tmp_path / "plan.enfilade.toml").read_text()
    assert 'moves = "remove; open 900mm 2400mm"' in text and 'moves = "x -1000 1000"' in text


def test_lines_of_a_plan_are_named_whole(tmp_path, real_program):
    rooms = [(0, 0), (8000, 0), (8000, 6000), (0, 6000)]
    inner = [[(x, 250), (x, 5750)] for x in (3950, 4050)]
    halves = ([(250, 250), (3950, 250)], [(4050, 250), (7750, 250)], [(7750, 250), (7750, 5750)], [(7750, 5750), (4050, 5750)])
    halves += ([(3950, 5750), (250, 5750)], [(250, 5750), (250, 250)])
    drawn = [Drawn("outer", "outer", [Stroke("lines", rooms, True)])]
    drawn += [Drawn(f"L{i}", f"L{i}", [Stroke("lines", line)]) for i, line in enumerate([*inner, *halves])]
    for line in drawn[1:3]:
        line.works = [Allowed("open", 900.0, 1200.0)]
    made = job.write(Study("test", "doc", drawn=drawn), str(tmp_path))
    found = works_of(real_program, made)
    assert {kind for kind, _, _ in found} == {"open"} and job.read(str(tmp_path)).study.rebuilt() == drawn[1:3]


@pytest.mark.parametrize("why", ("keep", "locked"))
def test_nothing_is_built_in_what_stays(house, tmp_path, why):
    partition = still(house).element("P1")
    setattr(partition, why, True if why == "keep" else "it is pinned")
    partition.openings[0].works = [Allowed("close")]
    plan = plan_of(house)
    assert plan.notes[-1].startswith("Building works are marked at 'P1', but none is made there: it is ")
    text, _ = job.drawing_text(house, plan)
    assert "EF-MOVE" not in text and allowed.tables(house, plan.outlines, {}) == []


def test_a_region_or_a_column_carries_no_works():
    study = Study("test", "doc", [wall("W", (0, 0), (1000, 0))], regions=[Region("keep", [(0, 0), (1, 0), (1, 1)])])
    assert study.rebuilt() == []
