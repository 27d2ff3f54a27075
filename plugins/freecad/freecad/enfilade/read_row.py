"""Of a plan of lines: which file is behind it, how it is read, and how wide a door is."""

import os
from typing import Optional

import FreeCAD as App
import FreeCADGui as Gui

from enfilade_common import job, program
from enfilade_common.model import PluginError
from enfilade_common.reading import DOOR_M, Reading, reading_of

from . import document, plan2d
from .asked import Asked
from .qt import QtCore, QtWidgets
from .source import Source, Sources
from .wording import count, say

#: A document of more objects is read when the user asks for it.
OBJECTS_MAX = 2500

WARNING = "color: #b00020"
DRAWING = "EnfiladeDrawingLabel"


class ReadRow(QtWidgets.QWidget):
    """The file behind the shapes, and in one line how the program reads them."""

    def __init__(self, panel):
        super().__init__()
        self._panel = panel
        self.sources = Sources()
        self.source = Source()
        self.reading: Optional[Reading] = None
        self._job: Optional[job.Job] = None
        self._read_for = None
        self._asked = Asked(self)
        layout = QtWidgets.QGridLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setColumnStretch(0, 1)
        self.file, self.read, self.asked = (QtWidgets.QLabel() for _ in range(3))
        for label, name in ((self.file, DRAWING), (self.read, "EnfiladeRead"), (self.asked, "EnfiladeDoorAsked")):
            label.setObjectName(name)
            label.setWordWrap(True)
        self.choose = self._button(say("Drawing behind …"), "EnfiladeBehind", self._choose)
        self.again = self._button(say("How is it read?"), "EnfiladeReadAgain", lambda: self.look(self._panel.document()))
        self.show_door = self._button(say("Show it"), "EnfiladeShowDoor", self._show_door)
        self.answers = QtWidgets.QHBoxLayout()
        layout.addWidget(self.file, 0, 0)
        layout.addWidget(self.choose, 0, 1)
        layout.addWidget(self.read, 1, 0)
        layout.addWidget(self.again, 1, 1)
        layout.addWidget(self.asked, 2, 0)
        layout.addWidget(self.show_door, 2, 1)
        layout.addLayout(self.answers, 3, 0, 1, 2)
        self._say_nothing()
        self.setVisible(False)

    def _button(self, words: str, name: str, action):
        button = QtWidgets.QPushButton(words)
        button.setObjectName(name)
        button.clicked.connect(lambda _=False: self._panel.attempt(action))
        return button

    # -- the file

    def behind(self, doc, study) -> Source:
        """The file behind a study's lines; what it says is shown from now on."""
        self.source = self.sources.of(doc, study.drawn)
        self._show_file()
        return self.source

    def _show_file(self) -> None:
        self.file.setText(self.source.words)
        self.file.setStyleSheet(WARNING if self.source.is_warning else "")

    def _choose(self) -> None:
        doc = self._panel.document()
        names = say("Drawings") + " (*.dxf *.DXF)"
        path = QtWidgets.QFileDialog.getOpenFileName(self._panel, say("Drawing behind these shapes"), "", names)[0]
        if path:
            self.use(doc, path)

    def use(self, doc, path: str) -> None:
        """The user says which file it is."""
        study, _ = document.study(doc, self._panel.study.wishes(), self._panel.head.storey())
        self.source = self.sources.choose(doc, os.path.abspath(path), study.drawn)
        self._show_file()
        self.look(doc)

    # -- how it is read

    def refresh(self, doc) -> None:
        """Shown for a plan of lines; a plan that is new here is read once."""
        is_plan = doc is not None and plan2d.is_plan(doc)
        self.setVisible(is_plan)
        if not is_plan:
            self._read_for = None
        elif self._read_for != doc.Name:
            self._read_for = doc.Name
            self._say_nothing()
            if len(doc.Objects) <= OBJECTS_MAX:
                QtCore.QTimer.singleShot(0, lambda: self._look_first(doc.Name))

    def _look_first(self, name: str) -> None:
        """Once the panel is there: a large plan takes a while."""
        doc = App.listDocuments().get(name)
        if doc is not None and self._read_for == name and self.reading is None:
            self.look(doc)

    def look(self, doc) -> None:
        """Asks the program how it reads the plan as it stands."""
        self._read_for = doc.Name
        try:
            study, _ = document.study(doc, self._panel.study.wishes(), self._panel.head.storey())
            source = self.behind(doc, study)
            self._job = job.write(study, self._asked.open(), source.match)
            path = self._panel.program()
        except PluginError as e:
            self.read.setText(str(e))
            return
        self._asked.start(path, program.check_arguments(self._job.drawing), self._finished, self._not_begun)

    def stop(self) -> None:
        self._asked.stop()

    def _finished(self, text: str) -> None:
        try:
            self._show(reading_of(text))
        except PluginError as e:
            self._say_unread(str(e))

    def _not_begun(self) -> None:
        self.stop()
        self._say_unread(say("The program cannot be started."))

    def _say_unread(self, why: str) -> None:
        self.reading = None
        self.read.setText(why)
        self._ask()

    def _say_nothing(self) -> None:
        self.reading, self.source = None, Source()
        for label in (self.file, self.read, self.asked):
            label.setText("")
        self._ask()

    def _show(self, reading: Reading) -> None:
        self.reading = reading
        words = say(
            "Read in {}: {}, {}, {}.",
            reading.unit,
            count(reading.walls, "{} wall", "{} walls"),
            count(reading.doors, "{} door", "{} doors"),
            count(reading.rooms, "{} room", "{} rooms"),
        )
        if not reading.is_plausible:
            wide = f"{reading.door_m:.2f}"
            words += " " + say("Doors are {} m wide. Usual are {} to {} m: is the unit right?", wide, *DOOR_M)
        self.read.setText(words)
        self.read.setStyleSheet("" if reading.is_plausible else WARNING)
        self._ask()

    def _ask(self) -> None:
        """One button for every width that the door may have."""
        while self.answers.count():
            item = self.answers.takeAt(0)
            if item.widget() is not None:
                item.widget().deleteLater()
        question = self.reading.question if self.reading is not None else None
        self.asked.setText(say("How wide is this door?") if question else "")
        self.asked.setVisible(question is not None)
        self.show_door.setVisible(question is not None and bool(question.handles))
        for i, (metres, unit) in enumerate(question.answers if question else ()):
            button = self._button(f"{metres:.2f} m", f"EnfiladeAnswer_{i}", lambda u=unit: self.answer(u))
            button.setToolTip(say("The drawing is in {}.", unit))
            self.answers.addWidget(button)

    def answer(self, unit: str) -> None:
        """The width of the door says the unit; the plan is read again with it."""
        page = self._panel.study
        page.unit.setCurrentIndex(page.unit.findData(unit))
        self._panel.tell(say("The drawing is in {}.", unit))
        self.look(self._panel.document())

    def _show_door(self) -> None:
        """Selects what draws the door."""
        doc, owners = self._panel.document(), self._job.owners()
        ids = {owners.get(h) for h in self.reading.question.handles} - {None}
        names = [e.name for e in self._job.study.movables() if e.id in ids]
        Gui.Selection.clearSelection()
        for name in names:
            Gui.Selection.addSelection(doc.Name, name)
        if names and App.GuiUp:
            Gui.SendMsgToActiveView("ViewSelection")
