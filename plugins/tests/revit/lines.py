"""Which lines of our modules ran, by Python's own trace."""

import dis
import os
import sys


class Lines:
    """Traces the files of a folder from :meth:`start` on."""

    def __init__(self, folder):
        self.folder = os.path.realpath(folder)
        self.ran = {}
        self._known = {}

    def start(self):
        sys.settrace(self._call)

    def _call(self, frame, event, arg):
        name = frame.f_code.co_filename
        if name not in self._known:
            path = os.path.realpath(name)
            self._known[name] = path if os.path.dirname(path) == self.folder else None
        if self._known[name] is None:
            return None
        ran = self.ran.setdefault(self._known[name], set())
        ran.add(frame.f_lineno)

        def line(frame, event, arg):
            ran.add(frame.f_lineno)
            return line

        return line

    def missed(self, name):
        """Lines with code of a file that never ran."""
        path = os.path.join(self.folder, name)
        with open(path, encoding="utf-8") as f:
            code = compile(f.read(), path, "exec")
        return sorted(_lines(code) - self.ran.get(path, set()))


def _lines(code):
    out = {line for _, line in dis.findlinestarts(code) if line}
    for inner in code.co_consts:
        if hasattr(inner, "co_code"):
            # Where a function begins is no line of its own; a module begins at line 0.
            out |= _lines(inner)
    return out
