"""Waterfall: spectra of an output in sequence, over time or over the speed of a shaft."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from ltcgear.generated.errors import LtcgearError

from ..results.amplitude_spectrum import WINDOWS, amplitude_spectrum, noise_bandwidth
from ..results.select import split_output
from ..results.train_record import read_train
from .trace import FEWEST, FloatArray, list_items, pick, read_trace, tell_bounds

if TYPE_CHECKING:
    import xarray as xr

SEGMENTS = 16
"""Segments without overlap that a signal is cut into where no resolution is given."""
OVERLAP = 0.75
"""Share of a segment that the next one has too; a Hann window then weighs all samples alike."""
RPM = 30.0 / np.pi
STANDING = 1e-3
"""Turns or tooth meshes per second below which shafts and gears count as at rest [Hz]."""


@dataclass(frozen=True)
class Waterfall:
    """Amplitude spectra of segments that follow each other.

    Attributes
    ----------
    name, title, unit
        Of the output.
    time
        Middle of each segment [s], shape (m,).
    frequency
        Bins [Hz], shape (n,).
    amplitude
        [unit], shape (m, n).
    segment_s
        Length of a segment [s].
    window, resolution, bandwidth
        One of ``spectra.WINDOWS``, distance of bins [Hz], equivalent noise bandwidth [Hz].
    speed, shaft
        Mean speed of a rotor over each segment [r/min], shape (m,), and the rotor; empty where none was given.
    """

    name: str
    title: str
    unit: str
    time: FloatArray
    frequency: FloatArray
    amplitude: FloatArray
    segment_s: float
    window: str
    resolution: float
    bandwidth: float
    speed: FloatArray
    shaft: str = ""


def find_waterfall(
    signal: xr.DataArray, speed: xr.DataArray | None = None, *, resolution_hz: float | None = None, window: str = "hann"
) -> Waterfall:
    """Return amplitude spectra of segments that overlap by three quarters.

    A line that moves by more than the resolution within a segment is smeared: fine bins and quick changes exclude
    each other.

    Parameters
    ----------
    signal
        Output over time.
    speed
        Speed of a rotor at the same instants [rad/s].
    resolution_hz
        Distance of bins [Hz], the inverse of a segment's length; 16 over the signal's length where left out.
    window
        See ``find_spectrum``.

    Raises
    ------
    LtcgearError
        If segments of that resolution are too short, or longer than the signal.
    """
    one = read_trace(signal)
    longest = one.values.size / one.rate
    wanted = resolution_hz if resolution_hz is not None else SEGMENTS / longest
    count = round(one.rate / wanted) if wanted > 0.0 else 0
    count = max(count, FEWEST) if resolution_hz is None else count
    if not FEWEST <= count <= one.values.size:
        low, high = tell_bounds(1.0 / longest, one.rate / FEWEST)
        raise LtcgearError(f"--resolution {wanted:g}: must lie between {low} and {high} Hz in this span")
    step = max(1, round(count * (1.0 - OVERLAP)))
    starts = np.arange(0, one.values.size - count + 1, step)
    spectra = [amplitude_spectrum(one.values[k : k + count], one.rate, window) for k in starts]
    rows = np.array([amplitude for _, amplitude in spectra])
    turning, shaft = np.zeros(0), ""
    if speed is not None:
        other = read_trace(speed)
        turning = np.array([RPM * abs(other.values[k : k + count].mean()) for k in starts])
        shaft = split_output(other.name)[1]
    return Waterfall(
        one.name, one.title, one.unit, one.time[starts] + 0.5 * (count - 1) / one.rate, spectra[0][0], rows,
        count / one.rate, window, one.rate / count, noise_bandwidth(window, count) * one.rate / count, turning, shaft,
    )  # fmt: skip


def mesh_courses(dataset: xr.Dataset, waterfall: Waterfall) -> dict[str, FloatArray]:
    """Return each gear set's mesh frequency [Hz] at the waterfall's instants, by the phase's advance over a segment.

    Parameters
    ----------
    dataset
        The result it was taken from, with ``mesh_phase`` (time, mesh) [cycles].
    waterfall
        Tells instants and segments.
    """
    time, half = dataset["time"].values, 0.5 * waterfall.segment_s
    train, found = read_train(dataset), dict[str, FloatArray]()
    for mesh in list_items(dataset, "mesh_phase"):
        phase = pick(dataset, "mesh_phase", mesh).values
        late, early = (np.clip(waterfall.time + side * half, time[0], time[-1]) for side in (1.0, -1.0))
        passed = np.interp(late, time, phase) - np.interp(early, time, phase)
        found.setdefault(train.stage(mesh), np.abs(passed / (late - early)))
    return {stage: course for stage, course in found.items() if course.max() > STANDING}


def main_lobe(waterfall: Waterfall) -> float:
    """Return how far two lines of a segment must be apart to be told from each other [Hz]."""
    return WINDOWS[waterfall.window] * waterfall.resolution
