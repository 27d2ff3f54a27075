"""Bringing a written option back as a document of its own."""

import os

import FreeCAD as App

from enfilade_common.model import PluginError


def as_document(path: str):
    """Opens a candidate (DXF, IFC) as a new document with a group for every layer."""
    extension = os.path.splitext(path)[1].lower()
    if not os.path.isfile(path):
        raise PluginError(f"{path} is not there any more.")
    if extension == ".ifc":
        import importIFC

        doc = importIFC.open(path)
        if doc is None:
            raise PluginError(f"FreeCAD could not read {path}.")
        return doc
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
