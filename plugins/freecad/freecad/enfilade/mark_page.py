"""Page 1: what may be done with what is selected, and the regions."""

import FreeCAD as App
import FreeCADGui as Gui

from enfilade_common.model import PluginError, number, pair_name

from . import document, marks, plan2d
from .allow_rows import MOVE_ROWS, Rows, given, moves_of, show_tick, works_of
from .offers import Offers, said, shortened
from .qt import QtCore, QtWidgets
from .wording import say

REGIONS = (("query", "People are here"), ("reference", "They look at this"), ("keep", "Nothing moves here"))


class MarkPage(QtWidgets.QWidget):
    """What may be done with the selected objects, the marks on them, buttons for regions."""

    def __init__(self, panel):
        super().__init__()
        self._panel = panel
        self._awaited_region = ""
        self._offers = Offers()
        #: What was selected, and marked on it, when the rows were filled: until this changes, what is ticked stays.
        self._filled = None
        #: Whether the selected objects are of several groups.
        self._has_groups = False
        self._later = QtCore.QTimer(self)
        self._later.setSingleShot(True)
        self._later.timeout.connect(self.refresh)
        layout = QtWidgets.QVBoxLayout(self)
        self.selected = QtWidgets.QLabel()
        self.selected.setObjectName("EnfiladeSelected")
        self.selected.setWordWrap(True)
        self.selected.setAlignment(QtCore.Qt.AlignTop)
        layout.addWidget(self.selected)
        self.can = QtWidgets.QLabel()
        self.can.setObjectName("EnfiladeCan")
        self.can.setWordWrap(True)
        self.can.setAlignment(QtCore.Qt.AlignTop)
        # High enough for most words, so that few buttons jump while something is selected.
        self.can.setMinimumHeight(4 * self.can.fontMetrics().lineSpacing())
        layout.addWidget(self.can)
        self.rows = Rows()
        layout.addWidget(self.rows)
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

    def _group(self):
        row = QtWidgets.QHBoxLayout()
        row.addWidget(QtWidgets.QLabel(say("Group")))
        self.group = QtWidgets.QLineEdit()
        self.group.setObjectName("EnfiladeGroup")
        self.group.setToolTip(say("Objects with the same group name move together"))
        row.addWidget(self.group)
        self.keep = QtWidgets.QCheckBox(say("Must stay"))
        self.keep.setObjectName("EnfiladeKeep")
        self.keep.toggled.connect(self.rows.keep)
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

    def _settle(self) -> None:
        """What was just selected is shown before anything is done with it: no tick of the selection before counts."""
        if self._later.isActive():
            self._later.stop()
            self.refresh()

    def _allow(self) -> None:
        selection = self.selection()
        objects = self.chosen(selection)
        if not objects:
            raise PluginError(what_is_selected(selection, objects, plan2d.is_plan(self._panel.document())))
        self._on_this_storey(objects)
        self._settle()
        if not self._is_said():
            self._take_back(objects)
            return
        asked = {o.Name: self.rows.sizes(self._kinds(o, self._offer(o)), given(o)) for o in objects}
        moving = [o for o in objects if moves_of(asked[o.Name])]
        group, together = self.group.text().strip(), ""
        if len(moving) > 1 and all(plan2d.is_line(o) for o in moving) and not self._has_groups:
            # A wall of a 2D plan is several lines.
            group = together = group or moving[0].Label
        done = [o for o in objects if asked[o.Name] or group or self.keep.isChecked() or marks.is_marked(o)]
        self._write(done, asked, group)
        self._tell_marked(done, [o for o in objects if o not in done], asked, together)

    def _is_said(self) -> bool:
        return self.rows.is_any_ticked() or bool(self.group.text().strip()) or self._has_groups or self.keep.isChecked()

    def _take_back(self, objects) -> None:
        """No tick is left: what was marked is so no more."""
        if not any(marks.is_marked(o) for o in objects):
            raise PluginError(say("Tick what may be done with it, name its group, or tick that it must stay."))
        self._unmark()

    def _write(self, objects, asked, group: str) -> None:
        if not objects:
            return
        doc = objects[0].Document
        known = marks.ids(doc)
        is_kept = self.keep.checkState()
        doc.openTransaction("Enfilade: mark")
        for obj in objects:
            sizes = asked[obj.Name]
            own_group = marks.group(obj) if self._has_groups and not self.group.isModified() else group
            kept = marks.keep(obj) if is_kept == QtCore.Qt.PartiallyChecked else is_kept == QtCore.Qt.Checked
            marks.mark(obj, moves_of(sizes), own_group, kept, known, [] if kept else works_of(sizes))
        doc.commitTransaction()
        self.group.setModified(False)
        self._filled = None
        self._panel.refresh()

    def _tell_marked(self, done, stays, asked, together: str) -> None:
        names = shortened([o.Label for o in done])
        marked = say("Marked: {}. They move together, as '{}'.", names, together) if together else say("Marked: {}", names)
        left = ", ".join(f"'{o.Label}'" for o in stays)
        only = say("What is ticked is not possible with {}.", left) if stays else ""
        held = [f"'{o.Label}': {document.lock(o)}." for o in done if moves_of(asked[o.Name]) and document.lock(o)]
        locked = say("Marked, but they stay: {}", " ".join(held)) if held else ""
        told = [w for w in (marked if done else "", only, locked) if w]
        self._panel.tell(" ".join(w if w.endswith(".") or w is told[-1] else w + "." for w in told))

    def _offer(self, obj):
        return self._offers.of(obj, self._panel.head.storey(), self._panel.study.wishes().level)

    def _kinds(self, obj, offer):
        """What an object may be allowed, and what it was, so that it can be taken away."""
        return {*offer.moves, *offer.works, *given(obj)}

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
        self._show(objects)

    def document_changed(self) -> None:
        """What may be done is asked anew."""
        self._offers.forget()

    def _show(self, objects) -> None:
        """What may be done with the selected objects, and what was marked on them."""
        offers = [(o, self._offer(o)) for o in objects]
        self.can.setText(said(offers))
        self.rows.offer({k for o, offer in offers for k in self._kinds(o, offer)} if objects else {k for k, _ in MOVE_ROWS})
        now = [(o.Document.Name, o.Name, given(o), marks.group(o), marks.keep(o)) for o in objects]
        if now != self._filled:
            self._filled = now
            self._fill(offers)
        for kind, row in self.rows.rows.items():
            row.left.setText(what_is_left(objects[0], kind) if objects else "")

    def _fill(self, offers) -> None:
        """The marks of what is selected, and none of what was selected before."""
        self.rows.show_given({k: [given(o) for o, offer in offers if k in self._kinds(o, offer)] for k in self.rows.rows})
        groups = list(dict.fromkeys(marks.group(o) for o, _ in offers)) or [""]
        self._has_groups = len(groups) > 1
        self.group.setText("" if self._has_groups else groups[0])
        self.group.setPlaceholderText(say("several") if self._has_groups else "")
        kept = [marks.keep(o) for o, _ in offers]
        show_tick(self.keep, sum(kept), len(kept))

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


def what_is_left(obj, kind: str) -> str:
    """What accepted options have left of a move's bounds."""
    left = {c.kind: c for c in marks.clauses(obj, 0.0)} if marks.bounds(obj) else {}
    if kind not in left or not marks.used(obj, kind):
        return ""
    return say("left: {} to {}", *(number(round(v, 1)) for v in (left[kind].lower, left[kind].upper)))


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
