"""Revit's dialogs, as plain as they come with Windows. Never run in Revit; see the README."""

import os

import clr  # type: ignore[import-not-found]

clr.AddReference("System.Windows.Forms")
clr.AddReference("System.Drawing")

from Autodesk.Revit.UI import TaskDialog  # noqa: E402
from System.Diagnostics import Process  # type: ignore[import-untyped]  # noqa: E402
from System.Drawing import Image, Size  # type: ignore[import-untyped]  # noqa: E402
from System.Windows.Forms import (  # type: ignore[import-untyped]  # noqa: E402
    Button,
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
        chosen = form.ShowDialog() == DialogResult.OK and box.SelectedIndex >= 0
        return int(box.SelectedIndex) if chosen else None

    def choose_picture(self, title, rows, report):
        """Options with pictures; ``rows`` are (name, words, picture). Index of the chosen one."""
        form, listing, images = _form(title, 1000, 640), ListView(), ImageList()
        images.ImageSize = Size(240, 220)
        for i, (name, words, picture) in enumerate(rows):
            if os.path.exists(picture):
                images.Images.Add(Image.FromFile(picture))
                listing.Items.Add(f"{name}: {words}", images.Images.Count - 1)
            else:
                listing.Items.Add(f"{name}: {words}")
        listing.LargeImageList, listing.View, listing.Dock = images, View.LargeIcon, DockStyle.Fill
        listing.MultiSelect = False
        form.Controls.Add(listing)
        form.Controls.Add(_confirm(form))
        page = Button()
        page.Text, page.Dock = "Report", DockStyle.Bottom
        page.Click += lambda sender, event: Process.Start(report)
        form.Controls.Add(page)
        if form.ShowDialog() == DialogResult.OK and listing.SelectedIndices.Count == 1:
            return int(listing.SelectedIndices[0])
        return None


def _form(title, width, height):
    form = Form()
    form.Text, form.Width, form.Height = title, width, height
    return form


def _confirm(form):
    button = Button()
    button.Text, button.DialogResult, button.Dock = "OK", DialogResult.OK, DockStyle.Bottom
    form.AcceptButton = button
    return button
