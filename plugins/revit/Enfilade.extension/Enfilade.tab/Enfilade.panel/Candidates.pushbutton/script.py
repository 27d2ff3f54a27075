#! python3
"""The options with their pictures; the chosen one is applied."""

from enfilade_revit import work
from enfilade_revit.host import Host
from enfilade_revit.window import Window

window = Window()
work.guarded(window, lambda: work.candidates(Host(__revit__.ActiveUIDocument), window))  # noqa: F821  (pyRevit gives it)
