"""Bandwidth of a result: up to which frequency its signals are true."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..results.statistics import sampling_rate

if TYPE_CHECKING:
    import xarray as xr

RAW = "samples are raw: what lies above half the sampling rate is folded back, so lines may be aliases"
"""What is said of results that were not band-limited before they were sampled."""


@dataclass(frozen=True)
class Band:
    """The band of a result.

    Attributes
    ----------
    end_hz
        Where it ends [Hz].
    raw
        Whether samples are unfiltered, so that lines may be aliases.
    """

    end_hz: float
    raw: bool


def find_band(dataset: xr.Dataset) -> Band:
    """Return the band for which outputs were band-limited (``band_hz``); of raw samples half their rate."""
    band = dataset.attrs.get("band_hz")
    return Band(0.5 * sampling_rate(dataset), raw=True) if band is None else Band(float(band), raw=False)
