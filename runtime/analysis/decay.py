"""Free decay: whether a line decays as vibration in a mode does."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..results.amplitude_spectrum import window_samples
from .trace import Trace, read_trace

if TYPE_CHECKING:
    import xarray as xr

    from .trace import FloatArray

LEAST = float(np.log(2.0))
"""Natural logarithm by which a mode must decay over the span for it to be told from what is forced."""
AGREE = 0.25
"""Largest difference of the measured rate from the mode's, as a part of this."""


def decays_as(signals: Sequence[xr.DataArray], frequency_hz: float, rate: float) -> bool:
    """Say whether a line of some outputs decays throughout their span at a mode's rate.

    A free vibration exp(-sigma t) cos(omega t) has in two windows that lie D apart amplitudes whose ratio is
    exp(-sigma D), whatever the window; what is forced has the same in both. Three windows of half the span, a
    quarter of it apart, give two ratios. Both must agree with the mode's sigma.

    Parameters
    ----------
    signals
        Outputs over time, one or those of two axes; none decays.
    frequency_hz
        Of the line.
    rate
        sigma, damping ratio times angular eigenfrequency [1/s].
    """
    traces = [read_trace(signal) for signal in signals]
    if not traces or rate * _span(traces[0]) < LEAST:
        return False
    sizes = np.hypot.reduce([_follow(one, frequency_hz) for one in traces])
    if not sizes.min() > 0.0:
        return False
    found = -np.diff(np.log(sizes)) / (0.25 * _span(traces[0]))
    return bool((np.abs(found - rate) <= AGREE * rate).all())


def _span(one: Trace) -> float:
    """Return how long an output lasts [s]."""
    return one.values.size / one.rate


def _follow(one: Trace, frequency_hz: float) -> FloatArray:
    """Return a line's amplitude under three windows of half the span, a quarter of it apart, shape (3,)."""
    half, quarter = one.values.size // 2, one.values.size // 4
    weights = window_samples("hann", half)
    wave = weights * np.exp(-2j * np.pi * frequency_hz / one.rate * np.arange(half)) * (2.0 / weights.sum())
    parts = [one.values[start : start + half] for start in (0, quarter, 2 * quarter)]
    return np.array([abs((part - part.mean()) @ wave) for part in parts])
