"""Figures of a run's course: speeds and torques over time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from ltcgear.generated.errors import LtcgearError

from ...analysis.span import CHANGING
from ...analysis.trace import list_items
from ...model.ties import largest_first, order_by_size
from ...results.train_record import read_train
from ..plots import finish_axes
from .drawing import columns_for, open_axes, scale_of, style_of, thin

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from ...analysis.trace import FloatArray

RPM = 30.0 / np.pi
CURVES = 12
"""Curves in a figure at most."""
TORQUES = {"drive_torque": "drive", "load_torque": "load", "coupling_torque": "shaft"}


def is_changing(dataset: xr.Dataset) -> bool:
    """Say whether a run's speeds, or the torques of its loads, are others at some time of the record than at another.

    Values are first averaged over twentieths of the record, so that vibration does not count.
    """
    for quantity in ("speed", "load_torque"):
        if quantity in dataset and dataset[quantity].size:
            values = dataset[quantity].transpose("time", ...).values
            blocks = np.array([block.mean(axis=0) for block in np.array_split(values, min(20, len(values)))])
            if np.ptp(blocks, axis=0).max() > CHANGING * np.abs(blocks).max():
                return True
    return False


def draw_speeds(dataset: xr.Dataset) -> Figure:
    """Draw the speeds of rotors that are no planets, the fastest first."""
    names = list_items(dataset, "speed")
    if not names:
        raise LtcgearError("the result has no speeds")
    train, values = read_train(dataset), RPM * dataset["speed"].transpose("time", ...).values
    chosen = [k for k in order_by_size(np.abs(values).max(axis=0), names) if not train.is_planet(names[k])]
    return _draw(dataset, "Speeds of rotors", "speed [r/min]", {names[k]: values[:, k] for k in chosen})


def draw_torques(dataset: xr.Dataset) -> Figure:
    """Draw the torques of drives, loads and shafts, the largest first."""
    found = {
        f"{word} {name}": dataset[quantity].transpose("time", ...).values[:, k]
        for quantity, word in TORQUES.items()
        for k, name in enumerate(list_items(dataset, quantity))
    }
    if not found:
        raise LtcgearError("the result has no torques")
    ordered = {name: found[name] for name in largest_first({name: float(np.abs(v).max()) for name, v in found.items()})}
    size, unit = scale_of("N*m", max(float(np.abs(values).max()) for values in found.values()))
    return _draw(dataset, "Torques", f"torque [{unit}]", {name: values / size for name, values in ordered.items()})


def _draw(dataset: xr.Dataset, title: str, y: str, curves: dict[str, FloatArray]) -> Figure:
    """Draw curves over time."""
    figure, axes = open_axes(title, "time [s]", y)
    time, shown = dataset["time"].values, list(curves.items())[:CURVES]
    for number, (name, values) in enumerate(shown):
        colour, dash = style_of(number)
        axes.plot(*thin(time, values, columns_for(len(shown))), dash, color=colour, lw=1.1, label=name)
    axes.margins(x=0.0)
    finish_axes(axes)
    return figure
