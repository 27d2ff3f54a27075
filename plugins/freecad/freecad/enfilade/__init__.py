"""Enfilade in FreeCAD: mark what may move, study, look at options, accept one."""

import importlib.util
import os
import sys


def _find_common():
    """Makes the shared package importable: bundled beside this one, or in a checkout of the project."""
    if importlib.util.find_spec("enfilade_common") is not None:
        return
    here = os.path.dirname(os.path.realpath(__file__))
    for folder in (here, os.path.join(here, "..", "..", "..", "common")):
        if os.path.isdir(os.path.join(folder, "enfilade_common")):
            sys.path.append(os.path.realpath(folder))
            return
    raise ImportError("the package enfilade_common lies neither beside the workbench nor in a checkout")


_find_common()
