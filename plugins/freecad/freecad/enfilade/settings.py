"""What is remembered: the study in its document, the program's place in FreeCAD's settings, job folders."""

import json
import os
from dataclasses import asdict
from typing import Any, Dict, List

import FreeCAD as App

from enfilade_common.model import Objective, Wishes

NAME = "EnfiladeStudy"
PREFERENCES = "User parameter:BaseApp/Preferences/Mod/Enfilade"


def _study_object(doc):
    return next((o for o in doc.Objects if hasattr(o, "EnfiladeWishes")), None)


def wishes(doc) -> Wishes:
    """The wishes remembered in a document, or the default ones."""
    obj = _study_object(doc)
    try:
        data = json.loads(obj.EnfiladeWishes) if obj is not None else {}
        data["objectives"] = [Objective(**o) for o in data["objectives"]]
        return Wishes(**data)
    except (KeyError, TypeError, ValueError):
        return Wishes()


def storey(doc) -> str:
    return str(getattr(_study_object(doc), "EnfiladeStorey", "") or "")


def lineage(doc) -> List[Dict[str, Any]]:
    """Accepted rounds of a document, oldest first."""
    try:
        return list(json.loads(getattr(_study_object(doc), "EnfiladeLineage", "") or "[]"))
    except ValueError:
        return []


def _made(doc):
    obj = _study_object(doc)
    if obj is None:
        obj = doc.addObject("App::FeaturePython", NAME)
        obj.Label = "Enfilade"
        for name, words in (
            ("EnfiladeWishes", "What should get better, how to search"),
            ("EnfiladeStorey", "Storey that is studied"),
            ("EnfiladeLineage", "Accepted rounds"),
        ):
            obj.addProperty("App::PropertyString", name, "Enfilade", words)
            obj.setEditorMode(name, 1)
    return obj


def remember(doc, chosen: Wishes, storey_label: str) -> None:
    """Writes the study into the document, as one undo step, if it differs from what stands there."""
    text = json.dumps(asdict(chosen))
    obj = _study_object(doc)
    if obj is not None and (obj.EnfiladeWishes, obj.EnfiladeStorey) == (text, storey_label):
        return
    doc.openTransaction("Enfilade: study")
    obj = _made(doc)
    obj.EnfiladeWishes, obj.EnfiladeStorey = text, storey_label
    doc.commitTransaction()


def remember_accepted(doc, entry: Dict[str, Any]) -> None:
    """Adds an accepted round, inside the transaction that accepts it."""
    known = lineage(doc)
    _made(doc).EnfiladeLineage = json.dumps([*known, entry])


def program_path() -> str:
    return App.ParamGet(PREFERENCES).GetString("Program", "")


def remember_program_path(path: str) -> None:
    App.ParamGet(PREFERENCES).SetString("Program", path)


def job_folder(doc) -> str:
    """Where a document's jobs lie: beside its file, or in FreeCAD's own folder before it is saved."""
    if doc.FileName:
        folder, name = os.path.split(os.path.abspath(doc.FileName))
        if os.access(folder, os.W_OK):
            return os.path.join(folder, os.path.splitext(name)[0] + "-enfilade")
    return os.path.join(App.getUserAppDataDir(), "Enfilade", str(getattr(doc, "Uid", "") or doc.Name))
