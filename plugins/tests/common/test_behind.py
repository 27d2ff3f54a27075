"""The file behind the shapes of a host: found by where they lie, patched with what was edited and marked."""

import json
import os
import subprocess
import sys

import pytest
from conftest import ROOT

sys.path.insert(0, os.path.join(ROOT, "plugins", "tests"))

from drawings import Dxf, strokes, two_rooms  # noqa: E402
from enfilade_common import behind, job, preview, reading, results  # noqa: E402
from enfilade_common.dxf_file import DxfFile  # noqa: E402
from enfilade_common.model import Clause, Drawn, PluginError, Region, Stroke, Study, Wishes  # noqa: E402


def study(drawn, **rest):
    return Study("test", "doc", drawn=drawn, wishes=Wishes(members=1, evaluations=60), **rest)


def check(program, path, out):
    done = subprocess.run([program, "check", path, "--json", str(out)], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    assert done.returncode in (0, 1)
    return json.load(open(out))["reading"]


def of_walls(drawing):
    """Handles and layers of the entities of a file, without our own layers."""
    entities = DxfFile(drawing).entities
    return {e.handle: (e.kind, e.layer) for e in entities if not e.layer.startswith(b"EF-")}


def test_the_file_itself_is_the_drawing(tmp_path, real_program):
    path, _ = two_rooms(tmp_path / "house.dxf")
    drawn = strokes(path)
    match = behind.match(DxfFile(path), drawn)
    assert (match.scale, match.shapes_share, match.file_share, match.absent()) == (1000.0, 1.0, 1.0, [])
    made = job.write(study(drawn), str(tmp_path / "job"), match)
    assert of_walls(made.drawing) == of_walls(path)
    ours, theirs = (check(real_program, p, tmp_path / "out.json") for p in (made.drawing, path))
    assert ours["unit"]["name"] == "m" and len(ours["walls"]) == len(theirs["walls"]) > 4
    for key in ("openings", "rooms", "interior"):
        assert len(ours[key]) == len(theirs[key]), key
    assert job.read(made.folder).parts == made.parts and job.read(made.folder).scale == 1000.0


def test_what_was_edited_keeps_its_layer(tmp_path):
    path, handles = two_rooms(tmp_path / "house.dxf")
    drawn = strokes(path)
    before = behind.match(DxfFile(path), drawn)
    i = next(i for i, e in enumerate(before.file.entities) if e.handle == handles["partition"][0])
    moved = next(d for d in drawn if f"{d.id}/0" in before.strokes_of(i))
    moved.strokes[0].points = [(x + 300.0, y) for x, y in moved.strokes[0].points]
    gone = next(d for d in drawn if f"{d.id}/0" in before.strokes_of(i + 1))
    rest = [d for d in drawn if d is not gone]
    made = job.write(study(rest), str(tmp_path / "job"), behind.match(DxfFile(path), rest))
    now = of_walls(made.drawing)
    assert not {handles["partition"][0], handles["partition"][1]} & now.keys()
    (new,) = now.keys() - of_walls(path).keys()
    assert now[new] == ("LINE", b"A-WALL")
    line = next(e for e in DxfFile(made.drawing).entities if e.handle == new)
    assert line.real(10) == pytest.approx(4.25) and made.owners()[new] == moved.id


def test_another_file_does_not_fit(tmp_path):
    path, _ = two_rooms(tmp_path / "house.dxf")
    other = Dxf()
    for y in range(20):
        other.line("A-WALL", (0, y * 0.37), (5, y * 0.41))
    match = behind.match(DxfFile(other.write(tmp_path / "other.dxf")), strokes(path))
    assert not match.fits and match.shapes_share < 0.1


@pytest.mark.parametrize("content", (b"AutoCAD Binary DXF\r\n\x1a\0\0\0", b"no dxf", b""))
def test_what_is_no_text_dxf_fits_nothing(tmp_path, content):
    (tmp_path / "x.dxf").write_bytes(content)
    try:
        assert DxfFile(str(tmp_path / "x.dxf")).entities == []
    except PluginError as e:
        assert "is no DXF in text form" in str(e)


def test_what_an_import_lost_stays_in_the_file(tmp_path):
    """Remembered from the first look; what goes later was deleted."""
    path, handles = two_rooms(tmp_path / "house.dxf")
    drawn = strokes(path)
    every = behind.match(DxfFile(path), drawn)
    screen = next(i for i, e in enumerate(every.file.entities) if e.handle == handles["screen"])
    lost = {s.split("/")[0] for s in every.strokes_of(screen)[1:3]}
    rest = [d for d in drawn if d.id not in lost]
    first = behind.match(DxfFile(path), rest)
    assert first.absent() == [handles["screen"]]
    made = job.write(study(rest), str(tmp_path / "job"), behind.match(DxfFile(path), rest, first.absent()))
    assert of_walls(made.drawing) == of_walls(path)
    made = job.write(study(rest), str(tmp_path / "job"), first)
    assert handles["screen"] not in of_walls(made.drawing)


def test_marks_reach_the_file_and_options_come_back(tmp_path, real_program):
    path, handles = two_rooms(tmp_path / "house.dxf")
    drawn = strokes(path)
    found = behind.match(DxfFile(path), drawn)
    marked = {handles["screen"]: ("Q", [Clause("y", -500, 500)]), handles["partition"][1]: ("P", [Clause("x", -500, 500)])}
    marked.update((h, marked[handles["partition"][1]]) for h in handles["partition"])
    for i, e in enumerate(found.file.entities):
        for s in found.strokes_of(i) if e.handle in marked else ():
            owner = next(d for d in drawn if d.id == s.split("/")[0])
            owner.group, owner.clauses = marked[e.handle]
    region = Region("query", [(500, 500), (3500, 500), (3500, 5500), (500, 5500)])
    made = job.write(study(drawn, regions=[region]), str(tmp_path / "job"), behind.match(DxfFile(path), drawn))
    assert of_walls(made.drawing) == of_walls(path), "what is marked as a whole stays one"
    query = next(e for e in DxfFile(made.drawing).entities if e.layer == b"EF-QUERY")
    assert query.lines[0].ends == ((0.5, 0.5), (3.5, 0.5))
    done = subprocess.run([real_program, "run", made.drawing, "--quiet"], stdin=subprocess.DEVNULL)
    assert done.returncode in (0, 1)
    found = results.latest(made)
    layout = found.options[0] if found.options else found.best
    assert found.unit == "m" and found.per_metre == 1000.0 and layout is not None, found.notes
    changes = {c.id: c for c in results.layout(made, layout)}
    gone, new = preview.ghosts(made, layout)
    assert changes and gone and new
    shift = {m[0]: p for m, p in zip(found.moves, layout.parameters)}
    by_id = {d.id: d for d in drawn}
    for id, change in changes.items():
        name = by_id[id].group
        if name == "P" and change.motion is not None and by_id[id].strokes[0].kind == "lines":
            assert change.axis_after[0][0] - change.axis_before[0][0] == pytest.approx(shift["P"], abs=0.2)
    curves = [c for id, c in changes.items() if by_id[id].strokes[0].kind == "arc"]
    assert all(c.motion is not None for c in curves)
    assert bool(curves) == (abs(shift["P"]) > 1), "the door's block goes with its wall"


def test_a_mirrored_block_is_found_as_freecad_draws_it(tmp_path):
    out = Dxf()
    out.block = [(0, "LINE"), (8, "0"), (10, 0.0), (20, 0.0), (11, 1.0), (21, 0.5)]
    out.insert("A-DOOR", "DOOR", (2, 3), (41, -0.6), (42, 0.6))
    out.insert("A-DOOR", "DOOR", (5, 3), (50, 90.0))
    file = DxfFile(out.write(tmp_path / "x.dxf"))
    first, second = file.entities
    assert first.lines[0].ends == ((2.0, 3.0), (pytest.approx(1.4), pytest.approx(3.3)))
    assert second.lines[0].ends == ((5.0, 3.0), (pytest.approx(4.5), pytest.approx(4.0)))
    assert file.as_host(first)[0].ends[1][0] == pytest.approx(2 - 0.36 ** (1 / 3))


def checked(doors, questions=(), metres=0.001):
    openings = [{"kind": "door", "at": [i, 0], "width_m": w, "elements": [{"handle": "A"}]} for i, w in enumerate(doors)]
    read = {"unit": {"name": "mm", "metres": metres}, "walls": [1], "openings": openings, "rooms": []}
    read["questions"] = list(questions)
    return json.dumps({"schema": reading.CHECK_SCHEMA, "reading": read})


def test_how_wide_a_door_is_is_asked_with_answers():
    values = {"witness": "door", "length": 90.0, "lengths_m": [0.09, 2.286]}
    answers = [{"correction": {"unit": u}} for u in ("mm", "in")]
    read = reading.reading_of(checked([0.09, 0.09], [{"about": "unit", "values": values, "answers": answers}]))
    assert not read.is_plausible and read.door_m == 0.09
    assert read.question.answers == [(0.09, "mm"), (pytest.approx(0.9), "cm"), (pytest.approx(2.286), "in")]
    read = reading.reading_of(checked([0.8, 0.9, 1.0]))
    assert read.is_plausible and read.question is None and (read.walls, read.doors) == (1, 3)
    read = reading.reading_of(checked([2.3], metres=0.0254))
    assert not read.is_plausible and (pytest.approx(0.9055, abs=1e-3), "cm") in read.question.answers
    with pytest.raises(PluginError, match="schema"):
        reading.reading_of('{"schema": "other/1"}')
    with pytest.raises(PluginError, match="cannot be read"):
        reading.reading_of("no json")


def test_an_edited_stroke_of_another_kind_stays_drawn(tmp_path):
    path, _ = two_rooms(tmp_path / "house.dxf")
    drawn = [*strokes(path), Drawn("new", "Circle", [Stroke("circle", [(2000.0, 2000.0)], True, (2000.0, 2000.0), 150.0)])]
    made = job.write(study(drawn), str(tmp_path / "job"), behind.match(DxfFile(path), drawn))
    (circle,) = [e for e in DxfFile(made.drawing).entities if e.kind == "CIRCLE"]
    assert circle.real(40) == pytest.approx(0.15) and circle.real(10) == pytest.approx(2.0)
