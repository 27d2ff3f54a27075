"""The extension over a fake of Revit's API (``fake``); every line of it that runs is kept (``lines``)."""

import os
import sys

import pytest

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.abspath(os.path.join(HERE, "..", "..", ".."))
LIB = os.path.join(ROOT, "plugins", "revit", "Enfilade.extension", "lib")
sys.path[:0] = [os.path.join(ROOT, "plugins", "common"), LIB]

from fake import building, dotnet, forms, install  # noqa: E402
from lines import Lines  # noqa: E402

install.install()
LINES = Lines(os.path.join(LIB, "enfilade_revit"))
LINES.start()

from enfilade_revit.host import Host  # noqa: E402


def pytest_collection_modifyitems(items):
    """Which lines ran is asked last, and only where all tests run."""
    last = [i for i in items if i.path.name == "test_lines.py"]
    items[:] = [i for i in items if i not in last]
    if {i.path.name for i in items} >= {n for n in os.listdir(HERE) if n.startswith("test_")} - {"test_lines.py"}:
        items += last


@pytest.fixture(autouse=True)
def traced():
    """A debugger or another plugin may have taken the trace."""
    LINES.start()
    dotnet.Process._opened, forms.TaskDialog._shown, forms.Image._locked = [], [], []


class FakeWindow:
    """Answers as told; remembers what was said."""

    def __init__(self, *answers):
        self.answers, self.said, self.asked = list(answers), [], []

    def tell(self, title, text):
        self.said.append(text)

    def choose(self, title, question, rows):
        self.asked.append((title, question, rows))
        return self.answers.pop(0)

    def choose_picture(self, title, rows, report):
        self.rows = rows
        return self.answers.pop(0)

    def choose_folder(self, title, start):
        return self.answers.pop(0)


@pytest.fixture
def window():
    return FakeWindow


@pytest.fixture
def revit(tmp_path):
    """The house of the common tests, open in Revit and saved in a folder."""
    model, model.at = building.house(path=str(tmp_path / "Haus Süd.rvt"))
    model.host = lambda view=None: Host(model.uidoc(view))
    yield model
    assert model.doc._open == [] and model.doc._transaction is None and model.doc._group is None


@pytest.fixture
def real_program():
    """The program itself; the runner of these tests names it in ENFILADE."""
    path = os.environ.get("ENFILADE", "")
    assert path and os.path.exists(path), "ENFILADE names no built program; run scripts/test-plugins"
    return path
