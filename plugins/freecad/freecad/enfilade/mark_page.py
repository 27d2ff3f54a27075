"""Page 1: what may move, and the regions."""

import FreeCAD as App
import FreeCADGui as Gui

from enfilade_common.model import PluginError, pair_name

from . import document, marks
from .qt import QtCore, QtWidgets
from .wording import say

ROWS = (("x", "east-west"), ("y", "north-south"), ("along", "along the wall"), ("rotate", "turn"))
#: What a freshly ticked move allows: mm, degrees.
USUAL = {"x": 500.0, "y": 500.0, "along": 500.0, "rotate": 15.0}
REGIONS = (("query", "People are here"), ("reference", "They look at this"), ("keep", "Nothing moves here"))


class MarkPage(QtWidgets.QWidget):
    """Bounds of the selected objects, buttons for regions."""

    def __init__(self, panel):
        super().__init__()
        self._panel = panel
        self._awaited_region = ""
        self._later = QtCore.QTimer(self)
        self._later.setSingleShot(True)
        self._later.timeout.connect(self.refresh)
        layout = QtWidgets.QVBoxLayout(self)
        self.selected = QtWidgets.QLabel()
        self.selected.setWordWrap(True)
        layout.addWidget(self.selected)
        layout.addLayout(self._bounds())
        layout.addLayout(self._group())
        layout.addLayout(self._buttons())
        layout.addSpacing(12)
        layout.addLayout(self._regions())
        layout.addStretch(1)

    def _bounds(self):
        grid = QtWidgets.QGridLayout()
        for column, title in ((1, "from"), (2, "to")):
            grid.addWidget(QtWidgets.QLabel(say(title)), 0, column)
        self.rows = {}
        for row, (kind, title) in enumerate(ROWS, 1):
            tick = QtWidgets.QCheckBox(say(title))
            tick.setObjectName("EnfiladeAllow_" + kind)
            boxes = []
            for column in (1, 2):
                box = QtWidgets.QDoubleSpinBox()
                box.setObjectName(f"EnfiladeBound_{kind}_{column}")
                limit = 180.0 if kind == "rotate" else 100000.0
                low, high = (-limit, 0.0) if column == 1 else (0.0, limit)
                box.setRange(low, high)
                box.setDecimals(0 if kind != "rotate" else 1)
                box.setSingleStep(100 if kind != "rotate" else 5)
                box.setSuffix("°" if kind == "rotate" else " mm")
                box.setEnabled(False)
                tick.toggled.connect(box.setEnabled)
                grid.addWidget(box, row, column)
                boxes.append(box)
            tick.toggled.connect(lambda on, k=kind: self._ticked(k, on))
            grid.addWidget(tick, row, 0)
            self.rows[kind] = (tick, *boxes)
        return grid

    def _ticked(self, kind: str, on: bool) -> None:
        _, low, high = self.rows[kind]
        if on and not low.value() and not high.value():
            low.setValue(-USUAL[kind])
            high.setValue(USUAL[kind])

    def _group(self):
        row = QtWidgets.QHBoxLayout()
        row.addWidget(QtWidgets.QLabel(say("Group")))
        self.group = QtWidgets.QLineEdit()
        self.group.setObjectName("EnfiladeGroup")
        self.group.setToolTip(say("Objects with the same group name move together"))
        row.addWidget(self.group)
        self.keep = QtWidgets.QCheckBox(say("Must stay"))
        self.keep.setObjectName("EnfiladeKeep")
        row.addWidget(self.keep)
        return row

    def _buttons(self):
        row = QtWidgets.QHBoxLayout()
        for name, title, action in (
            ("EnfiladeAllow", "Allow", self._allow),
            ("EnfiladeUnmark", "Remove marks", self._unmark),
        ):
            button = QtWidgets.QPushButton(say(title))
            button.setObjectName(name)
            button.clicked.connect(lambda _=False, a=action: self._panel.attempt(a))
            row.addWidget(button)
        return row

    def _regions(self):
        column = QtWidgets.QVBoxLayout()
        column.addWidget(QtWidgets.QLabel(say("Regions: select a closed line, or draw one")))
        row = QtWidgets.QHBoxLayout()
        for kind, title in REGIONS:
            button = QtWidgets.QPushButton(say(title))
            button.setObjectName("EnfiladeRegion_" + kind)
            button.clicked.connect(lambda _=False, k=kind: self._panel.attempt(self._region, k))
            row.addWidget(button)
        column.addLayout(row)
        named = QtWidgets.QHBoxLayout()
        named.addWidget(QtWidgets.QLabel(say("Name")))
        self.pair = QtWidgets.QLineEdit()
        self.pair.setObjectName("EnfiladePair")
        self.pair.setPlaceholderText(say("none; regions of one name are a pair of their own"))
        named.addWidget(self.pair)
        column.addLayout(named)
        return column

    # -- what the user does

    def chosen(self):
        """Selected walls, columns, doors and windows; a selected axis stands for its wall."""
        out = []
        for obj in Gui.Selection.getSelection():
            parents = [o for o in obj.InList if getattr(o, "Base", None) is obj]
            for o in [obj, *parents]:
                if document.kind_of(o) in ("Wall", "Window") or document.is_column(o):
                    if o not in out:
                        out.append(o)
        return out

    def _allow(self) -> None:
        objects = self.chosen()
        if not objects:
            raise PluginError(say("Nothing selected. Select walls, columns, doors or windows in the view."))
        ticked = {k: (low.value(), high.value()) for k, (tick, low, high) in self.rows.items() if tick.isChecked()}
        has_moves = any(any(pair) for pair in ticked.values())
        if not (has_moves or self.group.text().strip() or self.keep.isChecked()):
            raise PluginError(say("Tick how it may move, name its group, or tick that it must stay."))
        doors = [o for o in objects if document.kind_of(o) == "Window"]
        rest = [o for o in objects if o not in doors]
        along = {k: v for k, v in ticked.items() if k == "along"}
        stays = []
        if has_moves and not any(any(pair) for pair in along.values()):
            # A door moves in its wall only; in any other direction it would seem marked and stay.
            stays, doors = doors, []
        fixed = ", ".join(f"'{o.Label}'" for o in stays)
        only = say("Doors and windows only slide along the wall; {} was not marked.", fixed) if stays else ""
        if not rest and not doors:
            raise PluginError(only)
        doc = objects[0].Document
        doc.openTransaction("Enfilade: mark")
        for some, bounds in ((rest, ticked), (doors, along)):
            marks.mark_all(some, bounds, self.group.text().strip(), self.keep.isChecked())
        doc.commitTransaction()
        self._panel.refresh()
        marked = say("Marked: {}", ", ".join(o.Label for o in [*rest, *doors]))
        held = [f"'{o.Label}': {document.lock(o)}." for o in rest if has_moves and document.lock(o)]
        locked = say("Marked, but they stay: {}", " ".join(held)) if held else ""
        self._panel.tell(" ".join(w for w in (marked, only, locked) if w))

    def _unmark(self) -> None:
        regions = [o for o in Gui.Selection.getSelection() if marks.region_kind(o)]
        objects = [*self.chosen(), *regions]
        if not objects:
            raise PluginError(say("Nothing selected. Select walls, columns, doors or windows in the view."))
        doc = objects[0].Document
        doc.openTransaction("Enfilade: remove marks")
        for obj in objects:
            marks.unmark(obj)
        doc.commitTransaction()
        self._panel.refresh()
        self._panel.tell(say("Marks removed: {}", ", ".join(o.Label for o in objects)))

    def _region(self, kind: str) -> None:
        self._panel.document()
        pair_name(self.pair.text())
        closed = [o for o in Gui.Selection.getSelection() if is_closed(o)]
        if not closed:
            self._awaited_region = kind
            self._panel.tell(say("Draw a closed line now; it becomes the region."))
            Gui.runCommand("Draft_Wire")
            return
        self._mark_regions(closed, kind)

    def _mark_regions(self, objects, kind: str) -> None:
        doc = objects[0].Document
        doc.openTransaction("Enfilade: region")
        for obj in objects:
            marks.mark_region(obj, kind, pair_name(self.pair.text()) if kind != "keep" else "")
        doc.commitTransaction()
        self._panel.refresh()
        self._panel.tell(say("Marked: {}", ", ".join(o.Label for o in objects)))

    def object_created(self, obj) -> None:
        """A line drawn after a region was asked for becomes it, once Draft has finished with it."""
        # While it is drawn, Draft shows a Part::Feature that never is the line itself.
        if self._awaited_region and obj.isDerivedFrom("Part::Part2DObject"):
            kind, self._awaited_region = self._awaited_region, ""
            name, doc_name = obj.Name, obj.Document.Name
            QtCore.QTimer.singleShot(600, lambda: self._panel.attempt(self._drawn, doc_name, name, kind))

    def _drawn(self, doc_name: str, name: str, kind: str) -> None:
        doc = App.listDocuments().get(doc_name)
        obj = doc.getObject(name) if doc is not None else None
        if obj is None or not is_closed(obj):
            raise PluginError(say("The region is not closed and was left as it is."))
        self._mark_regions([obj], kind)

    # -- what is shown

    def refresh_later(self) -> None:
        self._later.start(80)

    def refresh(self) -> None:
        objects = self.chosen() if App.ActiveDocument is not None else []
        labels = ", ".join(o.Label for o in objects[:6]) + (" …" if len(objects) > 6 else "")
        empty = "Nothing selected. Select walls, columns, doors or windows in the view."
        self.selected.setText(say("Selected: {}", labels) if objects else say(empty))
        if not objects:
            return
        first = objects[0]
        given = {c.kind: c for c in marks.clauses(first, 0.0)}
        for kind, (tick, low, high) in self.rows.items():
            if marks.is_marked(first):
                clause = given.get(kind)
                low.setValue(clause.lower if clause else 0.0)
                high.setValue(clause.upper if clause else 0.0)
                tick.setChecked(clause is not None)
        if marks.is_marked(first):
            self.group.setText(marks.group(first))
            self.keep.setChecked(marks.keep(first))


def is_closed(obj) -> bool:
    shape = getattr(obj, "Shape", None)
    is_line = shape is not None and not shape.isNull() and not shape.Solids
    return is_line and any(w.isClosed() for w in shape.Wires)
