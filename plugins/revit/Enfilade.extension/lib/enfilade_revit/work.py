"""What the buttons do: export, run, choose, apply. ``window`` talks to the user, ``host`` to Revit."""

import os
from typing import Optional

from enfilade_common import job, program, results
from enfilade_common.model import PluginError, Wishes

from . import applying, reading


def job_folder(host) -> str:
    """Beside the model, or in the user's documents before it is saved."""
    folder = host.document_folder() or os.path.join(os.path.expanduser("~"), "Documents", "Enfilade")
    return os.path.join(folder, f"{host.document_name()}-enfilade")


def guarded(window, action) -> None:
    """Does something of the user's; what stands against it is told in a sentence."""
    try:
        action()
    except PluginError as e:
        window.tell("Enfilade", str(e))


def export_study(host, window, wishes: Optional[Wishes] = None) -> None:
    """Writes the view as a job and runs it, on a thread; Revit stays free."""
    study, notes = reading.study(host, wishes or Wishes())
    made = job.write(study, job_folder(host))
    path = program.find()
    program.version(path)
    program.Run(path, made.drawing, lambda progress: None, lambda code, words: None)
    lines = [f"Written to {made.drawing}; the study runs.", "Look at the options with 'Candidates' when it is done."]
    window.tell("Enfilade", "\n".join([*lines, *notes, *made.notes]))


def export_drawing(host, window) -> None:
    """Revit's own DXF or IFC of the view, into the watched folder."""
    folder = window.choose_folder("Watched folder", host.document_folder())
    if not folder:
        return
    kind = window.choose("Enfilade", "Which format?", ["DXF", "IFC"])
    if kind is None:
        return
    write = host.export_dxf if kind == 0 else host.export_ifc
    write(folder, host.document_name())
    window.tell("Enfilade", f"Written to {folder}.")


def describe_marks(host, window) -> None:
    """Says what is marked in the view: regions, moves, what cannot be used."""
    study, notes = reading.study(host, Wishes())
    marked = [e for e in study.movables() if e.clauses or e.group]
    doors = [o for w in study.walls for o in w.openings if o.clauses]
    lines = [f"{len(study.walls)} walls, {len(study.columns)} columns."]
    for e in marked:
        group = f" (group {e.group})" if e.group else ""
        lines.append(f"{e.label}: " + "; ".join(c.text() for c in e.clauses) + group)
    lines += [f"{o.label}: slides {o.clauses[0].lower:g} to {o.clauses[0].upper:g} mm" for o in doors]
    lines += [f"Region: {r.kind}, {len(r.points)} corners" for r in study.regions]
    if not marked and not doors:
        lines.append("Nothing is marked; Enfilade then moves what stands free.")
    window.tell("Enfilade", "\n".join([*lines, *notes]))


def _newest(host):
    made = job.read(job_folder(host))
    return made, results.latest(made)


def candidates(host, window) -> None:
    """The options with their pictures."""
    made, found = _newest(host)
    if not found.options:
        raise PluginError("Nothing may move: the present layout was measured.")
    rows = [(f"Option {o.number}", o.words, o.picture("degree")) for o in found.options]
    chosen = window.choose_picture("Enfilade", rows, found.report)
    if chosen is not None:
        _apply(host, window, made, found.options[chosen])


def apply_option(host, window) -> None:
    """An option by its number."""
    made, found = _newest(host)
    chosen = window.choose("Enfilade", "Which option?", [f"{o.number}: {o.words}" for o in found.options])
    if chosen is not None:
        _apply(host, window, made, found.options[chosen])


def _apply(host, window, made, option) -> None:
    moved = applying.apply(host, made, option)
    window.tell("Enfilade", f"Option {option.number}: {', '.join(moved)} moved. Undo takes all of it back.")


def apply_drawing(host, window) -> None:
    """An option of a drawing that Revit itself exported, by its round's folder."""
    folder = window.choose_folder("Folder of the round (plan.enfilade/round-…)", host.document_folder())
    if not folder:
        return
    found = results.read(folder)
    chosen = window.choose("Enfilade", "Which option?", [f"{o.number}: {o.words}" for o in found.options])
    if chosen is not None:
        moved = applying.apply_drawing(host, found.options[chosen])
        window.tell("Enfilade", f"{len(moved)} elements moved. Undo takes all of it back.")
