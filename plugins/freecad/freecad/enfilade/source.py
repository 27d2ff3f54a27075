"""The DXF file that a document was imported from: where it is, whether it still fits, what is remembered of it."""

import os
from dataclasses import dataclass
from typing import Dict, List, Optional, Tuple

import FreeCAD as App

from enfilade_common import behind
from enfilade_common.behind import Match
from enfilade_common.dxf_file import DxfFile
from enfilade_common.model import Drawn, PluginError

from . import plan2d, settings
from .wording import say

#: Files opened last that are looked at, where none bears the document's name.
RECENT_MAX = 10
#: Bytes of a file that is looked at unasked, where its name says nothing.
UNNAMED_MAX = 10 << 20
#: How a folder of our own jobs ends: what lies there is written anew by every job.
JOB_FOLDER = "-enfilade"
#: What was left out by the import at first may be so much of a file; more was deleted.
USUAL_MAX = 0.05


@dataclass
class Source:
    """What stands behind the shapes of a document: a file that fits, and what is to be said of it."""

    match: Optional[Match] = None
    words: str = ""
    #: Whether the user has to do something.
    is_warning: bool = False

    @property
    def scale(self) -> float:
        return self.match.scale if self.match else 1.0


class Sources:
    """The files behind documents; each is read again only where it has changed."""

    def __init__(self):
        self._files: Dict[str, Tuple[float, DxfFile]] = {}
        #: Files that could not be read, and those that did not fit, by document: when, and how many shapes there were.
        self._misfits: Dict[Tuple[str, str], Tuple[float, int]] = {}
        #: What an import left out, by document and file, before it was remembered in the document.
        self._usual: Dict[Tuple[str, str], List[str]] = {}

    def of(self, doc, drawn: List[Drawn]) -> Source:
        """The file behind the lines of a document, if one fits."""
        if not drawn:
            return Source()
        said = settings.drawing(doc)
        known = str(said.get("path") or "")
        if known:
            match = self._look(doc, known, drawn)
            return _found(match) if match is not None and match.fits else Source(None, _lost(known, match), True)
        tiers = candidates(doc)
        for paths in tiers:
            fits = [m for m in (self._look(doc, path, drawn) for path in paths) if m is not None and m.fits]
            if fits:
                return _found(max(fits, key=lambda m: m.shapes_share))
        if not any(tiers) and knows_its_lines(doc):
            return Source(None, say("No DXF file is known for these shapes: they are read as drawn here."))
        return Source(None, say("No DXF file fits these shapes. Layers and unit are unknown."), True)

    def choose(self, doc, path: str, drawn: List[Drawn]) -> Source:
        """The user says which file it is: it is remembered if it fits."""
        if _is_job(path):
            raise PluginError(say("{} is a drawing of a job, which is written anew. Choose your own.", path))
        match = behind.match(self._file(path), drawn)
        if not match.fits:
            raise PluginError(_misfit(path, match))
        self._usual[doc.Name, path] = usual(match)
        self.remember(doc, match)
        return _found(match)

    def remember(self, doc, match: Optional[Match]) -> None:
        if match is not None:
            settings.remember_drawing(doc, match.file.path, sorted(match.usual))

    def _look(self, doc, path: str, drawn: List[Drawn]) -> Optional[Match]:
        said = settings.drawing(doc)
        is_known = said.get("path") == path
        left_out = said.get("usual") if is_known else self._usual.get((doc.Name, path))
        now = (_changed(path), len(drawn))
        if not is_known and self._misfits.get((doc.Name, path)) == now:
            return None
        try:
            match = behind.match(self._file(path), drawn, left_out or ())
        except PluginError:
            self._misfits[doc.Name, path] = now
            return None
        if not match.fits:
            self._misfits[doc.Name, path] = now
            self._files.pop(path, None)
        if left_out is None and match.fits:
            match.usual = set(usual(match))
            self._usual[doc.Name, path] = sorted(match.usual)
        return match

    def _file(self, path: str) -> DxfFile:
        try:
            changed = os.path.getmtime(path)
        except OSError as e:
            raise PluginError(say("{} is not there.", path)) from e
        known = self._files.get(path)
        if known is None or known[0] != changed:
            self._files[path] = (changed, DxfFile(path))
        return self._files[path][1]


def usual(match: Match) -> List[str]:
    """What an import left out of a file, where nothing was edited since: little, and every shape is in the file."""
    lost = match.lost()
    is_little = len(lost) <= max(1.0, USUAL_MAX * len(match.file.entities))
    return lost if is_little and not match.loose_owners else []


def _found(match: Match) -> Source:
    name = os.path.basename(match.file.path)
    words = [say("Layers, blocks and unit from {}.", name)]
    edited = len(match.loose_owners)
    if edited:
        words.append(say("{} shapes are new or edited.", edited) if edited > 1 else say("1 shape is new or edited."))
    # A line that was edited is one of them.
    gone = len(match.absent()) - edited
    if gone > 0:
        words.append(say("Things of the file that are not here, and are left out: {}.", gone))
    if match.usual:
        words.append(say("Things that the import lost, taken from the file: {}.", len(match.usual)))
    return Source(match, " ".join(words))


def _lost(path: str, match: Optional[Match]) -> str:
    if match is None:
        return say("{} cannot be read any more. Layers and unit are unknown.", path)
    return _misfit(path, match)


def _misfit(path: str, match: Match) -> str:
    share = f"{100 * min(match.shapes_share, match.file_share):.0f}"
    return say("{} does not fit these shapes: only {} % are alike. It is not used.", os.path.basename(path), share)


def knows_its_lines(doc) -> bool:
    """Whether no line of a document is a bare shape, as an import leaves unless Draft objects are asked for."""
    return all(o.TypeId != "Part::Feature" for o in plan2d.lines(doc))


def candidates(doc) -> List[List[str]]:
    """Files that may be behind a document: those of its name, opened last or beside it, and where none fits the last ones."""
    recent = [p for p in _recent() if p.lower().endswith(".dxf")]
    names = {_plain(doc.Label), _plain(doc.Name)}
    beside = []
    folders = [_last_folder(), os.path.dirname(doc.FileName or "")]
    stems = dict.fromkeys([doc.Label, os.path.splitext(os.path.basename(doc.FileName or ""))[0]])
    for folder in (f for f in folders if f):
        beside += [os.path.join(folder, stem + ext) for stem in stems if stem for ext in (".dxf", ".DXF")]
    named = [p for p in recent if _plain(os.path.splitext(os.path.basename(p))[0]) in names]
    first = [p for p in dict.fromkeys([*named, *beside]) if os.path.isfile(p)]
    others = [p for p in recent[:RECENT_MAX] if os.path.isfile(p) and os.path.getsize(p) <= UNNAMED_MAX]
    return [[p for p in found if not _is_job(p)] for found in (first, others)]


def _is_job(path: str) -> bool:
    """Whether a file lies in the folder of a job of ours."""
    return os.path.basename(os.path.dirname(os.path.abspath(path))).endswith(JOB_FOLDER)


def _changed(path: str) -> float:
    try:
        return os.path.getmtime(path)
    except OSError:
        return 0.0


def _plain(name: str) -> str:
    """A name as FreeCAD makes one of a file's."""
    return "".join(c if c.isalnum() and c.isascii() else "_" for c in name).lower()


def _recent() -> List[str]:
    group = App.ParamGet("User parameter:BaseApp/Preferences/RecentFiles")
    return [p for p in (group.GetString(f"MRU{i}", "") for i in range(50)) if p]


def _last_folder() -> str:
    path = App.ParamGet("User parameter:BaseApp/Preferences/General").GetString("FileOpenSavePath", "")
    return path if os.path.isdir(path) else os.path.dirname(path)
