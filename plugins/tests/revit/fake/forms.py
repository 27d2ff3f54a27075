"""Windows' dialogs: each keeps what it was given; who answers them is ``_answer``."""

import enum
import os


class DialogResult(enum.Enum):
    OK = 1
    Cancel = 2


class DockStyle(enum.Enum):
    Bottom = 2
    Fill = 5


class ColorDepth(enum.Enum):
    Depth32Bit = 32


class View(enum.Enum):
    LargeIcon = 0


class Size:
    def __init__(self, width, height):
        self.Width, self.Height = width, height


class MemoryStream:
    def __init__(self, data):
        self._data = data


class File:
    @staticmethod
    def ReadAllBytes(path):
        with open(path, "rb") as f:
            return f.read()


class Image:
    """A picture from a file keeps the file locked; the tests know by ``_locked``."""

    _locked = []

    @staticmethod
    def FromFile(filename):
        Image._locked.append(filename)
        return Image()

    @staticmethod
    def FromStream(stream):
        assert stream._data
        return Image()


class _Items(list):
    def Add(self, *item):
        self.append(item if len(item) > 1 else item[0])

    @property
    def Count(self):
        return len(self)


class _Event:
    def __init__(self):
        self._calls = []

    def __iadd__(self, call):
        self._calls.append(call)
        return self


class Control:
    def __init__(self):
        self.Text, self.Dock = "", None


class Button(Control):
    def __init__(self):
        super().__init__()
        self.Click, self.DialogResult = _Event(), None

    def _press(self):
        for call in self.Click._calls:
            call(self, None)


class ListBox(Control):
    def __init__(self):
        super().__init__()
        self.Items, self.SelectedIndex = _Items(), -1


class ListView(Control):
    def __init__(self):
        super().__init__()
        self.Items, self.SelectedIndices = _Items(), _Items()


class ImageList:
    def __init__(self):
        self.Images = _Items()


class Form(Control):
    """What was open last, and who answers it: a function of the form that gives the result."""

    _answer = None

    def __init__(self):
        super().__init__()
        self.Controls, self._gone = _Items(), False

    def ShowDialog(self):
        return type(self)._answer(self)

    def _of(self, kind):
        return [c for c in self.Controls if type(c) is kind]

    def Dispose(self):
        self._gone = True
        for box in self._of(ListBox):
            box.SelectedIndex = -1
        for view in self._of(ListView):
            view.SelectedIndices.clear()


class FolderBrowserDialog:
    _answer = None

    def ShowDialog(self):
        if self._answer is None:
            return DialogResult.Cancel
        assert os.path.isdir(self.SelectedPath) or self.SelectedPath == ""
        self.SelectedPath = self._answer
        return DialogResult.OK


class TaskDialog:
    _shown = []

    @staticmethod
    def Show(title, mainInstruction):
        TaskDialog._shown.append((title, mainInstruction))
