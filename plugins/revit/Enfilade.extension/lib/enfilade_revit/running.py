"""A run that does not need Revit's Python: the program is started detached and writes its progress to a file.

Revit's Python stands still between two clicks. A thread that read the program's words through a pipe would starve
there, and the program would stop at a full pipe. So a click starts the program and later clicks look at the file.
"""

import contextlib
import json
import os
import subprocess
from dataclasses import dataclass
from typing import Any, Dict, List, Optional

from enfilade_common import program, results
from enfilade_common.job import Job
from enfilade_common.model import PluginError

#: What the program says goes here, and here stands which process it is.
PROGRESS, RUN = "plan.progress.txt", "plan.run.json"

#: Of a process on Windows: a group of its own, no console, below all that the user works with.
FLAGS = ("CREATE_NEW_PROCESS_GROUP", "CREATE_NO_WINDOW", "BELOW_NORMAL_PRIORITY_CLASS")


@dataclass
class State:
    """How a run is. ``words`` say how far it is, or what stopped it."""

    is_running: bool
    words: str


def start(job: Job, path: str, version: str) -> None:
    """Starts the program on a job; returns at once."""
    before = [os.path.basename(f) for f in results.round_folders(job.results_folder)]
    flags = sum(getattr(subprocess, name, 0) for name in FLAGS)
    try:
        with open(os.path.join(job.folder, PROGRESS), "wb") as said:
            started = subprocess.Popen(
                [path, *program.arguments(job.drawing)],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=said,
                cwd=job.folder,
                creationflags=flags,
                start_new_session=True,
            )
        run = {"pid": started.pid, "begun": _begun(started.pid), "version": version, "before": before}
        with open(os.path.join(job.folder, RUN), "w", encoding="utf-8") as f:
            json.dump(run, f)
    except OSError as e:
        raise PluginError(f"{path} does not start: {e.strerror or e}. Nothing was started.") from e
    program.give_way(started.pid)


def state(folder: str) -> Optional[State]:
    """How the last run of a job folder is; nothing where there was none."""
    run = _run(folder)
    if run is None:
        return None
    listener, said = program.Listener(), b""
    with contextlib.suppress(OSError), open(os.path.join(folder, PROGRESS), "rb") as f:
        said = f.read()
    progress = listener.feed(said)
    if _is_running(run):
        return State(True, _how_far(progress))
    errors = [w for w in listener.words if w.startswith("error")]
    return State(False, " ".join(errors or listener.words[-3:]))


def result(job: Job) -> results.Round:
    """What the last run of a job has written; says why there is nothing."""
    run, now = _run(job.folder), state(job.folder)
    if run is None or now is None:
        return results.latest(job)
    if now.is_running:
        raise PluginError(f"The study still runs: {now.words}. Look again later.")
    before = [os.path.join(job.results_folder, name) for name in run["before"]]
    made = [f for f in results.round_folders(job.results_folder) if f not in before]
    if not made:
        raise PluginError(f"The study ended without options. {now.words}".strip())
    return results.made_since(job, before, run["version"])


def stop(folder: str) -> None:
    """Ends a run. What the program stores appears whole or not at all, so nothing half-written stays."""
    run = _run(folder)
    if run is not None and _is_running(run):
        _process(run["pid"]).Kill()


def _run(folder: str) -> Optional[Dict[str, Any]]:
    try:
        with open(os.path.join(folder, RUN), encoding="utf-8") as f:
            run = json.load(f)
        numbers = {"pid": int(run["pid"]), "begun": int(run["begun"])}
        return {**numbers, "version": str(run["version"]), "before": [str(name) for name in run["before"]]}
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _process(pid: int):
    """.NET's process; nothing where there is none of that number, or none that we may look at. Python by itself
    would have to ask Windows' C interface."""
    from System.Diagnostics import Process  # type: ignore[import-untyped]

    try:
        found = Process.GetProcessById(pid)
        return None if found.HasExited else found
    except Exception:  # .NET's, of several kinds
        return None


def _begun(pid: int) -> int:
    """When a process began, so that one of the same number later is not taken for it; 0 for none."""
    found = _process(pid)
    return 0 if found is None else int(found.StartTime.ToFileTimeUtc())


def _is_running(run: Dict[str, Any]) -> bool:
    return run["begun"] != 0 and _begun(run["pid"]) == run["begun"]


def _how_far(said: List[program.Progress]) -> str:
    if not said:
        return "it has just begun"
    last = said[-1]
    words = [last.stage]
    if last.share is not None:
        words.append(f"{100 * last.share:.0f} %")
    if last.eta_secs is not None:
        words.append(f"about {max(last.eta_secs / 60, 1):.0f} min left")
    return ", ".join(words)
