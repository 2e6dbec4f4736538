"""Time signal of one output, and how it is found by name."""

from __future__ import annotations

from dataclasses import dataclass
from decimal import ROUND_CEILING, ROUND_FLOOR, Context
from typing import TYPE_CHECKING

import numpy as np
from ltcgear.generated.errors import LtcgearError
from numpy.typing import NDArray

from ..results.select import find_columns, split_output
from ..results.train_record import read_train

if TYPE_CHECKING:
    import xarray as xr

FloatArray = NDArray[np.float64]
FEWEST = 64
"""Samples below which a window is too short to be analysed."""
AXES = ("_x", "_y")


@dataclass(frozen=True)
class Trace:
    """One output over a window of time.

    Attributes
    ----------
    name
        ``mesh_force:psh.mesh``.
    title
        The same in words: ``normal mesh force of psh.mesh``.
    unit
        Of the values.
    time, values
        Uniform instants [s] and samples [unit], shape (n,) each.
    """

    name: str
    title: str
    unit: str
    time: FloatArray
    values: FloatArray

    @property
    def rate(self) -> float:
        """Return the sampling rate [Hz]."""
        return float((self.time.size - 1) / (self.time[-1] - self.time[0]))


def read_trace(signal: xr.DataArray) -> Trace:
    """Read an output over time, such as ``result.mesh["psh.mesh"].force``.

    Raises
    ------
    LtcgearError
        If it is not one output over time, has fewer than `FEWEST` samples or samples that are not numbers.
    """
    name = name_of(signal)
    if signal.dims != ("time",):
        raise LtcgearError(f"{name}: has the dimensions {', '.join(map(str, signal.dims))}; choose one item over time")
    values = np.asarray(signal.values, dtype=np.float64)
    time = np.asarray(signal["time"].values, dtype=np.float64)
    if values.size < FEWEST:
        raise LtcgearError(f"{name}: {values.size} samples are too few, {FEWEST} at least; choose a longer window")
    missing = np.flatnonzero(~np.isfinite(values))
    if missing.size:
        raise LtcgearError(f"{name}: not a number from {time[missing[0]]:.6g} s on; choose a window that leaves it out")
    words, item = str(signal.attrs.get("long_name", signal.name or "signal")), split_output(name)[1]
    return Trace(name, f"{words} of {item}" if item else words, unit_of(signal), time, values)


def tell_bounds(low: float, high: float) -> tuple[str, str]:
    """Return bounds in four digits, rounded inwards, so that what is told is accepted."""
    ends = ((low, ROUND_CEILING), (high, ROUND_FLOOR))
    low_text, high_text = (f"{float(Context(4, way).create_decimal(f'{value:.9g}')):g}" for value, way in ends)
    return low_text, high_text


def unit_of(signal: xr.DataArray) -> str:
    """Return the unit of an output."""
    return str(signal.attrs.get("units", "1"))


def name_of(signal: xr.DataArray) -> str:
    """Name an output as QUANTITY:ITEM; the item is the one label that is left of a dimension."""
    items = [str(value.values) for key, value in signal.coords.items() if key != "time" and value.ndim == 0]
    return ":".join([str(signal.name or "signal"), *items[:1]])


def select_output(dataset: xr.Dataset, wanted: str, option: str = "--output ") -> tuple[xr.DataArray, ...]:
    """Find an output by QUANTITY:ITEM.

    Parameters
    ----------
    dataset
        Simulation result.
    wanted
        Such as ``mesh_force:psh.mesh``; ``acceleration:lsp.sun`` means both axes.
    option
        Prefix of a refused output, as the user gave it.

    Returns
    -------
    tuple of xarray.DataArray
        One over time, or those of x and y.

    Raises
    ------
    LtcgearError
        If there is no such output; the nearest is named.
    """
    quantity, item = split_output(wanted)
    if not item:
        raise LtcgearError(f"{option}{wanted}: write QUANTITY:ITEM, for example mesh_force:psh.mesh")
    pair = [quantity + axis for axis in AXES]
    names = pair if all(name in dataset for name in pair) else [quantity]
    find_columns(dataset, [f"{name}:{item}" for name in names], option)
    return tuple(pick(dataset, name, item) for name in names)


def phase_of(dataset: xr.Dataset, mesh: str) -> xr.DataArray | None:
    """Return the phase of a mesh [cycles], which its two flanks share; None if it does not rotate."""
    front = read_train(dataset).front(mesh)
    return pick(dataset, "mesh_phase", front) if front in list_items(dataset, "mesh_phase") else None


def list_items(dataset: xr.Dataset, quantity: str) -> list[str]:
    """List the items of a quantity over time; none if the result lacks it."""
    return [str(name) for name in dataset[quantity][dataset[quantity].dims[-1]].values] if quantity in dataset else []


def pick(dataset: xr.Dataset, quantity: str, item: str) -> xr.DataArray:
    """Return one item of a quantity over time."""
    return dataset[quantity].sel({dataset[quantity].dims[-1]: item})
