"""Running the program under Qt's event loop, so that FreeCAD's window never waits for it."""

from enfilade_common import program

from .qt import QtCore


class Runner(QtCore.QObject):
    """One run at a time. ``progressed(Progress)``, ``ended(code, words)``."""

    progressed = QtCore.Signal(object)
    ended = QtCore.Signal(int, str)

    def __init__(self, parent=None):
        super().__init__(parent)
        self._process = None
        self._listener = None
        self._is_stopped = False

    def is_running(self) -> bool:
        return self._process is not None

    def start(self, path: str, drawing: str) -> None:
        self._listener, self._is_stopped = program.Listener(), False
        self._process = QtCore.QProcess(self)
        self._process.readyReadStandardError.connect(self._read)
        self._process.finished.connect(self._finished)
        self._process.errorOccurred.connect(self._failed)
        self._process.setStandardOutputFile(QtCore.QProcess.nullDevice())
        self._process.setStandardInputFile(QtCore.QProcess.nullDevice())
        process = self._process
        process.started.connect(lambda: program.give_way(int(process.processId())))
        process.start(path, program.arguments(drawing, keeps_best=True))

    @property
    def so_far(self) -> str:
        """Folder of the best so far of this run; empty before it was written."""
        return self._listener.so_far if self._listener is not None else ""

    def stop(self) -> bool:
        """Asks the program to stop; kills it if it does not. Where something was measured and nothing kept yet,
        waits for that first, and says so; asked again, it does not."""
        if self._process is None:
            return False
        waits = not self._is_stopped and bool(self._listener.evaluations) and not self.so_far
        self._is_stopped = True
        if not waits:
            self._interrupt()
        return waits

    def _interrupt(self) -> None:
        process = self._process
        if not process.processId():
            return
        try:
            program.interrupt(int(process.processId()))
        except (OSError, ValueError):
            process.kill()
        QtCore.QTimer.singleShot(int(program.STOP_SECS * 1000), lambda: self._kill(process))

    def _kill(self, process) -> None:
        if self._process is process:
            process.kill()

    def _read(self) -> None:
        if self._process is None:
            return
        for progress in self._listener.feed(bytes(self._process.readAllStandardError())):
            self.progressed.emit(progress)
            if self._is_stopped and progress.stage == program.SO_FAR:
                self._interrupt()

    def _finished(self, code, status=None) -> None:
        if self._process is None:
            return
        self._read()
        crashed = self._process.exitStatus() == QtCore.QProcess.CrashExit
        self._process.deleteLater()
        self._process = None
        if crashed:
            # Qt gives the number of the signal; on Windows the code of the exception.
            code = 130 if self._is_stopped else -abs(int(code))
        code = int(code)
        self.ended.emit(code, self._listener.outcome(code))

    def _failed(self, error) -> None:
        if self._process is not None and error == QtCore.QProcess.FailedToStart:
            words = self._process.errorString()
            self._process.deleteLater()
            self._process = None
            self.ended.emit(4, f"The program does not start: {words}.")
