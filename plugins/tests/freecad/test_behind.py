"""What FreeCAD imported from a DXF reads as the file itself; what is edited and marked here reaches it."""

import json
import os
import subprocess
import sys

import FreeCAD as App
import pytest
from conftest import ROOT, V
from enfilade import accept, document, marks, settings, source
from enfilade_common import job, results
from enfilade_common.model import PluginError, Wishes

sys.path.insert(0, os.path.join(ROOT, "plugins", "tests"))
from drawings import two_rooms  # noqa: E402

SHARED = os.path.join(os.environ.get("ENFILADE_SHARED") or os.path.join(ROOT, "..", "shared"), "data", "dxf")
#: Drawings of eight hands that FreeCAD imports.
EIGHT = (
    "barcelona_freecad_r12",
    "ceco_villa_plan",
    "gallery_depthmapx",
    "gama_house_librecad",
    "giraffe360_residential",
    "potynobg_pianta_house",
    "roomsize_two_rooms",
    "us_house_bishop",
)
RECENT = "User parameter:BaseApp/Preferences/RecentFiles"


@pytest.fixture
def recent():
    """Says which files were opened last."""
    group = App.ParamGet(RECENT)

    def opened(*paths):
        for i in range(20):
            group.RemString(f"MRU{i}")
        for i, path in enumerate(paths):
            group.SetString(f"MRU{i}", str(path))

    yield opened
    opened()


def import_into(doc, path, grouped=False):
    import importDXF

    draft = App.ParamGet("User parameter:BaseApp/Preferences/Mod/Draft")
    draft.SetBool("dxfShowDialog", False)
    draft.SetBool("groupLayers", grouped)
    importDXF.insert(str(path), doc.Name)
    doc.Label = os.path.splitext(os.path.basename(str(path)))[0]
    doc.recompute()
    doc.clearUndos()


def behind(doc):
    study, _ = document.study(doc, Wishes(members=1, evaluations=80))
    return study, source.Sources().of(doc, study.drawn)


def reading(program, path, out):
    """What matters of how the program reads a drawing."""
    words = [program, "check", str(path), "--json", str(out)]
    assert subprocess.run(words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL).returncode in (0, 1)
    with open(out) as f:
        read = json.load(f)["reading"]
    doors = [o for o in read["openings"] if o["kind"] == "door"]
    area = sum(abs(ring(i["outline"])) - sum(abs(ring(h)) for h in i["holes"]) for i in read["interior"])
    area *= read["unit"]["metres"] ** 2
    return read["unit"]["name"], len(read["walls"]), len(doors), len(read["openings"]), len(read["rooms"]), round(area, 2)


def ring(points):
    return sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(points, points[1:] + points[:1])) / 2


@pytest.mark.parametrize("grouped", (False, True))
@pytest.mark.parametrize("scale,insunits", ((1.0, 6), (1000.0, 4), (1.0, 0)))
def test_an_imported_file_reads_as_itself(doc, tmp_path, program, recent, scale, insunits, grouped):
    path, _ = two_rooms(tmp_path / "house.dxf", scale, insunits)
    import_into(doc, path, grouped)
    recent(tmp_path / "other.dxf", path)
    study, found = behind(doc)
    assert found.words == "Layers, blocks and unit from house.dxf." and not found.is_warning
    made = job.write(study, str(tmp_path / "job"), found.match)
    ours, theirs = (reading(program, p, tmp_path / "out.json") for p in (made.drawing, path))
    assert ours == theirs and ours[0] == ("mm" if scale == 1000.0 else "m") and ours[2] == 1


@pytest.mark.parametrize("name", EIGHT)
def test_eight_drawings_read_as_themselves(doc, tmp_path, program, recent, name):
    path = os.path.join(SHARED, name + ".dxf")
    if not os.path.exists(path):
        pytest.skip("the drawings of shared/data are not here")
    import_into(doc, path)
    recent(path)
    study, found = behind(doc)
    made = job.write(study, str(tmp_path / "job"), found.match)
    ours, theirs = (reading(program, p, tmp_path / "out.json") for p in (made.drawing, path))
    assert ours == theirs, name


def test_edits_and_marks_reach_the_file_and_accept_comes_back(doc, tmp_path, program, recent):
    path, handles = two_rooms(tmp_path / "house.dxf")
    import_into(doc, path)
    recent(path)
    study, found = behind(doc)
    names = {e.id: e.name for e in study.drawn}
    shapes = {
        entity.handle: [doc.getObject(names[s.split("/")[0]]) for s in found.match.strokes_of(i)]
        for i, entity in enumerate(found.match.file.entities)
    }
    partition = [shapes[h][0] for h in handles["partition"]]
    marks.mark_all(partition, {"x": (-500, 500)}, "P")
    moved = shapes[handles["screen"]][0]
    moved.Placement.Base = V(0, -200, 0)
    doc.recompute()
    doc.clearUndos()
    study, found = behind(doc)
    assert found.words == "Layers, blocks and unit from house.dxf. 1 shape is new or edited."
    made = job.write(study, str(tmp_path / "job"), found.match)
    layers = {made.owners()[e.handle]: e.layer for e in source.DxfFile(made.drawing).entities if e.handle in made.owners()}
    assert layers[next(i for i, n in names.items() if n == moved.Name)] == b"A-WALL"
    assert subprocess.run([program, "run", made.drawing, "--quiet"], stdin=subprocess.DEVNULL).returncode in (0, 1)
    result = results.latest(made)
    option = result.options[0] if result.options else result.best
    assert result.unit == "m" and result.per_metre == 1000.0 and option is not None, result.notes
    shift = option.parameters[[m[0] for m in result.moves].index("P")]
    before = [o.Shape.BoundBox.Center.x for o in partition]
    swing = shapes[handles["door"]][0].Shape.BoundBox.XMin
    assert accept.accept(doc, made, result, option) and doc.UndoCount == 1 and abs(shift) > 1
    assert [o.Shape.BoundBox.Center.x for o in partition] == pytest.approx([x + shift for x in before], abs=0.2)
    assert shapes[handles["door"]][0].Shape.BoundBox.XMin == pytest.approx(swing + shift, abs=0.2), "its block too"
    doc.undo()
    doc.recompute()
    assert [o.Shape.BoundBox.Center.x for o in partition] == pytest.approx(before, abs=1e-6)


def test_a_file_that_does_not_fit_is_not_used(doc, tmp_path, recent):
    path, _ = two_rooms(tmp_path / "house.dxf")
    import_into(doc, path)
    study, found = behind(doc)
    assert found.match is None and found.words == "No DXF file fits these shapes. Layers and unit are unknown."
    other, _ = two_rooms(tmp_path / "other.dxf")
    with open(other) as f:
        text = f.read()
    for old, new in (("5.75", "5.15"), ("0.25", "0.45"), ("3.95", "3.15"), ("4.05", "3.25"), ("5.5\n", "5.9\n")):
        text = text.replace(old, new)
    with open(other, "w") as f:
        f.write(text)
    recent(other)
    assert behind(doc)[1].match is None
    with pytest.raises(PluginError, match="other.dxf does not fit these shapes: only .* % are alike. It is not used."):
        source.Sources().choose(doc, other, study.drawn)
    assert settings.drawing(doc) == {}
    source.Sources().choose(doc, path, study.drawn)
    assert settings.drawing(doc) == {"path": path, "usual": []}
    assert behind(doc)[1].words == "Layers, blocks and unit from house.dxf."
    os.replace(other, path)
    changed = behind(doc)[1]
    assert changed.match is None and changed.is_warning and "house.dxf does not fit these shapes" in changed.words
    os.remove(path)
    assert behind(doc)[1].words == f"{path} cannot be read any more. Layers and unit are unknown."


def test_a_named_file_that_does_not_fit_hides_no_other(doc, tmp_path, recent):
    path, _ = two_rooms(tmp_path / "house.dxf")
    import_into(doc, path)
    doc.Label = "other"
    named = str(tmp_path / "other.dxf")
    with open(named, "w") as f:
        f.write("0\nSECTION\n2\nENTITIES\n0\nLINE\n8\n0\n10\n0\n20\n0\n11\n7\n21\n3\n0\nENDSEC\n0\nEOF\n")
    recent(named, path)
    assert behind(doc)[1].match.file.path == path


def test_a_plan_drawn_here_needs_no_file(doc, recent):
    import Draft

    for x in (0, 4000):
        Draft.make_line(V(x, 0, 0), V(x, 3000, 0))
    doc.recompute()
    recent()
    found = behind(doc)[1]
    assert found.match is None and not found.is_warning
    assert found.words == "No DXF file is known for these shapes: they are read as drawn here."


def test_the_file_is_remembered_in_the_document(doc, tmp_path, recent):
    path, _ = two_rooms(tmp_path / "house.dxf")
    import_into(doc, path)
    recent(path)
    study, found = behind(doc)
    source.Sources().remember(doc, found.match)
    recent()
    doc.saveAs(str(tmp_path / "Häuschen.FCStd"))
    App.closeDocument(doc.Name)
    again = App.openDocument(str(tmp_path / "Häuschen.FCStd"))
    assert behind(again)[1].match.file.path == path
    # What is deleted after the first look is gone from the drawing of the job.
    study, found = behind(again)
    gone = study.drawn[6]
    again.removeObject(gone.name)
    assert len(behind(again)[1].match.absent()) == 1
