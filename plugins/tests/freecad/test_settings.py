import os
import time

import FreeCAD as App
import pytest
from conftest import build_house
from enfilade import document, importing, marks, settings, wording
from enfilade_common.model import Objective, PluginError, Wishes
from enfilade_common.results import Note


def test_a_study_is_remembered_in_its_document(doc, tmp_path):
    assert settings.wishes(doc) == Wishes() and settings.storey(doc) is None
    chosen = Wishes([Objective("depth", "min", 0.4), Objective("degree", "max", is_on=False)], 3, 7, 900, 0.5, "knee")
    settings.remember(doc, chosen, "Erdgeschoß")
    settings.remember(doc, chosen, "Erdgeschoß")
    assert doc.UndoNames == ["Enfilade: study"], "one entry, and none for the same again"
    doc.saveAs(str(tmp_path / "a.FCStd"))
    App.closeDocument(doc.Name)
    again = App.openDocument(str(tmp_path / "a.FCStd"))
    assert (settings.wishes(again), settings.storey(again)) == (chosen, "Erdgeschoß")


def test_accepted_rounds_are_kept_in_order(doc):
    for number in (2, 1):
        settings.remember_accepted(doc, {"candidate": number})
    assert [e["candidate"] for e in settings.lineage(doc)] == [2, 1]


def test_what_someone_else_wrote_there_is_no_study(doc):
    settings.remember(doc, Wishes(), "")
    study = doc.getObject(settings.NAME)
    study.EnfiladeWishes, study.EnfiladeLineage = "[1, 2", "nonsense"
    assert settings.wishes(doc) == Wishes() and settings.lineage(doc) == []
    objective = '{"measure": "degree", "sense": "max"%s}'
    for text in (
        "[]",
        "null",
        '{"objectives": []}',
        '{"objectives": [%s]}' % (objective % ', "threshold": "x"'),
        '{"objectives": [%s], "members": "a"}' % (objective % ""),
        '{"objectives": [{"measure": "size", "sense": "max"}]}',
    ):
        study.EnfiladeWishes = text
        assert settings.wishes(doc) == Wishes(), text
    study.EnfiladeWishes = '{"objectives": [%s], "members": 2}' % (objective % "")
    assert settings.wishes(doc) == Wishes([Objective("degree", "max")], 2)


def test_jobs_lie_beside_a_saved_document(doc, tmp_path):
    assert settings.job_folder(doc).startswith(App.getUserAppDataDir())
    doc.saveAs(str(tmp_path / "Haus Süd.FCStd"))
    assert settings.job_folder(doc) == os.path.join(str(tmp_path), "Haus Süd-enfilade")


def test_a_folder_that_cannot_be_written_is_said(doc, tmp_path, monkeypatch):
    assert settings.folder_notice(doc) == []
    doc.saveAs(str(tmp_path / "a.FCStd"))
    assert settings.folder_notice(doc) == []
    monkeypatch.setattr(os, "access", lambda *a: False)
    (notice,) = settings.folder_notice(doc)
    assert "cannot be written" in notice and settings.job_folder(doc) in notice


def test_a_region_loses_its_mark(doc):
    import Draft

    made = Draft.make_rectangle(1000, 1000)
    marks.mark_region(made, "query")
    marks.unmark(made)
    assert marks.region_kind(made) == ""


def test_regions_of_a_name_are_a_pair(doc):
    import Arch
    import Draft

    Arch.makeWall(length=3000, width=200, height=2800)
    doc.recompute()
    made = Draft.make_rectangle(1000, 1000)
    marks.mark_region(made, "query", "Main Door")
    doc.recompute()
    assert document.pairs(doc) == ["main-door"]
    study, reading = document.study(doc, Wishes())
    assert [(r.kind, r.pair) for r in study.regions] == [("query", "main-door")] and reading.notes == []
    made.EnfiladePair = "a/b"
    assert document.pairs(doc) == []
    study, reading = document.study(doc, Wishes())
    assert study.regions[0].pair == "" and "cannot name a pair" in reading.notes[0]
    marks.unmark(made)
    assert not hasattr(made, "EnfiladePair")


def test_ifc_without_its_reader(doc, tmp_path, monkeypatch):
    import importlib.util

    (tmp_path / "x.ifc").write_text("not ifc")
    known = list(App.listDocuments())
    find = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda n, *a: None if n == "ifcopenshell" else find(n, *a))
    with pytest.raises(PluginError, match="IfcOpenShell, which is not installed"):
        importing.as_document(str(tmp_path / "x.ifc"))
    assert list(App.listDocuments()) == known


def test_an_ifc_that_fails_leaves_no_empty_document(doc, tmp_path, monkeypatch):
    import importlib.util
    import sys
    import types

    (tmp_path / "x.ifc").write_text("not ifc")
    known = list(App.listDocuments())
    find = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda n, *a: n if n == "ifcopenshell" else find(n, *a))

    def fails(path):
        App.newDocument("x")
        raise RuntimeError("no header")

    for reads in (fails, lambda path: App.newDocument("x"), lambda path: App.newDocument("y") and None):
        monkeypatch.setitem(sys.modules, "importIFC", types.SimpleNamespace(open=reads))
        with pytest.raises(PluginError, match="could not read"):
            importing.as_document(str(tmp_path / "x.ifc"))
        assert list(App.listDocuments()) == known


def test_a_crash_is_no_stop(program, tmp_path):
    from enfilade.qt import QtCore
    from enfilade.runner import Runner

    app = QtCore.QCoreApplication.instance() or QtCore.QCoreApplication([])
    crash = tmp_path / "crash"
    crash.write_text("#!/bin/sh\necho one >&2; echo last words >&2; kill -SEGV $$\n")
    crash.chmod(0o755)
    deaf = tmp_path / "deaf"
    deaf.write_text("#!/bin/sh\ntrap '' INT\necho ready >&2; while true; do sleep 0.1; done\n")
    deaf.chmod(0o755)
    for path, expected in ((crash, (-11, "The program ended with code -11. last words")), (deaf, (130, "Stopped."))):
        ended = []
        runner = Runner()
        runner.ended.connect(lambda *a: ended.append(a))
        runner.start(str(path), "plan.dxf")
        end = time.monotonic() + 120
        while not ended and time.monotonic() < end:
            app.processEvents()
            if path is deaf and runner._process is not None and runner._listener.words and not runner._is_stopped:
                runner.stop()
                runner._kill(runner._process)
            time.sleep(0.01)
        assert ended == [expected]


def test_the_language_is_freecads():
    general = App.ParamGet("User parameter:BaseApp/Preferences/General")
    before = general.GetString("Language", "")
    try:
        general.SetString("Language", "German")
        assert wording.say("Option {}", 2) == "Variante 2"
        general.SetString("Language", "French")
        assert wording.say("Option {}", 2) == "Option 2"
    finally:
        general.SetString("Language", before)


def test_notes_are_said_in_the_words_of_the_window():
    for text, words in (
        ("spacing 0.2 m: 1130 vertices are measured on 45 m²; --spacing overrides it",
         "Cell size 0.2 m: 1130 cells are measured on 45 m²; 'Cell size' on page 2 overrides it."),
        ("All thresholds were lowered to 82 % of what was asked, so that the options differ. `--thresholds firm` keeps them.",
         "All thresholds were lowered to 82 % of what was asked, so that the options differ. Set a slider on page 2 to keep them."),
        ("maps correlate 0.69. Lower thresholds or more EF-MOVE boxes make room for other ideas.",
         "Maps correlate 0.69. Lower thresholds or more marks make room for other ideas."),
        ("gaps were taken as closed to find the interior; EF-QUERY or --seed-point says it exactly",
         "Gaps were taken as closed to find the interior; regions on page 1 say it exactly."),
        ("only P may move; more --evaluations find more, and EF-MOVE boxes round more walls or wider bounds in them make room",
         "Only P may move; more 'Layouts to measure' find more, and marks on more walls or wider bounds make room."),
        ("more --evaluations, wider bounds or lower thresholds find more",
         "More 'Layouts to measure', wider bounds or lower thresholds find more."),
        ("unit: mm assumed ($INSUNITS 0, $MEASUREMENT 1): then the walls are 7.8 m long; --unit overrides it",
         "Unit: mm assumed: then the walls are 7.8 m long; 'Drawn in' on page 2 overrides it."),
        ('[[move]] "Q" names no wall of the drawing; nothing moves here', "No line of 'Q' is read as a wall; nothing moves here."),
        ("the drawing is 3.8 m long when read in cm; --unit overrides it (--unit 25m: one drawing unit is 25 m)",
         "The drawing is 3.8 m long when read in cm; 'Drawn in' on page 2 overrides it."),
        ("unit: mm as --unit or the settings file says (the file: $INSUNITS 4, $MEASUREMENT 1)", "Unit: mm, as in the document."),
    ):
        assert wording.note_here(Note("info", "plan.dxf", text), {}) == Note("info", "", words)
    placed = Note("warning", "plan.dxf:120 POLYLINE 3F layer A-WALL", "its joint opens in option 2")
    assert wording.note_here(placed, {"3F": "P1"}).text == "'P1': its joint opens in option 2."
    assert wording.here("One part of a door goes along (layer A-DOOR).") == "One part of a door goes along."


def test_no_note_of_a_real_study_speaks_of_files_or_the_command_line(doc, wishes, tmp_path, run_study):
    build_house(doc)
    made, found = run_study(doc, wishes, tmp_path)
    notes = [wording.note_here(n, made.labels()) for n in found.notes]
    assert notes
    for note in notes:
        assert not any(w in note.text for w in ("EF-", "--", "plan.dxf", "[[", "layer A-")), note.text


def test_a_candidate_becomes_a_document(doc, wishes, tmp_path, run_study):
    build_house(doc)
    _, found = run_study(doc, wishes, tmp_path)
    made = importing.as_document(found.options[0].file)
    edges = {o.Label: len(o.Shape.Edges) for o in made.Objects if hasattr(o, "Shape")}
    assert edges["A_WALL"] >= 8 * 4 and edges["EF_MOVED"] > 0


def test_what_is_no_candidate_is_refused(tmp_path):
    (tmp_path / "x.txt").write_text("")
    for name, words in (("nothing.dxf", "not there"), ("x.txt", "a .dxf or an .ifc")):
        with pytest.raises(PluginError, match=words):
            importing.as_document(str(tmp_path / name))
