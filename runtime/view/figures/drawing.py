"""Axes, units and line thinning that figures share."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from ...analysis.trace import FloatArray
from ..plots import LINE_COLOURS, make_canvas

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH, HEIGHT = 9.0, 4.4
"""Size of a figure with one panel [in]."""
COLUMNS, FEWEST = 1200, 120
"""Columns that the curves of a panel are thinned to, all together, and one curve; each keeps its extremes."""
SIZES = {
    "N": ((1.0, "N"), (1e3, "kN")),
    "N*m": ((1.0, "N m"), (1e3, "kN m")),
    "m": ((1e-6, "µm"), (1e-3, "mm")),
}
"""Unit -> sizes [unit] in which it is shown, and their names, ascending."""
DASHES = ("-", "--", "-.", ":")


def open_axes(title: str, x: str, y: str, height: float = HEIGHT) -> tuple[Figure, Axes]:
    """Make a figure with one panel; labels come with their units in brackets."""
    figure = make_canvas(WIDTH, height)
    axes = figure.add_subplot()
    label_axes(axes, title, x, y)
    return figure, axes


def label_axes(axes: Axes, title: str, x: str, y: str) -> None:
    """Label a panel."""
    axes.set_title(title, loc="left", fontsize=11)
    axes.set_xlabel(x)
    axes.set_ylabel(y)


def scale_of(unit: str, largest: float) -> tuple[float, str]:
    """Return by what values are divided to be shown, and the unit they then have.

    Parameters
    ----------
    unit
        In which values are given.
    largest
        Of them; the largest handy size below it is taken.
    """
    sizes = SIZES.get(unit, ((1.0, unit.replace("*", " ").replace("^2", "²")),))
    return max((size for size in sizes if size[0] <= largest), default=sizes[0])


def style_of(number: int) -> tuple[str, str]:
    """Return colour and dash of a curve by its number from 0: colours first, then dashes."""
    colours = len(LINE_COLOURS)
    return LINE_COLOURS[number % colours], DASHES[number // colours % len(DASHES)]


def dash_of(number: int, curves: int) -> str:
    """Return the dash of a planet's curve: opposite planets may carry the same, so one half lets the other show."""
    return "--" if 2 * number >= curves > 2 else "-"


def columns_for(curves: int) -> int:
    """Return into how many columns each of some curves is thinned."""
    return int(np.clip(COLUMNS // max(curves, 1), FEWEST, COLUMNS // 3))


def thin(x: FloatArray, y: FloatArray, columns: int = COLUMNS // 3) -> tuple[FloatArray, FloatArray]:
    """Return the lowest and the highest point of every column of a curve, so that no peak is lost.

    Parameters
    ----------
    x, y
        Points of the curve, x ascending, shape (n,).
    columns
        Equal parts of the points.
    """
    if x.size <= 2 * columns:
        return x, y
    edges = np.linspace(0, x.size, columns + 1).astype(int)
    kept = [
        first + place
        for first, last in pairwise(edges)
        for place in sorted({int(np.argmin(y[first:last])), int(np.argmax(y[first:last]))})
    ]
    return x[kept], y[kept]


def pool(values: FloatArray, columns: int) -> FloatArray:
    """Return the largest of every column along the last axis, as many columns as asked for at most."""
    count = values.shape[-1]
    if count <= columns:
        return values
    edges = np.linspace(0, count, columns + 1).astype(int)[:-1]
    return np.asarray(np.maximum.reduceat(values, edges, axis=-1))
