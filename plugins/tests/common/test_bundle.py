"""What is handed out is whole: the folders to install and the one-file macro."""

import os
import subprocess
import sys

from conftest import ROOT

BUNDLE = os.path.join(ROOT, "plugins", "bundle.py")


def test_installable_folders_bring_all_they_need(tmp_path):
    subprocess.run([sys.executable, BUNDLE, "dist", str(tmp_path)], check=True)
    workbench = tmp_path / "freecad" / "Enfilade"
    extension = tmp_path / "revit" / "Enfilade.extension"
    for path in (
        workbench / "package.xml",
        workbench / "LICENSE",
        workbench / "freecad" / "enfilade" / "enfilade_common" / "job.py",
        workbench / "freecad" / "enfilade" / "icons" / "enfilade.svg",
        extension / "extension.json",
        extension / "lib" / "enfilade_common" / "job.py",
    ):
        assert path.is_file(), path
    assert not list(tmp_path.rglob("__pycache__"))
    code = "import sys; sys.path.insert(0, sys.argv[1]); from enfilade_revit import work; print(work.job.__file__)"
    words = [sys.executable, "-B", "-c", code, str(extension / "lib")]
    said = subprocess.run(words, stdout=subprocess.PIPE, check=True).stdout.decode()
    assert str(extension) in said, "the package inside is the one that is used"


def test_every_icon_that_is_named_is_there():
    folder = os.path.join(ROOT, "plugins", "freecad", "freecad", "enfilade")
    with open(os.path.join(folder, "commands.py"), encoding="utf-8") as f:
        named = [line.split('Command("')[1].split('"')[0] for line in f if 'Command("' in line]
    assert len(named) == 7
    for name in [*named, "enfilade"]:
        assert os.path.isfile(os.path.join(folder, "icons", name + ".svg")), name


def test_a_changed_source_makes_the_macro_stale():
    assert subprocess.run([sys.executable, BUNDLE, "check"]).returncode == 0
    with open(os.path.join(ROOT, "plugins", "freecad", "Enfilade.FCMacro"), encoding="utf-8") as f:
        text = f.read()
    space = {"__name__": "macro"}
    exec(compile(text.split("class _Bundled")[0], "macro", "exec"), space)
    assert {"enfilade_common.job", "enfilade_macro.panel", "enfilade_macro.__init__"} <= space["SOURCES"].keys()
    with open(os.path.join(ROOT, "plugins", "common", "enfilade_common", "job.py"), encoding="utf-8") as f:
        assert space["SOURCES"]["enfilade_common.job"] == f.read(), "to the letter"
