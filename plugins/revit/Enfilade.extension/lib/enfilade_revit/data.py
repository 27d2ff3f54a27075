"""What passes between Revit and us: plain values, millimetres in the project's plan (x east, y north)."""

from dataclasses import dataclass, field
from typing import Dict, List, Optional, Tuple

Point = Tuple[float, float]

#: Names of line styles whose closed detail lines are marks.
LINE_STYLES = {"EF-QUERY": "query", "EF-REFERENCE": "reference", "EF-KEEP": "keep"}

#: Instance parameters that carry marks: text, as in a marker's text, and a group's name.
MOVES_PARAMETER = "Enfilade Moves"
GROUP_PARAMETER = "Enfilade Group"
KEEP_PARAMETER = "Enfilade Keep"


@dataclass
class RevitWall:
    """A wall of the view. ``axis`` is its location line; none where that is no straight line."""

    element_id: int
    label: str
    axis: Optional[List[Point]]
    #: Distance of the left and right finish face from the location line, seen along it.
    left: float
    right: float
    rings: List[List[Point]] = field(default_factory=list)
    parameters: Dict[str, str] = field(default_factory=dict)
    is_pinned: bool = False


@dataclass
class RevitInsert:
    """A door or window in a wall: centre of its opening and clear width."""

    element_id: int
    label: str
    host_id: int
    centre: Point
    width: float
    is_window: bool
    parameters: Dict[str, str] = field(default_factory=dict)


@dataclass
class RevitColumn:
    element_id: int
    label: str
    ring: List[Point]
    parameters: Dict[str, str] = field(default_factory=dict)
    is_pinned: bool = False


@dataclass
class DetailLine:
    """One detail line on a named line style."""

    style: str
    a: Point
    b: Point
