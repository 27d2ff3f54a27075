"""What the buttons do: export, run, choose, apply. ``window`` talks to the user, ``host`` to Revit."""

import os
import re
from typing import Optional

from enfilade_common import job, program, results
from enfilade_common.allowed import text_of
from enfilade_common.model import PluginError, Wishes

from . import applying, reading, running


def job_folder(host) -> str:
    """Beside the model, or in the user's documents before it is saved; one for each storey."""
    folder = host.document_folder() or os.path.join(os.path.expanduser("~"), "Documents", "Enfilade")
    return os.path.join(folder, f"{_file_name(host.document_name())}-enfilade", _file_name(host.level_name()))


def _file_name(text: str) -> str:
    """A name that Windows takes for a folder."""
    return re.sub(r'[<>:"/\\|?*\x00-\x1f]', "_", text).strip(" .") or "_"


def guarded(window, action) -> None:
    """Does something of the user's; what stands against it is told in a sentence."""
    try:
        action()
    except PluginError as e:
        window.tell("Enfilade", str(e))


def add_parameters(host, window) -> None:
    """Gives walls, columns, doors and windows the parameters that carry marks."""
    added = host.add_parameters()
    said = f"Added: {', '.join(added)}." if added else "The model has the parameters already."
    window.tell(title(host), said)


def title(host) -> str:
    """Which document and storey a dialog is about."""
    return f"Enfilade: {host.document_name()}, {host.level_name()}"


def export_study(host, window, wishes: Optional[Wishes] = None) -> None:
    """Writes the view as a job and starts the program on it; Revit stays free."""
    folder = job_folder(host)
    now = running.state(folder)
    if now is not None and now.is_running:
        raise PluginError(f"The study of this storey still runs: {now.words}. 'Candidates' can stop it.")
    study, notes = reading.study(host, wishes or Wishes())
    path = program.find()
    version = program.version(path)
    made = job.write(study, folder)
    running.start(made, path, version)
    lines = [f"Written to {made.drawing}; the study runs.", "'Candidates' shows how far it is, then its options."]
    window.tell(title(host), "\n".join([*lines, *notes, *made.notes]))


def export_drawing(host, window) -> None:
    """Revit's own DXF or IFC of the view, into the watched folder."""
    folder = window.choose_folder("Watched folder", host.document_folder())
    if not folder:
        return
    kind = window.choose(title(host), "Which format?", ["DXF", "IFC"])
    if kind is None:
        return
    write = host.export_dxf if kind == 0 else host.export_ifc
    write(folder, host.document_name())
    window.tell(title(host), f"Written to {folder}.")


def describe_marks(host, window) -> None:
    """Says what is marked in the view: regions, moves, what cannot be used."""
    study, notes = reading.study(host, Wishes())
    marked = [e for e in study.movables() if e.clauses or e.group]
    rebuilt = study.rebuilt()
    doors = [o for w in study.walls for o in w.openings if o.clauses]
    lines = [f"{len(study.walls)} walls, {len(study.columns)} columns."]
    for e in marked:
        group = f" (group {e.group})" if e.group else ""
        lines.append(f"{e.label}: " + "; ".join(c.text() for c in e.clauses) + group)
    lines += [f"{o.label}: slides {o.clauses[0].lower:g} to {o.clauses[0].upper:g} mm" for o in doors]
    lines += [f"{e.label}: may be rebuilt: {text_of(e.works)}" for e in rebuilt]
    lines += [f"Region: {r.kind}, {len(r.points)} corners" for r in study.regions]
    if not marked and not doors and not rebuilt:
        lines.append("Nothing is marked; Enfilade then moves what stands free.")
    window.tell(title(host), "\n".join([*lines, *notes]))


def _newest(host):
    made = job.read(job_folder(host))
    host.bind(made.study.document)
    found = running.result(made)
    if not found.options:
        raise PluginError("No layout improves the present one, or nothing may move: the present layout was measured.")
    return made, found


def candidates(host, window) -> None:
    """How far the study is; then its options with their pictures."""
    now = running.state(job_folder(host))
    if now is not None and now.is_running:
        if window.choose(title(host), f"The study runs: {now.words}", ["Let it run", "Stop it"]) == 1:
            running.stop(job_folder(host))
        return
    made, found = _newest(host)
    rows = [(f"Option {o.number}", o.words, o.picture("degree")) for o in found.options]
    chosen = window.choose_picture(title(host), rows, found.report)
    if chosen is not None:
        _apply(host, window, made, found.options[chosen])


def apply_option(host, window) -> None:
    """An option by its number."""
    made, found = _newest(host)
    chosen = window.choose(title(host), "Which option?", [f"{o.number}: {o.words}" for o in found.options])
    if chosen is not None:
        _apply(host, window, made, found.options[chosen])


def _apply(host, window, made, option) -> None:
    _tell_moved(host, window, option, applying.apply(host, made, option))


def _tell_moved(host, window, option, moved) -> None:
    lines = [f"Option {option.number}: {', '.join(moved)} moved. Undo takes all of it back."]
    lines += [f"Revit warns: {warning}" for warning in dict.fromkeys(host.warnings)]
    window.tell(title(host), "\n".join(lines))


def apply_drawing(host, window) -> None:
    """An option of a drawing that Revit itself exported, by its round's folder."""
    folder = window.choose_folder("Folder of the round (plan.enfilade/round-…)", host.document_folder())
    if not folder:
        return
    found = results.read(folder)
    chosen = window.choose(title(host), "Which option?", [f"{o.number}: {o.words}" for o in found.options])
    if chosen is not None:
        _tell_moved(host, window, found.options[chosen], applying.apply_drawing(host, found.options[chosen]))
