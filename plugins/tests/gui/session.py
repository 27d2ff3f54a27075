"""What FreeCAD runs in its real window: builds the gallery, then answers the test's questions.

The test clicks with the real mouse; this side only says where a widget is, what the document holds, and
makes pictures. Questions and answers are files in the folder ENFILADE_GUI_TEST names, so that nothing is
called from outside FreeCAD's own event loop.
"""

import json
import os
import sys
import time
import traceback

import FreeCAD as App
import FreeCADGui as Gui
from PySide import QtCore, QtGui

try:
    from PySide import QtWidgets
except ImportError:
    QtWidgets = QtGui

FOLDER = os.environ["ENFILADE_GUI_TEST"]
V = App.Vector


class Heart(QtCore.QObject):
    """Beats every 10 ms; remembers the longest pause, and the most this thread worked between two beats.
    A pause without work is the machine's, busy with other programs."""

    def __init__(self):
        super().__init__()
        self._timer = QtCore.QTimer(self)
        self._timer.setTimerType(QtCore.Qt.PreciseTimer)
        self._timer.timeout.connect(self.beat)
        self._timer.start(10)
        self.begin()

    def beat(self):
        now, worked = time.monotonic(), time.thread_time()
        self.longest = max(self.longest, now - self._last)
        self.busiest = max(self.busiest, worked - self._worked)
        self._last, self._worked = now, worked

    def begin(self):
        self.longest = self.busiest = 0.0
        self._last, self._worked = time.monotonic(), time.thread_time()


def wall(a, b, width, label):
    import Arch
    import Draft

    made = Arch.makeWall(Draft.make_line(V(*a, 0), V(*b, 0)), width=width, height=3000)
    made.Label = label
    return made


def build():
    """A gallery of 12 × 8 m: a partition with a door, a wall that ends on it, two screens, a column."""
    import Arch

    doc = App.newDocument("Gallery")
    corners = [(0, 0), (12000, 0), (12000, 8000), (0, 8000)]
    for name, a, b in zip(("South", "East", "North", "West"), corners, corners[1:] + corners[:1]):
        wall(a, b, 250, name)
    partition = wall((5000, 125), (5000, 7875), 120, "Partition")
    wall((5060, 4500), (9000, 4500), 120, "Spur")
    wall((1500, 4000), (3500, 4000), 100, "Screen A")
    wall((8000, 2200), (10000, 2200), 100, "Schirm Ö")
    column = Arch.makeStructure(length=350, width=350, height=3000)
    column.Placement.Base = V(7000, 6500, 0)
    column.Label = "Column"
    doc.recompute()
    place = App.Placement(V(5000, 1000, 0), App.Rotation(V(0, 0, 1), 90).multiply(App.Rotation(V(1, 0, 0), 90)))
    door = Arch.makeWindowPreset(
        "Simple door", width=900, height=2100, h1=50, h2=50, h3=0, w1=100, w2=50, o1=0, o2=50, placement=place
    )
    door.Hosts = [partition]
    door.Label = "Door"
    doc.recompute()
    doc.recompute()
    doc.clearUndos()
    view = Gui.activeDocument().activeView()
    view.viewTop()
    Gui.SendMsgToActiveView("ViewFit")
    return doc


def state():
    out = {}
    for o in App.ActiveDocument.Objects:
        shape = getattr(o, "Shape", None)
        if shape is not None and not shape.isNull() and shape.Vertexes:
            box = shape.BoundBox
            numbers = (box.XMin, box.YMin, box.XMax, box.YMax, shape.Volume / 1e6)
            out[o.Label] = [round(v, 3) + 0.0 for v in numbers]
    return out


def window():
    return Gui.getMainWindow()


def panel():
    return window().findChild(QtWidgets.QDockWidget, "EnfiladePanel")


def where(widget):
    """Middle of a widget on the screen."""
    middle = widget.rect().center()
    if isinstance(widget, QtWidgets.QCheckBox):
        middle.setX(10)
    at = widget.mapToGlobal(middle)
    return [at.x(), at.y()]


class Answers:
    """One method for each question."""

    def find(self, name):
        for widget in window().findChildren(QtWidgets.QWidget, name):
            if widget.isVisible():
                area = widget.parent()
                while area is not None and not isinstance(area, QtWidgets.QScrollArea):
                    area = area.parent()
                if area is not None:
                    area.ensureWidgetVisible(widget)
                    Gui.updateGui()
                return where(widget)
        return None

    def checked(self, name):
        return window().findChild(QtWidgets.QCheckBox, name).isChecked()

    def tool(self, command):
        for bar in window().findChildren(QtWidgets.QToolBar):
            for action in bar.actions():
                if action.text().replace("&", "") == command and bar.widgetForAction(action) is not None:
                    return where(bar.widgetForAction(action))
        return None

    def tab(self, index):
        bar = panel().pages.tabBar()
        at = bar.mapToGlobal(bar.tabRect(index).center())
        return [at.x(), at.y()]

    def item(self, row):
        strip = panel().options.strip
        strip.scrollToItem(strip.item(row))
        at = strip.viewport().mapToGlobal(strip.visualItemRect(strip.item(row)).center())
        return [at.x(), at.y()]

    def point(self, x, y, z=3000):
        """Where a point of the drawing is on the screen."""
        view = Gui.activeDocument().activeView()
        px, py = view.getPointOnScreen(V(x, y, z))[:2]
        viewers = ("Quarter", "View3DInventorViewer")
        named = ((w, w.metaObject().className()) for w in window().findChildren(QtWidgets.QWidget))
        shown = [w for w, name in named if any(v in name for v in viewers)]
        widget = max((w for w in shown if w.isVisible()), key=lambda w: w.width() * w.height())
        widget = widget.viewport() if hasattr(widget, "viewport") else widget
        height = view.getSize()[1]
        at = widget.mapToGlobal(QtCore.QPoint(int(px), int(height - py)))
        return [at.x(), at.y()]

    def state(self):
        return state()

    def document(self):
        doc = App.ActiveDocument
        return {
            "undo": doc.UndoCount,
            "undo_names": list(doc.UndoNames),
            "objects": len(doc.Objects),
            "selection": [o.Label for o in Gui.Selection.getSelection()],
        }

    def panel(self):
        p = panel()
        overlay = p._overlays.get(App.ActiveDocument.Name)
        return {
            "status": p.status.text(),
            "page": p.pages.currentIndex(),
            "running": p.runner.is_running(),
            "options": len(p.round.options) if p.round else 0,
            "row": p.options.strip.currentRow(),
            "words": p.options.words.text(),
            "round": p.round.folder if p.round else "",
            "overlay": {n: not overlay[1].is_empty(n) for n in ("marks", "heat", "ghost", "best")} if overlay else {},
            "document": App.getDocument(p.doc_name).Label if p.doc_name else "",
            "front": App.ActiveDocument.Label,
            "storey": p.head.storey(),
            "stage": p.foot.stage.text(),
        }

    def text(self, name):
        """What a label or a button says; nothing where it is not shown."""
        widget = window().findChild(QtWidgets.QWidget, name)
        return widget.text() if widget.isVisible() else ""

    def numbers(self):
        """The table of the shown layout: what is measured, and the change of it."""
        table = panel().options.numbers
        return {table.item(r, 0).text(): table.item(r, 3).text() for r in range(table.rowCount())}

    def is_on_screen(self, name):
        """Whether all of a widget is seen without scrolling."""
        widget = window().findChild(QtWidgets.QWidget, name)
        corner = widget.mapToGlobal(QtCore.QPoint(0, 0))
        box = QtCore.QRect(corner, widget.size())
        return widget.isVisible() and not widget.visibleRegion().isEmpty() and (
            widget.visibleRegion().boundingRect().size() == widget.size()
            and QtCore.QRect(0, 0, 1600, 1000).contains(box)
        )

    def view_tab(self, label):
        """Where the tab of a document's view is."""
        area = window().findChild(QtWidgets.QMdiArea)
        bar = area.findChild(QtWidgets.QTabBar)
        index = next(i for i in range(bar.count()) if bar.tabText(i).startswith(label + " :"))
        at = bar.mapToGlobal(bar.tabRect(index).center())
        return [at.x(), at.y()]

    def draft_line(self):
        import Draft

        made = Draft.make_line(V(500, 500, 0), V(3000, 500, 0))
        App.ActiveDocument.recompute()
        return made.Label

    def heat_colours(self):
        """How many colours the heat map of the document in front has."""
        from pivy import coin

        (material,) = (n for n in panel()._overlays[App.ActiveDocument.Name][1]._parts["heat"] if isinstance(n, coin.SoMaterial))
        return len({tuple(round(v, 4) for v in c.getValue()) for c in material.diffuseColor})

    def set(self, name, value):
        widget = window().findChild(QtWidgets.QWidget, name)
        getattr(widget, "setValue" if hasattr(widget, "setValue") else "setText")(value)

    def heart(self, begin=False):
        if begin:
            HEART.begin()
        return [HEART.longest, HEART.busiest]

    def fit(self):
        Gui.SendMsgToActiveView("ViewFit")

    def isometric(self):
        Gui.activeDocument().activeView().viewIsometric()
        Gui.SendMsgToActiveView("ViewFit")

    def top(self):
        Gui.activeDocument().activeView().viewTop()
        Gui.SendMsgToActiveView("ViewFit")

    def marks(self):
        return {o.Label: o.EnfiladeId for o in App.ActiveDocument.Objects if getattr(o, "EnfiladeId", "")}

    def used(self):
        """How far marked objects have gone, by kind, with their first bounds."""
        from freecad.enfilade import marks

        marked = ((o, kind, ends) for o in App.ActiveDocument.Objects for kind, ends in marks.bounds(o).items())
        return [[o.Label, kind, marks.used(o, kind), *ends] for o, kind, ends in marked if marks.used(o, kind)]

    def save_and_reload(self, path):
        App.ActiveDocument.saveAs(path)
        App.closeDocument(App.ActiveDocument.Name)
        App.openDocument(path)
        return len(App.ActiveDocument.Objects)

    def save(self, path):
        App.ActiveDocument.saveAs(path)

    def select(self, label):
        self.select_all([label])

    def select_all(self, labels):
        """Selects; the page shows it at once, not a moment later."""
        Gui.Selection.clearSelection()
        for label in labels:
            Gui.Selection.addSelection(App.ActiveDocument.getObjectsByLabel(label)[0])
        panel().mark.refresh()

    def allowed(self):
        """Building works that are marked, by label."""
        return {o.Label: o.EnfiladeWorks for o in App.ActiveDocument.Objects if getattr(o, "EnfiladeWorks", "")}

    def rows(self):
        """What page 1 offers: by kind how far it is ticked (0, 1 for some of the objects, 2) and its numbers."""
        rows = panel().mark.rows.rows.values()
        return {
            r.kind: [int(r.tick.checkState()), *(b.value() for b in r.boxes.values())] for r in rows if not r.tick.isHidden()
        }

    def undo(self):
        App.ActiveDocument.undo()

    def edit_wall(self, label, width):
        doc = App.ActiveDocument
        doc.openTransaction("edit")
        doc.getObjectsByLabel(label)[0].Width = width
        doc.recompute()
        doc.commitTransaction()

    def recompute(self):
        App.ActiveDocument.recompute()

    def five_hundred(self):
        """What drawing, marking and exporting 500 walls takes with a window: seconds of this thread, and by the clock."""
        import Arch
        import Draft
        from enfilade_common import job
        from enfilade_common.model import Wishes
        from freecad.enfilade import document, marks

        clocks = lambda: (time.thread_time(), time.monotonic())  # noqa: E731
        doc = App.newDocument("Many")
        first = clocks()
        for i in range(500):
            a = V(i % 25 * 3000, i // 25 * 3000, 0)
            Arch.makeWall(Draft.make_line(a, a.add(V(2000, 0, 0))), width=100, height=3000)
        doc.recompute()
        began = clocks()
        doc.openTransaction("mark")
        walls = [o for o in doc.Objects if document.kind_of(o) == "Wall"]
        marks.mark_all(walls, {"x": (-300, 300), "y": (-300, 300)})
        doc.commitTransaction()
        marked = clocks()
        job.write(document.study(doc, Wishes())[0], os.path.join(FOLDER, "many"))
        written = clocks()
        App.closeDocument(doc.Name)
        return [[b - a for a, b in zip(*pair)] for pair in ((first, began), (began, marked), (marked, written))]

    def draw_rectangle(self, x, y, width, height):
        """A closed line, as Draft's tools leave it; gives its label."""
        import Draft

        made = Draft.make_rectangle(width, height, App.Placement(V(x, y, 0), App.Rotation()), False)
        App.ActiveDocument.recompute()
        return made.Label

    def regions(self):
        kinds = [getattr(o, "EnfiladeRegion", "") for o in App.ActiveDocument.Objects]
        return sorted(k for k in kinds if k)

    def remove(self, labels):
        for label in labels:
            App.ActiveDocument.removeObject(App.ActiveDocument.getObjectsByLabel(label)[0].Name)

    def best(self, value):
        """Plays the progress of a program that tells its best layout."""
        p = panel()
        plan = p._written(p.document())[0].plan
        p._show_best(plan, [value] * len(plan.tables))
        return not p.overlay(App.ActiveDocument).is_empty("best")

    def clear_preview(self):
        panel().clear_preview()

    def macro(self, path):
        """Runs the macro as FreeCAD does, after the workbench's panel has gone; gives its panel's module."""
        old = panel()
        old.shut()
        window().removeDockWidget(old)
        old.setObjectName("")
        old.hide()
        with open(path, encoding="utf-8") as f:
            exec(compile(f.read(), path, "exec"), {"__name__": "__main__", "__file__": path})
        return type(panel()).__module__

    def import_option(self):
        p = panel()
        names = set(App.listDocuments())
        p.options._import()
        (made,) = set(App.listDocuments()) - names
        edges = {o.Label: len(o.Shape.Edges) for o in App.getDocument(made).Objects if hasattr(o, "Shape")}
        App.closeDocument(made)
        return edges

    def run_command(self, name):
        Gui.runCommand(name)

    def new_document(self, label):
        doc = App.newDocument(label)
        doc.UndoMode = 1
        return doc.Name

    def house(self, label, beside=False):
        """A room with a partition, its door, and a free wall, in a document of its own, or beside the others."""
        import Arch

        for name in [] if beside else list(App.listDocuments()):
            App.closeDocument(name)
        doc = App.newDocument(label)
        doc.UndoMode = 1
        corners = [(0, 0), (8000, 0), (8000, 6000), (0, 6000)]
        for name, a, b in zip("SENW", corners, corners[1:] + corners[:1]):
            wall(a, b, 250, name)
        made = wall((4000, 125), (4000, 4800), 100, "P")
        wall((6000, 1000), (6000, 3000), 100, "Q")
        doc.recompute()
        place = App.Placement(V(4000, 700, 0), App.Rotation(V(0, 0, 1), 90).multiply(App.Rotation(V(1, 0, 0), 90)))
        sizes = dict(width=900, height=2100, h1=50, h2=50, h3=0, w1=100, w2=50, o1=0, o2=50)
        door = Arch.makeWindowPreset("Simple door", placement=place, **sizes)
        door.Hosts, door.Label = [made], "Tür"
        doc.recompute()
        doc.recompute()
        doc.clearUndos()
        self.top()
        return [doc.Name, doc.Label]

    def furnished(self, label):
        """The house with windows in two outer walls and a front door."""
        import Arch

        self.house(label)
        doc = App.ActiveDocument
        sizes = dict(h1=50, h2=50, h3=0, w1=100, w2=50, o1=0, o2=50)
        upright = App.Rotation(V(1, 0, 0), 90)
        for name, preset, host, at, width, height in (
            ("Haustür", "Simple door", "S", V(5500, 0, 0), 1000, 2100),
            ("Fenster 1", "Open 1-pane", "S", V(1500, 0, 900), 1200, 1200),
            ("Fenster 2", "Open 1-pane", "N", V(2000, 6000, 900), 1500, 1200),
        ):
            made = Arch.makeWindowPreset(preset, width=width, height=height, placement=App.Placement(at, upright), **sizes)
            made.Hosts, made.Label = [doc.getObjectsByLabel(host)[0]], name
        doc.recompute()
        doc.recompute()
        doc.clearUndos()

    def empty(self):
        """A place in the view where nothing stands."""
        box = App.BoundBox()
        for o in App.ActiveDocument.Objects:
            if hasattr(o, "Shape") and not o.Shape.isNull():
                box.add(o.Shape.BoundBox)
        return self.point(box.Center.x, box.YMax + box.YLength / 10, box.ZMax)

    def plan(self, label):
        """A 2D plan of Draft lines: a room with a partition with a gap, and a free screen, in a document of its own."""
        import Draft

        for name in list(App.listDocuments()):
            App.closeDocument(name)
        doc = App.newDocument(label)
        doc.UndoMode = 1
        outer = [V(*p, 0) for p in ((0, 0), (8000, 0), (8000, 6000), (0, 6000))]
        Draft.make_wire(outer, closed=True, face=False)
        left = [(3850, 5750), (250, 5750), (250, 250), (3850, 250)]
        right = [(4150, 250), (7750, 250), (7750, 5750), (4150, 5750)]
        lines = [*zip(left, left[1:]), *zip(right, right[1:])]
        for y0, y1, end in ((250, 700, 700), (1600, 5750, 1600)):
            lines += [((x, y0), (x, y1)) for x in (3850, 4150)] + [((3850, end), (4150, end))]
        ring = [(5500, 2500), (5700, 2500), (5700, 4500), (5500, 4500), (5500, 2500)]
        for a, b in [*lines, *zip(ring, ring[1:])]:
            Draft.make_line(V(*a, 0), V(*b, 0))
        doc.recompute()
        doc.clearUndos()
        self.top()
        Gui.Selection.clearSelection()

    def imported(self, path):
        """A DXF as FreeCAD's own importer brings it, in a document of its own."""
        import importDXF

        for name in list(App.listDocuments()):
            App.closeDocument(name)
        doc = App.newDocument("Imported")
        doc.UndoMode = 1
        importDXF.insert(path, doc.Name)
        doc.recompute()
        doc.clearUndos()
        self.top()

    def read(self):
        """How the plan is read, as the panel says it."""
        panel().refresh()
        return panel().row.read.text()

    def use_file(self, path):
        row = panel().row
        row.read.setText("")
        panel().attempt(row.use, App.ActiveDocument, path)

    def answers(self):
        """What is offered to a question, in order."""
        buttons = window().findChildren(QtWidgets.QPushButton)
        return [b.text() for b in buttons if b.objectName().startswith("EnfiladeAnswer_") and b.isVisible()]

    def drawn_in(self, unit):
        page = panel().study
        page.unit.setCurrentIndex(page.unit.findData(unit))

    def middle(self, label):
        """Where the middle of an object's first line is on the screen."""
        edge = App.ActiveDocument.getObjectsByLabel(label)[0].Shape.Edges[0]
        at = edge.valueAt((edge.FirstParameter + edge.LastParameter) / 2)
        return self.point(at.x, at.y, at.z)

    def labels_at(self, places):
        """Labels of the lines whose middles these are."""
        out = []
        for x, y in places:
            at = V(x, y, 0)
            lines = [o for o in App.ActiveDocument.Objects if hasattr(o, "Shape") and len(o.Shape.Edges) == 1]
            out.append(min(lines, key=lambda o: (o.Shape.CenterOfMass - at).Length).Label)
        return out

    def ends(self):
        """Corners of all that is drawn, to a micrometre, by label."""
        drawn = (o for o in App.ActiveDocument.Objects if hasattr(o, "Shape"))
        return {o.Label: [[round(c, 3) + 0.0 for c in v.Point] for v in o.Shape.Vertexes] for o in drawn}

    def forget_status(self):
        panel().tell("")

    def activate(self, label):
        panel().bring_to_front(next(d for d in App.listDocuments().values() if label in (d.Label, d.Name)))

    def clear_selection(self):
        Gui.Selection.clearSelection()

    def close(self, name):
        App.closeDocument(name)

    def accept_behind(self, name):
        """Accepts while another document is the active one."""
        App.setActiveDocument(name)
        panel().accept()

    def undo_of(self, name):
        return App.getDocument(name).UndoCount

    def level(self, name, labels):
        """Draws a level of some walls."""
        import Arch

        doc = App.ActiveDocument
        floor = Arch.makeFloor([doc.getObjectsByLabel(label)[0] for label in labels])
        floor.Label = name
        doc.recompute()

    def tick(self, kind, on=True):
        panel().mark.refresh()
        panel().mark.rows.rows[kind].tick.setChecked(on)

    def choose_storey(self, index):
        panel().head.storeys.setCurrentIndex(index)
        return panel().head.storey()

    def storeys_offered(self):
        storeys = panel().head.storeys
        return [storeys.itemText(i) for i in range(storeys.count())]

    def job_walls(self):
        p = panel()
        return [w.label for w in (p._running or p).job.study.walls]

    def run_outside(self):
        """What a watching program does: another round of the same job."""
        import subprocess

        words = [os.environ["ENFILADE"], "run", panel().job.drawing, "--quiet", "--seed", "5"]
        return subprocess.run(words, stdin=subprocess.DEVNULL).returncode

    def quit(self):
        QtCore.QTimer.singleShot(100, lambda: os._exit(0))


def listen():
    question = os.path.join(FOLDER, "question.json")
    if not os.path.exists(question):
        return
    with open(question) as f:
        asked = json.load(f)
    os.remove(question)
    try:
        answer = {"value": getattr(ANSWERS, asked["name"])(*asked["values"])}
    except Exception:
        answer = {"error": traceback.format_exc()}
    with open(os.path.join(FOLDER, "answer.part"), "w") as f:
        json.dump(answer, f)
    os.replace(os.path.join(FOLDER, "answer.part"), os.path.join(FOLDER, "answer.json"))


def timed(cls, name):
    """Prints how long a method of the panel takes, for the record of the run."""
    original = getattr(cls, name)

    def method(self, *values):
        began = time.perf_counter()
        try:
            return original(self, *values)
        finally:
            sys.__stdout__.write(f"{name}: {1000 * (time.perf_counter() - began):.0f} ms\n")
            sys.__stdout__.flush()

    setattr(cls, name, method)


def main():
    try:
        from freecad.enfilade.panel import Panel

        for name in ("_run", "_load", "preview", "_accept"):
            timed(Panel, name)
        window().showMaximized()
        for dock in window().findChildren(QtWidgets.QDockWidget):
            if dock.objectName() in ("Python console", "Report view"):
                dock.hide()
        build()
        Gui.activateWorkbench("EnfiladeWorkbench")
        Gui.SendMsgToActiveView("ViewFit")
        open(os.path.join(FOLDER, "ready"), "w").close()
    except Exception:
        with open(os.path.join(FOLDER, "failed"), "w") as f:
            f.write(traceback.format_exc())
        os._exit(1)
    TIMER.start(30)


HEART = Heart()
ANSWERS = Answers()
TIMER = QtCore.QTimer()
TIMER.timeout.connect(listen)
QtCore.QTimer.singleShot(800, main)
