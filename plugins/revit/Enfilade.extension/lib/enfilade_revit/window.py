"""Revit's dialogs, as plain as they come with Windows. Never run in Revit; see docs/hosts/revit.md."""

import os

import clr  # type: ignore[import-not-found]

clr.AddReference("System.Windows.Forms")
clr.AddReference("System.Drawing")

from Autodesk.Revit.UI import TaskDialog  # noqa: E402
from System.Diagnostics import Process, ProcessStartInfo  # type: ignore[import-untyped]  # noqa: E402
from System.Drawing import Image, Size  # type: ignore[import-untyped]  # noqa: E402
from System.IO import File, MemoryStream  # type: ignore[import-untyped]  # noqa: E402
from System.Windows.Forms import (  # type: ignore[import-untyped]  # noqa: E402
    Button,
    ColorDepth,
    DialogResult,
    DockStyle,
    FolderBrowserDialog,
    Form,
    ImageList,
    ListBox,
    ListView,
    View,
)


class Window:
    """Says and asks."""

    def tell(self, title, text):
        TaskDialog.Show(title, text)

    def choose_folder(self, title, start):
        dialog = FolderBrowserDialog()
        dialog.Description = title
        dialog.SelectedPath = start
        return dialog.SelectedPath if dialog.ShowDialog() == DialogResult.OK else ""

    def choose(self, title, question, rows):
        """Index of the chosen row, or ``None``."""
        form, box = _form(f"{title}: {question}", 640, 360), ListBox()
        for row in rows:
            box.Items.Add(row)
        box.Dock = DockStyle.Fill
        form.Controls.Add(box)
        form.Controls.Add(_confirm(form))
        chosen = int(box.SelectedIndex) if form.ShowDialog() == DialogResult.OK else -1
        form.Dispose()
        return chosen if chosen >= 0 else None

    def choose_picture(self, title, rows, report):
        """Options with pictures; ``rows`` are (name, words, picture). Index of the chosen one."""
        form, listing, images = _form(title, 1000, 640), ListView(), ImageList()
        images.ImageSize, images.ColorDepth = Size(240, 220), ColorDepth.Depth32Bit
        for name, words, picture in rows:
            if os.path.exists(picture):
                # From memory: a picture read from its file would keep the file locked.
                images.Images.Add(Image.FromStream(MemoryStream(File.ReadAllBytes(picture))))
                listing.Items.Add(f"{name}: {words}", images.Images.Count - 1)
            else:
                listing.Items.Add(f"{name}: {words}")
        listing.LargeImageList, listing.View, listing.Dock = images, View.LargeIcon, DockStyle.Fill
        listing.MultiSelect = False
        form.Controls.Add(listing)
        form.Controls.Add(_confirm(form))
        page = Button()
        page.Text, page.Dock = "Report", DockStyle.Bottom
        page.Click += lambda sender, event: open_file(report)
        form.Controls.Add(page)
        is_chosen = form.ShowDialog() == DialogResult.OK and listing.SelectedIndices.Count == 1
        chosen = int(listing.SelectedIndices[0]) if is_chosen else None
        form.Dispose()
        return chosen


def open_file(path):
    """As a double click would. .NET 8 (Revit 2025) takes a page for a program unless the shell is asked for."""
    wanted = ProcessStartInfo(path)
    wanted.UseShellExecute = True
    Process.Start(wanted)


def _form(title, width, height):
    form = Form()
    form.Text, form.Width, form.Height = title, width, height
    return form


def _confirm(form):
    button = Button()
    button.Text, button.DialogResult, button.Dock = "OK", DialogResult.OK, DockStyle.Bottom
    form.AcceptButton = button
    return button
