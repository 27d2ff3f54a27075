#! python3
"""Says what is marked in this view: detail lines on the line styles EF-QUERY, EF-REFERENCE and EF-KEEP, and the parameters Enfilade Moves, Enfilade Group and Enfilade Keep."""

from enfilade_revit import work
from enfilade_revit.host import Host
from enfilade_revit.window import Window

window = Window()
work.guarded(window, lambda: work.describe_marks(Host(__revit__.ActiveUIDocument), window))  # noqa: F821  (pyRevit gives it)
