"""What host.py asks of Revit beside walls: parameters, exports, transactions."""

import os

import pytest
from enfilade_common.model import PluginError
from enfilade_revit import host as module
from enfilade_revit import work
from fake import building, document, failures


def test_the_parameters_are_made_from_a_file_of_our_own(revit):
    revit.doc._bindings = {"Enfilade Moves": ((), "theirs"), "Comments": ((), "")}
    used, create = [], document.Definitions.Create

    def noting(self, option):
        used.append((self._group._path, option.Description))
        return create(self, option)

    document.Definitions.Create = noting
    try:
        assert revit.host().add_parameters() == ["Enfilade Group", "Enfilade Keep"]
    finally:
        document.Definitions.Create = create
    assert revit.doc.Application.SharedParametersFilename == building.SHARED, "the user's file is set again"
    assert len({path for path, _ in used}) == 1 and not os.path.exists(used[0][0]) and used[0][1]
    categories, guid = revit.doc._bindings["Enfilade Group"]
    assert set(categories) == set(building.BOUND) and guid == module.PARAMETERS[1][2]
    assert revit.doc._bindings["Enfilade Moves"] == ((), "theirs"), "what is there stays"
    assert [name for name, _ in revit.doc._undo] == ["Enfilade: parameters"]
    assert revit.host().add_parameters() == [] and len(revit.doc._undo) == 1


def test_the_users_parameter_file_is_set_again_when_revit_refuses(revit):
    revit.doc._bindings = {}
    revit.doc._trouble = [(failures.FailureSeverity.Error, "The model is read-only.")]
    with pytest.raises(PluginError, match="The model is read-only"):
        revit.host().add_parameters()
    assert revit.doc.Application.SharedParametersFilename == building.SHARED and revit.doc._bindings == {}


def test_the_button_says_what_it_added(revit, window):
    said = window()
    work.add_parameters(revit.host(), said)
    revit.doc._bindings = {}
    work.add_parameters(revit.host(), said)
    assert said.said == [
        "The model has the parameters already.",
        "Added: Enfilade Moves, Enfilade Group, Enfilade Keep.",
    ]


def test_exports_are_in_the_coordinates_in_which_elements_are_moved(revit, window, tmp_path):
    for kind in (0, 1):
        asked = window(str(tmp_path), kind)
        work.export_drawing(revit.host(), asked)
        assert asked.said == [f"Written to {tmp_path}."]
    (_, name, views, dxf), (folder, _, _, ifc) = revit.doc._exports
    assert (name, folder) == ("Haus Süd", str(tmp_path)) and [v.Value for v in views] == [revit.plan._id]
    assert (dxf.LayerMapping, dxf.SharedCoords, dxf.TargetUnit.name) == ("AIA", False, "Millimeter")
    assert (ifc.FileVersion.name, ifc.FilterViewId, ifc._more) == ("IFC4", revit.plan.Id, {"SitePlacement": "3"})
    assert revit.doc._undo == [] and revit.doc._transaction is None
    work.export_drawing(revit.host(), window(""))
    work.export_drawing(revit.host(), window(str(tmp_path), None))
    assert len(revit.doc._exports) == 2
    revit.doc._writes = False
    for write in (revit.host().export_dxf, revit.host().export_ifc):
        with pytest.raises(PluginError, match="Revit did not write Haus Süd"):
            write(str(tmp_path), "Haus Süd")


def test_an_export_that_revit_refuses(revit, tmp_path, monkeypatch):
    def refusing(self, folder, name, *rest):
        raise failures.InvalidOperationException("The view cannot be printed.")

    monkeypatch.setattr(document.Document, "Export", refusing)
    for write in (revit.host().export_dxf, revit.host().export_ifc):
        with pytest.raises(PluginError, match="Revit refuses: The view cannot be printed"):
            write(str(tmp_path), "a")
    assert revit.doc._transaction is None


def test_a_preprocessor_read_twice_is_of_another_name():
    """pythonnet knows classes for as long as Revit runs; pyRevit reads modules again."""
    with open(module.__file__, encoding="utf-8") as f:
        exec(compile(f.read(), "again", "exec"), {"__name__": "enfilade_revit.again", "__package__": "enfilade_revit"})
    with pytest.raises(TypeError, match="Duplicate type name"):
        type("_Failures", (failures.IFailuresPreprocessor,), {"__namespace__": module._Failures.__namespace__})


def test_what_is_no_failure_of_revit_rolls_back_too(revit):
    before = dict(revit.at["Screen"]._s)
    with pytest.raises(ZeroDivisionError):
        with revit.host().transaction("test"):
            revit.at["Screen"].Pinned = True
            1 / 0
    assert revit.at["Screen"]._s == before and revit.doc._transaction is None
