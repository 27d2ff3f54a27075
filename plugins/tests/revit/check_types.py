#!/usr/bin/env python3
"""Checks the Revit extension against the published stubs of Revit's API (pyrevit-stubs-25, mypy).

The stubs are generated and do not all parse: empty classes lack a body, and a method is called
``None``. A copy with those repaired is what mypy reads.
"""

import importlib.util
import os
import re
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.realpath(__file__))
PLUGINS = os.path.join(HERE, "..", "..")
LIB = os.path.join(PLUGINS, "revit", "Enfilade.extension", "lib")

CONFIG = """[mypy]
python_version = 3.11
explicit_package_bases = True
namespace_packages = True
check_untyped_defs = True
disable_error_code = abstract
[mypy-Autodesk.*]
ignore_errors = True
"""


def repaired(text):
    """A stub that parses: empty classes get a body, a method named None an underscore."""
    lines = text.split("\n")
    out = []
    for i, line in enumerate(lines):
        out.append(re.sub(r"\bdef None\(", "def None_(", line))
        head = re.match(r"(\s*)class .*:\s*(#.*)?$", line)
        if head:
            rest = next((later for later in lines[i + 1 :] if later.strip()), "")
            if len(rest) - len(rest.lstrip()) <= len(head.group(1)):
                out.append(head.group(1) + "    ...")
    return "\n".join(out)


def main():
    spec = importlib.util.find_spec("Autodesk")
    if spec is None or not spec.submodule_search_locations:
        sys.exit("pyrevit-stubs-25 is not installed for this Python; scripts/setup installs it into .venv")
    source = list(spec.submodule_search_locations)[0]
    with tempfile.TemporaryDirectory() as folder:
        for at, _, names in os.walk(source):
            target = os.path.join(folder, "Autodesk", os.path.relpath(at, source))
            os.makedirs(target, exist_ok=True)
            for name in (n for n in names if n.endswith(".pyi")):
                with open(os.path.join(at, name), encoding="utf-8-sig") as f:
                    text = repaired(f.read())
                with open(os.path.join(target, name), "w", encoding="utf-8") as f:
                    f.write(text)
        config = os.path.join(folder, "mypy.ini")
        with open(config, "w") as f:
            f.write(CONFIG)
        path = os.pathsep.join((os.path.realpath(os.path.join(PLUGINS, "common")), folder))
        words = [sys.executable, "-m", "mypy", "--config-file", config, "--cache-dir", os.path.join(folder, "cache")]
        done = subprocess.run([*words, "enfilade_revit"], cwd=LIB, env={**os.environ, "MYPYPATH": path})
        sys.exit(done.returncode)


if __name__ == "__main__":
    main()
