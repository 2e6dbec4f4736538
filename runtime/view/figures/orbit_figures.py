"""Figures of orbits: the paths of members, with clearance and static position."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...analysis.orbits import Orbit
from ..plots import BLUE, GREY, ORANGE, VERMILLION, make_canvas
from .drawing import label_axes, scale_of

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ACROSS = 4
"""Panels in a row."""
MOST = 12
REST = 1e-12
"""Largest distance of a member that is at rest [m]."""


def draw_orbits(orbits: Sequence[Orbit]) -> Figure:
    """Draw the paths of members' centres, a panel each; those at rest are left out where others move."""
    moving = [orbit for orbit in orbits if _reach(orbit) > REST] or list(orbits)
    shown = moving[:MOST]
    across = min(ACROSS, len(shown))
    down = -(-len(shown) // across)
    figure = make_canvas(2.9 * across + 1.9, 3.1 * down + 0.5)
    grid = figure.subplots(down, across, squeeze=False).ravel()
    for axes, orbit in zip(grid, shown, strict=False):
        _draw_orbit(axes, orbit)
    for axes in grid[len(shown) :]:
        axes.set_axis_off()
    figure.suptitle("Paths of members in axes that turn with their carriers", x=0.01, ha="left", fontsize=11)
    known: dict[str, Artist] = {}
    for axes in grid[: len(shown)]:
        handles, labels = axes.get_legend_handles_labels()
        known |= dict(zip(labels, handles, strict=True))
    figure.legend(list(known.values()), list(known), loc="outside right upper", frameon=False, fontsize=9)
    return figure


def _reach(orbit: Orbit) -> float:
    """Return the largest displacement [m]."""
    return float(np.hypot(orbit.x, orbit.y).max())


def _draw_orbit(axes: Axes, orbit: Orbit) -> None:
    """Draw one path."""
    size, unit = scale_of("m", max(_reach(orbit), orbit.clearance or 0.0))
    # A path has no columns to thin; as a picture within the figure it stays small whatever its length.
    axes.plot(orbit.x / size, orbit.y / size, color=BLUE, lw=0.6, label="path", rasterized=True)
    axes.plot(*(value / size for value in orbit.centre), "+", color=VERMILLION, ms=9, label="mean place")
    if orbit.static is not None:
        axes.plot(*(value / size for value in orbit.static), "x", color=ORANGE, ms=7, label="static place")
    if orbit.clearance:
        turn = np.linspace(0.0, 2.0 * np.pi, 121)
        ring = orbit.clearance / size
        axes.plot(ring * np.cos(turn), ring * np.sin(turn), color=GREY, lw=0.9, ls="--", label="radial clearance")
    axes.set_aspect("equal", adjustable="datalim")
    label_axes(axes, orbit.member + (" (floating)" if orbit.floating else ""), f"x [{unit}]", f"y [{unit}]")
    axes.ticklabel_format(useOffset=False)
    axes.locator_params(nbins=4)
    axes.grid(alpha=0.25, lw=0.5)
