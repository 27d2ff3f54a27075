"""Building works that marks allow: their text, their usual sizes, and how a job tells them to the program."""

import re
from typing import Any, Dict, Iterable, List, Optional, Tuple, Union

from .dxf_r12 import Drawing
from .model import Allowed, Drawn, Opening, Study, Wall
from .outlines import Outline
from .plane import Point, direction, distance, left_of, plus
from .works import KINDS

#: Least and most that a freshly ticked work allows, mm: the program's own usual widths. Of an end only the most.
USUAL: Dict[str, Tuple[Optional[float], float]] = {
    "open": (900.0, 2400.0),
    "glaze": (1200.0, 2400.0),
    "widen": (1200.0, 2400.0),
    "end": (None, 1000.0),
}
#: Works on a door or an opening that stands there.
OF_OPENINGS = ("widen", "close", "rehang")

#: A box round a door reaches so far beyond its jambs and its wall's faces, mm.
BESIDE_MM = 100.0
#: A longer box on the same wall is so much wider, mm.
NESTED_MM = 4.0
#: Layer of the boxes, height of the text in them, mm.
LAYER, TEXT_MM = "EF-MOVE", 50.0

#: What works are marked on as a whole.
Base = Union[Wall, Drawn]

UNITS_MM = {"": 1.0, "mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, "ft": 304.8}


def usual(kind: str) -> Allowed:
    """A work with its usual sizes."""
    return Allowed(kind, *USUAL.get(kind, (None, None)))


def text_of(works: Iterable[Allowed]) -> str:
    return "; ".join(w.text() for w in works)


def is_work(clause: str) -> bool:
    """Whether a clause of a mark is one of works, and none of moves."""
    return clause.split(" ")[0].lower() in KINDS


def works_in(text: str) -> Tuple[List[Allowed], List[str]]:
    """The works of ``open 0.9m 2.4m; remove``, lengths without a unit in mm; and the clauses that are none."""
    out, unread = [], []
    for clause in (" ".join(c.split()) for c in re.split(r"[;\n]", text)):
        if clause:
            found = _work(clause.split(" "))
            unread.append(clause) if found is None else out.append(found)
    return out, unread


def _work(words: List[str]) -> Optional[Allowed]:
    kind = words[0].lower()
    try:
        sizes = [length_mm(w) for w in words[1:]]
    except ValueError:
        return None
    if kind not in KINDS or len(sizes) > 2:
        return None
    if not sizes:
        return Allowed(kind)
    low, high = sizes[0], sizes[-1]
    if kind == "end":
        return Allowed(kind, None, -low) if low < 0.0 <= max(high, 0.0) else None
    return Allowed(kind, low, high) if 0.0 < low <= high else None


def length_mm(text: str) -> float:
    """``500``, ``-1.5m``, ``2ft`` in millimetres."""
    match = re.fullmatch(r"([-+]?[0-9]*\.?[0-9]+)(mm|cm|m|in|ft)?", text.strip().replace("−", "-"))
    if match is None:
        raise ValueError(text)
    return float(match.group(1)) * UNITS_MM[match.group(2) or ""]


# -- for the program


def tables(study: Study, outlines: List[Outline], handles: Dict[str, str]) -> List[Dict[str, Any]]:
    """``[[move]]`` tables of the side-car that allow works and say nothing of moves: of walls by their corners, of a 2D
    plan by whole entities."""
    out: List[Dict[str, Any]] = []
    bases: List[Base] = [*study.walls, *study.drawn]
    for element in bases:
        if not element.works or _why_not(element):
            continue
        own = [o for o in outlines if o.owner == element.id]
        table: Dict[str, Any] = {"name": element.label, "moves": text_of(element.works)}
        if isinstance(element, Drawn):
            table["handles"] = list(dict.fromkeys(handles[o.host_id] for o in own))
        else:
            table["nodes"] = list(dict.fromkeys(p for o in own for p in o.points))
        out.append(table)
    return out


def _why_not(element: Base) -> str:
    return element.locked or ("it is marked 'must stay' too" if element.keep else "")


def notes_on(study: Study) -> List[str]:
    """Where works are marked and none can be made."""
    out = []
    bases: List[Base] = [*study.walls, *study.drawn]
    for element in bases:
        of_openings = [w for o in element.openings for w in o.works] if isinstance(element, Wall) else []
        if _why_not(element) and (element.works or of_openings):
            out.append(f"Building works are marked at '{element.label}', but none is made there: {_why_not(element)}.")
    return out


def draw_boxes(out: Drawing, study: Study) -> None:
    """Boxes round doors and openings with what is allowed to them. Only a box tells one door of a wall from another."""
    for wall in study.walls:
        for at, ring, words in [] if wall.rings or _why_not(wall) else _boxes(wall):
            out.polyline(LAYER, ring)
            out.text(LAYER, at, TEXT_MM, words)


def _boxes(wall: Wall) -> List[Tuple[Point, List[Point], str]]:
    """Boxes on a wall: where the text stands, corners, text. A text counts for the smallest box that it stands in. So a
    longer box is wider too, and has its text where shorter ones do not reach."""
    asked: Dict[Tuple[Point, Point, float, float], Tuple[float, List[str]]] = {}
    for opening in wall.openings:
        a, b, begun = piece_at(wall, opening)
        low, high = opening.start - begun, opening.end - begun
        for work in opening.works:
            reach = _reach(work, low, high, distance(a, b))
            _, words = asked.setdefault((a, b, *reach), ((low + high) / 2.0, []))
            words.append(work.text())
    out = []
    for i, ((a, b, low, high), (middle, words)) in enumerate(sorted(asked.items(), key=lambda i: i[0][3] - i[0][2])):
        u = direction(a, b)
        off, beyond = left_of(u), BESIDE_MM + i * NESTED_MM
        left, right = wall.left + beyond, -wall.right - beyond
        place = [plus(plus(a, u, t), off, v) for t, v in ((low, right), (high, right), (high, left), (low, left))]
        at = plus(plus(a, u, middle), off, left - NESTED_MM / 2.0)
        out.append((at, place, "; ".join(dict.fromkeys(words))))
    return out


def _reach(work: Allowed, low: float, high: float, length: float) -> Tuple[float, float]:
    """Where the jambs of a work on an opening may stand: as far as it may grow; all along its piece of wall; where they
    are."""
    if work.kind == "rehang" or work.kind == "widen" and work.most is None:
        low, high = min(low, 0.0), max(high, length)
    elif work.kind == "widen":
        by = max((work.most or 0.0) - (high - low), 0.0)
        low, high = low - by, high + by
    return low - BESIDE_MM, high + BESIDE_MM


def piece_at(wall: Wall, opening: Opening) -> Tuple[Point, Point, float]:
    """Ends of the straight piece of axis in which an opening lies, and where along the wall it begins."""
    middle, begun = (opening.start + opening.end) / 2.0, 0.0
    points = wall.corners()
    for a, b in zip(points, points[1:]):
        length = distance(a, b)
        if middle <= begun + length or b == points[-1]:
            return a, b, begun
        begun += length
    return points[0], points[-1], 0.0
