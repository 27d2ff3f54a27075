"""The rows of page 1: a tick for each move and each building work that may be allowed, with its sizes."""

from typing import Dict, List, Optional, Tuple

from enfilade_common.allowed import USUAL as USUAL_WORKS
from enfilade_common.model import Allowed

from . import marks
from .qt import QtCore, QtWidgets
from .wording import say

MOVE_ROWS = (("x", "east-west"), ("y", "north-south"), ("along", "along the wall"), ("rotate", "turn"))
WORK_ROWS = (
    ("open", "opening"),
    ("door", "door of 0.9 m"),
    ("glaze", "glass"),
    ("widen", "wider door or opening"),
    ("close", "door walled up"),
    ("rehang", "door elsewhere in its wall"),
    ("end", "free end goes back"),
    ("remove", "whole wall removed"),
    ("add", "new wall across the room"),
)
#: What a freshly ticked move allows: mm, degrees.
USUAL = {"x": 500.0, "y": 500.0, "along": 500.0, "rotate": 15.0}
#: Narrowest and widest opening, mm.
WIDTHS = (100.0, 20000.0)

#: Least and most of what is allowed, by its kind; of a work without a size nothing.
Sizes = Dict[str, Tuple[Optional[float], Optional[float]]]


def given(obj) -> Sizes:
    """What an object was allowed."""
    works = {w.kind: (w.least, w.most) for w in marks.works(obj)}
    return {**marks.bounds(obj), **works}


def show_tick(tick, having: int, all_of: int) -> None:
    """A tick where all have something, half a tick where some have it."""
    is_half = 0 < having < all_of
    whole = QtCore.Qt.Checked if having else QtCore.Qt.Unchecked
    tick.setTristate(is_half)
    tick.setCheckState(QtCore.Qt.PartiallyChecked if is_half else whole)


class Row:
    """A tick and up to two numbers."""

    def __init__(self, kind: str, title: str):
        self.kind, self.is_move = kind, kind in USUAL
        self.tick = QtWidgets.QCheckBox(say(title))
        self.tick.setObjectName(("EnfiladeAllow_" if self.is_move else "EnfiladeWork_") + kind)
        self.tick.toggled.connect(self._ticked)
        self.boxes: Dict[int, QtWidgets.QDoubleSpinBox] = {}
        usual = (-USUAL[kind], USUAL[kind]) if self.is_move else USUAL_WORKS.get(kind, (None, None))
        self._usual = dict(enumerate(usual, 1))
        for column, value in self._usual.items():
            if value is not None:
                self.boxes[column] = self._box(column)
        self.left = QtWidgets.QLabel()
        self.left.setObjectName("EnfiladeLeft_" + kind)
        self.left.setToolTip(say("Press Allow to begin anew from here."))

    def _box(self, column: int):
        box = QtWidgets.QDoubleSpinBox()
        box.setObjectName(f"EnfiladeBound_{self.kind}_{column}")
        is_turn = self.kind == "rotate"
        if self.is_move:
            limit = 180.0 if is_turn else 100000.0
            box.setRange(*((-limit, 0.0) if column == 1 else (0.0, limit)))
        else:
            box.setRange(*WIDTHS)
        box.setDecimals(1 if is_turn else 0)
        box.setSingleStep(5 if is_turn else 100)
        box.setSuffix("°" if is_turn else " mm")
        box.setEnabled(False)
        return box

    def widgets(self):
        return [self.tick, *self.boxes.values(), self.left]

    def _ticked(self, on: bool) -> None:
        for box in self.boxes.values():
            box.setEnabled(on)
        if on and not any(box.value() for box in self.boxes.values()):
            self._fill(self._usual)

    def _fill(self, values) -> None:
        for column, box in self.boxes.items():
            box.setValue(values[column] or 0.0)

    def show(self, all_given: List[Sizes]) -> None:
        """Shows what some objects were allowed; half a tick where not all of them were."""
        having = [g[self.kind] for g in all_given if self.kind in g]
        shown = having[0] if having else (0.0, 0.0) if self.is_move else (None, None)
        # A work without a size may have any.
        self._fill({c: self._usual[c] if v is None else v for c, v in enumerate(shown, 1)})
        show_tick(self.tick, len(having), len(all_given))

    def sizes(self, own: Sizes) -> Sizes:
        """What an object is allowed by this row; of half a tick what it was."""
        state = self.tick.checkState()
        if state == QtCore.Qt.PartiallyChecked:
            return {self.kind: own[self.kind]} if self.kind in own else {}
        if state == QtCore.Qt.Unchecked:
            return {}
        least, most = (self.boxes[c].value() if c in self.boxes else None for c in (1, 2))
        if not self.is_move and least is not None and most is not None:
            least, most = sorted((least, most))
        return {self.kind: (least, most)} if self.is_move and (least or most) or not self.is_move else {}


class Rows(QtWidgets.QWidget):
    """All rows; only those are shown that the selected objects can be allowed."""

    def __init__(self):
        super().__init__()
        self.rows: Dict[str, Row] = {}
        grid = QtWidgets.QGridLayout(self)
        grid.setContentsMargins(0, 0, 0, 0)
        self._moves_title = self._add(grid, 0, MOVE_ROWS, "May move")
        self._works_title = self._add(grid, len(MOVE_ROWS) + 1, WORK_ROWS, "May be built")
        only = say("Where any work is marked, options build nothing else.")
        for label in self._works_title:
            label.setToolTip(only)

    def _add(self, grid, begin: int, rows, title: str):
        titles = [QtWidgets.QLabel(say(words)) for words in (title, "from", "to")]
        for column, label in enumerate(titles):
            grid.addWidget(label, begin, column)
        for at, (kind, words) in enumerate(rows, begin + 1):
            row = self.rows[kind] = Row(kind, words)
            grid.addWidget(row.tick, at, 0)
            for column, box in row.boxes.items():
                grid.addWidget(box, at, column)
            grid.addWidget(row.left, at, 3)
        return titles

    def offer(self, kinds) -> None:
        """Shows the rows of these kinds."""
        for kind, row in self.rows.items():
            for widget in row.widgets():
                widget.setVisible(kind in kinds)
        for titles, rows in ((self._moves_title, MOVE_ROWS), (self._works_title, WORK_ROWS)):
            for label in titles:
                label.setVisible(any(kind in kinds for kind, _ in rows))

    def keep(self, is_kept: bool) -> None:
        """Nothing is built in what must stay."""
        for kind, _ in WORK_ROWS:
            self.rows[kind].tick.setEnabled(not is_kept)

    def show_given(self, all_given: Dict[str, List[Sizes]]) -> None:
        """Shows by kind what the objects were allowed that may be allowed it."""
        for kind, row in self.rows.items():
            row.show(all_given[kind])

    def is_any_ticked(self) -> bool:
        return any(row.tick.isChecked() for row in self.rows.values())

    def sizes(self, kinds, own: Sizes) -> Sizes:
        """What an object is allowed of some kinds, if all is written as it is ticked."""
        return {k: v for kind, row in self.rows.items() if kind in kinds for k, v in row.sizes(own).items()}


def moves_of(sizes: Sizes) -> Dict[str, tuple]:
    return {k: v for k, v in sizes.items() if k in USUAL}


def works_of(sizes: Sizes) -> List[Allowed]:
    return [Allowed(k, *v) for k, v in sizes.items() if k not in USUAL]
