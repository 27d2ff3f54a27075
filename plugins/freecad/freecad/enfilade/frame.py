"""What stands above and below the pages, whichever is open: what the panel works on, and its buttons."""

from typing import Optional

import FreeCAD as App

from . import document, settings
from .qt import QtCore, QtWidgets
from .wording import count, say


class Head(QtWidgets.QWidget):
    """The one document and storey that the panel works on; a button to work on the document in front."""

    def __init__(self, panel):
        super().__init__()
        self._panel = panel
        self._listed_for = ""
        layout = QtWidgets.QGridLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setColumnStretch(1, 1)
        self.name = QtWidgets.QLabel()
        self.name.setObjectName("EnfiladeDocument")
        self.switch = QtWidgets.QPushButton()
        self.switch.setObjectName("EnfiladeSwitch")
        self.switch.clicked.connect(lambda _=False: self._panel.attempt(self._panel.switch))
        self.storeys = QtWidgets.QComboBox()
        self.storeys.setObjectName("EnfiladeStorey")
        self.storeys.currentIndexChanged.connect(lambda _: self._panel.refresh_later())
        self._storey = QtWidgets.QLabel(say("Storey"))
        layout.addWidget(QtWidgets.QLabel(say("Document")), 0, 0)
        layout.addWidget(self.name, 0, 1)
        layout.addWidget(self.switch, 0, 2)
        layout.addWidget(self._storey, 1, 0)
        layout.addWidget(self.storeys, 1, 1, 1, 2)

    def storey(self) -> Optional[str]:
        """Label of the storey; empty for walls outside any level, nothing where there is no choice."""
        return self.storeys.itemData(self.storeys.currentIndex()) if self.storeys.count() > 1 else None

    def refresh(self, doc) -> None:
        front = App.ActiveDocument
        self.name.setText(f"<b>{doc.Label}</b>" if doc is not None else say("none"))
        is_other = doc is not None and front is not None and front.Name != doc.Name
        self.switch.setVisible(is_other)
        if is_other:
            self.switch.setText(say("Switch to '{}'", front.Label))
        self._list_storeys(doc)

    def _list_storeys(self, doc) -> None:
        labels = document.storeys(doc) if doc is not None else []
        chosen = self.storey()
        if doc is not None and (doc.Name != self._listed_for or chosen is None):
            self._listed_for, chosen = doc.Name, settings.storey(doc)
        if labels != [self.storeys.itemData(i) for i in range(self.storeys.count())]:
            self.storeys.blockSignals(True)
            self.storeys.clear()
            for label in labels:
                self.storeys.addItem(label or say("outside any level"), label)
            self.storeys.blockSignals(False)
        if labels:
            shown = chosen if chosen in labels else document.default_storey(doc, labels)
            self.storeys.setCurrentIndex(labels.index(shown))
        for widget in (self._storey, self.storeys):
            widget.setVisible(len(labels) > 1)


class Foot(QtWidgets.QWidget):
    """Run, Stop, Accept; how far the run is; one line of what happened."""

    def __init__(self, panel):
        super().__init__()
        layout = QtWidgets.QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        row = QtWidgets.QHBoxLayout()
        self.run, self.stop, self.accept = (QtWidgets.QPushButton(say(t)) for t in ("Run", "Stop", "Accept"))
        for button, name, action in (
            (self.run, "EnfiladeRun", panel.run),
            (self.stop, "EnfiladeStop", panel.stop),
            (self.accept, "EnfiladeAccept", panel.accept),
        ):
            button.setObjectName(name)
            button.clicked.connect(lambda _=False, a=action: a())
            row.addWidget(button)
        row.setStretch(2, 1)
        self.bar = QtWidgets.QProgressBar()
        self.bar.setObjectName("EnfiladeProgress")
        layout.addWidget(self.bar)
        self.stage = QtWidgets.QLabel()
        self.stage.setWordWrap(True)
        layout.addWidget(self.stage)
        self.status = QtWidgets.QLabel()
        self.status.setObjectName("EnfiladeStatus")
        self.status.setWordWrap(True)
        self.status.setTextInteractionFlags(QtCore.Qt.TextSelectableByMouse)
        layout.addWidget(self.status)
        # Below all that grows, so that no button jumps away from the mouse while a run tells how far it is.
        layout.addLayout(row)
        self.offer(None)
        self.end()

    def offer(self, name: Optional[str]) -> None:
        """Accept is for the layout of this name."""
        self.accept.setText(say("Accept: {}", name) if name else say("Accept"))
        self.accept.setEnabled(bool(name))

    def begin(self) -> None:
        self.bar.setRange(0, 0)
        self._show_running(True)

    def end(self) -> None:
        self.stage.setText("")
        self._show_running(False)

    def _show_running(self, is_running: bool) -> None:
        self.bar.setVisible(is_running)
        self.stage.setVisible(is_running)
        self.run.setEnabled(not is_running)
        self.stop.setEnabled(is_running)

    def progress(self, progress) -> None:
        self.bar.setRange(0, progress.total or 0)
        self.bar.setValue(progress.done)
        words = [progress.stage, count(progress.evaluations, "{} layout measured", "{} layouts measured")]
        if progress.best is not None:
            words.append(say("best so far {}", f"{progress.best:.4g}"))
        if progress.eta_secs is not None:
            minutes = progress.eta_secs / 60
            short = say("about {} s left", f"{progress.eta_secs:.0f}")
            words.append(short if minutes < 2 else say("about {} min left", f"{minutes:.0f}"))
        self.stage.setText(" · ".join(words))
