"""Adds the workbench to FreeCAD's window."""

import os

import FreeCADGui as Gui

import freecad.enfilade as package


class EnfiladeWorkbench(Gui.Workbench):
    """Mark, study, look, accept."""

    MenuText = "Enfilade"
    ToolTip = "Better layouts from your own plan"
    Icon = os.path.join(os.path.dirname(package.__file__), "icons", "enfilade.svg")

    def Initialize(self):
        from freecad.enfilade import commands

        names = commands.register()
        self.appendToolbar("Enfilade", names)
        self.appendMenu("Enfilade", names)

    def Activated(self):
        from freecad.enfilade.panel import panel

        panel()

    def GetClassName(self):
        return "Gui::PythonWorkbench"


Gui.addWorkbench(EnfiladeWorkbench())
