"""Page 3: the options as a strip of pictures, their numbers and words; arrow keys switch."""

import os

from .overlay import RAMP
from .qt import QtCore, QtGui, QtWidgets
from .wording import count, say, words_of

MEASURES = (
    ("degree", "visibility"),
    ("mean-depth", "steps"),
    ("depth", "most steps"),
    ("entropy", "evenness"),
)
#: What counts cells is shown as area, m².
AREAS = ("degree",)
THUMB_PX = 150


class OptionsPage(QtWidgets.QWidget):
    """Strip, heat map choice, numbers, words, buttons."""

    def __init__(self, panel):
        super().__init__()
        self._panel = panel
        self._round, self._shown, self._layouts = None, -1, []
        layout = QtWidgets.QVBoxLayout(self)
        layout.addLayout(self._choices())
        self.strip = QtWidgets.QListWidget()
        self.strip.setObjectName("EnfiladeStrip")
        self.strip.setViewMode(QtWidgets.QListWidget.IconMode)
        self.strip.setFlow(QtWidgets.QListWidget.LeftToRight)
        self.strip.setWrapping(False)
        self.strip.setMovement(QtWidgets.QListWidget.Static)
        self.strip.setIconSize(QtCore.QSize(THUMB_PX, THUMB_PX))
        self.strip.setFixedHeight(THUMB_PX + 62)
        self.strip.setResizeMode(QtWidgets.QListWidget.Adjust)
        self.strip.setMouseTracking(True)
        self.strip.currentRowChanged.connect(self._row_changed)
        self.strip.itemEntered.connect(lambda item: self._show(self.strip.row(item)))
        self.strip.viewport().installEventFilter(self)
        layout.addWidget(self.strip)
        self.words = QtWidgets.QLabel(say("Run the study to see options here."))
        self.words.setObjectName("EnfiladeWords")
        self.words.setWordWrap(True)
        self.words.setAlignment(QtCore.Qt.AlignTop)
        # As high as the longest words, so that nothing below jumps while the mouse passes the strip.
        self.words.setMinimumHeight(5 * self.words.fontMetrics().lineSpacing())
        layout.addWidget(self.words)
        self.brief = QtWidgets.QLabel()
        self.brief.setObjectName("EnfiladeBrief")
        self.brief.setWordWrap(True)
        self.brief.setTextInteractionFlags(QtCore.Qt.TextSelectableByMouse)
        layout.addWidget(self.brief)
        self.numbers = QtWidgets.QTableWidget(0, 4)
        self.numbers.setObjectName("EnfiladeNumbers")
        self.numbers.setEditTriggers(QtWidgets.QAbstractItemView.NoEditTriggers)
        self.numbers.verticalHeader().setVisible(False)
        self.numbers.setFixedHeight(150)
        layout.addWidget(self.numbers)
        self.legend = QtWidgets.QLabel()
        self.legend.setObjectName("EnfiladeLegend")
        self.legend.setTextFormat(QtCore.Qt.RichText)
        layout.addWidget(self.legend)
        layout.addLayout(self._buttons())
        layout.addWidget(self._notes())
        layout.addStretch(1)
        self.clear()

    def _choices(self):
        row = QtWidgets.QHBoxLayout()
        self.measure = QtWidgets.QComboBox()
        self.measure.setObjectName("EnfiladeMeasure")
        for measure, words in MEASURES:
            self.measure.addItem(say(words), measure)
        self.measure.addItem(say("no heat map"), "")
        self.measure.currentIndexChanged.connect(lambda _: self._measure_changed())
        self.ghosts = QtWidgets.QCheckBox(say("Ghost walls"))
        self.ghosts.setObjectName("EnfiladeGhosts")
        self.ghosts.setChecked(True)
        self.ghosts.toggled.connect(lambda _: self._show_again())
        row.addWidget(self.measure)
        row.addWidget(self.ghosts)
        return row

    def _buttons(self):
        row = QtWidgets.QHBoxLayout()
        self.buttons = []
        for name, title, action in (
            ("EnfiladeReport", "Open report", self._open_report),
            ("EnfiladeImport", "Import as document", self._import),
        ):
            button = QtWidgets.QPushButton(say(title))
            button.setObjectName(name)
            button.setEnabled(False)
            button.clicked.connect(lambda _=False, a=action: a())
            row.addWidget(button)
            self.buttons.append(button)
        return row

    def _notes(self):
        """Warnings, and below them what else there is to know, folded."""
        box = QtWidgets.QWidget()
        column = QtWidgets.QVBoxLayout(box)
        column.setContentsMargins(0, 0, 0, 0)
        self.warnings, self.infos = QtWidgets.QLabel(), QtWidgets.QLabel()
        self.fold = QtWidgets.QToolButton()
        self.fold.setObjectName("EnfiladeFold")
        self.fold.setCheckable(True)
        self.fold.setAutoRaise(True)
        self.fold.setToolButtonStyle(QtCore.Qt.ToolButtonTextBesideIcon)
        self.fold.toggled.connect(self._unfold)
        for label, name in ((self.warnings, "EnfiladeWarnings"), (self.infos, "EnfiladeInfos")):
            label.setObjectName(name)
            label.setWordWrap(True)
            label.setTextInteractionFlags(QtCore.Qt.TextSelectableByMouse)
        for widget in (self.warnings, self.fold, self.infos):
            column.addWidget(widget)
        return box

    def _unfold(self, is_open: bool) -> None:
        self.fold.setArrowType(QtCore.Qt.DownArrow if is_open else QtCore.Qt.RightArrow)
        self.infos.setVisible(is_open)

    def _show_notes(self, notes) -> None:
        warnings, infos = ([n.text for n in notes if n.is_warning is wanted] for wanted in (True, False))
        self.warnings.setText("\n".join("⚠ " + text for text in warnings))
        self.warnings.setVisible(bool(warnings))
        self.infos.setText("\n".join("• " + text for text in infos))
        self.fold.setText(count(len(infos), "{} note", "{} notes"))
        self.fold.setVisible(bool(infos))
        self.fold.setChecked(False)
        self._unfold(False)

    def clear(self) -> None:
        self._round, self._shown = None, -1
        self.strip.clear()
        self.numbers.setRowCount(0)
        self.words.setText(say("Run the study to see options here."))
        self._show_brief([])
        self.show_span("", (0.0, 0.0))
        self._show_notes([])
        self._panel.foot.offer(None)
        for button in self.buttons:
            button.setEnabled(False)

    def layouts(self, found):
        """What the strip shows of a round: nothing for the present layout, the options, the best where it is none."""
        return [None, *found.options, *([found.best] if found.best else [])]

    def measured(self, drawing: str) -> None:
        """More cells are known: the colours may mean other values now."""
        if self._round is not None:
            self._show_again()

    def show_span(self, measure: str, span) -> None:
        """What the lines and colours of the view mean."""
        name = measure.partition("@")[0]
        area = self._round.spacing_m**2 if self._round is not None and name in AREAS else 1.0
        unit = " m²" if name in AREAS else ""
        least, most = (_number(v, area, unit) if measure else say(w) for v, w in zip(span, ("little", "much")))
        ramp = "".join(f"<span style='background-color:{_hex(c)}'>&nbsp;&nbsp;</span>" for c in RAMP)
        self.legend.setText(
            f"<span style='color:#d90061'>━━</span> {say('new place')} &nbsp; ┅┅ {say('stands there now')} &nbsp; "
            f"{least} {ramp} {most}"
        )

    def show_round(self, found, notes) -> None:
        """Fills the strip; pictures follow one at a time, so that the window stays awake."""
        self.clear()
        self._round = found
        self._layouts = self.layouts(found)
        self._show_notes(notes)
        for option in self._layouts:
            name = name_of(option)
            item = QtWidgets.QListWidgetItem(name if option is None or option.within_threshold else name + " *")
            item.setSizeHint(QtCore.QSize(THUMB_PX + 12, THUMB_PX + 28))
            self.strip.addItem(item)
        for button in self.buttons:
            button.setEnabled(True)
        self.strip.setCurrentRow(1 if found.options else 0)
        self.strip.setFocus()
        self._load_pictures(0, found)

    def _load_pictures(self, row: int, found) -> None:
        if found is not self._round or row >= self.strip.count():
            return
        path = self._picture(row)
        if path and os.path.exists(path):
            reader = QtGui.QImageReader(path)
            size = reader.size()
            size.scale(THUMB_PX, THUMB_PX, QtCore.Qt.KeepAspectRatio)
            reader.setScaledSize(size)
            self.strip.item(row).setIcon(QtGui.QIcon(QtGui.QPixmap.fromImage(reader.read())))
        QtCore.QTimer.singleShot(0, lambda: self._load_pictures(row + 1, found))

    def _picture(self, row: int) -> str:
        measure = self._measure() or "degree"
        option = self._option(row)
        return option.picture(measure) if option else self._round.initial_picture(measure)

    def _measure(self) -> str:
        return self.measure.itemData(self.measure.currentIndex()) or ""

    def _row_changed(self, _row) -> None:
        option = self.chosen()
        self.buttons[1].setEnabled(option is not None)
        self._panel.foot.offer(name_of(option) if option else None)
        self._show()

    def _show_again(self) -> None:
        self._shown = -1
        self._show()

    def _measure_changed(self) -> None:
        if self._round is not None:
            self._load_pictures(0, self._round)
        self._show_again()

    def _option(self, row: int):
        return self._layouts[row] if self._round is not None and row >= 1 else None

    def chosen(self):
        return self._option(self.strip.currentRow())

    def eventFilter(self, _watched, event):
        """Back to the chosen option when the mouse leaves the strip."""
        if event.type() == QtCore.QEvent.Leave:
            self._show()
        return False

    def _show(self, hovered: int = -1) -> None:
        """The chosen option, or the one under the mouse, in the view, in numbers and in words."""
        row = hovered if hovered >= 0 else self.strip.currentRow()
        if self._round is None or row < 0 or row == self._shown:
            return
        self._shown = row
        option = self._option(row)
        self.words.setText(words_of(option) if option else say("Present"))
        self._show_brief(option.brief if option else self._round.brief)
        self._fill_numbers(option)
        self._panel.preview(option, self._measure(), self.ghosts.isChecked())

    def _show_brief(self, lines) -> None:
        """The brief of rooms as ticks and crosses."""
        self.brief.setText("\n".join(line.text() for line in lines))
        self.brief.setVisible(bool(lines))

    def _fill_numbers(self, option) -> None:
        heads = [say("Measure"), say("Now"), name_of(option) if option else "", say("Change")]
        self.numbers.setHorizontalHeaderLabels(heads)
        shown = [(m, say(w)) for m, w in MEASURES if m in self._round.initial]
        words_of = dict(MEASURES)
        for name in self._round.initial:
            measure, at, pair = name.partition("@")
            if at and measure in words_of:
                shown.append((name, f"{say(words_of[measure])} · {pair}"))
        self.numbers.setRowCount(len(shown))
        for row, (measure, words) in enumerate(shown):
            area = self._round.spacing_m**2 if measure.partition("@")[0] in AREAS else 1.0
            now = self._round.initial[measure]
            then = option.mean.get(measure) if option else None
            # What was confirmed, where the program confirmed anything: the same words as on its page.
            change = option.change(measure) if option and option.gain else _change(now, then)
            unit = " m²" if measure.partition("@")[0] in AREAS else ""
            cells = [words, _number(now, area, unit), _number(then, area, unit), change]
            for column, text in enumerate(cells):
                self.numbers.setItem(row, column, QtWidgets.QTableWidgetItem(text))
        self.numbers.resizeColumnsToContents()

    def _open_report(self) -> None:
        if self._round is not None:
            QtGui.QDesktopServices.openUrl(QtCore.QUrl.fromLocalFile(self._round.report))

    def _import(self) -> None:
        option = self.chosen()
        if option is not None:
            self._panel.bring(option.file)


def name_of(option) -> str:
    """What the strip calls a layout; none is the present one."""
    if option is None:
        return say("Present")
    return say("Option {}", option.number) if option.number else say("Best found")


def _number(value, area=1.0, unit="") -> str:
    return "" if value is None else f"{value * area:.3g}{unit}"


def _change(now, then) -> str:
    return f"{100 * (then - now) / now:+.1f} %" if now and then is not None else ""


def _hex(colour) -> str:
    return "#" + "".join(f"{round(255 * c):02x}" for c in colour)
