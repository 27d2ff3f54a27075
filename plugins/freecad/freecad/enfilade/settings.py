"""What is remembered: the study in its document, the program's place in FreeCAD's settings, job folders."""

import json
import os
from dataclasses import asdict
from typing import Any, Dict, List, Optional

import FreeCAD as App

from enfilade_common.model import MEASURES, UNITS, Objective, Wishes

from .wording import say

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
        found = Wishes(**data)
        return found if _is_sound(found) else Wishes()
    except (KeyError, TypeError, ValueError):
        return Wishes()


def _is_sound(found: Wishes) -> bool:
    """Whether what was remembered are wishes, whoever wrote them there."""

    def is_number(value, *kinds) -> bool:
        return isinstance(value, kinds) and not isinstance(value, bool)

    objectives = all(
        o.measure in MEASURES
        and o.sense in ("max", "min")
        and is_number(o.threshold, int, float)
        and isinstance(o.is_on, bool)
        and isinstance(o.pair, str)
        for o in found.objectives
    )
    whole = all(is_number(v, int) for v in (found.members, found.seed))
    budget = found.evaluations is None or is_number(found.evaluations, int)
    spacing = found.spacing_m is None or is_number(found.spacing_m, int, float)
    is_unit = found.unit in ("", *UNITS)
    brief = isinstance(found.brief, list) and all(isinstance(item, str) for item in found.brief)
    return bool(found.objectives) and objectives and whole and budget and spacing and is_unit and brief


def storey(doc) -> Optional[str]:
    """The storey last studied; nothing where none was."""
    obj = _study_object(doc)
    return None if obj is None else str(obj.EnfiladeStorey)


def lineage(doc) -> List[Dict[str, Any]]:
    """Accepted rounds of a document, oldest first."""
    try:
        return list(json.loads(getattr(_study_object(doc), "EnfiladeLineage", "") or "[]"))
    except ValueError:
        return []


def drawing(doc) -> Dict[str, Any]:
    """The file behind the shapes: its ``path``, the handles of what its import left out."""
    try:
        said = json.loads(getattr(_study_object(doc), "EnfiladeDrawing", "") or "{}")
    except ValueError:
        return {}
    is_sound = isinstance(said, dict) and isinstance(said.get("path"), str) and isinstance(said.get("usual"), list)
    return dict(said, usual=[str(h) for h in said["usual"]]) if is_sound else {}


def remember_drawing(doc, path: str, usual: List[str]) -> None:
    """Writes into the document which file is behind its shapes, as one undo step, if that is new."""
    text = json.dumps({"path": path, "usual": usual})
    if getattr(_study_object(doc), "EnfiladeDrawing", "") == text:
        return
    doc.openTransaction("Enfilade: drawing")
    _made(doc).EnfiladeDrawing = text
    doc.commitTransaction()


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
            _add_text(obj, name, words)
    if not hasattr(obj, "EnfiladeDrawing"):
        _add_text(obj, "EnfiladeDrawing", "The DXF file behind the shapes")
    return obj


def _add_text(obj, name: str, words: str) -> None:
    obj.addProperty("App::PropertyString", name, "Enfilade", words)
    obj.setEditorMode(name, 1)


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


def folder_notice(doc) -> List[str]:
    """Where the job lies, where that is not beside the document."""
    folder = job_folder(doc)
    if not doc.FileName or os.path.dirname(folder) == os.path.dirname(os.path.abspath(doc.FileName)):
        return []
    return [say("The folder of the document cannot be written; the job lies in {}.", folder)]
