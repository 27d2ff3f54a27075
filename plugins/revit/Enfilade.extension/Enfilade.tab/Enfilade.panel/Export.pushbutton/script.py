#! python3
"""Writes the walls of this view as a study and runs it."""

from enfilade_revit import work
from enfilade_revit.host import Host
from enfilade_revit.window import Window

window = Window()
work.guarded(window, lambda: work.export_study(Host(__revit__.ActiveUIDocument), window))  # noqa: F821  (pyRevit gives it)
