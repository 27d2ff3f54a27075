"""Page 2: what should get better, how long to search."""

from dataclasses import replace

from enfilade_common.model import UNITS, Objective, Wishes, default_objectives

from . import document, settings
from .qt import QtCore, QtWidgets
from .wording import say

#: Measure, and in words what more and what less of it means.
WORDS = {
    "degree": ("See more (visibility)", "See less (visibility)"),
    "mean-depth": ("More steps (turns)", "Fewer steps (turns)"),
    "depth": ("Farther corners (most steps)", "Nearer corners (most steps)"),
    "entropy": ("Opens up evenly (evenness)", "Opens up unevenly (evenness)"),
}


class Wish(QtWidgets.QWidget):
    """One objective: a tick, its words, how much of the gain every option keeps."""

    def __init__(self, objective: Objective):
        super().__init__()
        self.measure, self.pair = objective.measure, objective.pair
        row = QtWidgets.QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        self.tick = QtWidgets.QCheckBox()
        self.tick.setObjectName("EnfiladeWish_" + objective.name())
        self.tick.setChecked(objective.is_on)
        self.sense = QtWidgets.QComboBox()
        for sense, words in zip(("max", "min"), WORDS[objective.measure]):
            self.sense.addItem(say(words) + (f" · {self.pair}" if self.pair else ""), sense)
        self.sense.setCurrentIndex(0 if objective.sense == "max" else 1)
        self.slider = QtWidgets.QSlider(QtCore.Qt.Horizontal)
        self.slider.setRange(0, 100)
        self.slider.setValue(round(objective.threshold * 100))
        self.slider.setToolTip(say("share of the possible gain that every option keeps"))
        self.share = QtWidgets.QLabel()
        self.share.setMinimumWidth(38)
        self.slider.valueChanged.connect(lambda v: self.share.setText(f"{v} %"))
        self.share.setText(f"{self.slider.value()} %")
        for widget in (self.tick, self.sense, self.slider, self.share):
            row.addWidget(widget)

    def objective(self) -> Objective:
        sense = self.sense.itemData(self.sense.currentIndex())
        return Objective(self.measure, sense, self.slider.value() / 100, self.tick.isChecked(), self.pair)


class StudyPage(QtWidgets.QWidget):
    """Wishes, and how to search."""

    def __init__(self, panel):
        super().__init__()
        self._panel = panel
        self._shown_for = None
        layout = QtWidgets.QVBoxLayout(self)
        title = QtWidgets.QLabel(say("What should get better, most important first"))
        title.setWordWrap(True)
        layout.addWidget(title)
        self._list = QtWidgets.QVBoxLayout()
        layout.addLayout(self._list)
        layout.addLayout(self._form())
        layout.addStretch(1)
        self._fill(Wishes())

    def _form(self):
        form = QtWidgets.QFormLayout()
        self.members, self.seed, self.evaluations = (QtWidgets.QSpinBox() for _ in range(3))
        self.members.setRange(1, 50)
        self.seed.setRange(0, 2**31 - 1)
        self.evaluations.setRange(0, 100_000_000)
        self.evaluations.setSingleStep(500)
        self.evaluations.setSpecialValueText(say("automatic"))
        self.level = QtWidgets.QComboBox()
        self.level.addItem(say("at eye level"), "eye")
        self.level.addItem(say("at knee level"), "knee")
        self.spacing = QtWidgets.QDoubleSpinBox()
        self.spacing.setRange(0, 100)
        self.spacing.setSingleStep(0.1)
        self.spacing.setSuffix(" m")
        self.spacing.setSpecialValueText(say("automatic"))
        self.unit = QtWidgets.QComboBox()
        self.unit.setToolTip(say("Of a plan of lines. FreeCAD takes what is drawn without a unit for millimetres."))
        self.unit.addItem(say("automatic"), "")
        for unit in UNITS:
            self.unit.addItem(unit, unit)
        self.brief = QtWidgets.QLineEdit()
        self.brief.setPlaceholderText("kitchen next-to dining; bedroom area min 9 m2")
        self.brief.setToolTip(say("What rooms must have, parted by semicolons. Options that break it are left out."))
        self.program = QtWidgets.QLineEdit(settings.program_path())
        self.program.setObjectName("EnfiladeProgram")
        self.program.setPlaceholderText(say("found by itself"))
        self.program.editingFinished.connect(lambda: settings.remember_program_path(self.program.text().strip()))
        for title, name, widget in (
            ("Options", "EnfiladeMembers", self.members),
            ("Seed", "EnfiladeSeed", self.seed),
            ("Layouts to measure", "EnfiladeEvaluations", self.evaluations),
            ("Sight lines", "EnfiladeLevel", self.level),
            ("Cell size", "EnfiladeSpacing", self.spacing),
            ("Drawn in", "EnfiladeUnit", self.unit),
            ("Asked of rooms", "EnfiladeAsked", self.brief),
            ("Program", "EnfiladeProgram", self.program),
        ):
            widget.setObjectName(name)
            form.addRow(say(title), widget)
        return form

    def _fill(self, wishes: Wishes) -> None:
        while self._list.count():
            self._list.takeAt(0).widget().deleteLater()
        self._wishes = []
        for objective in wishes.objectives:
            if objective.measure in WORDS:
                self._add(Wish(objective))
        self.members.setValue(wishes.members)
        self.seed.setValue(wishes.seed)
        self.evaluations.setValue(wishes.evaluations or 0)
        self.level.setCurrentIndex(0 if wishes.level == "eye" else 1)
        self.spacing.setValue(wishes.spacing_m or 0.0)
        self.unit.setCurrentIndex(self.unit.findData(wishes.unit))
        self.brief.setText("; ".join(wishes.brief))

    def _add(self, wish: Wish) -> None:
        row = QtWidgets.QWidget()
        layout = QtWidgets.QHBoxLayout(row)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(wish)
        for words, step in (("▲", -1), ("▼", 1)):
            button = QtWidgets.QToolButton()
            button.setText(words)
            button.clicked.connect(lambda _=False, r=row, s=step: self._shift(r, s))
            layout.addWidget(button)
        row.wish = wish
        self._list.addWidget(row)

    def _shift(self, row, step: int) -> None:
        to = self._list.indexOf(row) + step
        if 0 <= to < self._list.count():
            self._list.removeWidget(row)
            self._list.insertWidget(to, row)

    def _rows(self):
        return [self._list.itemAt(i).widget() for i in range(self._list.count())]

    def _list_pairs(self, pairs) -> None:
        """A row for every measure over every named pair of regions, not ticked at first; those of lost names go."""
        for row in self._rows():
            if row.wish.pair and row.wish.pair not in pairs:
                self._list.removeWidget(row)
                row.deleteLater()
        known = {(r.wish.measure, r.wish.pair) for r in self._rows()}
        for pair in pairs:
            for usual in default_objectives():
                if (usual.measure, pair) not in known:
                    self._add(Wish(replace(usual, pair=pair, is_on=False)))

    def wishes(self) -> Wishes:
        return Wishes(
            objectives=[r.wish.objective() for r in self._rows()],
            members=self.members.value(),
            seed=self.seed.value(),
            evaluations=self.evaluations.value() or None,
            spacing_m=self.spacing.value() or None,
            level=self.level.itemData(self.level.currentIndex()),
            unit=self.unit.itemData(self.unit.currentIndex()),
            brief=[item.strip() for item in self.brief.text().split(";") if item.strip()],
        )

    def refresh(self, doc) -> None:
        """Fills in what the panel's document remembers, once for each document."""
        key = doc.Name if doc is not None else None
        is_new = key != self._shown_for
        self._shown_for = key
        if is_new and doc is not None:
            self._fill(settings.wishes(doc))
        if is_new or self.isVisible():
            self._list_pairs(document.pairs(doc) if doc is not None else [])
