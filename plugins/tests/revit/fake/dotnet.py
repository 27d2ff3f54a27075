"""The little of .NET that the extension uses, as pythonnet shows it to Python."""

import os
import uuid


class Int64(int):
    pass


class Guid:
    def __init__(self, text):
        self._value = uuid.UUID(str(text))

    def __eq__(self, other):
        return isinstance(other, Guid) and other._value == self._value

    def __hash__(self):
        return hash(self._value)

    def __str__(self):
        return str(self._value)


class SystemException(Exception):
    pass


class List:
    """``List[ElementId]()``; holds nothing else, and a Python list is none."""

    _kind = object

    def __class_getitem__(cls, kind):
        return type("List", (cls,), {"_kind": kind})

    def __init__(self):
        self._items = []

    def Add(self, item):
        if not isinstance(item, self._kind):
            raise TypeError("wrong kind of item")
        self._items.append(item)

    def __iter__(self):
        return iter(self._items)


class _Moment:
    def __init__(self, ticks):
        self._ticks = ticks

    def ToFileTimeUtc(self):
        return self._ticks


class ProcessStartInfo:
    """``UseShellExecute`` is off unless asked for, since .NET Core."""

    def __init__(self, fileName):
        self.FileName, self.UseShellExecute = fileName, False


class Process:
    """Real processes of this machine; .NET says of one that is not there that there is none."""

    #: What was opened by the shell.
    _opened = []

    def __init__(self, pid):
        self._pid = pid

    @staticmethod
    def GetProcessById(processId):
        process = Process(processId)
        if process._stat() is None:
            raise SystemException(f"Process with an Id of {processId} is not running.")
        return process

    def _stat(self):
        try:
            with open(f"/proc/{self._pid}/stat") as f:
                return f.read().rsplit(")", 1)[1].split()
        except OSError:
            return None

    @property
    def HasExited(self):
        stat = self._stat()
        return stat is None or stat[0] == "Z"

    @property
    def StartTime(self):
        return _Moment(int(self._stat()[19]))

    def Kill(self):
        os.kill(self._pid, 9)

    @staticmethod
    def Start(startInfo):
        """.NET 8 starts programs; a page or a picture only through the shell."""
        if not isinstance(startInfo, ProcessStartInfo) or not startInfo.UseShellExecute:
            raise SystemException("The specified executable is not a valid application for this OS platform.")
        Process._opened.append(startInfo.FileName)
