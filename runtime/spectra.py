"""Spectra: amplitude spectra of results, their strongest lines and the lines' names."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from ltcgear.generated.errors import LtcgearError
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]

#: Highest orders that still count as an explanation among others; beyond them coincidence rules.
HARMONICS = 25
#: Share of the tolerance within which any order of a mesh explains what nothing else does, and the widest that this may
#: be over the mesh frequency: further out chance finds an order for anything.
CLOSE, SHARP = 1 / 3, 0.05
CARRIER_ORDERS = 6
SIDE_ORDERS = 3
#: Windows, and to how many bins on either side of a sine each spreads it (half of its main lobe).
WINDOWS = {"hann": 2, "flattop": 5, "blackmanharris": 4, "boxcar": 1}
#: Windows as sums of cosines: w_n = a_0 - a_1 cos(2 pi n / N) + a_2 cos(4 pi n / N) - ... They are those of
#: scipy.signal.get_window, as are the peaks of `find_peaks`; that package takes longer to import than spectra to find.
COSINES = {
    "hann": (0.5, 0.5),
    "flattop": (0.21557895, 0.41663158, 0.277263158, 0.083578947, 0.006947368),
    "blackmanharris": (0.35875, 0.48829, 0.14128, 0.01168),
    "boxcar": (1.0,),
}


@dataclass(frozen=True)
class Line:
    """One peak of an amplitude spectrum.

    Attributes
    ----------
    frequency_hz
        Frequency of the peak's bin [Hz].
    amplitude
        Amplitude at that bin [unit of the signal].
    """

    frequency_hz: float
    amplitude: float


def window_samples(window: str, count: int) -> FloatArray:
    """Return the samples of a window of `WINDOWS`, shape (count,) [1].

    They are periodic (not symmetric like numpy.hanning's), which keeps bins orthogonal.

    Raises
    ------
    LtcgearError
        If there is no such window.
    """
    if window not in WINDOWS:
        raise LtcgearError(f"window {window}: must be one of {', '.join(WINDOWS)}")
    angle = 2.0 * np.pi / count * np.arange(count)
    weights = np.zeros(count)
    for k, share in enumerate(COSINES[window]):
        weights += (-1) ** k * share * np.cos(k * angle)
    return weights


def noise_bandwidth(window: str, count: int) -> float:
    """Return the equivalent noise bandwidth of a window [bins] (Harris 1978, Proc. IEEE 66:51, eq. 11)."""
    weights = window_samples(window, count)
    return float(count * (weights**2).sum() / weights.sum() ** 2)


def amplitude_spectrum(signal: ArrayLike, rate: float, window: str = "hann") -> tuple[FloatArray, FloatArray]:
    """Single-sided amplitude spectrum under a window, its gain corrected.

    A sine of amplitude A whose frequency falls on a bin reads A there. Bins are
    ``rate / n`` apart (2 s of signal: 0.5 Hz) and two sines are told apart from
    about two bins on. Half-way between two bins a sine reads 15 % low under a Hann
    window, and right under a flat top, which tells sines apart from five bins on. The mean
    is taken off before the window, so it cannot leak, and bin 0 is its magnitude.

    Parameters
    ----------
    signal
        Samples, shape (n,), n at least 4 [any unit].
    rate
        Sampling rate [Hz].
    window
        One of `WINDOWS`.

    Returns
    -------
    frequency, amplitude
        Both of shape (n // 2 + 1,) [Hz], [unit of the signal].

    Raises
    ------
    ValueError
        If the signal is not one-dimensional or has fewer than four samples.
    LtcgearError
        If there is no such window.
    """
    samples = np.asarray(signal, dtype=np.float64)
    if samples.ndim != 1 or samples.size < 4:
        raise ValueError(f"a spectrum needs a row of at least 4 samples, got shape {samples.shape}")
    count = samples.size
    mean = samples.mean()
    weights = window_samples(window, count)
    transform = np.fft.rfft((samples - mean) * weights)
    amplitude: FloatArray = np.abs(transform) * (2.0 / weights.sum())
    if count % 2 == 0:
        amplitude[-1] *= 0.5  # the Nyquist bin has no mirror image to be added
    amplitude[0] = abs(mean)
    frequency = np.arange(count // 2 + 1, dtype=np.float64) * (rate / count)
    return frequency, amplitude


def planar_spectrum(x: ArrayLike, y: ArrayLike, rate: float, window: str = "hann") -> tuple[FloatArray, FloatArray]:
    """Root-sum-square of the amplitude spectra of two axes.

    Parameters
    ----------
    x, y
        Samples along two perpendicular axes, shape (n,) each [same unit].
    rate
        Sampling rate [Hz].
    window
        One of `WINDOWS`.

    Returns
    -------
    frequency, amplitude
        As from `amplitude_spectrum`.
    """
    frequency, along_x = amplitude_spectrum(x, rate, window)
    along_y = amplitude_spectrum(y, rate, window)[1]
    return frequency, np.hypot(along_x, along_y)


def strongest_lines(
    frequency: FloatArray,
    amplitude: FloatArray,
    count: int,
    separation_hz: float,
    relative_floor: float = 1e-3,
) -> list[Line]:
    """Pick the strongest peaks of a spectrum, strongest first.

    Parameters
    ----------
    frequency
        Uniform bins, shape (m,) [Hz].
    amplitude
        Amplitudes, shape (m,) [any unit].
    count
        How many lines at most.
    separation_hz
        Of peaks closer than this only the strongest stays [Hz].
    relative_floor
        Peaks below this fraction of the strongest are numerical dust and dropped [1].

    Returns
    -------
    list of Line
        Possibly fewer than `count`. The first and last bin are never peaks.
    """
    bins = max(1, int(np.ceil(separation_hz / (frequency[1] - frequency[0]))))
    ordered = find_peaks(amplitude, bins)[:count]
    return [
        Line(float(frequency[peak]), float(amplitude[peak]))
        for peak in ordered
        if amplitude[peak] > 0.0 and amplitude[peak] >= relative_floor * amplitude[ordered[0]]
    ]


def find_peaks(values: FloatArray, distance: int = 1) -> list[int]:
    """Return local maxima, largest first; of those closer than a distance [samples] only the largest stays.

    Of a flat one it is the middle. The first and last sample are never peaks.
    """
    edges = np.flatnonzero(np.diff(values)) + 1
    starts, stops = np.append(0, edges), np.append(edges, values.size)
    rising = np.diff(values[starts]) > 0.0
    tops = np.flatnonzero(rising[:-1] & ~rising[1:]) + 1
    middles = (starts[tops] + stops[tops] - 1) // 2
    found, near = list[int](), np.zeros(values.size, dtype=bool)
    for peak in middles[np.argsort(-values[middles], kind="stable")]:
        if not near[peak]:
            found.append(int(peak))
            near[max(peak - distance + 1, 0) : peak + distance] = True
    return found


def explain_line(
    frequency_hz: float,
    mesh_frequencies: Mapping[str, float],
    tolerance_hz: float,
    rotations: Mapping[str, float] | None = None,
    shafts: Mapping[str, float] | None = None,
    modes: Mapping[str, tuple[float, float]] | None = None,
    highest_hz: float = 0.0,
    rate_hz: float | None = None,
    highest: int = HARMONICS,
) -> tuple[str, str]:
    """Explain a line by the mesh frequencies, rotations and modes that are there.

    Harmonics come first (``"3 hsp"``), lowest order preferred; then sidebands of
    a mesh's harmonic at the distance of a rotation (``"hsp - 1 hsp.carrier"``) or of
    a slower mesh's (``"hsp + 1 lsp"``, ``"2 psh - 1 hsp"``), lowest sum of orders
    preferred; then turns of shafts and sidebands at their distance; then harmonics of
    any order that the spectrum holds (``"46 lsp"``), and those that sampling folds back
    into it (``"10 psh folded"``); modes last, since what is excited at a harmonic is
    heard there, not at its own frequency.

    Parameters
    ----------
    frequency_hz
        Frequency of the line [Hz].
    mesh_frequencies
        Frequency of each stage's mesh [Hz], by name.
    tolerance_hz
        Largest distance that still counts as a match [Hz]; at least half a bin.
    rotations
        Frequency of turning members [Hz], by name: a planetary carrier's turns modulate
        what a sensor in the housing sees.
    shafts
        Frequency of further turning members [Hz]: eccentric gears show once a turn.
    modes
        Eigenfrequency and half of the half-power bandwidth [Hz], by name; a mode that is
        broader than the tolerance matches as far as its bandwidth goes.
    highest_hz
        End of the spectrum: harmonics of any order up to it count, of meshes whose orders the
        tolerance tells apart (`CLOSE`, `SHARP`).
    rate_hz
        Sampling rate, where harmonics beyond its half may have folded back.
    highest
        Highest order that is considered, of a harmonic and of either part of a sideband.

    Returns
    -------
    kind, name
        ``harmonic``, ``sideband``, ``shaft`` or ``mode``, and the name; "" twice for a line that nothing explains.
    """
    turning = {name: value for name, value in mesh_frequencies.items() if value > 0.0}
    carriers = {name: value for name, value in (rotations or {}).items() if value > 0.0}
    others = {name: value for name, value in (shafts or {}).items() if value > 0.0}
    close = CLOSE * tolerance_hz
    tiers = (
        ("harmonic", tolerance_hz, list(_harmonics(turning, highest))),
        ("sideband", tolerance_hz, [*_sidebands(turning, carriers, highest), *_sidebands(turning, turning, highest)]),
        ("shaft", tolerance_hz, [*_turns(others, highest), *_sidebands(turning, others, highest)]),
        ("harmonic", close, [*_high_harmonics(turning, close, highest_hz), *_folded(turning, rate_hz)]),
    )
    for kind, within, candidates in tiers:
        matches = [
            (order, abs(value - frequency_hz), name)
            for order, value, name in candidates
            if abs(value - frequency_hz) <= within
        ]
        if matches:
            return kind, min(matches)[2]
    mode = nearest_mode(frequency_hz, tolerance_hz, modes or {})
    return ("mode", mode) if mode else ("", "")


def name_line(
    frequency_hz: float,
    mesh_frequencies: Mapping[str, float],
    tolerance_hz: float,
    rotations: Mapping[str, float] | None = None,
    highest: int = HARMONICS,
) -> str:
    """Return the name by which `explain_line` knows a line, "" for one that nothing explains."""
    return explain_line(frequency_hz, mesh_frequencies, tolerance_hz, rotations, highest=highest)[1]


def nearest_mode(frequency_hz: float, tolerance_hz: float, modes: Mapping[str, tuple[float, float]]) -> str:
    """Return the mode nearest to a line, within the tolerance or the mode's half bandwidth; "" for none."""
    near = [
        (abs(value - frequency_hz), name)
        for name, (value, half) in modes.items()
        if abs(value - frequency_hz) <= max(tolerance_hz, half)
    ]
    return min(near)[1] if near else ""


def _harmonics(meshes: Mapping[str, float], highest: int) -> Iterator[tuple[int, float, str]]:
    """Yield order, frequency [Hz] and name of every harmonic considered."""
    for name, value in meshes.items():
        for order in range(1, min(HARMONICS, highest) + 1):
            yield order, order * value, f"{order} {name}"


def _high_harmonics(meshes: Mapping[str, float], tolerance: float, highest: float) -> Iterator[tuple[int, float, str]]:
    """Yield order, frequency [Hz] and name of harmonics beyond `HARMONICS` up to the highest frequency."""
    for name, value in meshes.items():
        if tolerance <= SHARP * value:
            for order in range(HARMONICS + 1, int((highest + tolerance) / value) + 1):
                yield order, order * value, f"{order} {name}"


def _folded(meshes: Mapping[str, float], rate: float | None) -> Iterator[tuple[int, float, str]]:
    """Yield order, frequency at which it shows [Hz] and name of every harmonic beyond half the sampling rate."""
    if rate is None:
        return
    for order, value, name in _harmonics(meshes, HARMONICS):
        if value > 0.5 * rate:
            yield order, abs(value - rate * round(value / rate)), f"{name} folded"


def _turns(shafts: Mapping[str, float], highest: int) -> Iterator[tuple[int, float, str]]:
    """Yield order, frequency [Hz] and name of the turns of shafts and their low harmonics."""
    for name, value in shafts.items():
        for order in range(1, min(SIDE_ORDERS, highest) + 1):
            yield order, order * value, f"{order} {name}"


def _sidebands(
    meshes: Mapping[str, float], sides: Mapping[str, float], highest: int
) -> Iterator[tuple[int, float, str]]:
    """Yield sum of orders, frequency [Hz] and name of every sideband considered."""
    for carrier, centre in meshes.items():
        for side, distance in sides.items():
            foreign = "." in side and side.split(".")[0] != carrier  # a carrier turns its own stage's meshes
            if distance >= centre or foreign:
                continue
            for order in range(1, min(CARRIER_ORDERS, highest) + 1):
                middle = carrier if order == 1 else f"{order} {carrier}"
                for step in range(1, min(SIDE_ORDERS, highest) + 1):
                    yield order + step, order * centre + step * distance, f"{middle} + {step} {side}"
                    yield order + step, order * centre - step * distance, f"{middle} - {step} {side}"
