"""Dialogs and buttons: what Windows is asked for."""

import os
import re
import runpy

import pytest
from conftest import LIB
from enfilade_revit import work
from enfilade_revit.window import Window, open_file
from fake import dotnet, forms

PANEL = os.path.join(LIB, "..", "Enfilade.tab", "Enfilade.panel")


def answering(choose, result=forms.DialogResult.OK):
    def answer(form):
        choose(form)
        return result

    forms.Form._answer = staticmethod(answer)


def test_a_row_is_chosen():
    answering(lambda form: setattr(form._of(forms.ListBox)[0], "SelectedIndex", 1))
    assert Window().choose("Enfilade", "Which?", ["one", "two"]) == 1
    answering(lambda form: None)
    assert Window().choose("Enfilade", "Which?", ["one"]) is None
    answering(lambda form: setattr(form._of(forms.ListBox)[0], "SelectedIndex", 0), forms.DialogResult.Cancel)
    assert Window().choose("Enfilade", "Which?", ["one"]) is None


def test_pictures_are_shown_and_their_files_stay_free(tmp_path):
    picture, seen = tmp_path / "candidate-1-degree.png", []
    picture.write_bytes(b"png")

    def look(form):
        view, report = form._of(forms.ListView)[0], form._of(forms.Button)[1]
        seen.extend(view.Items)
        view.SelectedIndices.append(1)
        report._press()

    rows = [("Option 1", "better", str(picture)), ("Option 2", "worse", str(tmp_path / "none.png"))]
    answering(look)
    assert Window().choose_picture("Enfilade", rows, "report.html") == 1
    assert seen == [("Option 1: better", 0), "Option 2: worse"] and forms.Image._locked == []
    assert dotnet.Process._opened == ["report.html"]
    answering(look, forms.DialogResult.Cancel)
    assert Window().choose_picture("Enfilade", rows, "report.html") is None


def test_a_page_is_opened_by_the_shell():
    """.NET 8 starts a bare path as a program; the fake does so too."""
    with pytest.raises(dotnet.SystemException, match="not a valid application"):
        dotnet.Process.Start("report.html")
    with pytest.raises(dotnet.SystemException, match="not a valid application"):
        dotnet.Process.Start(dotnet.ProcessStartInfo("report.html"))
    open_file("report.html")
    assert dotnet.Process._opened == ["report.html"]


def test_a_folder_is_chosen(monkeypatch, tmp_path):
    assert Window().choose_folder("Folder", str(tmp_path)) == ""
    monkeypatch.setattr(forms.FolderBrowserDialog, "_answer", "/there")
    assert Window().choose_folder("Folder", str(tmp_path)) == "/there"


def test_every_button_has_its_parts_and_runs(revit):
    buttons = [b for b in os.listdir(PANEL) if b.endswith(".pushbutton")]
    with open(os.path.join(PANEL, "bundle.yaml")) as f:
        assert sorted(re.findall(r"- (\w+)", f.read())) == sorted(b.split(".")[0] for b in buttons)
    called = []
    for button in buttons:
        assert sorted(os.listdir(os.path.join(PANEL, button))) == ["bundle.yaml", "icon.png", "script.py"]
        script = os.path.join(PANEL, button, "script.py")
        with open(script) as f:
            name = re.search(r"work\.(\w+)\(Host\(", f.read()).group(1)
        kept = getattr(work, name)
        setattr(work, name, lambda host, window: called.append((name, host.document_name())))
        try:
            application = type("UIApplication", (), {"ActiveUIDocument": revit.uidoc()})
            runpy.run_path(script, {"__revit__": application})
            runpy.run_path(script, {"__revit__": type("UIApplication", (), {"ActiveUIDocument": None})})
        finally:
            setattr(work, name, kept)
    assert len(called) == len(buttons) == 7 and {host for _, host in called} == {"Haus Süd"}
    assert forms.TaskDialog._shown == [("Enfilade", "Open a project first.")] * 7
