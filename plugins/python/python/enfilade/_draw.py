"""A plan with matplotlib, in the program's colours."""

from __future__ import annotations

from math import floor, log10
from typing import TYPE_CHECKING, Any, List, Optional

from ._needed import needed

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ._enfilade import Present

INK = "#16181c"
#: Columns that every table has: to draw one, no other needs to be measured.
ALWAYS = ("degree", "depth", "entropy")


def cells(ax: Axes, present: Present, measure: str, radius: Optional[float]) -> None:
    """Each cell as a square of the colour of its value, with the key of the colours."""
    numpy = needed("numpy", "show()")
    colors = needed("matplotlib.colors", "show()")
    asked = "Connectivity" if measure.strip().lower() in ALWAYS else measure
    _, x, y, columns = present.cells([asked], radius, [], True)
    name, values, unit, (low, high), colours = _column(columns, measure)
    side = present.spacing_m
    column, row = (numpy.rint((at - at.min()) / side).astype(int) for at in (x, y))
    image = numpy.full((row.max() + 1, column.max() + 1), numpy.nan)
    image[row, column] = values
    table = numpy.frombuffer(colours, numpy.uint8).reshape(-1, 3) / 255
    left, right, bottom, top = x.min() - side / 2, x.max() + side / 2, y.min() - side / 2, y.max() + side / 2
    shown = ax.imshow(
        image,
        extent=(left, right, bottom, top),
        origin="lower",
        interpolation="nearest",
        cmap=colors.ListedColormap(table),
        vmin=low,
        vmax=high,
    )
    key = ax.figure.colorbar(shown, ax=ax, shrink=0.7)
    key.set_label(f"{name}, {unit}" if unit else name)


def _column(columns: Any, measure: str) -> Any:
    """The column of a measure, also within a radius."""
    asked = measure.strip().lower()
    named = [c for c in columns if c[0].lower() == asked or c[0].lower().startswith(f"{asked} r")]
    return named[0] if named else columns[0]


def walls(ax: Axes, present: Present) -> None:
    """Walls as lines and filled outlines, and a scale bar; the frame of the axes goes."""
    collections = needed("matplotlib.collections", "show()")
    filled: List[Any] = []
    lines: List[Any] = []
    for points, is_closed, is_filled, _ in present.walls():
        line = [*points, points[0]] if is_closed else points
        (filled if is_filled else lines).append(line)
    ax.add_collection(collections.LineCollection(lines, colors=INK, linewidths=1.0))
    ax.add_collection(collections.PolyCollection(filled, facecolors=INK, edgecolors=INK, linewidths=0.6))
    ax.autoscale_view()
    ax.set_aspect("equal")
    ax.set_axis_off()
    _scale_bar(ax)


def _scale_bar(ax: Axes) -> None:
    """A bar of a round length, at most a quarter of the plan wide, below it."""
    left, right = ax.get_xlim()
    bottom, top = ax.get_ylim()
    most = (right - left) / 4
    power = 10.0 ** floor(log10(most))
    length = power * max(step for step in (1, 2, 5) if step * power <= most)
    y = bottom - (top - bottom) * 0.03
    ax.plot([left, left + length], [y, y], color=INK, linewidth=3, solid_capstyle="butt", label="scale bar")
    ax.annotate(
        f"{length:g} m", (left + length, y), (6, 0), textcoords="offset points", va="center", color=INK
    )
