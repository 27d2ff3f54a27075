"""The file behind the shapes as the drawing of a job: its own entities, layers, blocks and unit, with what was changed
or marked in the host."""

from dataclasses import dataclass, field
from typing import Callable, Dict, Iterable, List, Optional, Sequence, Set, Tuple

from . import APPLICATION, drawn as strokes
from .behind import Match, Piece
from .dxf_file import Entity, Group, Line
from .dxf_r12 import LAYERS, Drawing, escaped, xdata
from .model import Drawn, Stroke, Study
from .plane import Point, distance

#: From which version a DXF names the classes of its entities.
CLASSES_FROM = b"AC1012"
CLASSES = {
    "LINE": ["AcDbLine"],
    "CIRCLE": ["AcDbCircle"],
    "ARC": ["AcDbCircle"],
    "TEXT": ["AcDbText"],
    "LWPOLYLINE": ["AcDbPolyline"],
}
#: Groups that say how an entity looks: line type, colour, line type scale, weight.
LOOK = (6, 62, 48, 370, 420)
#: Digits behind the point.
DIGITS = 8

#: A point of a stroke and the corner of the written entity that it is; -1 where it goes with the whole.
Part = Tuple[str, int, int]


class Addition(Drawing):
    """Entities that are added to a file: in its version, in its unit, on its layers."""

    def __init__(self, version: bytes, first_handle: int, scale: float) -> None:
        super().__init__(DIGITS, is_mm=False, scale=scale)
        self._handle = first_handle
        self._has_classes = version >= CLASSES_FROM
        #: How the next entities look.
        self.look: List[Group] = []
        self.layers: Dict[str, None] = {}

    def _begin(self, kind: str, layer: str) -> List[str]:
        self._handle += 1
        self.layers[layer] = None
        handle = ["5", f"{self._handle:X}"]
        look = [v for code, value in self.look for v in (str(code), value.decode("latin-1").strip())]
        # A layer of the file is written as it stands there.
        name = layer if all(" " <= c <= "\xff" for c in layer) else escaped(layer)
        if not self._has_classes:
            return ["0", kind, *handle, "8", name, *look]
        classes = [v for c in CLASSES.get(kind, []) for v in ("100", c)]
        return ["0", kind, *handle, "100", "AcDbEntity", "8", name, *look, *classes]

    def _angles_begin(self) -> List[str]:
        return ["100", "AcDbArc"] if self._has_classes else []

    def polyline(self, layer: str, points: Sequence[Point], closed: bool = True, ids: Iterable[str] = ()) -> str:
        if not self._has_classes:
            return super().polyline(layer, points, closed, ids)
        out = self._begin("LWPOLYLINE", layer) + ["90", str(len(points)), "70", "1" if closed else "0"]
        for p in points:
            out += self._point(p, 0)[:4]
        return self._add(out + xdata(ids), points)

    def text(self, layer: str, at: Point, height: float, words: str) -> None:
        super().text(layer, at, height, words)
        if self._has_classes:
            self._entities += ["100", "AcDbText"]

    def groups(self) -> List[Group]:
        pairs = zip(self._entities[0::2], self._entities[1::2])
        return [(int(code), value.encode("latin-1")) for code, value in pairs]


@dataclass
class Patched:
    """The drawing, the handle of every stroke, and what the entities that keep several strokes are made of."""

    content: bytes = b""
    handles: Dict[str, str] = field(default_factory=dict)
    parts: Dict[str, List[Part]] = field(default_factory=dict)


class _Work:
    """One drawing in the making."""

    def __init__(self, match: Match, study: Study) -> None:
        self.match, self.study, self.out = match, study, Patched()
        self.owners: Dict[str, Drawn] = {f"{d.id}/{i}": d for d in study.drawn for i in range(len(d.strokes))}
        self.strokes: Dict[str, Stroke] = {f"{d.id}/{i}": s for d in study.drawn for i, s in enumerate(d.strokes)}
        file = match.file
        self.added = Addition(file.variable(b"$ACADVER"), _last_handle(file.groups), match.scale)
        #: What stands in the place of an entity; nothing where it goes.
        self.instead: Dict[int, List[Group]] = {}
        #: Strokes that an entity draws which stays.
        self.kept: Set[str] = set()
        #: Layer and look of a stroke whose entity goes.
        self.looks: Dict[str, Tuple[bytes, Entity]] = {}
        #: Lines of entities that go and are nowhere any more.
        self.lost: List[Tuple[Line, Entity]] = []

    def keep_entities(self) -> None:
        users: Dict[str, int] = {}
        for i in range(len(self.match.file.entities)):
            for s in self.match.strokes_of(i):
                users[s] = users.get(s, 0) + 1
        for i, entity in enumerate(self.match.file.entities):
            mine = self.match.strokes_of(i)
            marked = [s for s in mine if _is_marked(self.owners[s])]
            if self.match.is_there(i) and (not marked or self._is_one(entity, mine, users)):
                self._keep(i, entity, mine, bool(marked))
            else:
                self._drop(i, entity)

    def _is_one(self, entity: Entity, mine: List[str], users: Dict[str, int]) -> bool:
        """Whether an entity is marked as a whole, so that it may stay one."""
        if entity.kind == "INSERT" or any(users[s] > 1 or len(self.strokes[s].points) > 2 for s in mine):
            return False
        first = self.owners[mine[0]]
        said = (first.clauses, first.group, first.works)
        return all((d.clauses, d.group, d.works) == said for d in (self.owners[s] for s in mine))

    def _keep(self, index: int, entity: Entity, mine: List[str], is_marked: bool) -> None:
        self.kept.update(mine)
        if not mine:
            return
        key = _free(mine[0], self.out.parts)
        rows = zip(self.match.lines[index], self.match.pieces[index])
        self.out.parts[key] = [p for line, found in rows for p in _parts(line, found, self.strokes)]
        groups = self.match.file.groups[entity.start : entity.end]
        handle = entity.handle
        if not handle:
            handle = self.added.next_handle()
            groups = [groups[0], (5, handle.encode("ascii")), *groups[1:]]
        if entity.kind == "INSERT" and not entity.first(50):
            # So that the program has a value to change where the block turns with its wall.
            groups = _before_more(groups, [(50, b"0.0")])
        self.instead[index] = _signed(groups, (key, self.owners[mine[0]].label))
        for s in mine:
            self.out.handles.setdefault(s, handle)

    def _drop(self, index: int, entity: Entity) -> None:
        self.instead[index] = []
        for line, found in zip(self.match.lines[index], self.match.pieces[index]):
            for piece in found:
                self.looks.setdefault(piece.host_id, (line.layer, entity))
            if not found:
                self.lost.append((line, entity))

    def draw_rest(self) -> None:
        """What no entity draws any more: strokes that are marked one by one, edited or new."""
        own: Dict[str, Tuple[bytes, Optional[Entity]]] = {}
        for s, look in self.looks.items():
            own.setdefault(self.owners[s].id, look)
        whole: Dict[str, str] = {}
        for s, handle in self.out.handles.items():
            whole.setdefault(self.owners[s].id, handle)
        for s, stroke in self.strokes.items():
            if s in self.kept:
                continue
            owner = self.owners[s]
            # A part that is alike without being the same goes with its entity, where that stays.
            if s in self.match.known and s not in self.looks and owner.id in whole:
                self.out.handles.setdefault(s, whole[owner.id])
                continue
            seen: Optional[Tuple[bytes, Optional[Entity]]] = self.looks.get(s) or own.get(owner.id)
            layer, entity = seen or self._kin(owner, stroke)
            self.added.look = [g for g in entity.groups if g[0] in LOOK] if entity else []
            self.out.handles[s] = strokes.draw_stroke(self.added, layer.decode("latin-1"), stroke, (s, owner.label))
        self.added.look = []

    def _kin(self, owner: Drawn, stroke: Stroke) -> Tuple[bytes, Optional[Entity]]:
        """The layer and look of the entity that an edited stroke most likely was; its own layer where there is none."""
        alike = [(line, e) for line, e in self.lost if (line.kind == "line") == (stroke.kind == "lines")]
        ends = [(x / self.match.scale, y / self.match.scale) for x, y in (stroke.points[0], stroke.points[-1])]
        if not alike:
            return escaped(owner.layer).encode("latin-1"), None

        def away(kin: Tuple[Line, Entity]) -> float:
            (p, q), (a, b) = kin[0].ends, ends
            return min(distance(p, a) + distance(q, b), distance(p, b) + distance(q, a))

        line, entity = min(alike, key=away)
        return line.layer, entity

    def content(self) -> bytes:
        file = self.match.file
        added = self.added.groups()
        out: List[Group] = []
        at, last = 0, file.sections.get(b"ENTITIES", (0, len(file.groups)))[1]
        for i, entity in enumerate(file.entities):
            if i in self.instead:
                out += file.groups[at : entity.start] + self.instead[i]
                at = entity.end
        out += file.groups[at:last] + added + file.groups[last:]
        out = _with_tables(out, file.variable(b"$ACADVER"), self.added)
        return b"".join(b"%3d\r\n%s\r\n" % group for group in out)


def patched(match: Match, study: Study, mark: Callable[[Drawing], None]) -> Patched:
    """The file with what was changed and marked; ``mark`` draws our own layers."""
    work = _Work(match, study)
    work.keep_entities()
    work.draw_rest()
    strokes.draw_kept(work.added, study)
    mark(work.added)
    work.out.content = work.content()
    return work.out


def _is_marked(owner: Drawn) -> bool:
    return bool(owner.clauses or owner.group or owner.works)


def _free(host_id: str, taken: Dict[str, List[Part]]) -> str:
    key, k = host_id, 0
    while key in taken:
        k += 1
        key = f"{host_id}.{k}"
    return key


def _parts(line: Line, found: List[Piece], drawn: Dict[str, Stroke]) -> List[Part]:
    out: List[Part] = []
    for piece in found:
        points, corners = piece.points, line.corners
        if len(points) == len(corners) == 2:
            a, b = piece.line.ends
            is_turned = drawn[piece.host_id].kind == "lines" and _is_turned(line, a, b)
            corners = corners[::-1] if is_turned else corners
            out += [(piece.host_id, p, c) for p, c in zip(points, corners)]
        elif len(points) == len(corners) == 1:
            out.append((piece.host_id, points[0], corners[0]))
        else:
            out.append((piece.host_id, -1, -1))
    return out


def _is_turned(line: Line, a: Point, b: Point) -> bool:
    """Whether a line runs from ``b`` to ``a``."""
    (p, q) = line.ends
    return (q[0] - p[0]) * (b[0] - a[0]) + (q[1] - p[1]) * (b[1] - a[1]) < 0


def _before_more(groups: List[Group], more: List[Group]) -> List[Group]:
    """An entity with more groups, before its XDATA and what belongs to it."""
    head = next((i for i, g in enumerate(groups) if i and (g[0] == 0 or g[0] >= 1000)), len(groups))
    return groups[:head] + more + groups[head:]


def _signed(groups: List[Group], ids: Sequence[str]) -> List[Group]:
    """An entity with our ids, in place of those that it has."""
    head = next((i for i, g in enumerate(groups) if i and g[0] == 0), len(groups))
    own, skips = [], False
    for code, value in groups[:head]:
        skips = value.strip() == APPLICATION.encode("ascii") if code == 1001 else skips and code >= 1000
        if not skips:
            own.append((code, value))
    said = xdata(ids)
    return own + [(int(c), v.encode("ascii")) for c, v in zip(said[0::2], said[1::2])] + groups[head:]


def _last_handle(groups: List[Group]) -> int:
    last = 0x20
    for code, value in groups:
        if code in (5, 105):
            try:
                last = max(last, int(value, 16))
            except ValueError:
                continue
    return last


def _with_tables(groups: List[Group], version: bytes, added: Addition) -> List[Group]:
    """Layers and the application of ours in the tables, the next free handle in the header."""
    has_classes = version >= CLASSES_FROM
    out: List[Group] = []
    table = b""
    known: Set[bytes] = set()
    for i, (code, value) in enumerate(groups):
        if code == 0 and value.strip() == b"TABLE" and i + 1 < len(groups):
            table, known = groups[i + 1][1].strip(), set()
        elif code == 2 and table and groups[i - 1][1].strip() != b"TABLE":
            known.add(value.strip().upper())
        elif code == 0 and value.strip() == b"ENDTAB":
            if table == b"LAYER":
                for layer in added.layers:
                    if layer.encode("latin-1", "replace").upper() not in known:
                        out += _layer(layer, added, has_classes)
            elif table == b"APPID" and APPLICATION.encode("ascii").upper() not in known:
                out += _record("APPID", "AcDbRegAppTableRecord", APPLICATION, added, has_classes) + [(70, b"0")]
            table = b""
        out.append((code, value))
    seed = next((i for i, g in enumerate(out) if g == (9, b"$HANDSEED")), None)
    if seed is not None:
        out[seed + 1] = (5, added.next_handle().encode("ascii"))
    return out


def _record(kind: str, name_of_class: str, name: str, added: Addition, has_classes: bool) -> List[Group]:
    head = [(0, kind.encode("ascii")), (5, added.next_handle().encode("ascii"))]
    if has_classes:
        head += [(100, b"AcDbSymbolTableRecord"), (100, name_of_class.encode("ascii"))]
    return head + [(2, name.encode("latin-1", "replace"))]


def _layer(layer: str, added: Addition, has_classes: bool) -> List[Group]:
    colour = next((c for name, c in LAYERS if layer == name or layer.startswith(name + "-")), 7)
    record = _record("LAYER", "AcDbLayerTableRecord", layer, added, has_classes)
    return record + [(70, b"0"), (62, str(colour).encode("ascii")), (6, b"CONTINUOUS")]
