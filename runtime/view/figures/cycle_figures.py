"""Figures of rainflow cycles: how many there are of each range, and of each range and mean."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...analysis.cycles import Cycles
from ...results.select import split_output
from ..plots import finish_axes
from .drawing import HEIGHT, open_axes, scale_of, style_of
from .load_figures import NAMES

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def draw_ranges(counts: Sequence[Cycles]) -> Figure:
    """Draw how many rainflow cycles there are of each range."""
    shown = list(counts)[:NAMES]
    size, unit = scale_of(shown[0].unit, max(one.largest for one in shown))
    figure, axes = open_axes("Rainflow cycles by range (ASTM E1049)", f"range [{unit}]", "cycles in the bin [1]")
    for number, one in enumerate(shown):
        colour, dash = style_of(number)
        edges, count = one.by_range()
        label = f"{split_output(one.name)[1]}: {one.total:.6g} cycles"
        axes.stairs(count, edges / size, color=colour, ls=dash, lw=1.2, label=label)
    axes.set_yscale("symlog", linthresh=1.0)
    axes.set_xlim(left=0.0)
    finish_axes(axes)
    return figure


def draw_range_means(cycles: Cycles) -> Figure:
    """Draw how many rainflow cycles there are of each range and mean."""
    from matplotlib.colors import LogNorm

    size, unit = scale_of(cycles.unit, cycles.largest)
    title = f"Rainflow cycles by range and mean: {cycles.title}"
    figure, axes = open_axes(title, f"mean [{unit}]", f"range [{unit}]", 1.15 * HEIGHT)
    spans, means, count = cycles.by_range_and_mean()
    shown = np.ma.masked_less_equal(count, 0.0)
    extent = (means[0] / size, means[-1] / size, spans[0] / size, spans[-1] / size)
    image = axes.imshow(
        shown, origin="lower", aspect="auto", extent=extent, cmap="cividis", interpolation="none",
        norm=LogNorm(0.5, max(1.0, float(count.max()))),
    )  # fmt: skip
    figure.colorbar(image, ax=axes, label="cycles in the bin [1]", pad=0.02)
    finish_axes(axes)
    return figure
