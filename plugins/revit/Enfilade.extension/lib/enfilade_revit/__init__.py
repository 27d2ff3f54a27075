"""Enfilade in Revit. Only :mod:`host` knows Revit's API; everything else works on plain data in mm."""

import os
import sys

_COMMON = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", "..", "..", "common")
if os.path.isdir(os.path.join(_COMMON, "enfilade_common")):
    sys.path.append(os.path.realpath(_COMMON))
