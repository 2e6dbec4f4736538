"""Amplitude spectrum and power spectral density of an output, with their window and resolution."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from ltcgear.generated.errors import LtcgearError

from ..results.amplitude_spectrum import WINDOWS, amplitude_spectrum, noise_bandwidth, planar_spectrum, window_samples
from ..results.select import split_output
from .trace import FEWEST, FloatArray, Trace, read_trace, tell_bounds

if TYPE_CHECKING:
    import xarray as xr


PROUD, FLOOR = 7.0, 0.2
"""How high a peak stands over what that share of the bins about it stay below; of noise one bin in thousands does."""


@dataclass(frozen=True)
class Spectrum:
    """Amplitudes or power densities over frequency or order.

    Attributes
    ----------
    name, title
        Of the output: ``mesh_force:psh.mesh``, ``normal mesh force of psh.mesh``.
    kind
        ``amplitude`` or ``density``.
    unit
        Of ``value``: that of the output, or its square over Hz.
    axis_unit
        ``Hz``, or ``1`` where ``axis`` counts cycles in a turn of ``shaft``.
    axis, value
        Bins and their values, shape (m,) each. Bin 0 of amplitudes is the magnitude of the mean.
    window
        One of ``spectra.WINDOWS``.
    resolution
        Distance of bins [axis_unit].
    bandwidth
        Equivalent noise bandwidth [axis_unit].
    start_s, stop_s
        First and last sample used [s].
    shaft
        The rotor whose turns are counted, "" over frequency.
    averaged
        How many segments were averaged.
    """

    name: str
    title: str
    kind: str
    unit: str
    axis_unit: str
    axis: FloatArray
    value: FloatArray
    window: str
    resolution: float
    bandwidth: float
    start_s: float
    stop_s: float
    shaft: str = ""
    averaged: int = 1

    @property
    def separation(self) -> float:
        """Return how far two lines must be apart to be told from each other [axis_unit]."""
        return WINDOWS[self.window] * self.resolution

    def at(self, place: float) -> float:
        """Return the largest value within a bin of a place on the axis; NaN beyond it."""
        near = np.abs(self.axis - place) <= 1.01 * self.resolution
        return float(self.value[near].max()) if near.any() else float("nan")

    def refine(self, place: float) -> float:
        """Return where between bins a peak lies: the top of a parabola through the logarithms of three bins."""
        top = int(np.argmin(np.abs(self.axis - place)))
        values = self.value[max(top - 1, 0) : top + 2]
        if values.size < 3 or not values.min() > 0.0:
            return place
        low, middle, high = np.log(values)
        bend = 2.0 * middle - low - high
        return float(self.axis[top] + 0.5 * (high - low) / bend * self.resolution) if bend > 0.0 else place

    def peak(self, place: float) -> float:
        """Return the height of a peak within a bin of a place; 0 if there is only leakage or noise."""
        near = np.flatnonzero(np.abs(self.axis - place) <= 1.01 * self.resolution)
        if not near.size:
            return 0.0
        top = int(near[np.argmax(self.value[near])])
        reach = 8 * WINDOWS[self.window]
        about = self.value[max(top - reach, 1) : top + reach + 1]
        local = self.value[top] >= self.value[max(top - 1, 0) : top + 2].max()
        return float(self.value[top]) if local and self.value[top] > PROUD * np.quantile(about, FLOOR) else 0.0


def find_spectrum(signal: xr.DataArray, *others: xr.DataArray, window: str = "hann") -> Spectrum:
    """Return the single-sided amplitude spectrum of an output (see ``spectra.amplitude_spectrum``).

    Parameters
    ----------
    signal
        Output over time.
    others
        The same quantity along y, where the root-sum-square of two axes is wanted.
    window
        ``hann``, ``flattop`` (amplitudes right between bins), ``blackmanharris`` (weak lines beside strong ones) or
        ``boxcar`` (none: lines must fall on bins).

    Raises
    ------
    LtcgearError
        If the signal cannot be analysed (see ``read_trace``), or there is no such window.
    """
    one = read_trace(signal)
    weights = window_samples(window, one.values.size)
    if others:
        axis, value = planar_spectrum(one.values, read_trace(others[0]).values, one.rate, window)
        one = _planar(one)
    else:
        axis, value = amplitude_spectrum(one.values, one.rate, window)
    bins = noise_bandwidth(window, weights.size)
    resolution = one.rate / weights.size
    return Spectrum(
        one.name, one.title, "amplitude", one.unit, "Hz", axis, value, window, resolution, bins * resolution,
        float(one.time[0]), float(one.time[-1]),
    )  # fmt: skip


def _planar(one: Trace) -> Trace:
    """Name what two axes are together."""
    quantity, item = split_output(one.name)
    title = one.title.replace(", x of", " (root-sum-square of x and y) of")
    return Trace(f"{quantity.removesuffix('_x')}:{item}", title, one.unit, one.time, one.values)


def find_density(signal: xr.DataArray, *, window: str = "hann", segment_s: float | None = None) -> Spectrum:
    """Return the single-sided power spectral density of an output (Welch 1967, segments that overlap by half).

    Its integral over frequency is the variance of the output.

    Parameters
    ----------
    signal
        Output over time.
    window
        See `find_spectrum`.
    segment_s
        Length of a segment [s]; an eighth of the signal where left out. Bins are its inverse apart.

    Raises
    ------
    LtcgearError
        If the signal or the window cannot serve, or segments are too short or longer than the signal.
    """
    from scipy.signal import welch

    one = read_trace(signal)
    count = one.values.size // 8 if segment_s is None else round(segment_s * one.rate)
    count = max(count, FEWEST) if segment_s is None else count
    if not FEWEST <= count <= one.values.size:
        low, high = tell_bounds(FEWEST / one.rate, one.values.size / one.rate)
        raise LtcgearError(
            f"segments of {segment_s:g} s: must hold {FEWEST} samples at least and the signal at most; "
            f"give {low} to {high} s"
        )
    weights = window_samples(window, count)
    overlap = count // 2
    axis, value = welch(one.values, one.rate, weights, count, overlap, detrend="constant", scaling="density")
    resolution = one.rate / count
    return Spectrum(
        one.name, one.title, "density", squared(one.unit), "Hz", axis, value, window, resolution,
        noise_bandwidth(window, count) * resolution, float(one.time[0]), float(one.time[-1]),
        averaged=1 + (one.values.size - count) // (count - overlap),
    )  # fmt: skip


def squared(unit: str) -> str:
    """Return the unit of a density over Hz."""
    simple = unit.isalpha()
    return f"{unit}^2/Hz" if simple else f"({unit})^2/Hz"
