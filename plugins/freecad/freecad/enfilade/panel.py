"""The panel: mark, study, options. Every action reports in one line at its foot; nothing is modal."""

import os
from typing import List, Optional

import FreeCAD as App
import FreeCADGui as Gui

from enfilade_common import job, program, results
from enfilade_common.model import PluginError
from enfilade_common.moves import applied, why_nothing_moves

from . import accept, document, importing, settings
from .mark_page import MarkPage
from .options_page import OptionsPage
from .overlay import BEST, MOVED, Overlay
from .qt import QtCore, QtWidgets
from .runner import Runner
from .study_page import StudyPage
from .wording import say

NAME = "EnfiladePanel"
MARK, STUDY, OPTIONS = range(3)


class Panel(QtWidgets.QDockWidget):
    """Dock with three pages; owns the run and what is drawn over the views."""

    def __init__(self, parent):
        super().__init__(say("Enfilade"), parent)
        self.setObjectName(NAME)
        self.runner = Runner(self)
        self.job: Optional[job.Job] = None
        self.round: Optional[results.Round] = None
        #: Name of the document that job and round belong to.
        self.doc_name = ""
        #: What was noted when the study was written.
        self._said: List[str] = []
        self._overlays = {}
        self.pages = QtWidgets.QTabWidget()
        self.mark = MarkPage(self)
        self.study = StudyPage(self)
        self.options = OptionsPage(self)
        for page, title in ((self.mark, "1 Mark"), (self.study, "2 Study"), (self.options, "3 Options")):
            self.pages.addTab(_scrolling(page), say(title))
        self.status = QtWidgets.QLabel("")
        self.status.setObjectName("EnfiladeStatus")
        self.status.setWordWrap(True)
        self.status.setTextInteractionFlags(QtCore.Qt.TextSelectableByMouse)
        body = QtWidgets.QWidget()
        layout = QtWidgets.QVBoxLayout(body)
        layout.addWidget(self.pages)
        layout.addWidget(self.status)
        self.setWidget(body)
        self.setMinimumWidth(380)
        self.runner.progressed.connect(self._on_progress)
        self.runner.ended.connect(self._on_end)
        self._watcher = Watcher(self)
        self._later = QtCore.QTimer(self)
        self._later.setSingleShot(True)
        self._later.timeout.connect(self.refresh)
        self.refresh()

    # -- what every page uses

    def document(self):
        doc = App.ActiveDocument
        if doc is None:
            raise PluginError(say("Open or create a document first."))
        return doc

    def tell(self, text: str) -> None:
        self.status.setText(text)
        if text:
            App.Console.PrintLog(f"Enfilade: {text}\n")

    def attempt(self, action, *values):
        """Does something of the user's; what stands against it is said at the foot of the panel."""
        try:
            return action(*values)
        except PluginError as e:
            self.tell(str(e))
            App.Console.PrintWarning(f"Enfilade: {e}\n")
        return None

    def refresh_later(self) -> None:
        self._later.start(150)

    def refresh(self) -> None:
        """Shows marks and pages as the active document has them."""
        doc = App.ActiveDocument
        self.mark.refresh()
        self.study.refresh(doc)
        if doc is not None:
            overlay = self.overlay(doc)
            if overlay is not None:
                overlay.show_marks(doc)

    def overlay(self, doc) -> Optional[Overlay]:
        """Our node in the document's view."""
        gui = Gui.getDocument(doc.Name)
        view = gui.activeView() if gui else None
        if view is None or not hasattr(view, "getSceneGraph"):
            return None
        known = self._overlays.get(doc.Name)
        if known is None or known[0] is not gui:
            self._overlays[doc.Name] = (gui, Overlay(view))
        return self._overlays[doc.Name][1]

    def forget(self, doc_name: str) -> None:
        """A document is closed: nothing of ours may outlive it."""
        self._overlays.pop(doc_name, None)
        if doc_name == self.doc_name:
            if self.runner.is_running():
                self.runner.stop()
            self.job = self.round = None
            self.doc_name = ""
            self.options.clear()
            self.tell(say("The document was closed."))

    # -- run

    def run(self) -> None:
        self.attempt(self._run)

    def _run(self) -> None:
        if self.runner.is_running():
            raise PluginError(say("A study is running; stop it first."))
        doc = self.document()
        path = program.find(settings.program_path())
        program.version(path)
        wishes, storey = self.study.wishes(), self.study.storey()
        study, reading = document.study(doc, wishes, storey, settings.lineage(doc))
        self.clear_preview()
        self.round = None
        self.options.clear()
        self.job = job.write(study, settings.job_folder(doc))
        self.doc_name = doc.Name
        settings.remember(doc, wishes, storey or "")
        self.pages.setCurrentIndex(STUDY)
        self.study.begin()
        self._said = [*settings.folder_notice(doc), *reading.notes, *self.job.notes]
        self.tell(" ".join([say("Starting …"), *self._said]))
        self.runner.start(path, self.job.drawing)

    def stop(self) -> None:
        if self.runner.is_running():
            self.tell(say("Stopping …"))
            self.runner.stop()

    def export(self) -> None:
        """Writes the drawing and its side-car without running anything."""

        def write():
            if self.runner.is_running():
                raise PluginError(say("A study is running; stop it first."))
            doc = self.document()
            study, reading = document.study(doc, self.study.wishes(), self.study.storey(), settings.lineage(doc))
            made = job.write(study, settings.job_folder(doc))
            self.tell(" ".join([say("Written to {}", made.drawing), *settings.folder_notice(doc), *reading.notes, *made.notes]))

        self.attempt(write)

    def _on_progress(self, progress) -> None:
        self.study.progress(progress)
        if progress.best_parameters and self.job is not None and self.job.plan is not None:
            self._show_best(self.job.plan, progress.best_parameters)

    def _show_best(self, plan, parameters) -> None:
        """The best layout so far, as the program's progress tells it."""
        doc = App.listDocuments().get(self.doc_name)
        overlay = self.overlay(doc) if doc is not None else None
        if overlay is None or len(parameters) != len(plan.tables):
            return
        after = [ring for o, ring in zip(plan.outlines, applied(plan, parameters)) if ring != o.points]
        overlay.show_ghosts([], after, self.top(doc), BEST)

    def _on_end(self, code: int, words: str) -> None:
        self.study.end()
        if self.doc_name not in App.listDocuments():
            return
        self.clear_preview()
        if code not in (0, 1):
            self.tell(words)
            return
        self.attempt(self._load, words)

    def _load(self, words: str) -> None:
        self.round = results.latest(self.job)
        self.options.show_round(self.round)
        if not self.round.options:
            still = "; ".join(why_nothing_moves(self.job.study))
            none = say("No better layout was found within what may move.")
            self.tell(say("Nothing may move: {}. The present layout was measured.", still) if still else none)
            return
        self.pages.setCurrentIndex(OPTIONS)
        done = say("Done: {} options.", len(self.round.options))
        notes = dict.fromkeys([*self._said, *self.job.notes])
        self.tell(" ".join([done, words, *notes, *self.round.problems[:3]]).strip())

    # -- look

    def look(self) -> None:
        """Options of the newest run of this document, read again where it was made outside."""

        def load():
            if self.runner.is_running():
                raise PluginError(say("A study is running; stop it first."))
            doc = self.document()
            try:
                self._look(doc)
            except PluginError:
                if self.doc_name != doc.Name:
                    self._show_nothing()
                raise
            self.pages.setCurrentIndex(OPTIONS)

        self.attempt(load)

    def _show_nothing(self) -> None:
        """What is shown of one document must not pass for another's."""
        self.job = self.round = None
        self.doc_name = ""
        self.clear_preview()
        self.options.clear()

    def _look(self, doc) -> None:
        there = job.read(settings.job_folder(doc))
        newest = results.latest(there)
        shown = self.round
        if shown is not None and self.doc_name == doc.Name and shown.folder == newest.folder:
            if self.job is not None and self.job.sha256 == there.sha256:
                return
        self.job, self.doc_name, self._said = there, doc.Name, []
        self.clear_preview()
        self._load("")

    def bring(self, path: str) -> None:
        """Opens a candidate as a document of its own."""

        def opened():
            made = importing.as_document(path)
            self.tell(say("Opened as the document '{}': {} objects.", made.Label, len(made.Objects)))

        self.attempt(opened)

    def clear_preview(self) -> None:
        for _, overlay in self._overlays.values():
            overlay.clear("heat", "ghost")

    def top(self, doc) -> float:
        return max((o.Shape.BoundBox.ZMax for o in self._walls(doc)), default=0.0)

    def floor(self, doc) -> float:
        return min((o.Shape.BoundBox.ZMin for o in self._walls(doc)), default=0.0)

    def _walls(self, doc):
        names = {w.name for w in self.job.study.walls}
        return [o for o in doc.Objects if o.Name in names and hasattr(o, "Shape") and not o.Shape.isNull()]

    def preview(self, option: Optional[results.Option], measure: str, with_ghosts: bool) -> None:
        """Heat map and ghost walls of an option, or of the present layout."""
        doc = App.listDocuments().get(self.doc_name)
        overlay = self.overlay(doc) if doc is not None else None
        if overlay is None or self.round is None:
            return
        overlay.clear("heat", "ghost")
        drawing = option.file if option else os.path.join(self.round.folder, "initial.dxf")
        if measure:
            try:
                overlay.show_heat(results.heat_cells(drawing, measure), self.floor(doc))
            except (OSError, ValueError, KeyError) as e:
                self.tell(f"{drawing}: {e}")
        if option is not None and with_ghosts:
            after = results.outlines_after(self.job, option)
            before = [o.points for o in self.job.outlines if o.host_id in after]
            overlay.show_ghosts(before, list(after.values()), self.top(doc), MOVED)

    # -- accept

    def accept(self) -> None:
        self.attempt(self._accept)

    def _accept(self) -> None:
        option = self.options.chosen()
        if self.round is None or option is None:
            raise PluginError(say("Choose an option first."))
        doc = App.listDocuments().get(self.doc_name)
        if doc is None:
            raise PluginError(say("The document was closed."))
        entry = results.lineage_entry(self.round, option, os.path.basename(self.job.drawing))
        remember = lambda: settings.remember_accepted(doc, entry)  # noqa: E731
        around = accept.changed_around(doc, self.job, option)
        moved = list(dict.fromkeys(accept.accept(doc, self.job, self.round, option, remember)))
        self.clear_preview()
        self.refresh()
        done = say("Accepted option {}: {} moved. Undo takes all of it back.", option.number or "best", ", ".join(moved))
        there = say("This was in the document '{}', which is not the one in front.", doc.Label)
        is_in_front = App.ActiveDocument is not None and App.ActiveDocument.Name == doc.Name
        self.tell(" ".join(w for w in (done, "" if is_in_front else there, around) if w))

    def shut(self) -> None:
        """Takes everything of ours away."""
        self.runner.stop()
        self._watcher.stop()
        for _, overlay in self._overlays.values():
            overlay.remove()
        self._overlays.clear()


class Watcher:
    """Tells the panel of selections, of edited marks, of documents that come and go."""

    def __init__(self, panel: Panel):
        self._panel = panel
        App.addDocumentObserver(self)
        Gui.Selection.addObserver(self)

    def stop(self) -> None:
        App.removeDocumentObserver(self)
        Gui.Selection.removeObserver(self)

    def slotChangedObject(self, obj, name):
        if name.startswith("Enfilade") or name == "Shape" and hasattr(obj, "EnfiladeId"):
            self._panel.refresh_later()

    def slotCreatedObject(self, obj):
        self._panel.mark.object_created(obj)

    def slotDeletedObject(self, obj):
        if hasattr(obj, "EnfiladeId") or hasattr(obj, "EnfiladeRegion"):
            self._panel.refresh_later()

    def slotUndoDocument(self, doc):
        self._panel.refresh_later()

    def slotRedoDocument(self, doc):
        self._panel.refresh_later()

    def slotActivateDocument(self, doc):
        self._panel.refresh_later()

    def slotDeletedDocument(self, doc):
        self._panel.forget(doc.Name)

    def addSelection(self, *_):
        self._panel.mark.refresh_later()

    def removeSelection(self, *_):
        self._panel.mark.refresh_later()

    def setSelection(self, *_):
        self._panel.mark.refresh_later()

    def clearSelection(self, *_):
        self._panel.mark.refresh_later()


def _scrolling(page):
    area = QtWidgets.QScrollArea()
    area.setWidgetResizable(True)
    area.setFrameShape(QtWidgets.QFrame.NoFrame)
    area.setWidget(page)
    return area


def panel() -> Panel:
    """The one panel of the window, made at first use."""
    window = Gui.getMainWindow()
    found = window.findChild(QtWidgets.QDockWidget, NAME)
    if found is None or not hasattr(found, "runner"):
        found = Panel(window)
        window.addDockWidget(QtCore.Qt.RightDockWidgetArea, found)
    found.show()
    found.raise_()
    return found
