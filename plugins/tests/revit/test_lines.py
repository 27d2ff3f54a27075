"""Asked after all other tests: did every line run?"""

import os

import pytest
from conftest import LINES

#: Lines that need not run, by file; each with the reason why.
EXCUSED = {}


@pytest.mark.parametrize("name", sorted(n for n in os.listdir(LINES.folder) if n.endswith(".py")))
def test_every_line_ran(name):
    assert LINES.missed(name) == EXCUSED.get(name, []), f"lines of {name} that no test runs"


def test_a_line_that_did_not_run_is_seen(tmp_path):
    """The measure itself: of a function that is never called only its head ran."""
    (tmp_path / "m.py").write_text('"""Doc."""\n\n\ndef f(x):\n    if x:\n        return 1\n    return 2\n\n\nf(True)\n')
    seen = type(LINES)(str(tmp_path))
    try:
        seen.start()
        exec(compile((tmp_path / "m.py").read_text(), str(tmp_path / "m.py"), "exec"), {})
    finally:
        LINES.start()
    assert seen.missed("m.py") == [7]
