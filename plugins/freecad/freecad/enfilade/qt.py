"""Qt under the names of every FreeCAD: in 0.20 widgets stand in QtGui, later in QtWidgets."""

from PySide import QtCore, QtGui  # noqa: F401

try:
    from PySide import QtWidgets  # noqa: F401
except ImportError:
    QtWidgets = QtGui
