#! python3
"""Moves the walls, columns, doors and windows of the model to an option, as one undo step."""

from enfilade_revit import work
from enfilade_revit.host import Host
from enfilade_revit.window import Window

window = Window()
work.guarded(window, lambda: work.apply_option(Host(__revit__.ActiveUIDocument), window))  # noqa: F821  (pyRevit gives it)
