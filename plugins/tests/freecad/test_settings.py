import os

import FreeCAD as App
import pytest
from conftest import build_house
from enfilade import importing, settings, wording
from enfilade_common.model import Objective, PluginError, Wishes


def test_a_study_is_remembered_in_its_document(doc, tmp_path):
    assert settings.wishes(doc) == Wishes()
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


def test_jobs_lie_beside_a_saved_document(doc, tmp_path):
    assert settings.job_folder(doc).startswith(App.getUserAppDataDir())
    doc.saveAs(str(tmp_path / "Haus Süd.FCStd"))
    assert settings.job_folder(doc) == os.path.join(str(tmp_path), "Haus Süd-enfilade")


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
