"""Bringing a written option back as a document of its own."""

import importlib.util
import os

import FreeCAD as App

from enfilade_common.model import PluginError


def as_document(path: str):
    """Opens a candidate (DXF, IFC) as a new document with a group for every layer."""
    extension = os.path.splitext(path)[1].lower()
    if not os.path.isfile(path):
        raise PluginError(f"{path} is not there any more.")
    if extension == ".ifc":
        return _ifc_document(path)
    if extension != ".dxf":
        raise PluginError(f"{path}: a candidate is a .dxf or an .ifc file.")
    import importDXF

    stem = os.path.splitext(os.path.basename(path))[0]
    doc = App.newDocument(stem.replace("-", "_"))
    doc.Label = f"{os.path.basename(os.path.dirname(path))} {stem}"
    draft = App.ParamGet("User parameter:BaseApp/Preferences/Mod/Draft")
    changed = {"dxfShowDialog": False, "groupLayers": True, "dxfUseLegacyImporter": False}
    before = {k: draft.GetBool(k, False) for k in changed}
    try:
        for key, value in changed.items():
            draft.SetBool(key, value)
        importDXF.insert(path, doc.Name)
    finally:
        for key, value in before.items():
            draft.SetBool(key, value)
    doc.recompute()
    if not doc.Objects:
        App.closeDocument(doc.Name)
        raise PluginError(f"FreeCAD found nothing in {path}.")
    return doc


NO_IFC = (
    "FreeCAD reads IFC with the Python package IfcOpenShell, which is not installed here (Debian: "
    "python3-ifcopenshell; others: pip install ifcopenshell for FreeCAD's Python). A DXF candidate needs nothing."
)


def _ifc_document(path: str):
    if importlib.util.find_spec("ifcopenshell") is None:
        raise PluginError(NO_IFC)
    import importIFC

    known = set(App.listDocuments())
    try:
        doc = importIFC.open(path)
    except Exception as e:
        doc, said = None, f" ({type(e).__name__}: {e})"
    else:
        said = ""
    if doc is None or not doc.Objects:
        for name in set(App.listDocuments()) - known:
            App.closeDocument(name)
        raise PluginError(f"FreeCAD could not read {path}{said}.")
    return doc
