import json
import os
import subprocess

import pytest
from conftest import wall
from enfilade_common import job, results
from enfilade_common.dxf_r12 import Drawing, escaped
from enfilade_common.model import Clause, Objective, PluginError, Region, Study, default_objectives, pair_name
from enfilade_common.toml_text import dumps, string


def groups(text):
    lines = text.split("\r\n")[:-1]
    assert len(lines) % 2 == 0
    return list(zip((int(c) for c in lines[0::2]), lines[1::2]))


def test_ids_stand_in_the_drawing_as_extended_data(house):
    text, _ = job.drawing_text(house, job.plan_of(house))
    pairs = groups(text)
    ids = [v for i, (c, v) in enumerate(pairs) if c == 1000 and pairs[i - 1] == (1001, "ENFILADE")]
    assert ids[0] == "S/0" and "P1/1" in ids and "C/0" in ids
    handles = [v for c, v in pairs if c == 5]
    assert len(handles) == len(set(handles)) > 40
    assert pairs[-1] == (0, "EOF")


def test_marks_stand_on_our_layers(house):
    house.regions = [Region("query", [(0, 0), (1, 0), (1, 1)]), Region("reference", [(0, 0), (2, 0), (2, 2)])]
    house.element("E").keep = True
    layers = {v for c, v in groups(job.drawing_text(house, job.plan_of(house))[0]) if c == 8}
    assert {"EF-QUERY", "EF-REFERENCE", "EF-KEEP", "EF-NOTE", "A-WALL", "A-COLS", "A-DOOR", "A-GLAZ"} <= layers
    assert "EF-MOVE" not in layers, "what may move is said once, in the side-car"


def test_the_program_has_nothing_to_say_about_our_own_marks(house, tmp_path, real_program):
    """A wall and the door in it are marked: words of the one never lie in the other's place."""
    partition = house.element("P1")
    partition.clauses = [Clause("x", -500, 500), Clause("rotate", -10, 10)]
    partition.openings[0].start, partition.openings[0].end = 2400, 3300
    made = job.write(house, str(tmp_path))
    said = subprocess.run([real_program, "check", made.drawing, "--json"], stdout=subprocess.PIPE, check=True)
    problems = json.loads(said.stdout)["problems"]
    assert [p for p in problems if "EF-" in p["text"] and p["code"] != "interior-closed"] == []


def test_handles_of_the_drawing_tell_labels(house, tmp_path):
    made = job.write(house, str(tmp_path))
    assert set(made.labels().values()) == {"S", "E", "N", "W", "P1", "P2", "P3", "Säule", "Tür 1", "Door 2", "Fenster"}


SQUARES = {
    "door": ("query", [(500, 500), (3500, 500), (3500, 2500), (500, 2500)]),
    "picture": ("reference", [(4500, 300), (7500, 300), (7500, 2500), (4500, 2500)]),
}


def test_a_named_pair_is_measured_by_itself(house, tmp_path, real_program):
    name = pair_name(" Vom Süden ")
    assert name == "vom-süden"
    house.regions = [Region(*r, pair=name) for r in SQUARES.values()]
    house.wishes.objectives = [*default_objectives(), Objective("degree", "max", 0.6, pair=name)]
    written = job.write(house, str(tmp_path))
    layers = [v for c, v in groups(open(written.drawing, encoding="ascii", newline="").read()) if c == 8]
    assert "EF-QUERY-vom-s\\U+00FCden" in layers
    assert job.read(written.folder).study == house
    run = [real_program, "run", written.drawing, "--evaluations", "80"]
    assert subprocess.run(run, stdout=subprocess.PIPE, stderr=subprocess.PIPE).returncode in (0, 1)
    found = results.latest(written)
    over = f"degree@{name}"
    assert found.initial[over] > 0 and all(o.mean[over] > 0 for o in found.options)


def test_a_brief_is_asked_and_told(house, tmp_path, real_program):
    house.wishes.brief = ["rooms area min 1 m2", "goal: rooms area min 900 m2"]
    written = job.write(house, str(tmp_path))
    assert job.read(written.folder).study == house
    run = [real_program, "run", written.drawing, "--evaluations", "80"]
    assert subprocess.run(run, stdout=subprocess.PIPE, stderr=subprocess.PIPE).returncode in (0, 1)
    found = results.latest(written)
    for brief in [found.brief, *(o.brief for o in found.options)]:
        assert [line.verdict for line in brief] == ["pass", "fail"]
        assert brief[0].text() == "✓ rooms area min 1 m2"
        assert brief[1].text().startswith("✗ goal: rooms area min 900 m2: ")


def test_an_objective_over_a_pair_that_is_not_drawn_is_refused(house, tmp_path):
    house.wishes.objectives = [*default_objectives(), Objective("degree", "max", pair="north", is_on=False)]
    job.check(house)
    house.wishes.objectives[-1].is_on = True
    with pytest.raises(PluginError, match="'north', but no region"):
        job.write(house, str(tmp_path))


@pytest.mark.parametrize("text", ("a/b", "x" * 41, "ä" * 21, "a,b", "@"))
def test_what_cannot_name_a_pair_is_refused(text):
    with pytest.raises(PluginError, match="cannot name a pair"):
        pair_name(text)


def test_text_without_an_encoding():
    assert escaped("Tür\n壁 😀") == "T\\U+00FCr \\U+58C1 \\U+D83D\\U+DE00"


def test_numbers_are_reals_to_a_micrometre():
    d = Drawing()
    d.line("0", (1.0, -0.00001), (1234567.8914, 2.5))
    pairs = groups(d.file_text())
    assert [v for c, v in pairs if c in (10, 20, 11, 21)][-4:] == ["1.0", "0.0", "1234567.891", "2.5"]


def test_toml_text():
    text = dumps({"a": 'q"\\\n\x01ü', "n": None, "b": True, "p": [[1, 2.5]], "t": {"x y": 1}, "l": [{"k": 1}, {"k": 2}]})
    assert text == (
        'a = "q\\"\\\\\\n\\u0001ü"\nb = true\np = [[1, 2.5]]\n\n[t]\n"x y" = 1\n\n[[l]]\nk = 1\n\n[[l]]\nk = 2\n'
    )
    assert string("\ud800") == '"\\uFFFD"'
    with pytest.raises(ValueError):
        dumps({"a": float("nan")})


def test_a_job_reads_back_the_same(house, tmp_path):
    written = job.write(house, str(tmp_path / "new" / "folder"))
    again = job.read(written.folder)
    assert again.study == written.study
    assert (again.outlines, again.hashes, again.sha256) == (written.outlines, written.hashes, written.sha256)
    assert not [n for n in os.listdir(written.folder) if n.endswith(".part")]


def test_the_same_study_gives_the_same_bytes(house, tmp_path):
    names = ("plan.dxf", "plan.enfilade.toml", "plan.study.json")
    a, b = (job.write(house, str(tmp_path / n)).folder for n in "ab")
    for name in names:
        assert open(os.path.join(a, name), "rb").read() == open(os.path.join(b, name), "rb").read()


def test_what_cannot_be_measured_is_refused_before_anything_is_written(house, tmp_path):
    house.wishes.objectives = [Objective("degree", "max", is_on=False)]
    for study, words in (
        (Study("t", "d"), "no wall to measure"),
        (Study("t", "d", [wall("A", (0, 0), (1, 0)), wall("A", (0, 1), (1, 1))]), "the id A"),
        (house, "No objective"),
    ):
        with pytest.raises(PluginError, match=words):
            job.write(study, str(tmp_path / "x"))
    assert not (tmp_path / "x").exists()


def test_a_folder_that_cannot_be_written_is_said(house, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(PluginError, match="cannot be written"):
        job.write(house, str(tmp_path / "file" / "below"))


def test_what_cannot_be_written_leaves_nothing_half_done(house, tmp_path):
    (tmp_path / "plan.dxf").mkdir()
    with pytest.raises(PluginError, match="is a folder"):
        job.write(house, str(tmp_path))
    assert os.listdir(tmp_path) == ["plan.dxf"]


def test_only_what_is_marked_may_move(house, tmp_path, real_program):
    for element in house.movables():
        element.clauses = []
    house.element("P1").openings[0].clauses = []
    written = job.write(house, str(tmp_path))
    with open(os.path.join(written.folder, "plan.enfilade.toml"), encoding="utf-8") as f:
        assert "only-marked = true" in f.read().split("[")[0].splitlines()
    said = subprocess.run([real_program, "check", written.drawing, "--json"], stdout=subprocess.PIPE, check=True)
    assert json.loads(said.stdout)["moves"] == []


def test_thresholds_stand_once_somebody_has_set_them(house, tmp_path):
    def said():
        written = job.write(house, str(tmp_path))
        with open(os.path.join(written.folder, "plan.enfilade.toml"), encoding="utf-8") as f:
            return next(line for line in f if line.startswith("thresholds"))

    house.wishes.objectives = default_objectives()
    assert said() == 'thresholds = "yielding"\n'
    house.wishes.objectives[0].threshold = 0.65
    assert said() == 'thresholds = "firm"\n'


def test_no_study_or_a_strange_one(tmp_path):
    with pytest.raises(PluginError, match="run one first"):
        job.read(str(tmp_path))
    broken = json.dumps({"schema": "enfilade.study/1", "study": {}, "outlines": [{}]})
    for text in ("", "{", broken, json.dumps({"schema": "enfilade.study/9"}), "[1]"):
        (tmp_path / "plan.study.json").write_text(text)
        with pytest.raises(PluginError, match="run the study again"):
            job.read(str(tmp_path))


def test_the_program_understands_every_wall_and_move(house, tmp_path, real_program):
    written = job.write(house, str(tmp_path))
    said = subprocess.run([real_program, "check", written.drawing, "--json"], stdout=subprocess.PIPE, check=True)
    understood = json.loads(said.stdout)
    assert understood["walls"] == len(written.outlines)
    assert [(m["name"], m["kind"]) for m in understood["moves"]] == [
        ("Tür 1", "along"), ("P1", "x"), ("P3", "y"), ("P3", "rotate"), ("Säule", "x")
    ]
    assert understood["unit"]["name"] == "mm"
    assert [p for p in understood["problems"] if p["severity"] != "info"] == []


def test_five_hundred_walls_are_written_once_each(tmp_path):
    walls = [wall(f"w{i}", (i % 25 * 3000, i // 25 * 3000), (i % 25 * 3000 + 2000, i // 25 * 3000)) for i in range(500)]
    written = job.write(Study("t", "d", walls), str(tmp_path))
    assert len({o.host_id for o in job.read(written.folder).outlines}) == 500
