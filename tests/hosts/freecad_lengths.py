"""Run inside freecadcmd: how much is drawn on each layer of a DXF, as FreeCAD's importer reads it.

Reads the path from ENFILADE_DXF, writes `LAYER EDGES LENGTH_MM` lines to ENFILADE_OUT. freecadcmd hides
exceptions, so the process ends itself with a true exit code.
"""
import os
import sys
import traceback

code = 1
try:
    import FreeCAD
    import importDXF

    preferences = FreeCAD.ParamGet("User parameter:BaseApp/Preferences/Mod/Draft")
    preferences.SetBool("dxfUseLegacyImporter", False)
    preferences.SetBool("groupLayers", True)
    preferences.SetBool("dxfShowDialog", False)
    document = FreeCAD.newDocument("read")
    importDXF.insert(os.environ["ENFILADE_DXF"], document.Name)
    with open(os.environ["ENFILADE_OUT"], "w") as out:
        for thing in document.Objects:
            edges = thing.Shape.Edges if hasattr(thing, "Shape") else []
            out.write("%s %d %.6f\n" % (thing.Label, len(edges), sum(e.Length for e in edges)))
    code = 0
except BaseException:
    traceback.print_exc()
sys.stdout.flush()
sys.stderr.flush()
os._exit(code)
