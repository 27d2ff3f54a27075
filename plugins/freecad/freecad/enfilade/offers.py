"""What may be done with selected objects, and what is said of it."""

from typing import Dict, List, Optional, Tuple

from enfilade_common import possible
from enfilade_common.model import KINDS, Column, Drawn, Study, Wall
from enfilade_common.possible import Possible
from enfilade_common.works import KINDS as WORKS

from . import document, marks
from .wording import say

#: What can be done, as the end of "P can: …"; of a wall, and of a door or an opening itself where that differs.
WORDS = {
    "x": "move",
    "y": "move",
    "along": "move",
    "rotate": "turn",
    "open": "get an opening",
    "door": "get a door",
    "glaze": "get glass",
    "widen": "get wider doors and openings",
    "close": "have doors and openings walled up",
    "rehang": "have doors hung elsewhere in it",
    "end": "end earlier",
    "remove": "be removed",
    "add": "get a new wall across the room",
}
OPENING_WORDS = {
    "along": "slide along the wall",
    "widen": "become wider",
    "close": "be walled up",
    "rehang": "be hung elsewhere in its wall",
}
#: Why there is no more, with the names of the objects.
WHY_WORDS = {
    possible.KEPT: "{}: nothing is built in what must stay.",
    possible.REGION: "{}: lies in a region where nothing moves.",
    possible.OUTER: "{}: outdoors on one side, so nothing is opened or walled up.",
    possible.ROUND: "{}: has no straight axis, so no part of it is opened.",
    possible.SHORT: "{}: too short for an opening of 0.9 m.",
    possible.WINDOW: "{}: windows are not rebuilt.",
    possible.COLUMN: "{}: columns are not rebuilt.",
}
#: What differs is said of so many groups of objects; names in each.
SAID_MAX, NAMES_MAX = 4, 6


class Offers:
    """What may be done with the objects of a storey. Its walls are read once for all selections, until the document
    changes."""

    def __init__(self):
        self._key: Optional[Tuple] = None
        self._site: Optional[possible.Site] = None
        self._ids: Dict[str, List[str]] = {}

    def forget(self) -> None:
        """The document has changed."""
        self._key = None

    def of(self, obj, storey: Optional[str], level: str) -> Possible:
        key = (obj.Document.Name, storey, level)
        if key != self._key:
            self._read(obj.Document, storey, level)
            self._key = key
        for element in self._site.study.movables():
            if element.name == obj.Name:
                # Marks change without the plan.
                element.keep = marks.keep(obj)
        found = [p for p in map(self._site.of, self._ids.get(obj.Name, [])) if p is not None]
        if not found:
            # No part of the plan, as a high window.
            return Possible(["along"] if document.kind_of(obj) == "Window" else [k for k in KINDS if k != "along"])
        return Possible(
            [k for k in KINDS if any(k in p.moves for p in found)],
            [k for k in WORKS if any(k in p.works for p in found)],
            list(dict.fromkeys(w for p in found for w in p.why)),
        )

    def _read(self, doc, storey: Optional[str], level: str) -> None:
        reading = document.read(doc, storey, level)
        every = reading.elements()
        study = Study(
            "freecad",
            doc.Name,
            walls=[e for e in every if isinstance(e, Wall)],
            columns=[e for e in every if isinstance(e, Column)],
            drawn=[e for e in every if isinstance(e, Drawn)],
            regions=reading.regions,
        )
        self._site, self._ids = possible.Site(study), {}
        for id, found in reading.found.items():
            self._ids.setdefault(found.object.Name, []).append(id)
        for id, door in reading.openings.items():
            self._ids.setdefault(door.Name, []).append(id)


def said(offers: List[Tuple[object, Possible]]) -> str:
    """Names for each selected object what may be done with it, and why not more; alike ones together."""
    alike: Dict[Tuple[str, ...], List[str]] = {}
    why: Dict[str, List[str]] = {}
    for obj, offer in offers:
        own = OPENING_WORDS if document.kind_of(obj) == "Window" else {}
        can = [own.get(k) or words for k, words in WORDS.items() if k in offer.moves or k in offer.works]
        alike.setdefault(tuple(dict.fromkeys(can)), []).append(obj.Label)
        for code in offer.why:
            words = _locked(obj) if code == possible.LOCKED else say(WHY_WORDS[code], "{}")
            why.setdefault(words, []).append(obj.Label)
    lines = [say("{} can: {}.", shortened(names), ", ".join(say(w) for w in can)) for can, names in alike.items() if can]
    if len(lines) > SAID_MAX:
        lines = [*lines[:SAID_MAX], "…"]
    return "\n".join([*lines, *(words.format(shortened(names)) for words, names in list(why.items())[:SAID_MAX])])


def _locked(obj) -> str:
    reason = document.lock(obj).replace("{", "").replace("}", "")
    return say("{}: stays, since {}.", "{}", reason or say("its wall stays"))


def shortened(names) -> str:
    return ", ".join(names[:NAMES_MAX]) + (" …" if len(names) > NAMES_MAX else "")
