"""What every cell of the layouts of a round measures, asked of the program one layout after another."""

import io
from typing import Dict, List, Optional, Tuple

from enfilade_common import preview, program, results
from enfilade_common.model import PluginError

from .asked import Asked
from .qt import QtCore


class HeatMaps(QtCore.QObject):
    """Cells by the drawing they belong to. ``measured(drawing)`` once more of them are known, ``failed(words)``."""

    measured = QtCore.Signal(str)
    failed = QtCore.Signal(str)

    def __init__(self, parent=None):
        super().__init__(parent)
        self._asked = Asked(self)
        self.stop()

    def begin(self, path: str, found: results.Round, drawings: List[str], level: str) -> None:
        self.stop()
        self._asked.open()
        self._path, self._found, self._level = path, found, level
        self._todo = list(drawings)
        self._next()

    def stop(self) -> None:
        self._asked.stop()
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
        folder = self._asked.folder
        if self._asked.is_running or not self._todo or folder is None:
            return
        drawing = self._todo.pop(0)
        found = self._found
        grid = (found.spacing_m, found.lattice_centre)
        asked = program.cells_arguments(drawing, folder, self._level, found.unit, *grid)
        self._asked.start(self._path, asked, lambda text: self._finished(text, drawing), self.stop)

    def _finished(self, text: str, drawing: str) -> None:
        try:
            self._known[drawing] = preview.read_cells(io.StringIO(text), self._found.scale)
            self.measured.emit(drawing)
        except PluginError as e:
            self.failed.emit(str(e))
        self._next()
