#! python3
"""Gives walls, columns, doors and windows the parameters Enfilade Moves, Enfilade Group and Enfilade Keep."""

from enfilade_revit import work
from enfilade_revit.host import Host
from enfilade_revit.window import Window

window = Window()
work.guarded(window, lambda: work.add_parameters(Host(__revit__.ActiveUIDocument), window))  # noqa: F821  (pyRevit gives it)
