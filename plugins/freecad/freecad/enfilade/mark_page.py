"""Page 1: what may move, and the regions."""

import FreeCAD as App
import FreeCADGui as Gui

from enfilade_common.model import PluginError, number, pair_name

from . import document, marks, plan2d
from .qt import QtCore, QtWidgets
from .wording import say

ROWS = (("x", "east-west"), ("y", "north-south"), ("along", "along the wall"), ("rotate", "turn"))
#: What a freshly ticked move allows: mm, degrees.
USUAL = {"x": 500.0, "y": 500.0, "along": 500.0, "rotate": 15.0}
#: So many names are listed.
LISTED_MAX = 6
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
        self.selected.setAlignment(QtCore.Qt.AlignTop)
        # As high as the longest words, so that no button jumps while something is selected.
        self.selected.setMinimumHeight(3 * self.selected.fontMetrics().lineSpacing())
        layout.addWidget(self.selected)
        layout.addLayout(self._bounds())
        layout.addLayout(self._group())
        layout.addLayout(self._buttons())
        layout.addSpacing(12)
        layout.addLayout(self._regions())
        layout.addSpacing(12)
        self.listed = QtWidgets.QLabel()
        self.listed.setObjectName("EnfiladeListed")
        self.listed.setWordWrap(True)
        layout.addWidget(self.listed)
        layout.addStretch(1)

    def _bounds(self):
        grid = QtWidgets.QGridLayout()
        for column, title in ((1, "from"), (2, "to")):
            grid.addWidget(QtWidgets.QLabel(say(title)), 0, column)
        self.rows, self.left = {}, {}
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
            self.left[kind] = QtWidgets.QLabel()
            self.left[kind].setObjectName("EnfiladeLeft_" + kind)
            self.left[kind].setToolTip(say("Press Allow to begin anew from here."))
            grid.addWidget(self.left[kind], row, 3)
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

    def selection(self):
        """What is selected in the panel's document; refuses what is selected in another one."""
        doc = self._panel.document()
        objects = Gui.Selection.getSelection("*")
        for obj in objects:
            if obj.Document.Name != doc.Name:
                there = say(
                    "'{}' is in the document '{}', but the panel works on '{}'. Nothing was done: select there, or press "
                    "\"Switch\" above.",
                    *(obj.Label, obj.Document.Label, doc.Label),
                )
                raise PluginError(there)
        return objects

    def chosen(self, objects):
        """Walls, columns, doors and windows of these, or lines of a 2D plan; a selected axis stands for its wall."""
        if objects and plan2d.is_plan(objects[0].Document):
            return [o for o in objects if plan2d.is_line(o)]
        out = []
        for obj in objects:
            parents = [o for o in obj.InList if getattr(o, "Base", None) is obj]
            for o in [obj, *parents]:
                if document.kind_of(o) in ("Wall", "Window") or document.is_column(o):
                    if o not in out:
                        out.append(o)
        return out

    def _on_this_storey(self, objects) -> None:
        storey = self._panel.head.storey()
        away = [o for o in objects if storey is not None and document.storey_at(o) != storey]
        if away:
            there = say(
                "{} on another storey: the panel works on '{}'. Nothing was done: choose the storey above.",
                *(", ".join(f"'{o.Label}'" for o in away), storey or say("outside any level")),
            )
            raise PluginError(there)

    def _allow(self) -> None:
        selection = self.selection()
        objects = self.chosen(selection)
        if not objects:
            raise PluginError(what_is_selected(selection, objects, plan2d.is_plan(self._panel.document())))
        self._on_this_storey(objects)
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
        group = self.group.text().strip()
        are_lines = len(rest) > 1 and all(plan2d.is_line(o) for o in rest)
        if are_lines and has_moves and not group:
            # A wall of a 2D plan is several lines.
            group = rest[0].Label
        fixed = ", ".join(f"'{o.Label}'" for o in stays)
        only = say("Doors and windows only slide along the wall; {} was not marked.", fixed) if stays else ""
        if not rest and not doors:
            raise PluginError(only)
        doc = objects[0].Document
        doc.openTransaction("Enfilade: mark")
        for some, bounds in ((rest, ticked), (doors, along)):
            marks.mark_all(some, bounds, group, self.keep.isChecked())
        doc.commitTransaction()
        self.group.setModified(False)
        self._panel.refresh()
        names = shortened([o.Label for o in [*rest, *doors]])
        together = say("Marked: {}. They move together, as '{}'.", names, group)
        marked = together if are_lines and has_moves else say("Marked: {}", names)
        held = [f"'{o.Label}': {document.lock(o)}." for o in rest if has_moves and document.lock(o)]
        locked = say("Marked, but they stay: {}", " ".join(held)) if held else ""
        self._panel.tell(" ".join(w for w in (marked, only, locked) if w))

    def _unmark(self) -> None:
        selection = self.selection()
        objects = [*self.chosen(selection), *(o for o in selection if marks.region_kind(o))]
        if not objects:
            raise PluginError(what_is_selected(selection, objects, plan2d.is_plan(self._panel.document())))
        doc = objects[0].Document
        doc.openTransaction("Enfilade: remove marks")
        for obj in objects:
            marks.unmark(obj)
        doc.commitTransaction()
        self._panel.refresh()
        self._panel.tell(say("Marks removed: {}", ", ".join(o.Label for o in objects)))

    def _region(self, kind: str) -> None:
        pair_name(self.pair.text())
        closed = [o for o in self.selection() if is_closed(o)]
        if not closed:
            self._panel.bring_to_front(self._panel.document())
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
        try:
            selection, refused = self.selection(), ""
        except PluginError as e:
            selection, refused = [], str(e)
        objects = self.chosen(selection)
        doc = App.listDocuments().get(self._panel.doc_name)
        is_plan = doc is not None and not selection and plan2d.is_plan(doc)
        self.selected.setText(refused or what_is_selected(selection, objects, is_plan))
        self._list_marked()
        for label in self.left.values():
            label.setText("")
        if not objects:
            return
        first = objects[0]
        given, left = marks.bounds(first), {c.kind: c for c in marks.clauses(first, 0.0)}
        for kind, (tick, low, high) in self.rows.items():
            if marks.is_marked(first):
                for box, value in zip((low, high), given.get(kind, (0.0, 0.0))):
                    box.setValue(value)
                tick.setChecked(kind in given)
            if kind in left and marks.used(first, kind):
                ends = (number(round(v, 1)) for v in (left[kind].lower, left[kind].upper))
                self.left[kind].setText(say("left: {} to {}", *ends))
        if marks.is_marked(first):
            self.group.setText(marks.group(first))
            self.keep.setChecked(marks.keep(first))
        elif not self.group.isModified():
            # What was shown of the last one does not name this one's group.
            self.group.setText("")

    def _list_marked(self) -> None:
        """What is marked on the panel's storey, and what elsewhere."""
        doc = App.listDocuments().get(self._panel.doc_name)
        storey = self._panel.head.storey()
        by_storey = document.marked(doc) if doc is not None else {}
        here = [label for at, labels in by_storey.items() for label in labels if storey is None or at == storey]
        away = document.marked_elsewhere(doc, storey) if doc is not None and storey is not None else []
        lines = [say("Marked here: {}", shortened(here))] if here else []
        lines += [say("On other storeys, not studied here: {}", shortened(away))] if away else []
        self.listed.setText("\n".join(lines))


def shortened(names) -> str:
    return ", ".join(names[:LISTED_MAX]) + (" …" if len(names) > LISTED_MAX else "")


def what_is_selected(selection, objects, is_plan: bool = False) -> str:
    """Names what can be marked of a selection, or says what could."""
    if objects:
        return say("Selected: {}", shortened([o.Label for o in objects]))
    if not selection and is_plan:
        return say("Nothing selected. Select all lines of a wall in the view.")
    if not selection:
        return say("Nothing selected. Select walls, columns, doors or windows in the view.")
    return say(
        "{}: no wall, column, door or window, so it cannot move. A closed line can be a region: see below.",
        shortened([f"'{o.Label}'" for o in selection]),
    )


def is_closed(obj) -> bool:
    shape = getattr(obj, "Shape", None)
    is_line = shape is not None and not shape.isNull() and not shape.Solids
    return is_line and any(w.isClosed() for w in shape.Wires)
