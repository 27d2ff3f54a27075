"""The panel: mark, study, options. Every action reports in one line at its foot; nothing is modal."""

import os
from dataclasses import dataclass
from typing import List, Optional

import FreeCAD as App
import FreeCADGui as Gui

from enfilade_common import job, preview, program, results
from enfilade_common.model import UNITS, PluginError
from enfilade_common.moves import applied, why_nothing_moves

from . import accept, document, importing, plan2d, settings
from .frame import Foot, Head
from .heat import HeatMaps
from .mark_page import MarkPage
from .options_page import OptionsPage
from .overlay import BEST, MOVED, Overlay
from .qt import QtCore, QtWidgets
from .read_row import ReadRow
from .runner import Runner
from .study_page import StudyPage
from .wording import accepted, count, note_here, say

NAME = "EnfiladePanel"
MARK, STUDY, OPTIONS = range(3)


@dataclass
class Running:
    """A run that goes on: its job, what was noted when it was written, what stood there before, the program."""

    job: job.Job
    said: List[str]
    before: List[str]
    version: str


class Panel(QtWidgets.QDockWidget):
    """Dock with three pages; owns the run and what is drawn over the views. It works on one document, whichever is
    in front: FreeCAD brings another view to the front when the mouse goes from a view to the panel."""

    def __init__(self, parent):
        super().__init__(say("Enfilade"), parent)
        self.setObjectName(NAME)
        self.runner = Runner(self)
        self.heat = HeatMaps(self)
        #: Name of the document that the panel works on.
        self.doc_name = ""
        #: What is shown: a round, the job it belongs to, what was noted when that was written.
        self.job: Optional[job.Job] = None
        self.round: Optional[results.Round] = None
        self._said: List[str] = []
        self._running: Optional[Running] = None
        self._overlays = {}
        self.head, self.foot = Head(self), Foot(self)
        self.status = self.foot.status
        self.pages = QtWidgets.QTabWidget()
        self.mark = MarkPage(self)
        self.study = StudyPage(self)
        self.options = OptionsPage(self)
        self.row = ReadRow(self)
        for page, title in ((self.mark, "1 Mark"), (self.study, "2 Study"), (self.options, "3 Options")):
            self.pages.addTab(_scrolling(page), say(title))
        body = QtWidgets.QWidget()
        layout = QtWidgets.QVBoxLayout(body)
        layout.addWidget(self.head)
        layout.addWidget(self.row)
        layout.addWidget(self.pages, 1)
        layout.addWidget(self.foot)
        self.setWidget(body)
        self.setMinimumWidth(380)
        self.pages.currentChanged.connect(lambda _: self.refresh())
        self.runner.progressed.connect(self._on_progress)
        self.runner.ended.connect(self._on_end)
        self.heat.measured.connect(self.options.measured)
        self.heat.failed.connect(lambda words: self.tell(f"{self.status.text()} {words}"))
        self._watcher = Watcher(self)
        self._later = QtCore.QTimer(self)
        self._later.setSingleShot(True)
        self._later.timeout.connect(self.refresh)
        self.refresh()

    # -- what every page uses

    def document(self):
        """The document that the panel works on; the one in front where it has none yet."""
        doc = App.listDocuments().get(self.doc_name)
        if doc is None and App.ActiveDocument is not None:
            doc = App.ActiveDocument
            self._bind(doc)
        if doc is None:
            raise PluginError(say("Open or create a document first."))
        return doc

    def _bind(self, doc) -> None:
        self.doc_name = doc.Name
        self._show_nothing()

    def switch(self) -> None:
        """Works on the document in front from now on."""
        self._refuse_running()
        self._bind(App.ActiveDocument)
        self.refresh()
        self.tell(say("The panel works on '{}' now.", App.ActiveDocument.Label))

    def bring_to_front(self, doc) -> None:
        """What is worked on is what is seen."""
        App.setActiveDocument(doc.Name)
        for window in Gui.getMainWindow().findChildren(QtWidgets.QMdiSubWindow):
            shown = window.widget().windowTitle() if window.widget() is not None else ""
            if shown.split(" : ")[0] == doc.Label:
                window.mdiArea().setActiveSubWindow(window)
                return

    def _refuse_running(self) -> None:
        if self.runner.is_running():
            raise PluginError(say("A study is running; stop it first."))

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
        """Shows marks and pages as the document has them."""
        try:
            doc = self.document()
        except PluginError:
            doc = None
        self.head.refresh(doc)
        self.mark.refresh()
        self.study.refresh(doc)
        self.row.refresh(doc)
        if doc is not None:
            overlay = self.overlay(doc)
            if overlay is not None:
                overlay.show_marks(doc, self._scale(doc))

    def enterEvent(self, event):
        """Levels and regions may have been drawn since the mouse was last here."""
        self.refresh_later()
        super().enterEvent(event)

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
            self.runner.stop()
            self.doc_name = ""
            self._show_nothing()
            self.tell(say("The document was closed."))
        self.refresh_later()

    # -- run

    def run(self) -> None:
        self.attempt(self._run)

    def _run(self) -> None:
        self._refuse_running()
        doc = self.document()
        path = self.program()
        version = program.version(path)
        made, said = self._written(doc)
        settings.remember(doc, made.study.wishes, self.head.storey() or "")
        self.bring_to_front(doc)
        self._running = Running(made, said, results.round_folders(made.results_folder), version)
        self.foot.begin()
        where = say("'{}', storey '{}'", doc.Label, made.study.storey) if made.study.storey else f"'{doc.Label}'"
        self.tell(" ".join([say("Starting {} …", where), *said]))
        self.runner.start(path, made.drawing)

    def _written(self, doc):
        """The job of the document as it stands, and what is to be noted of it."""
        study, reading = document.study(doc, self.study.wishes(), self.head.storey(), settings.lineage(doc))
        source = self.row.behind(doc, study)
        made = job.write(study, settings.job_folder(doc), source.match)
        self.row.sources.remember(doc, source.match)
        warned = [source.words] if source.is_warning else []
        return made, [*settings.folder_notice(doc), *warned, *reading.notes, *made.notes]

    def stop(self) -> None:
        if self.runner.is_running():
            waits = self.runner.stop()
            kept = say("Stopping: the best so far is being kept. Press Stop again to end at once.")
            self.tell(kept if waits else say("Stopping …"))

    def export(self) -> None:
        """Writes the drawing and its side-car without running anything."""

        def write():
            self._refuse_running()
            made, said = self._written(self.document())
            self.tell(" ".join([say("Written to {}", made.drawing), *said]))

        self.attempt(write)

    def _on_progress(self, progress) -> None:
        self.foot.progress(progress)
        if progress.best_parameters and self._running is not None:
            self._show_best(self._running.job.plan, progress.best_parameters)

    def _show_best(self, plan, parameters) -> None:
        """The best layout so far, as the program's progress tells it."""
        doc = App.listDocuments().get(self.doc_name)
        overlay = self.overlay(doc) if doc is not None else None
        if overlay is None or len(parameters) != len(plan.tables):
            return
        scale = self._scale(doc)
        ways = [p if t.clause.kind == "rotate" else p * scale for t, p in zip(plan.tables, parameters)]
        pairs = zip(plan.outlines, applied(plan, ways))
        lines = [line for o, ring in pairs for line in preview.moved_lines(o.points, ring)[1]]
        overlay.show_best(lines, self.top(doc), BEST)

    def _scale(self, doc) -> float:
        """Units of the document in a mm of the building: of a 2D plan what page 2 or the last round says."""
        if not plan2d.is_plan(doc):
            return 1.0
        read = self.row.reading
        said = self.study.wishes().unit or (read.unit if read is not None and self.round is None else "")
        known = self.round.per_metre if self.round is not None and not said else 1000.0
        return (self.row.source.scale / UNITS[said] if said else known) / 1000.0

    def _on_end(self, code: int, words: str) -> None:
        self.foot.end()
        running, self._running = self._running, None
        if running is None or self.doc_name not in App.listDocuments():
            return
        for _, overlay in self._overlays.values():
            overlay.clear("best")
        if code in (0, 1):
            self.attempt(self._finish, running)
        elif code == program.STOPPED:
            self.attempt(self._stopped, running)
        else:
            self.tell(words)

    def _finish(self, running: Running) -> None:
        found = results.made_since(running.job, running.before, running.version)
        self._load(running.job, found, running.said)

    def _stopped(self, running: Running) -> None:
        """What a stopped run had found is shown; where it had found nothing, what was shown stays."""
        folder = self.runner.so_far
        found = results.keep_so_far(running.job, folder) if folder else None
        if found is not None and found.options:
            self._load(running.job, found, running.said)
            return
        stays = say("The options shown are those of the run before.") if self.round is not None else ""
        self.tell(" ".join(w for w in (say("Stopped. Nothing better had been found yet."), stays) if w))

    def program(self) -> str:
        return program.find(settings.program_path())

    def _load(self, made: job.Job, found: results.Round, said: List[str]) -> None:
        """Shows a round with its notes."""
        self.clear_preview()
        self.job, self.round, self._said = made, found, said
        drawings = [option.file if option else self._drawing(None) for option in self.options.layouts(found)]
        self.attempt(lambda: self.heat.begin(self.program(), found, drawings, made.study.wishes.level))
        labels = made.labels()
        notes = [results.Note("warning", "", n) for n in dict.fromkeys(said)]
        notes += [note_here(n, labels) for n in found.notes]
        notes.sort(key=lambda n: not n.is_warning)
        self.options.show_round(found, notes)
        self.pages.setCurrentIndex(OPTIONS)
        # Who marks works alone does not ask why nothing moves.
        still = "" if made.study.rebuilt() else "; ".join(why_nothing_moves(made.study))
        if not found.options:
            none = say("No better layout was found within what is marked.")
            done = say("Nothing may move: {}. The present layout was measured.", still) if still else none
        elif still and all(option.works for option in found.options):
            done = say("Nothing may move: {}. The options build.", still)
        elif found.is_so_far:
            done = count(len(found.options), "Stopped. Best so far: {} option.", "Stopped. Best so far: {} options.")
        else:
            done = count(len(found.options), "Done: {} option.", "Done: {} options.")
        self.tell(done)

    # -- look

    def look(self) -> None:
        """Options of the newest run of this document, read again where it was made outside."""

        def load():
            self._refuse_running()
            doc = self.document()
            there = job.read(settings.job_folder(doc))
            newest = results.latest(there)
            if self.round is None or self.round.folder != newest.folder or self.job.sha256 != there.sha256:
                self._load(there, newest, there.notes)
            self.pages.setCurrentIndex(OPTIONS)

        self.attempt(load)

    def _show_nothing(self) -> None:
        """What is shown of one document must not pass for another's."""
        self.job = self.round = None
        self.heat.stop()
        self.clear_preview()
        self.options.clear()

    def bring(self, path: str) -> None:
        """Opens a candidate as a document of its own."""

        def opened():
            made = importing.as_document(path)
            objects = count(len(made.Objects), "{} object", "{} objects")
            self.tell(say("Opened as the document '{}': {}.", made.Label, objects))

        self.attempt(opened)

    def clear_preview(self) -> None:
        for _, overlay in self._overlays.values():
            overlay.clear("heat", "ghost", "best")

    def _drawing(self, option: Optional[results.Option]) -> str:
        """The file of an option, or of the present layout."""
        return option.file if option else os.path.join(self.round.folder, "initial.dxf")

    def top(self, doc) -> float:
        return max((o.Shape.BoundBox.ZMax for o in self._walls(doc)), default=0.0)

    def floor(self, doc) -> float:
        return min((o.Shape.BoundBox.ZMin for o in self._walls(doc)), default=0.0)

    def _walls(self, doc):
        made = self._running.job if self._running is not None else self.job
        names = {e.name for e in made.study.movables()}
        return [o for o in doc.Objects if o.Name in names and hasattr(o, "Shape") and not o.Shape.isNull()]

    def preview(self, option: Optional[results.Option], measure: str, with_ghosts: bool) -> None:
        """Heat map and ghost walls of an option, or of the present layout."""
        doc = App.listDocuments().get(self.doc_name)
        overlay = self.overlay(doc) if doc is not None else None
        if overlay is None or self.round is None:
            return
        overlay.clear("heat", "ghost")
        cells = self.heat.of(self._drawing(option)) if measure else None
        if cells is not None:
            span = self.heat.span(measure)
            overlay.show_heat(cells, measure, span, self.round.spacing_m * self.round.per_metre, self.floor(doc))
            self.options.show_span(measure, span)
        if option is not None and with_ghosts:
            overlay.show_ghosts(*preview.ghosts(self.job, option), self.top(doc), MOVED)

    # -- accept

    def accept(self) -> None:
        self.attempt(self._accept)

    def _accept(self) -> None:
        self._refuse_running()
        option = self.options.chosen()
        if self.round is None or option is None:
            raise PluginError(say("Choose an option first."))
        doc = App.listDocuments().get(self.doc_name)
        if doc is None:
            raise PluginError(say("The document was closed."))
        entry = results.lineage_entry(self.round, option, os.path.basename(self.job.drawing))
        remember = lambda: settings.remember_accepted(doc, entry)  # noqa: E731
        around = accept.changed_around(doc, self.job, option)
        moved = [self.job.study.element(c.id).label for c in results.layout(self.job, option)]
        accept.accept(doc, self.job, self.round, option, remember)
        self.clear_preview()
        self.refresh()
        done = accepted(option, list(dict.fromkeys(moved)))
        there = say("This was in the document '{}', which is not the one in front.", doc.Label)
        is_in_front = App.ActiveDocument is not None and App.ActiveDocument.Name == doc.Name
        self.tell(" ".join(w for w in (done, "" if is_in_front else there, around) if w))

    def shut(self) -> None:
        """Takes everything of ours away."""
        self.runner.stop()
        self.heat.stop()
        self.row.stop()
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
        if name == "EnfiladeRegion" or not name.startswith("Enfilade"):
            self._panel.mark.document_changed()
        if name.startswith("Enfilade") or name == "Shape" and hasattr(obj, "EnfiladeId"):
            self._panel.refresh_later()

    def slotCreatedObject(self, obj):
        self._panel.mark.document_changed()
        self._panel.mark.object_created(obj)

    def slotDeletedObject(self, obj):
        self._panel.mark.document_changed()
        if hasattr(obj, "EnfiladeId") or hasattr(obj, "EnfiladeRegion"):
            self._panel.refresh_later()

    def slotUndoDocument(self, doc):
        self._panel.refresh_later()

    def slotRedoDocument(self, doc):
        self._panel.refresh_later()

    def slotRelabelDocument(self, doc):
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
