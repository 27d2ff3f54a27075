"""The program: where it is, whether it fits, what it is asked, listening to it, stopping it."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
from dataclasses import dataclass
from typing import Any, Dict, List, Optional

from .model import PluginError

NAME = "enfilade"
#: Oldest version that writes and reads what this plugin does. One with other numbers before the last point may not.
VERSION_MIN = (0, 1, 0)
#: The best so far is written after so many seconds of search, for a run that is stopped. Writing takes as long as
#: confirming the options in the end does.
KEPT_EVERY_SECS = 5
#: The stage in which the best so far is written.
SO_FAR = "so-far"
#: How long a stopped program may take to put its things away before it is killed, seconds.
STOP_SECS = 5.0
#: How long it may take to say its version, seconds: the host's window waits.
VERSION_SECS = 2.0

MISSING = (
    "The program 'enfilade' was not found. Install it, or say where it is: in the settings of this plugin, "
    "or in the environment variable ENFILADE."
)

#: The exit code of a run that the user stopped.
STOPPED = 130

#: What the exit codes of the program mean to a user.
EXITS = {
    1: "Done, with something left out; the report says what.",
    2: "The drawing could not be used.",
    3: "The settings could not be used.",
    4: "The disk, a permission or a device failed.",
    STOPPED: "Stopped.",
}


def find(configured: str = "") -> str:
    """Path of the program: as configured, else ``ENFILADE``, else on the search path."""
    for where, path in (("The settings name", configured), ("ENFILADE names", os.environ.get("ENFILADE", ""))):
        if not path:
            continue
        full = os.path.expanduser(path)
        if os.path.isfile(full) and os.access(full, os.X_OK):
            return full
        raise PluginError(f"{where} {path}, which is no program that can be started. Nothing was started.")
    found = shutil.which(NAME)
    if not found:
        raise PluginError(MISSING)
    return found


def version(path: str) -> str:
    """The program's version with its commit, ``0.1.0 (1f2e3d4c5)``, checked."""
    try:
        said = subprocess.run(
            [path, "--version"],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            timeout=VERSION_SECS,
        )
    except subprocess.TimeoutExpired as e:
        silent = f"{path} does not say its version within {VERSION_SECS:g} s"
        raise PluginError(silent + ": it hangs, or the machine is very busy. Nothing was started.") from e
    except OSError as e:
        raise PluginError(f"{path} does not start: {e}.") from e
    text = said.stdout.decode("utf-8", "replace").strip()
    parts = re.search(r"(\d+)\.(\d+)\.(\d+)", text)
    if not text.startswith(NAME + " ") or parts is None:
        said_words = f"says {text[:80]!r}" if text else "says nothing"
        raise PluginError(f"{path} is not Enfilade: asked for its version it {said_words}. Nothing was started.")
    found, needed = tuple(int(p) for p in parts.groups()), ".".join(str(v) for v in VERSION_MIN)
    if found < VERSION_MIN:
        raise PluginError(f"{text} is too old for this plugin, which needs {needed} or newer. Nothing was started.")
    if found[:2] > VERSION_MIN[:2]:
        raise PluginError(f"{text} is too new for this plugin, which is made for {needed}: update the plugin. Nothing was started.")
    return text[len(NAME) + 1 :]


def arguments(drawing: str, keeps_best: bool = False) -> List[str]:
    """Arguments that run the job of a drawing; everything else stands in its side-car. ``keeps_best`` for hosts
    that show the best so far of a run that is stopped."""
    kept = ["--write-every", str(KEPT_EVERY_SECS)] if keeps_best else []
    return ["run", drawing, *kept, "--progress", "json"]


def cells_arguments(drawing: str, folder: str, level: str, unit: str, spacing_m: float, centre) -> List[str]:
    """Arguments that measure the cells of a drawing and print them as a table, on the cells of a round."""
    grid = [f"--spacing={spacing_m!r}", f"--lattice-centre={centre[0]!r},{centre[1]!r}"]
    return ["analyse", drawing, "--level", level, "--unit", unit, *grid, "--out", folder, "--cells", "-", "--quiet", "--no-pictures"]


@dataclass
class Progress:
    """How far a run is. ``best_parameters`` is the best layout so far where the program says it."""

    stage: str
    done: int
    total: Optional[int]
    evaluations: int
    best: Optional[float]
    eta_secs: Optional[float]
    best_parameters: Optional[List[float]] = None

    @property
    def share(self) -> Optional[float]:
        return self.done / self.total if self.total else None


def _progress(data: Dict[str, Any]) -> Optional[Progress]:
    """One line of progress; nothing where it is not what the program writes."""

    def real(value: Any) -> Optional[float]:
        return None if value is None else float(value)

    try:
        best = data.get("best_parameters")
        return Progress(
            stage=str(data["stage"]),
            done=int(data.get("done") or 0),
            total=None if data.get("total") is None else int(data["total"]),
            evaluations=int(data.get("evaluations") or 0),
            best=real(data.get("best")),
            eta_secs=real(data.get("eta_secs")),
            best_parameters=None if best is None else [float(p) for p in best],
        )
    except (KeyError, TypeError, ValueError, OverflowError):
        return None


class Listener:
    """Turns the program's standard error into progress; keeps what it says in words."""

    def __init__(self) -> None:
        self._rest = b""
        self.words: List[str] = []
        #: Evaluations so far, and where the best so far was written; empty before that.
        self.evaluations = 0
        self.so_far = ""

    def feed(self, data: bytes) -> List[Progress]:
        """Progress in the lines that are complete."""
        *lines, self._rest = (self._rest + data).split(b"\n")
        out = [self._line(line) for line in lines]
        return [p for p in out if p is not None]

    def _line(self, line: bytes) -> Optional[Progress]:
        text = line.decode("utf-8", "replace").strip()
        try:
            data = json.loads(text) if text.startswith("{") else None
        except ValueError:
            data = None
        if isinstance(data, dict):
            progress = _progress(data)
            if progress is not None:
                self.evaluations = progress.evaluations or self.evaluations
                self.so_far = str(data.get("folder") or "") if progress.stage == SO_FAR else self.so_far
            return progress
        if text:
            self.words = (self.words + [text])[-50:]
        return None

    def outcome(self, code: int) -> str:
        """What to tell the user of a run that ended with ``code``."""
        errors = [w for w in self.words if w.startswith("error")]
        said = errors or self.words[-1 if code < 0 else -3 :]
        head = EXITS.get(code, "" if code == 0 else f"The program ended with code {code}.")
        return " ".join([head, *(said if code not in (0, 1, STOPPED) else [])]).strip()


def check_arguments(drawing: str) -> List[str]:
    """What the program is asked for how it reads a drawing, as JSON on its standard output."""
    return ["check", drawing, "--json", "-", "--quiet"]


def give_way(pid: int) -> None:
    """Lets everything else on the machine go first, so that the host's window stays quick."""
    if hasattr(os, "setpriority"):
        try:
            os.setpriority(os.PRIO_PROCESS, pid, 10)
        except OSError:
            pass


def interrupt(pid: int) -> None:
    """Asks a running program to stop and to put its things away."""
    if sys.platform == "win32":
        os.kill(pid, signal.CTRL_BREAK_EVENT)
    else:
        os.kill(pid, signal.SIGINT)
