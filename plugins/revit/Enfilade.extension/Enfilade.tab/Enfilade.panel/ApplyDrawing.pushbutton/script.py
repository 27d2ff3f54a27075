#! python3
"""Moves the model to an option of a drawing that Revit itself exported."""

from enfilade_revit import work
from enfilade_revit.host import Host
from enfilade_revit.window import Window

window = Window()
work.guarded(window, lambda: work.apply_drawing(Host(__revit__.ActiveUIDocument), window))  # noqa: F821  (pyRevit gives it)
