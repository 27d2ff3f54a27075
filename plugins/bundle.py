#!/usr/bin/env python3
"""Makes what is handed out: the one-file macro, and the folders people install.

``bundle.py macro`` writes ``plugins/freecad/Enfilade.FCMacro``; ``bundle.py dist FOLDER`` writes the FreeCAD
workbench and the Revit extension with the shared package inside. ``bundle.py check`` fails if the macro is
not what the sources make. ``bundle.py pictures FOLDER`` takes the pictures of the manual from the screenshots
of a test run.
"""

import os
import shutil
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
COMMON = os.path.join(HERE, "common", "enfilade_common")
WORKBENCH = os.path.join(HERE, "freecad", "freecad", "enfilade")
MACRO = os.path.join(HERE, "freecad", "Enfilade.FCMacro")

HEADER = '''# -*- coding: utf-8 -*-
"""Enfilade in one file: opens the panel without installing a workbench. Made by plugins/bundle.py."""

__Name__ = "Enfilade"
__Comment__ = "Measures how a plan works for people, and moves the walls you allow to better places"
__Author__ = "The Enfilade project"
__Date__ = "2026-11-21"
__Version__ = "{version}"
__License__ = "MIT OR Apache-2.0"
__Web__ = ""
__Wiki__ = ""
__Icon__ = ""
__Help__ = "Mark walls in the panel, run the study, look at the options, accept one"
__Status__ = "Stable"
__Requires__ = "FreeCAD >= 0.20, the program enfilade"
__Communication__ = ""
__Files__ = ""

import importlib.abc
import importlib.util
import sys

'''

FOOTER = '''

class _Bundled(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Imports the modules that stand in this file."""

    def find_spec(self, name, path=None, target=None):
        for module, is_package in ((name + ".__init__", True), (name, False)):
            if module in SOURCES:
                return importlib.util.spec_from_loader(name, self, is_package=is_package)
        return None

    def create_module(self, spec):
        return None

    def exec_module(self, module):
        name = module.__name__
        name = name + ".__init__" if name + ".__init__" in SOURCES else name
        module.__file__ = __name__ + "/" + name
        exec(compile(SOURCES[name], "Enfilade.FCMacro:" + name, "exec"), module.__dict__)


if not any(type(finder).__name__ == "_Bundled" for finder in sys.meta_path):
    sys.meta_path.insert(0, _Bundled())

from enfilade_macro.panel import panel  # noqa: E402

panel()
'''


def modules(folder, package):
    """Name and source of every module of a package, in order."""
    for name in sorted(os.listdir(folder)):
        if name.endswith(".py"):
            with open(os.path.join(folder, name), encoding="utf-8") as f:
                yield f"{package}.{name[:-3]}", f.read()


def macro_text():
    """The macro: header, all modules as strings, an importer for them."""
    version = next(s for n, s in modules(COMMON, "c") if n == "c.__init__").split('__version__ = "')[1].split('"')[0]
    sources = dict(modules(COMMON, "enfilade_common"))
    needless = ("enfilade_macro.init_gui", "enfilade_macro.commands")
    sources.update((n, s) for n, s in modules(WORKBENCH, "enfilade_macro") if n not in needless)
    sources["enfilade_macro.__init__"] = '"""The workbench, inside the macro."""\n'
    rows = [f"SOURCES[{name!r}] = {literal(source)}\n" for name, source in sorted(sources.items())]
    return HEADER.replace("{version}", version) + "SOURCES = {}\n" + "\n".join(rows) + FOOTER


def literal(source):
    """Source text as a triple-quoted string that can still be read."""
    return "'''" + source.replace("\\", "\\\\").replace("'''", "\\'\\'\\'") + "'''"


def write_dist(folder):
    """Workbench and extension, each whole in a folder of its own."""
    ignore = shutil.ignore_patterns("__pycache__", "*.pyc")
    workbench = os.path.join(folder, "freecad", "Enfilade")
    shutil.copytree(os.path.join(HERE, "freecad"), workbench, ignore=ignore)
    shutil.copytree(COMMON, os.path.join(workbench, "freecad", "enfilade", "enfilade_common"), ignore=ignore)
    extension = os.path.join(folder, "revit", "Enfilade.extension")
    shutil.copytree(os.path.join(HERE, "revit", "Enfilade.extension"), extension, ignore=ignore)
    shutil.copytree(COMMON, os.path.join(extension, "lib", "enfilade_common"), ignore=ignore)
    for name in ("LICENSE-MIT", "LICENSE-APACHE"):
        for part in (workbench, extension):
            shutil.copy(os.path.join(HERE, "..", name), part)
    shutil.copy(os.path.join(HERE, "..", "LICENSE-MIT"), os.path.join(workbench, "LICENSE"))


#: Picture of the manual, screenshot of the window test it is.
PICTURES = {
    "freecad-selected": "02-selected",
    "freecad-marked": "03-marked",
    "freecad-works": "32-works-marked",
    "freecad-regions": "03b-regions",
    "freecad-options": "04-options",
    "freecad-isometric": "06-option-3-isometric",
    "freecad-accepted": "09-another",
    "freecad-refused": "11-refused",
    "freecad-running": "12-running",
    "librecad-template": "librecad-template",
    "librecad-option": "librecad-option",
}


def take_pictures(folder):
    """Copies screenshots into the manual, smaller and in fewer colours."""
    target = os.path.join(HERE, "..", "docs", "hosts", "pictures")
    os.makedirs(target, exist_ok=True)
    for name, shot in PICTURES.items():
        words = ["convert", os.path.join(folder, shot + ".png"), "-resize", "1200x", "+dither", "-colors", "200"]
        subprocess.run([*words, "-strip", os.path.join(target, name + ".png")], check=True)


def main(words):
    if words == ["macro"]:
        with open(MACRO, "w", encoding="utf-8") as f:
            f.write(macro_text())
    elif words == ["check"]:
        with open(MACRO, encoding="utf-8") as f:
            if f.read() != macro_text():
                sys.exit("plugins/freecad/Enfilade.FCMacro is not current: run plugins/bundle.py macro")
    elif len(words) == 2 and words[0] == "pictures":
        take_pictures(words[1])
    elif len(words) == 2 and words[0] == "dist":
        write_dist(words[1])
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main(sys.argv[1:])
