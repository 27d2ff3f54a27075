#! python3
"""Revit's own DXF (AIA layers, shared coordinates) or IFC of this view, into the watched folder."""

from enfilade_revit import work
from enfilade_revit.host import Host
from enfilade_revit.window import Window

window = Window()
work.guarded(window, lambda: work.export_drawing(Host(__revit__.ActiveUIDocument), window))  # noqa: F821  (pyRevit gives it)
