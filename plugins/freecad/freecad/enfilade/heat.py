"""What every cell of the layouts of a round measures, asked of the program one layout after another."""

import io
import tempfile
from typing import Dict, List, Optional, Tuple

from enfilade_common import preview, program, results
from enfilade_common.model import PluginError

from .qt import QtCore


class HeatMaps(QtCore.QObject):
    """Cells by the drawing they belong to. ``measured(drawing)`` once more of them are known, ``failed(words)``."""

    measured = QtCore.Signal(str)
    failed = QtCore.Signal(str)

    def __init__(self, parent=None):
        super().__init__(parent)
        self._process: Optional[QtCore.QProcess] = None
        self._folder: Optional[tempfile.TemporaryDirectory] = None
        self.stop()

    def begin(self, path: str, found: results.Round, drawings: List[str], level: str) -> None:
        self.stop()
        self._folder = tempfile.TemporaryDirectory(prefix="enfilade-")
        self._path, self._found, self._level = path, found, level
        self._todo = list(drawings)
        self._next()

    def stop(self) -> None:
        process, self._process = self._process, None
        if process is not None:
            process.kill()
            process.waitForFinished(1000)
            process.deleteLater()
        if self._folder is not None:
            self._folder.cleanup()
            self._folder = None
        self._todo: List[str] = []
        self._known: Dict[str, preview.Cells] = {}

    def of(self, drawing: str) -> Optional[preview.Cells]:
        """The cells of a layout where they are known; else it is the next to be measured."""
        if drawing in self._todo:
            self._todo.remove(drawing)
            self._todo.insert(0, drawing)
        return self._known.get(drawing)

    def span(self, measure: str) -> Tuple[float, float]:
        """Least and most over all layouts known so far, so that one colour means one value."""
        values = [v for cells in self._known.values() for v in cells.values.get(measure, ())]
        return (min(values), max(values)) if values else (0.0, 0.0)

    def _next(self) -> None:
        if self._process is not None or not self._todo or self._folder is None:
            return
        drawing = self._todo.pop(0)
        process = self._process = QtCore.QProcess(self)
        process.setStandardErrorFile(QtCore.QProcess.nullDevice())
        process.setStandardInputFile(QtCore.QProcess.nullDevice())
        process.started.connect(lambda: program.give_way(int(process.processId())))
        process.finished.connect(lambda *_: self._finished(process, drawing))
        process.errorOccurred.connect(lambda error: self._failed(process, error))
        found = self._found
        grid = (found.spacing_m, found.lattice_centre)
        process.start(self._path, program.cells_arguments(drawing, self._folder.name, self._level, found.unit, *grid))

    def _finished(self, process, drawing: str) -> None:
        if process is not self._process:
            return
        text = bytes(process.readAllStandardOutput()).decode("utf-8", "replace")
        self._process = None
        process.deleteLater()
        try:
            self._known[drawing] = preview.read_cells(io.StringIO(text), self._found.scale)
            self.measured.emit(drawing)
        except PluginError as e:
            self.failed.emit(str(e))
        self._next()

    def _failed(self, process, error) -> None:
        if process is self._process and error == QtCore.QProcess.FailedToStart:
            self.stop()
