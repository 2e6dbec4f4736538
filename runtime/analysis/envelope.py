"""Envelope of the vibration in a band, and its sidebands in the spectrum."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

import numpy as np
from ltcgear.generated.errors import LtcgearError

from ..results.amplitude_spectrum import amplitude_spectrum, noise_bandwidth
from .spectrum import Spectrum
from .trace import FloatArray, Trace, read_trace, tell_bounds

if TYPE_CHECKING:
    import xarray as xr

BINS = 8
"""Bins of the spectrum below which a band that was not asked for is too narrow."""


@dataclass(frozen=True)
class Envelope:
    """The envelope of an output in a band.

    Attributes
    ----------
    name, title, unit
        Of the output.
    low_hz, high_hz
        Edges of the band [Hz].
    time, carrier, value
        Instants [s], the band's part of the output and its envelope [unit], shape (n,) each.
    spectrum
        Amplitude spectrum of the envelope; its bin 0 is the envelope's mean.
    """

    name: str
    title: str
    unit: str
    low_hz: float
    high_hz: float
    time: FloatArray
    carrier: FloatArray
    value: FloatArray
    spectrum: Spectrum


@dataclass(frozen=True)
class Sidebands:
    """Lines at equal distances about a line.

    Attributes
    ----------
    centre, spacing
        Name and frequency [axis unit of the spectrum] of the line, and name and distance of what modulates it.
    amplitude
        Of the line in the middle [unit].
    lower, upper
        Amplitudes of the first, second ... sideband below and above [unit]; 0 where there is no peak.
    """

    centre: tuple[str, float]
    spacing: tuple[str, float]
    amplitude: float
    lower: tuple[float, ...]
    upper: tuple[float, ...]

    @property
    def depth(self) -> float:
        """Return the first pair's amplitudes, added, over that of the middle: the depth of a modulation [1]."""
        return (self.lower[0] + self.upper[0]) / self.amplitude if self.amplitude > 0.0 else float("nan")


def find_envelope(signal: xr.DataArray, low_hz: float, high_hz: float, *, window: str = "hann") -> Envelope:
    """Return the envelope of an output in a band: the magnitude of its analytic signal (Hilbert transform).

    The band is cut out with sharp edges in the frequency domain, so near both ends of the signal, within about the
    inverse of the band's width, the envelope takes in what lies at the other end.

    Parameters
    ----------
    signal
        Output over time.
    low_hz, high_hz
        Edges of the band [Hz].
    window
        Of the envelope's spectrum, see ``find_spectrum``.

    Raises
    ------
    LtcgearError
        If the band is empty, or reaches beyond half the sampling rate.
    """
    one = read_trace(signal)
    count, half = one.values.size, 0.5 * one.rate
    if not 0.0 < low_hz < high_hz <= half * (1.0 + 1e-5):  # which is told in six digits
        raise LtcgearError(
            f"--band {low_hz:g}:{high_hz:g}: must lie above 0 and up to {half:g} Hz, low before high, "
            f"for example {0.125 * half:.0f}:{0.375 * half:.0f}"
        )
    frequency = np.fft.fftfreq(count, 1.0 / one.rate)
    inside = (frequency >= low_hz) & (frequency <= high_hz)
    if inside.sum() < 3:
        raise LtcgearError(
            f"--band {low_hz:g}:{high_hz:g}: narrower than 3 bins; make it "
            f"{tell_bounds(3.0 * one.rate / count, half)[0]} Hz wide at least"
        )
    analytic = np.fft.ifft(np.where(inside, 2.0 * np.fft.fft(one.values), 0.0))
    value = np.abs(analytic)
    return Envelope(
        one.name, one.title, one.unit, low_hz, high_hz, one.time, analytic.real, value, _spectrum(one, value, window)
    )


def _spectrum(one: Trace, value: FloatArray, window: str) -> Spectrum:
    """Return the amplitude spectrum of an envelope."""
    axis, amplitude = amplitude_spectrum(value, one.rate, window)
    resolution = one.rate / value.size
    return Spectrum(
        f"envelope of {one.name}", f"envelope of the {one.title}", "amplitude", one.unit, "Hz", axis, amplitude, window,
        resolution, noise_bandwidth(window, value.size) * resolution, float(one.time[0]), float(one.time[-1]),
    )  # fmt: skip


def choose_band(spectrum: Spectrum, mesh_hz: float, harmonics: int = 6, highest_hz: float = inf) -> tuple[float, float]:
    """Return the band [Hz] half a mesh frequency to both sides of the strongest of a mesh's first harmonics.

    Where that would hold fewer than `BINS` bins it is nearly all frequencies, up to the highest.
    """
    end = min(float(spectrum.axis[-1]), highest_hz)
    known = [h for h in range(1, harmonics + 1) if (h + 0.5) * mesh_hz <= end]
    if not known or mesh_hz < BINS * spectrum.resolution:
        return 2.0 * spectrum.resolution, end
    best = max(known, key=lambda h: spectrum.at(h * mesh_hz))
    return (best - 0.5) * mesh_hz, (best + 0.5) * mesh_hz


def find_sidebands(
    spectrum: Spectrum, centre: tuple[str, float], spacing: tuple[str, float], count: int = 3
) -> Sidebands | None:
    """Read the sidebands of a line.

    Parameters
    ----------
    spectrum
        Over frequency or order.
    centre, spacing
        Name and place of the line, name and distance of what modulates it [axis unit of the spectrum].
    count
        How many to either side.

    Returns
    -------
    Sidebands or None
        None if the spectrum is too coarse to tell the sidebands from the line.
    """
    if spacing[1] < spectrum.separation + spectrum.resolution:
        return None
    places = [k * spacing[1] for k in range(1, count + 1)]
    return Sidebands(
        centre, spacing, spectrum.at(centre[1]), tuple(spectrum.peak(centre[1] - place) for place in places),
        tuple(spectrum.peak(centre[1] + place) for place in places),
    )  # fmt: skip
