"""Samples, the program beside it, reference plans where they are."""

import os
import shutil
import subprocess
from pathlib import Path

import matplotlib
import pytest

matplotlib.use("Agg")
ROOT = Path(__file__).resolve().parents[3]
SHARED = Path(os.environ.get("ENFILADE_SHARED", ROOT.parent / "shared"))


@pytest.fixture
def sample(tmp_path):
    """A sample in a folder of its own, by name."""

    def of(name):
        return Path(shutil.copy(ROOT / "samples" / name, tmp_path))

    return of


@pytest.fixture
def enfilade_says(tmp_path):
    """Runs the program; its standard output."""

    def run(*args):
        program = [os.environ["ENFILADE"], *map(str, args)]
        done = subprocess.run(program, cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode in (0, 1), done.stderr
        return done.stdout

    return run


@pytest.fixture
def reference():
    """A reference plan by name; skips where there is none."""

    def of(name):
        path = SHARED / "reference" / name
        if not path.exists():
            pytest.skip(f"{name} is not there")
        return path

    return of
