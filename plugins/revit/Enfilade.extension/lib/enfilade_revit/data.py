"""What passes between Revit and us: plain values, millimetres in the project's plan (x east, y north)."""

from dataclasses import dataclass, field
from typing import Dict, List, Optional, Tuple, Union

Point = Tuple[float, float]

#: Names of line styles whose closed detail lines are marks.
LINE_STYLES = {"EF-QUERY": "query", "EF-REFERENCE": "reference", "EF-KEEP": "keep"}

#: Instance parameters that carry marks: text, as in a marker's text, and a group's name.
MOVES_PARAMETER = "Enfilade Moves"
GROUP_PARAMETER = "Enfilade Group"
KEEP_PARAMETER = "Enfilade Keep"


@dataclass
class RevitInsert:
    """What FindInserts finds in a wall: a door, a window, an opening, a wall of glass in the wall."""

    element_id: int
    label: str
    host_id: int
    #: Its insertion point or its middle; none where Revit gives none.
    centre: Optional[Point]
    width: float
    is_window: bool
    parameters: Dict[str, str] = field(default_factory=dict)
    #: Why the wall is taken as closed there; empty for an opening.
    closed: str = ""
    fixed: str = ""


@dataclass
class RevitWall:
    """A wall of the view. ``axis`` is its location line; none where that is no straight line."""

    element_id: int
    label: str
    axis: Optional[List[Point]] = None
    #: Distance of the left and right finish face from the location line, seen along it.
    left: float = 0.0
    right: float = 0.0
    rings: List[List[Point]] = field(default_factory=list)
    parameters: Dict[str, str] = field(default_factory=dict)
    inserts: List[RevitInsert] = field(default_factory=list)
    #: Ends of the location line, straight or not.
    ends: List[Point] = field(default_factory=list)
    #: Why it cannot be moved; empty where it can.
    fixed: str = ""
    #: Why it is no part of the plan; empty where it is.
    left_out: str = ""


@dataclass
class RevitColumn:
    element_id: int
    label: str
    ring: List[Point]
    parameters: Dict[str, str] = field(default_factory=dict)
    fixed: str = ""
    left_out: str = ""


RevitElement = Union[RevitWall, RevitColumn]


@dataclass
class DetailLine:
    """One detail line on a named line style."""

    style: str
    a: Point
    b: Point
