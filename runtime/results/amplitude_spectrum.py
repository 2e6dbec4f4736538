"""Amplitude spectra of results, their strongest lines and the lines' names.

scipy.signal is imported where it is called: its import takes half a second, and runs have no spectra.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import chain

import numpy as np
from ltcgear.generated.errors import LtcgearError
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]
Candidate = tuple[int, float, str]
"""Order, frequency [Hz] and name of what may explain a line."""

#: Highest orders that count within the tolerance; beyond them chance finds an order for anything.
HARMONICS = 25
#: Share of the tolerance within which orders beyond those count, and the widest that this may be over the mesh
#: frequency or the turns that are counted.
CLOSE, SHARP = 1 / 3, 0.05
CARRIER_ORDERS = 6
#: Steps of sidebands that count within the tolerance, and those of turns that count more closely: as many as a stage
#: has planets, as a rule.
SIDE_ORDERS, FAR_ORDERS = 3, 6
#: Windows, and to how many bins on either side of a sine each spreads it (half of its main lobe).
WINDOWS = {"hann": 2, "flattop": 5, "blackmanharris": 4, "boxcar": 1}


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
    from scipy.signal import get_window

    return np.asarray(get_window(window, count), dtype=np.float64)


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
    from scipy.signal import find_peaks as find_maxima

    tops, _ = find_maxima(values, distance=distance)
    return [int(top) for top in tops[np.argsort(-values[tops], kind="stable")]]


@dataclass(frozen=True)
class Sources:
    """Rotating members and meshes by name; those at rest explain no line.

    Attributes
    ----------
    meshes
        Frequency of each stage's mesh [Hz].
    carriers
        Turns of carriers a second [Hz]: they modulate what a sensor in the housing sees.
    shafts
        Turns of further members a second [Hz]: eccentric gears show once a turn.
    combs
        Those of both that have lines at the neighbouring whole orders as well, as a fault that strikes once a turn.
    stages
        Stage of each carrier and shaft, whose meshes alone it modulates.
    """

    meshes: Mapping[str, float]
    carriers: Mapping[str, float] = field(default_factory=dict)
    shafts: Mapping[str, float] = field(default_factory=dict)
    combs: Mapping[str, float] = field(default_factory=dict)
    stages: Mapping[str, str] = field(default_factory=dict)


def explain_line(
    frequency_hz: float, sources: Sources, tolerance_hz: float, highest_hz: float = 0.0, highest: int = HARMONICS
) -> tuple[str, str]:
    """Explain a line by what turns and meshes.

    Harmonics come first (``"3 hsp"``), lowest order preferred; then sidebands of
    a mesh's harmonic at the distance of a carrier's turns (``"hsp - 1 hsp.carrier"``) or of
    a slower mesh's (``"hsp + 1 lsp"``, ``"2 psh - 1 hsp"``), lowest sum of orders
    preferred. More closely there follow harmonics of any order (``"46 lsp"``) and their sidebands at
    a carrier's turns; turns of carriers and shafts (``"2 psh.input"``) and sidebands at a shaft's distance; all
    orders of shafts of which a comb of lines is there (``"27 psh.input"``); far sidebands (``"4 psh - 4 lsp"``).

    Parameters
    ----------
    frequency_hz
        Frequency of the line [Hz].
    sources
        What it may be of.
    tolerance_hz
        Largest distance that still counts as a match [Hz]; at least half a bin.
    highest_hz
        End of the spectrum, up to which orders count.
    highest
        Highest order that is considered, of a harmonic and of either part of a sideband.

    Returns
    -------
    kind, name
        ``harmonic``, ``sideband`` or ``shaft``, and the name; "" twice for a line that nothing explains.
    """
    end = highest_hz + tolerance_hz if highest_hz else 0.0
    for kind, within, candidates in _tiers(sources, tolerance_hz, end, highest):
        matches = [
            (order, abs(value - frequency_hz), name)
            for order, value, name in candidates
            if abs(value - frequency_hz) <= within
        ]
        if matches:
            return kind, min(matches)[2]
    return "", ""


def _tiers(
    sources: Sources, tolerance: float, end: float, highest: int
) -> Iterator[tuple[str, float, Iterable[Candidate]]]:
    """Yield kinds of explanations, the likeliest first, with the distance that counts and their candidates."""
    every = (sources.meshes, sources.carriers, sources.shafts)
    turning, carriers, others = ({name: value for name, value in of.items() if value > 0.0} for of in every)
    close, low, steps = CLOSE * tolerance, range(1, min(CARRIER_ORDERS, highest) + 1), min(SIDE_ORDERS, highest)
    sharp, wheels, faults = (_told_apart(of, close) for of in (turning, carriers | others, sources.combs))
    sidebands = partial(_sidebands, sources.stages)
    yield "harmonic", tolerance, _multiples(turning, highest)
    yield "sideband", tolerance, sidebands(turning, [carriers, turning], low, steps)
    yield "harmonic", close, _multiples(sharp, None, end)
    yield "sideband", close, sidebands(sharp, [carriers], None, steps, end)
    yield "shaft", close, chain(_multiples(carriers | others, steps), sidebands(turning, [others], low, steps))
    yield "shaft", close, chain(sidebands(sharp, [others, faults], None, steps, end), _multiples(faults, None, end))
    yield "sideband", close, sidebands(sharp, [sharp, wheels], None, FAR_ORDERS if end else 0, end)


def name_line(frequency_hz: float, sources: Sources, tolerance_hz: float, highest: int = HARMONICS) -> str:
    """Return the name by which `explain_line` knows a line, "" for one that nothing explains."""
    return explain_line(frequency_hz, sources, tolerance_hz, highest=highest)[1]


def nearest_mode(frequency_hz: float, tolerance_hz: float, modes: Mapping[str, tuple[float, float]]) -> str:
    """Return the mode nearest to a line, within the tolerance or the mode's half bandwidth; "" for none."""
    near = [
        (abs(value - frequency_hz), name)
        for name, (value, half) in modes.items()
        if abs(value - frequency_hz) <= max(tolerance_hz, half)
    ]
    return min(near)[1] if near else ""


def _multiples(of: Mapping[str, float], highest: int | None, end_hz: float = 0.0) -> Iterator[Candidate]:
    """Yield the multiples of some frequencies, up to an order or, where that is None, to the end of the spectrum."""
    for name, value in of.items():
        for order in range(1, (int(end_hz / value) if highest is None else highest) + 1):
            yield order, order * value, f"{order} {name}"


def _told_apart(of: Mapping[str, float], close: float) -> dict[str, float]:
    """Return the frequencies whose multiples a tolerance can distinguish at any order."""
    return {name: value for name, value in of.items() if close <= SHARP * value}


def _sidebands(
    stages: Mapping[str, str], meshes: Mapping[str, float], sides: Sequence[Mapping[str, float]], orders: range | None,
    steps: int, end_hz: float = 0.0,
) -> Iterator[Candidate]:  # fmt: skip
    """Yield the sidebands of harmonics of some orders, of all up to the end of the spectrum where they are None."""
    for carrier, centre in meshes.items():
        for side, distance in (pair for every in sides for pair in every.items()):
            foreign = stages.get(side, carrier) != carrier  # a carrier turns its own stage's meshes
            if distance >= centre or foreign:
                continue
            for order in range(1, int(end_hz / centre) + 1) if orders is None else orders:
                middle = carrier if order == 1 else f"{order} {carrier}"
                for step in range(1, steps + 1):
                    yield order + step, order * centre + step * distance, f"{middle} + {step} {side}"
                    yield order + step, order * centre - step * distance, f"{middle} - {step} {side}"
