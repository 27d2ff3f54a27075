"""The job folder: what a plugin writes for the program, and reads again when results come back.

``plan.dxf`` is the drawing, ``plan.enfilade.toml`` the side-car with settings, moves and the host's table,
``plan.study.json`` the study and every outline as written, so that results can be matched to the document
after a restart of the host.
"""

import hashlib
import json
import os
from dataclasses import asdict, dataclass, field
from typing import Any, Dict, List, Optional, Tuple

from . import APPLICATION, __version__
from . import allowed, drawn
from .behind import Match
from .dxf_r12 import Drawing
from .model import Column, PluginError, Region, Study, Wall, default_objectives, geometry_hash
from .moves import MoveTable, Plan, plan_of
from .outlines import Outline, Station
from .patched import Part, Patched, patched
from .plane import centroid, widened
from .toml_text import dumps

STUDY_SCHEMA = "enfilade.study/1"
HOST_SCHEMA = "enfilade.host/1"
DRAWING_NAME = "plan.dxf"
#: The program's folder beside the drawing.
RESULTS = "plan.enfilade"

#: Digits behind the point of a coordinate: of walls in mm, of a 2D plan in whatever unit it is.
WALL_DIGITS, STROKE_DIGITS = 3, 7

#: Words for people stand here, mm high.
NOTE_LAYER, TEXT_MM = "EF-NOTE", 200.0


@dataclass
class Job:
    """A written job: where it lies, what was written."""

    folder: str
    study: Study
    outlines: List[Outline]
    hashes: Dict[str, str]
    sha256: str
    notes: List[str]
    #: The moves as written; not kept when a job is read again.
    plan: Optional[Plan] = None
    #: Units of the host in one of the drawing.
    scale: float = 1.0
    #: Of entities of the file behind the shapes: which points of which strokes their corners are.
    parts: Dict[str, List[Part]] = field(default_factory=dict)

    @property
    def drawing(self) -> str:
        return os.path.join(self.folder, DRAWING_NAME)

    @property
    def results_folder(self) -> str:
        return os.path.join(self.folder, RESULTS)

    def labels(self) -> Dict[str, str]:
        """Labels of what stands in the drawing, by its handle there."""
        names = {e.id: e.label for e in self.study.movables()}
        names.update((o.id, o.label) for w in self.study.walls for o in w.openings)
        return {handle: names.get(id, "") for handle, id in self.owners().items()}

    def owners(self) -> Dict[str, str]:
        """Ids of the elements and openings that stand in the drawing, by handle; corners belong to their outline."""
        try:
            with open(self.drawing, encoding="ascii", errors="replace") as f:
                lines = [line.strip() for line in f]
        except OSError:
            return {}
        out: Dict[str, str] = {}
        handle, owner, is_corner = "", "", False
        for (code, value), (_, following) in zip(zip(lines[0::2], lines[1::2]), zip(lines[2::2], lines[3::2])):
            if code == "0":
                is_corner = value in ("VERTEX", "SEQEND")
                owner = owner if is_corner else ""
            elif code == "5":
                handle = value
                if is_corner and owner:
                    out[handle] = owner
            elif (code, value) == ("1001", APPLICATION):
                out[handle] = owner = following.rsplit("/", 1)[0]
        return out


def write(study: Study, folder: str, behind: Optional[Match] = None) -> Job:
    """Writes a study as a job, in the file behind its shapes where there is one. The drawing comes last, so that a
    watching daemon sees all of it."""
    check(study)
    plan = plan_of(study)
    made = patched(behind, study, lambda out: _draw_marks(out, study, plan)) if behind else _drawn_anew(study, plan)
    drawing, handles = made.content, made.handles
    job = Job(
        folder=folder,
        study=study,
        outlines=plan.outlines,
        hashes={e.id: geometry_hash(e) for e in study.movables()},
        sha256=hashlib.sha256(drawing).hexdigest(),
        notes=plan.notes,
        plan=plan,
        scale=behind.scale if behind else 1.0,
        parts=made.parts,
    )
    try:
        os.makedirs(folder, exist_ok=True)
        settings, kept = dumps(side_car(study, plan, job, handles)), json.dumps(_study_file(job))
        _replace_all(
            (os.path.join(folder, "plan.enfilade.toml"), settings.encode("utf-8")),
            (os.path.join(folder, "plan.study.json"), kept.encode("utf-8")),
            (job.drawing, drawing),
        )
    except OSError as e:
        raise PluginError(f"The job cannot be written to {folder}: {e.strerror or e}. Nothing was started.") from e
    return job


def check(study: Study) -> None:
    """Refuses a study that no program could measure."""
    if not (study.walls or study.drawn):
        raise PluginError("There is no wall to measure: draw walls first, or choose the storey that has them.")
    seen = set()
    for element in study.movables():
        if element.id in seen:
            raise PluginError(f"Two elements have the id {element.id}; export again.")
        seen.add(element.id)
    if not study.wishes.chosen():
        raise PluginError("No objective is chosen: say at least one thing that should get better.")
    drawn = study.pairs()
    lost = [o.pair for o in study.wishes.chosen() if o.pair and o.pair not in drawn]
    if lost:
        raise PluginError(f"Something should get better over '{lost[0]}', but no region is named so.")


def read(folder: str) -> Job:
    """Reads a job again."""
    path = os.path.join(folder, "plan.study.json")
    try:
        with open(path, encoding="utf-8") as f:
            data = json.load(f)
    except FileNotFoundError:
        raise PluginError("There is no study of this document yet: run one first.") from None
    except (OSError, ValueError) as e:
        raise PluginError(f"{path} cannot be read ({e}); run the study again.") from e
    if not isinstance(data, dict) or data.get("schema") != STUDY_SCHEMA:
        found = data.get("schema") if isinstance(data, dict) else None
        raise PluginError(f"{path} has the schema {found!r}, expected {STUDY_SCHEMA!r}; run the study again.")
    try:
        outlines = [_outline(o) for o in data["outlines"]]
        study = Study.from_dict(data["study"])
        there = Job(folder, study, outlines, dict(data["hashes"]), str(data["sha256"]), list(data["notes"]))
        there.scale = float(data.get("scale", 1.0))
        there.parts = {str(k): [(str(s), int(p), int(c)) for s, p, c in v] for k, v in data.get("parts", {}).items()}
        return there
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as e:
        broken = f"{path} is not complete ({type(e).__name__}: {e})"
        raise PluginError(broken + "; run the study again.") from e


def _study_file(job: Job) -> Dict[str, Any]:
    return {
        "schema": STUDY_SCHEMA,
        "plugin": __version__,
        "sha256": job.sha256,
        "hashes": job.hashes,
        "notes": job.notes,
        "scale": job.scale,
        "parts": job.parts,
        "study": job.study.to_dict(),
        "outlines": [asdict(o) for o in job.outlines],
    }


def _outline(data: Dict[str, Any]) -> Outline:
    stations = data["stations"] and tuple(Station(**s) for s in data["stations"])
    points = [(float(x), float(y)) for x, y in data["points"]]
    return Outline(data["owner"], data["piece"], points, stations or None, data["first"], bool(data.get("is_open")))


def _drawn_anew(study: Study, plan: Plan) -> Patched:
    text, handles = drawing_text(study, plan)
    return Patched(text.encode("ascii"), handles)


def drawing_text(study: Study, plan: Plan) -> Tuple[str, Dict[str, str]]:
    """The study as a DXF: faces on ``A-WALL`` and ``A-COLS`` with ids, openings, or the strokes of a 2D plan, whose
    handles it gives too; our marker layers."""
    # FreeCAD takes the numbers of a DXF without a unit for mm, so that it does not know the unit of a 2D plan.
    out = Drawing(STROKE_DIGITS, is_mm=False) if study.drawn else Drawing(WALL_DIGITS)
    handles = drawn.draw(out, study)
    columns = {c.id for c in study.columns}
    labels = {e.id: e.label for e in study.movables()}
    for outline in () if study.drawn else plan.outlines:
        layer = "A-COLS" if outline.owner in columns else "A-WALL"
        ids = (outline.host_id, labels[outline.owner])
        out.polyline(layer, outline.written(), outline.is_closed, ids)
    for wall in study.walls:
        for o in () if wall.rings else wall.openings:
            if o.kind == "passage":
                # A gap that nothing stands in.
                continue
            layer = "A-GLAZ" if o.kind == "window" else "A-DOOR"
            out.line(layer, wall.at(o.start), wall.at(o.end), (o.id, o.label))
    _draw_marks(out, study, plan)
    return out.file_text(), handles


def _draw_marks(out: Drawing, study: Study, plan: Plan) -> None:
    """Our own layers."""
    for region in study.regions:
        out.polyline(region.layer(), region.points)
    for element in study.built():
        if element.keep:
            out.polyline("EF-KEEP", _round_element(plan, element))
    allowed.draw_boxes(out, study)
    _note_moves(out, plan)


def _round_element(plan: Plan, element) -> List:
    return widened([p for o in plan.outlines if o.owner == element.id for p in o.points], 5.0)


def _note_moves(out: Drawing, plan: Plan) -> None:
    """What may move, in words for whoever opens the drawing. The side-car says it to the program: a mark of ours
    drawn here as well would be a second word on the same thing."""
    words: Dict[Tuple[str, ...], List[MoveTable]] = {}
    for table in plan.tables:
        words.setdefault((table.name, *table.members), []).append(table)
    for (name, *_), tables in words.items():
        places = [plan.outlines[i].points[c] for i, c in sorted(tables[0].corners)]
        said = "; ".join([name, *(t.clause.text() for t in tables)])
        out.text(NOTE_LAYER, centroid(places), TEXT_MM, said)


def side_car(study: Study, plan: Plan, job: Job, handles: Dict[str, str]) -> Dict[str, Any]:
    """Settings, moves by exact corners or, of a 2D plan, by whole entities, and the ``[host]`` table."""
    wishes = study.wishes
    by_corners = [{"name": t.name, "moves": t.clause.text(), "nodes": t.nodes(plan.outlines)} for t in plan.tables]
    moves = drawn.move_tables(plan, handles) if study.drawn else by_corners
    out: Dict[str, Any] = {
        # Who marked lines of a 2D plan wants to see options, also where its reading is unsure; the program's questions
        # are shown.
        "unit": (wishes.unit or None) if study.drawn else "mm",
        "unsure": "optimise" if study.drawn else None,
        "only-marked": True,
        # Lines that are marked one by one leave those they meet: that is done, and told of each option.
        "allow": "open-joints, narrow-ways" if study.drawn else None,
        "objective": wishes.objective_text(),
        "thresholds": "yielding" if wishes.chosen() == [o for o in default_objectives() if o.is_on] else "firm",
        "penalty": wishes.penalty_text(),
        "members": wishes.members,
        "seed": wishes.seed,
        "level": wishes.level,
        "evaluations": wishes.evaluations,
        "spacing": wishes.spacing_m,
        "brief": {"items": wishes.brief} if wishes.brief else None,
        "move": [*moves, *allowed.tables(study, plan.outlines, handles)],
        "lineage": study.lineage,
        "host": {
            "schema": HOST_SCHEMA,
            "program": study.host,
            "plugin": __version__,
            "document": study.document,
            "storey": study.storey,
            "drawing-sha256": job.sha256,
            "wall": [_host_wall(w, job) for w in study.walls],
            "column": [_host_column(c, job) for c in study.columns],
            "region": [_host_region(r) for r in study.regions],
        },
    }
    return {k: v for k, v in out.items() if v not in ([], None)}


def _host_wall(wall: Wall, job: Job) -> Dict[str, Any]:
    return {
        "id": wall.id,
        "name": wall.name,
        "label": wall.label,
        "axis": wall.axis,
        "thickness": wall.thickness,
        "left": wall.left,
        "bounds": "; ".join(c.text() for c in wall.clauses),
        "works": allowed.text_of(wall.works),
        "group": wall.group,
        "hash": job.hashes[wall.id],
    }


def _host_column(column: Column, job: Job) -> Dict[str, Any]:
    bounds = "; ".join(c.text() for c in column.clauses)
    hash = job.hashes[column.id]
    return {"id": column.id, "name": column.name, "label": column.label, "bounds": bounds, "hash": hash}


def _host_region(region: Region) -> Dict[str, Any]:
    pair = {"pair": region.pair} if region.pair else {}
    return {"kind": region.kind, "points": region.points, **pair}


def _replace_all(*files: Tuple[str, bytes]) -> None:
    """Writes files whole, in order, or leaves those that stand there; of a failure no ``.part`` stays behind."""
    parts = [path + ".part" for path, _ in files]
    try:
        for (path, data), part in zip(files, parts):
            if os.path.isdir(path):
                raise IsADirectoryError(0, f"{path} is a folder")
            with open(part, "wb") as f:
                f.write(data)
                f.flush()
                os.fsync(f.fileno())
        for (path, _), part in zip(files, parts):
            os.replace(part, path)
    finally:
        for part in parts:
            if os.path.isfile(part):
                os.remove(part)
