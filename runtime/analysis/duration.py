"""Load-duration distribution: how long, and over how many mesh cycles or revolutions, each load acts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from ltcgear.generated.errors import LtcgearError

from .trace import FloatArray, read_trace

if TYPE_CHECKING:
    import xarray as xr

BINS = 64


@dataclass(frozen=True)
class LoadDuration:
    """A load-duration distribution.

    Attributes
    ----------
    name, title, unit
        Of the load.
    edges
        Of the load's bins [unit], shape (m + 1,), ascending.
    seconds, count
        Time [s] and `counted` that pass in each bin, shape (m,).
    counted
        ``tooth meshes`` or ``turns``.
    """

    name: str
    title: str
    unit: str
    edges: FloatArray
    seconds: FloatArray
    count: FloatArray
    counted: str

    @property
    def exceeded(self) -> FloatArray:
        """Return `counted` for which the load is above the lower edge of each bin, shape (m,)."""
        return np.asarray(self.count[::-1].cumsum()[::-1])


def find_load_duration(load: xr.DataArray, counter: xr.DataArray, *, bins: int = BINS) -> LoadDuration:
    """Return the load-duration distribution of an output (as ISO 6336-6 and IEC 61400-4 use it: cycles by load bin).

    Each interval between samples counts at the mean of its two loads, with the time and the cycles that pass in it.

    Parameters
    ----------
    load
        Force or torque over time.
    counter
        Mesh phase [cycles, 1] or angle of a shaft [rad] at the same instants.
    bins
        Equal bins between the smallest and largest load.

    Raises
    ------
    LtcgearError
        If the signals cannot be analysed, or there is no bin.
    """
    one, other = read_trace(load), read_trace(counter)
    if bins < 1:
        raise LtcgearError(f"{bins} bins: one at least")
    angle = other.unit == "rad"
    cycles = np.abs(np.diff(other.values)) / (2.0 * np.pi if angle else 1.0)
    loads = 0.5 * (one.values[1:] + one.values[:-1])
    edges = np.histogram_bin_edges(loads, bins)
    seconds = np.histogram(loads, edges, weights=np.diff(one.time))[0]
    count = np.histogram(loads, edges, weights=cycles)[0]
    return LoadDuration(one.name, one.title, one.unit, edges, seconds, count, "turns" if angle else "tooth meshes")
