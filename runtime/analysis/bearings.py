"""Bearing loads: forces of bearings and pins over a span."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .trace import list_items, pick, read_trace

if TYPE_CHECKING:
    import xarray as xr

KINDS = ("bearing", "pin")


@dataclass(frozen=True)
class BearingLoad:
    """The radial force of a bearing.

    Attributes
    ----------
    name, kind
        Member or pin, and ``bearing`` or ``pin``.
    mean, rms, peak, vibration
        Of the force's magnitude [N]: mean, root mean square, largest, standard deviation.
    """

    name: str
    kind: str
    mean: float
    rms: float
    peak: float
    vibration: float


def list_bearing_loads(dataset: xr.Dataset) -> tuple[BearingLoad, ...]:
    """Return the loads of all bearings and pins over a result, or a span of it, by the magnitude of x and y."""
    found = []
    for kind in KINDS:
        for name in list_items(dataset, f"{kind}_force_x"):
            x, y = (read_trace(pick(dataset, f"{kind}_force_{axis}", name)).values for axis in "xy")
            size = np.hypot(x, y)
            rms = float(np.sqrt((size**2).mean()))
            found.append(BearingLoad(name, kind, float(size.mean()), rms, float(size.max()), float(size.std())))
    return tuple(found)
