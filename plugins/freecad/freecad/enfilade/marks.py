"""Marks of the user's on objects: properties in the group "Enfilade", shown in the property editor."""

import uuid
from typing import Dict, List, Sequence, Tuple

from enfilade_common.allowed import text_of, works_in
from enfilade_common.model import Allowed, Clause

GROUP = "Enfilade"

#: Kind of move, stem of its two properties, property type, what it does.
MOVES = (
    ("x", "EnfiladeX", "App::PropertyDistance", "east-west"),
    ("y", "EnfiladeY", "App::PropertyDistance", "north-south"),
    ("along", "EnfiladeAlong", "App::PropertyDistance", "along the wall"),
    ("rotate", "EnfiladeTurn", "App::PropertyAngle", "turn, anticlockwise"),
)
REGIONS = ("query", "reference", "keep")


def _value(obj, name: str) -> float:
    value = getattr(obj, name, 0.0)
    return float(getattr(value, "Value", value))


def bounds(obj) -> Dict[str, Tuple[float, float]]:
    """Least and most of every move that an object was allowed, by kind, from where it stood then."""
    given = {kind: (_value(obj, stem + "Min"), _value(obj, stem + "Max")) for kind, stem, _, _ in MOVES}
    return {k: (min(low, 0.0), max(high, 0.0)) for k, (low, high) in given.items() if low or high}


def used(obj, kind: str) -> float:
    """How far accepted options have taken an object since it was allowed to move so."""
    return _value(obj, next(stem for k, stem, _, _ in MOVES if k == kind) + "Used")


def clauses(obj, heading_deg: float) -> List[Clause]:
    """What remains of the allowed moves of an object, in the order of :data:`MOVES`. ``heading_deg`` is the axis'
    direction; along it means along the axis as it lay when the move was allowed."""
    out = []
    for kind, (least, most) in bounds(obj).items():
        done = used(obj, kind)
        along = heading_deg - used(obj, "rotate") if kind == "along" else 0.0
        out.append(Clause(kind, min(least - done, 0.0), max(most - done, 0.0), along))
    return out


def take(obj, by: Dict[str, float]) -> None:
    """Takes an accepted way off what remains of the bounds. Inside a transaction."""
    for kind, stem, type, words in MOVES:
        if by.get(kind) and kind in bounds(obj):
            _add(obj, type, stem + "Used", f"Enfilade: how far it has gone of what was allowed, {words}")
            setattr(obj, stem + "Used", used(obj, kind) + by[kind])
            obj.setEditorMode(stem + "Used", 1)


def works(obj) -> List[Allowed]:
    """Building works that an object was allowed."""
    return works_in(_works_text(obj))[0]


def unread(obj) -> List[str]:
    """Says what somebody wrote there that is no work."""
    expected = "is no building work, expected for example 'open 900mm 2400mm; remove'."
    return [f"'{obj.Label}': {clause!r} {expected}" for clause in works_in(_works_text(obj))[1]]


def _works_text(obj) -> str:
    return str(getattr(obj, "EnfiladeWorks", "") or "")


def group(obj) -> str:
    return str(getattr(obj, "EnfiladeGroup", "") or "")


def keep(obj) -> bool:
    return bool(getattr(obj, "EnfiladeKeep", False))


def region_kind(obj) -> str:
    kind = str(getattr(obj, "EnfiladeRegion", "") or "")
    return kind if kind in REGIONS else ""


def region_pair(obj) -> str:
    """The name of the pair that a region belongs to, as the user wrote it."""
    return str(getattr(obj, "EnfiladePair", "") or "")


def is_marked(obj) -> bool:
    return bool(bounds(obj)) or keep(obj) or bool(group(obj)) or bool(_works_text(obj))


def ids(doc) -> Dict[str, str]:
    """An id for every object, by its name.

    A marked object keeps the id it was given. A copy brings the id of its original along; the one whose
    name stands in the id keeps it, the copy goes by its own name.
    """
    given = {o.Name: str(getattr(o, "EnfiladeId", "") or "") for o in doc.Objects}
    owners: Dict[str, str] = {}
    for name, id in given.items():
        if id and (id not in owners or id.startswith(name + "~")):
            owners[id] = name
    return {name: id if id and owners[id] == name else name for name, id in given.items()}


def _add(obj, type: str, name: str, words: str) -> None:
    if not hasattr(obj, name):
        obj.addProperty(type, name, GROUP, words)


def _give_id(obj, known: Dict[str, str]) -> str:
    """The object's own id; made where it has none or only that of its original."""
    _add(obj, "App::PropertyString", "EnfiladeId", "Identity in Enfilade's files")
    if known.get(obj.Name) == obj.Name or not obj.EnfiladeId:
        obj.setEditorMode("EnfiladeId", 0)
        obj.EnfiladeId = f"{obj.Name}~{uuid.uuid4().hex[:12]}"
    obj.setEditorMode("EnfiladeId", 1)
    return obj.EnfiladeId


def mark_all(objects, bounds: Dict[str, tuple], group_name: str = "", is_kept: bool = False) -> None:
    """Marks objects of one document; see :func:`mark`."""
    known = ids(objects[0].Document) if objects else {}
    for obj in objects:
        mark(obj, bounds, group_name, is_kept, known)


def mark(
    obj, bounds: Dict[str, tuple], group_name: str = "", is_kept: bool = False, known=None, works: Sequence[Allowed] = ()
) -> None:
    """Writes marks; ``bounds`` gives ``(lower, upper)`` by kind, mm or degrees. Inside a transaction.

    ``known`` is what :func:`ids` says of the document, where many objects are marked at once.
    """
    _give_id(obj, ids(obj.Document) if known is None else known)
    for kind, stem, type, words in MOVES:
        lower, upper = bounds.get(kind, (0.0, 0.0))
        for end, value in (("Min", lower), ("Max", upper)):
            _add(obj, type, stem + end, f"Enfilade: least and most {words}; 0 and 0 keep it from moving so")
            setattr(obj, stem + end, float(value))
        if hasattr(obj, stem + "Used"):
            setattr(obj, stem + "Used", 0.0)
    _add(obj, "App::PropertyString", "EnfiladeGroup", "Enfilade: objects with one group name move together")
    obj.EnfiladeGroup = group_name
    _add(obj, "App::PropertyBool", "EnfiladeKeep", "Enfilade: stays as it stands, whatever else may move")
    obj.EnfiladeKeep = is_kept
    if works or hasattr(obj, "EnfiladeWorks"):
        _add(obj, "App::PropertyString", "EnfiladeWorks", "Enfilade: building works that are allowed, as 'open 900mm 2400mm; remove'")
        obj.EnfiladeWorks = text_of(works)


def copy(of, to) -> None:
    """Marks an object like another one, of which it is a part now. Inside a transaction."""
    names = [n for n in of.PropertiesList if n.startswith("Enfilade") and n != "EnfiladeId"]
    if not names:
        return
    _give_id(to, ids(to.Document))
    for name in names:
        _add(to, of.getTypeIdOfProperty(name), name, of.getDocumentationOfProperty(name))
        setattr(to, name, getattr(of, name))
        to.setEditorMode(name, 1 if name.endswith("Used") else 0)


def unmark(obj) -> None:
    """Takes moves, works, group and keep away, and what a region is for; the id stays. Inside a transaction."""
    for name in list(obj.PropertiesList):
        if name.startswith("Enfilade") and name != "EnfiladeId":
            obj.removeProperty(name)


def mark_region(obj, kind: str, pair: str = "") -> None:
    """Makes a closed object a region, of a named pair if there is a name. Inside a transaction."""
    if not hasattr(obj, "EnfiladeRegion"):
        obj.addProperty("App::PropertyEnumeration", "EnfiladeRegion", GROUP, "Enfilade: what this region is for")
        obj.EnfiladeRegion = ["none", *REGIONS]
    obj.EnfiladeRegion = kind
    words = "Enfilade: regions of one name are a pair of their own, which objectives may be measured over"
    _add(obj, "App::PropertyString", "EnfiladePair", words)
    obj.EnfiladePair = pair
