"""A study as a host program describes it: walls, columns, openings, regions, moves, wishes."""

import hashlib
import json
import re
from dataclasses import asdict, dataclass, field
from typing import Any, Dict, Iterator, List, Optional, Union

from .plane import Point, direction, distance

#: Kinds of moves a mark may allow.
KINDS = ("x", "y", "along", "rotate")

#: Longest name of a pair of regions, bytes of UTF-8; the program's own limit.
PAIR_NAME_BYTES = 40

#: Units of a drawing, in metres.
UNITS = {"mm": 0.001, "cm": 0.01, "m": 1.0, "in": 0.0254, "ft": 0.3048}

#: What an objective can measure, in the order of the panel.
MEASURES = ("degree", "mean-depth", "depth", "entropy", "score")


@dataclass
class Clause:
    """One allowed move: bounds in mm, or in degrees where ``kind`` is ``rotate``."""

    kind: str
    lower: float
    upper: float
    #: Direction of an ``along`` move, degrees anticlockwise from east.
    direction_deg: float = 0.0

    def text(self) -> str:
        """As a marker's text says it: ``x -1000 1000``, ``along 30 -500 500``."""
        head = f"along {number(self.direction_deg)}" if self.kind == "along" else self.kind
        return f"{head} {number(self.lower)} {number(self.upper)}"


@dataclass
class Allowed:
    """A kind of building work that a mark allows, with its least and its most: clear width in mm; of an ``end`` only the
    most, how far it goes back. Without them any size."""

    kind: str
    least: Optional[float] = None
    most: Optional[float] = None

    def text(self) -> str:
        """As a marker's text says it: ``open 900mm 2400mm``, ``end -1000mm 0``, ``remove``."""
        if self.most is None:
            return self.kind
        if self.kind == "end":
            return f"end -{number(self.most)}mm 0"
        return f"{self.kind} {number(self.most if self.least is None else self.least)}mm {number(self.most)}mm"


@dataclass
class Opening:
    """A door, a window or a passage in a wall, by where it begins and ends along the wall's axis, mm."""

    id: str
    label: str
    start: float
    end: float
    #: ``door``, ``window``, or ``passage``: an opening without a leaf.
    kind: str = "door"
    name: str = ""
    #: Slides along its wall within these clauses (kind ``along``).
    clauses: List[Clause] = field(default_factory=list)
    #: Building works that are allowed to it.
    works: List[Allowed] = field(default_factory=list)


@dataclass
class Wall:
    """A wall: an axis with its two faces, or finished outlines where it has no such axis."""

    id: str
    label: str
    axis: List[Point]
    #: Distance of the left and right face from the axis, seen along it, mm.
    left: float
    right: float
    closed: bool = False
    name: str = ""
    openings: List[Opening] = field(default_factory=list)
    #: Closed outlines as drawn, for walls that only move as a whole (arcs, free solids).
    rings: List[List[Point]] = field(default_factory=list)
    clauses: List[Clause] = field(default_factory=list)
    group: str = ""
    keep: bool = False
    #: Why the host cannot move it; empty where it can.
    locked: str = ""
    #: How high it is, mm; zero where the host does not say.
    height: float = 0.0
    #: Building works that are allowed in it.
    works: List[Allowed] = field(default_factory=list)

    @property
    def thickness(self) -> float:
        return self.left + self.right

    def corners(self) -> List[Point]:
        """Axis points with the first repeated at the end of a closed axis."""
        return self.axis + self.axis[:1] if self.closed else list(self.axis)

    def length(self) -> float:
        points = self.corners()
        return sum(distance(a, b) for a, b in zip(points, points[1:]))

    def at(self, along: float) -> Point:
        """The axis point ``along`` mm from its start."""
        points = self.corners()
        for a, b in zip(points, points[1:]):
            length = distance(a, b)
            if along <= length or (a, b) == (points[-2], points[-1]):
                u = direction(a, b)
                return (a[0] + u[0] * along, a[1] + u[1] * along)
            along -= length
        return points[-1]


@dataclass
class Column:
    """A column or another solid that moves as a whole, by its outline."""

    id: str
    label: str
    ring: List[Point]
    name: str = ""
    clauses: List[Clause] = field(default_factory=list)
    group: str = ""
    keep: bool = False
    locked: str = ""


@dataclass
class Stroke:
    """One thing drawn in a 2D plan: ``lines`` through points, an ``arc`` or a ``circle``. The points are what the
    program tells of it too: corners; an arc's ends, anticlockwise; a circle's centre."""

    kind: str
    points: List[Point]
    closed: bool = False
    centre: Point = (0.0, 0.0)
    radius: float = 0.0


@dataclass
class Drawn:
    """An object of a 2D plan, by its strokes. Which of them are walls is for the program to read."""

    id: str
    label: str
    strokes: List[Stroke]
    layer: str = "0"
    name: str = ""
    clauses: List[Clause] = field(default_factory=list)
    group: str = ""
    keep: bool = False
    locked: str = ""
    #: Whether it moves as a whole or not at all, so that no end of it can follow another.
    is_stiff: bool = False
    #: Building works that are allowed in the wall that it draws.
    works: List[Allowed] = field(default_factory=list)

    def points(self) -> List[Point]:
        return [p for s in self.strokes for p in s.points]


@dataclass
class Region:
    """A closed polygon: ``query`` (where people stand), ``reference`` (what they see) or ``keep``."""

    kind: str
    points: List[Point]
    id: str = ""
    #: Name of the pair of regions it belongs to, see :func:`pair_name`; empty for the unnamed one.
    pair: str = ""

    def layer(self) -> str:
        """``EF-QUERY``, ``EF-REFERENCE-entrance``."""
        pair = f"-{self.pair}" if self.pair and self.kind != "keep" else ""
        return f"EF-{self.kind.upper()}{pair}"


def pair_name(text: str) -> str:
    """The name of a pair as the program has it: case does not count, a space is ``-``; empty if there is none."""
    name = re.sub(r"\s", "-", text.strip().lower())
    is_plain = all(c.isalnum() or c in "-_." for c in name)
    if not is_plain or len(name.encode("utf-8")) > PAIR_NAME_BYTES:
        raise PluginError(
            f"'{text}' cannot name a pair: letters, digits, - _ and . are possible, {PAIR_NAME_BYTES} bytes at most."
        )
    return name


@dataclass
class Objective:
    """One wish: a measure, whether more is better, and how much of the gain every option keeps."""

    measure: str
    sense: str
    threshold: float = 0.7
    is_on: bool = True
    #: The pair of regions it is measured over; empty for the unnamed one.
    pair: str = ""

    def name(self) -> str:
        """As the program names it: ``degree``, ``degree@entrance``."""
        return f"{self.measure}@{self.pair}" if self.pair else self.measure


def default_objectives() -> List[Objective]:
    """Those whose gains the program can promise, and evenness for who ticks it."""
    return [Objective("degree", "max"), Objective("mean-depth", "min"), Objective("entropy", "max", is_on=False)]


@dataclass
class Wishes:
    """How to search: objectives in order of weight, number of options, budget."""

    objectives: List[Objective] = field(default_factory=default_objectives)
    members: int = 5
    seed: int = 1
    #: Layouts that may be measured; ``None``: by the size of the study.
    evaluations: Optional[int] = None
    #: Cell size in metres; ``None``: chosen by the program.
    spacing_m: Optional[float] = None
    #: ``eye``: windows are seen through; ``knee``: they block.
    level: str = "eye"
    #: Unit in which a 2D plan is drawn; empty: the program finds out.
    unit: str = ""
    clearance: float = 1.0
    wall_length: float = 1.0
    #: What is asked of rooms, item by item, as a brief of the program has it.
    brief: List[str] = field(default_factory=list)

    def objective_text(self) -> str:
        """As the program's ``--objective`` has it."""
        return ", ".join(f"{o.name()} {o.sense} {number(o.threshold)}" for o in self.chosen())

    def chosen(self) -> List[Objective]:
        return [o for o in self.objectives if o.is_on]

    def penalty_text(self) -> str:
        return f"clearance {number(self.clearance)}, wall-length {number(self.wall_length)}"


#: What has faces and a place on the floor.
Built = Union[Wall, Column]
Movable = Union[Wall, Column, Drawn]
#: What building works may be made on.
Rebuilt = Union[Wall, Opening, Drawn]


@dataclass
class Study:
    """One storey of one document, ready to be written as a job."""

    host: str
    document: str
    walls: List[Wall] = field(default_factory=list)
    columns: List[Column] = field(default_factory=list)
    regions: List[Region] = field(default_factory=list)
    wishes: Wishes = field(default_factory=Wishes)
    storey: str = ""
    #: ``[[lineage]]`` tables of earlier rounds, oldest first.
    lineage: List[Dict[str, Any]] = field(default_factory=list)
    #: Of a 2D plan, in place of walls and columns.
    drawn: List[Drawn] = field(default_factory=list)

    def built(self) -> Iterator[Built]:
        yield from self.walls
        yield from self.columns

    def movables(self) -> Iterator[Movable]:
        yield from self.built()
        yield from self.drawn

    def rebuilt(self) -> List[Rebuilt]:
        """All that building works are marked on; the program then offers no others."""
        every: List[Rebuilt] = [*self.walls, *(o for w in self.walls for o in w.openings), *self.drawn]
        return [e for e in every if e.works]

    def pairs(self) -> List[str]:
        """Names of the pairs of regions, each once, in the order in which they are drawn."""
        return list(dict.fromkeys(r.pair for r in self.regions if r.pair and r.kind != "keep"))

    def element(self, id: str) -> Optional[Movable]:
        return next((e for e in self.movables() if e.id == id), None)

    def to_dict(self) -> Dict[str, Any]:
        return asdict(self)

    @classmethod
    def from_dict(cls, data: Dict[str, Any]) -> "Study":
        walls = [_wall(w) for w in data["walls"]]
        columns = [Column(**dict(c, ring=_points(c["ring"]), clauses=_clauses(c))) for c in data["columns"]]
        regions = [Region(**dict(r, points=_points(r["points"]))) for r in data["regions"]]
        wishes = dict(data["wishes"])
        wishes["objectives"] = [Objective(**o) for o in wishes["objectives"]]
        drawn = [_drawn(d) for d in data.get("drawn", [])]
        rest = dict(data, walls=walls, columns=columns, drawn=drawn, regions=regions, wishes=Wishes(**wishes))
        return cls(**rest)


def _points(rows: Any) -> List[Point]:
    return [(float(x), float(y)) for x, y in rows]


def _clauses(data: Dict[str, Any]) -> List[Clause]:
    return [Clause(**c) for c in data["clauses"]]


def _works(data: Dict[str, Any]) -> List[Allowed]:
    return [Allowed(**w) for w in data.get("works", [])]


def _wall(data: Dict[str, Any]) -> Wall:
    openings = [Opening(**dict(o, clauses=_clauses(o), works=_works(o))) for o in data["openings"]]
    rings = [_points(r) for r in data["rings"]]
    rest = dict(data, axis=_points(data["axis"]), rings=rings, openings=openings, clauses=_clauses(data))
    return Wall(**dict(rest, works=_works(data)))


def _drawn(data: Dict[str, Any]) -> Drawn:
    strokes = [Stroke(**dict(s, points=_points(s["points"]), centre=_points([s["centre"]])[0])) for s in data["strokes"]]
    return Drawn(**dict(data, strokes=strokes, clauses=_clauses(data), works=_works(data)))


def number(value: float) -> str:
    """Shortest text that reads back to a micrometre: ``250``, ``-0.5``, ``1234.567``."""
    text = f"{value:.3f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def geometry_hash(element: Movable) -> str:
    """Fingerprint of all that decides where an element stands in plan, to 0.01 mm.

    It changes when axis, faces, openings or outline change, and with nothing else.
    """

    def rounded(points: List[Point]) -> List[List[float]]:
        return [[round(x, 2) + 0.0, round(y, 2) + 0.0] for x, y in points]

    def finely(points: List[Point]) -> List[List[float]]:
        return [[round(x, 5) + 0.0, round(y, 5) + 0.0] for x, y in points]

    if isinstance(element, Column):
        data: Any = ["column", rounded(element.ring)]
    elif isinstance(element, Drawn):
        data = [[s.kind, s.closed, finely(s.points), finely([s.centre]), round(s.radius, 5)] for s in element.strokes]
    else:
        openings = sorted([o.id, round(o.start, 2) + 0.0, round(o.end, 2) + 0.0] for o in element.openings)
        rings = [rounded(r) for r in element.rings]
        faces = [round(element.left, 2), round(element.right, 2)]
        data = ["wall", rounded(element.axis), element.closed, faces, openings, rings]
    return hashlib.sha256(json.dumps(data).encode()).hexdigest()[:16]


class PluginError(Exception):
    """Something the user can do something about; its text is shown as it is."""
