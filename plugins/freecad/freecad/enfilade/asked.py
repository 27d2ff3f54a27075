"""A question that the program answers beside the window: one run at a time, in a folder of its own."""

import tempfile
from typing import Callable, List, Optional

from enfilade_common import program

from .qt import QtCore


class Asked:
    """At most one run of the program, which gives way to the host."""

    def __init__(self, parent: QtCore.QObject) -> None:
        self._parent = parent
        self._process: Optional[QtCore.QProcess] = None
        self._folder: Optional[tempfile.TemporaryDirectory] = None

    @property
    def is_running(self) -> bool:
        return self._process is not None

    @property
    def folder(self) -> Optional[str]:
        """For what is written and asked, until it is stopped."""
        return self._folder.name if self._folder is not None else None

    def open(self) -> str:
        """A new folder; what runs is stopped."""
        self.stop()
        self._folder = tempfile.TemporaryDirectory(prefix="enfilade-")
        return self._folder.name

    def start(self, path: str, arguments: List[str], answered: Callable[[str], None], failed: Callable[[], None]) -> None:
        """Runs the program. ``answered`` has its standard output; ``failed`` is called where it does not begin."""
        process = self._process = QtCore.QProcess(self._parent)
        process.setStandardErrorFile(QtCore.QProcess.nullDevice())
        process.setStandardInputFile(QtCore.QProcess.nullDevice())
        process.started.connect(lambda: program.give_way(int(process.processId())))
        process.finished.connect(lambda *_: self._ended(process, answered))
        process.errorOccurred.connect(lambda error: self._missed(process, error, failed))
        process.start(path, arguments)

    def stop(self) -> None:
        process, self._process = self._process, None
        if process is not None:
            process.kill()
            process.waitForFinished(1000)
            process.deleteLater()
        if self._folder is not None:
            self._folder.cleanup()
            self._folder = None

    def _ended(self, process: QtCore.QProcess, answered: Callable[[str], None]) -> None:
        if process is not self._process:
            return
        text = bytes(process.readAllStandardOutput()).decode("utf-8", "replace")
        self._process = None
        process.deleteLater()
        answered(text)

    def _missed(self, process: QtCore.QProcess, error: int, failed: Callable[[], None]) -> None:
        if process is self._process and error == QtCore.QProcess.FailedToStart:
            failed()
