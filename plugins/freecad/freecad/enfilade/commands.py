"""Commands of the workbench's menu and tool bar."""

import os

import FreeCAD as App
import FreeCADGui as Gui

from .qt import QtWidgets
from .wording import say

ICONS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "icons")


class Command:
    """A command that does something with the panel."""

    def __init__(self, icon: str, title: str, action, needs_document: bool = True):
        self._icon, self._title = icon, title
        self._action, self._needs_document = action, needs_document

    def GetResources(self):
        words = say(self._title)
        return {"Pixmap": os.path.join(ICONS, self._icon + ".svg"), "MenuText": words, "ToolTip": words}

    def IsActive(self):
        return not self._needs_document or App.ActiveDocument is not None

    def Activated(self, _index=0):
        from .panel import panel

        self._action(panel())


def _page(index: int):
    return lambda panel: panel.pages.setCurrentIndex(index)


def _import(panel) -> None:
    names = say("Drawings") + " (*.dxf *.ifc)"
    path = QtWidgets.QFileDialog.getOpenFileName(panel, say("Import a candidate"), "", names)[0]
    if path:
        panel.bring(path)


COMMANDS = {
    "Enfilade_Mark": Command("mark", "Mark what may move", _page(0)),
    "Enfilade_Study": Command("study", "Study: say what should get better", _page(1)),
    "Enfilade_Run": Command("run", "Run the study", lambda panel: panel.run()),
    "Enfilade_Look": Command("look", "Look at the options", lambda panel: panel.look()),
    "Enfilade_Accept": Command("accept", "Accept the option", lambda panel: panel.accept()),
    "Enfilade_Import": Command("import", "Import a candidate", _import, needs_document=False),
    "Enfilade_Export": Command("export", "Export for the watched folder", lambda panel: panel.export()),
}


def register() -> list:
    """Adds the commands to FreeCAD; gives their names."""
    for name, command in COMMANDS.items():
        Gui.addCommand(name, command)
    return list(COMMANDS)
