"""Puts the fake where Python looks for Revit and .NET."""

import sys
import types

from . import document, dotnet, elements, failures, forms, geometry, walls

#: Namespaces and what of the fake stands in each.
DB = {
    name: value
    for module in (geometry, failures, elements, walls, document)
    for name, value in vars(module).items()
    if isinstance(value, type) and value.__module__ == module.__name__ and not name.startswith("_")
}
EXCEPTIONS = {name: DB.pop(name) for name in list(DB) if name.endswith("Exception")}
APPLICATION = {"Application": DB.pop("Application")}
UI = {"UIDocument": DB.pop("UIDocument"), "TaskDialog": forms.TaskDialog}
SPACES = {
    "Autodesk.Revit.DB": DB,
    "Autodesk.Revit.Exceptions": EXCEPTIONS,
    "Autodesk.Revit.ApplicationServices": APPLICATION,
    "Autodesk.Revit.UI": UI,
    "System": {"Guid": dotnet.Guid, "Int64": dotnet.Int64},
    "System.Collections.Generic": {"List": dotnet.List},
    "System.Diagnostics": {"Process": dotnet.Process, "ProcessStartInfo": dotnet.ProcessStartInfo},
    "System.Drawing": {"Image": forms.Image, "Size": forms.Size},
    "System.IO": {"File": forms.File, "MemoryStream": forms.MemoryStream},
    "System.Windows.Forms": {
        name: value for name, value in vars(forms).items() if isinstance(value, type) and not name.startswith("_")
    },
}


def install():
    for space, names in SPACES.items():
        parts = space.split(".")
        for i in range(1, len(parts) + 1):
            sys.modules.setdefault(".".join(parts[:i]), types.ModuleType(".".join(parts[:i])))
        vars(sys.modules[space]).update(names)
    clr = types.ModuleType("clr")
    clr.AddReference = lambda name: None
    sys.modules["clr"] = clr
