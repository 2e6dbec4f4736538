"""Figures of step sizes and switchings over time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from ltcgear.generated.errors import LtcgearError

from ..figures.drawing import open_axes, thin
from ..plots import BLUE, VERMILLION, finish_axes

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

BINS = 120
"""Spans that switchings are counted in, at most."""


def draw_steps(dataset: xr.Dataset) -> Figure:
    """Draw the mean size of the integrator's steps between samples.

    Parameters
    ----------
    dataset
        Result with ``steps`` (time).

    Raises
    ------
    LtcgearError
        If no step was taken between any two samples.
    """
    time, taken = dataset["time"].values, np.diff(dataset["steps"].values)
    known = taken > 0
    if not known.any():
        raise LtcgearError("no steps are known between the samples")
    figure, axes = open_axes("Size of the integrator's steps", "time [s]", "step size [µs]")
    axes.semilogy(*thin(time[1:][known], 1e6 * np.diff(time)[known] / taken[known]), color=BLUE, lw=0.9)
    axes.set_xlim(time[0], time[-1])
    finish_axes(axes)
    return figure


def draw_switchings(dataset: xr.Dataset) -> Figure:
    """Draw how often meshes change their stiffness or their contact, as seen at the samples."""
    time, changes = dataset["time"].values, count_changes(dataset)
    edges = np.linspace(time[0], time[-1], min(BINS, time.size - 1) + 1)
    rate = np.histogram(time[1:], edges, weights=changes)[0] / np.diff(edges)
    figure, axes = open_axes("Switchings", "time [s]", "switchings a second [1/s]")
    axes.step(np.append(edges[:-1], time[-1]), np.append(rate, rate[-1]), where="post", color=VERMILLION, lw=1.1)
    axes.set_xlim(time[0], time[-1])
    axes.set_ylim(0.0, max(float(rate.max()), 1.0) * 1.08)
    finish_axes(axes)
    return figure


def count_changes(dataset: xr.Dataset) -> NDArray[np.float64]:
    """Return how many meshes change stiffness or contact between samples, shape (n - 1,)."""
    changes = np.zeros(dataset.sizes["time"] - 1)
    for quantity in ("mesh_level", "mesh_contact"):
        if quantity in dataset:
            values = dataset[quantity].transpose("time", ...).values
            changes += (np.diff(values.astype(np.int8), axis=0) != 0).sum(axis=1)
    return changes
