"""Figures of Sobol indices: bars of what each varied number brings to a metric's variance."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...studies.sweep.influence import SobolIndices
from ...studies.sweep.sweep_reading import shorten
from ..plots import BLUE, ORANGE, make_canvas
from .drawing import WIDTH, label_axes

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PANELS = 4
"""Maps and groups of bars that a figure has at most."""


def draw_influences(found: list[SobolIndices]) -> Figure:
    """Draw first-order and total Sobol indices with their confidence, a panel for each number, the first few.

    Parameters
    ----------
    found
        Of one metric, from ``find_influences``.
    """
    shown = [one for one in found if np.isfinite(one.first).all()][:PANELS]
    keys = shown[0].axes
    columns = min(len(shown), 2)
    rows = -(-len(shown) // columns)
    figure = make_canvas(WIDTH * (0.8 + 0.4 * (columns - 1)), rows * (1.2 + 0.55 * len(keys)) + 0.5)
    panels = figure.subplots(rows, columns, squeeze=False, sharey=True, sharex=True)
    place, prefix, names = np.arange(len(keys)), *shorten(keys)
    for axes, one in zip(panels.flat, shown, strict=False):
        for shift, colour, label, value, half in (
            (-0.2, BLUE, "first order", one.first, one.first_confidence),
            (0.2, ORANGE, "total", one.total, one.total_confidence),
        ):
            axes.barh(place + shift, value, 0.36, xerr=half, color=colour, label=label, capsize=2.0, ecolor="black",
                      error_kw={"lw": 0.9})  # fmt: skip
        axes.set_yticks(place, names, fontsize=9)
        label_axes(axes, one.item or one.metric, "share of the variance [1]", "")
        axes.grid(axis="x", alpha=0.25, lw=0.5)
        axes.set_axisbelow(True)
        axes.spines[["top", "right"]].set_visible(False)
    panels.flat[0].invert_yaxis()
    for axes in panels.flat[len(shown) :]:
        axes.set_visible(False)
    handles, labels = panels.flat[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower right", ncols=2, frameon=False, fontsize=9)
    whose = f" of keys of {prefix.removesuffix('.')}" if prefix else ""
    figure.suptitle(
        f"{shown[0].metric}: Sobol indices{whose}, {shown[0].blocks} blocks", x=0.01, ha="left", fontsize=11
    )
    return figure
