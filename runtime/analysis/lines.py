"""Lines: the strongest peaks of a spectrum, each named by meshes, carriers, shafts and modes that explain it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ..spectra import explain_line, nearest_mode, strongest_lines
from ..statistics import mesh_frequencies, sampling_rate, shaft_speeds
from .orders import TURN
from .span import CHANGING, speed_change
from .spectrum import Spectrum
from .waterfall import STANDING

if TYPE_CHECKING:
    import xarray as xr

    from ..linear.modes import Mode

WITHIN = 0.6
"""How far a line may be from what it is named after [bins], where others near it push it."""
DUST = 1e-4
"""Share of the strongest line below which peaks are left out."""


@dataclass(frozen=True)
class Clues:
    """What lines are explained by.

    Attributes
    ----------
    meshes, carriers, shafts
        Mesh frequency by gear set, and turns a second of carriers and of other members that are no planets [Hz].
    modes
        ``mode 7`` -> eigenfrequency and half of the half-power bandwidth [Hz].
    words
        ``mode 7`` -> what moves in it.
    rate
        Sampling rate [Hz], by which harmonics fold back; None where they leave no lines, as speeds change.
    filtered
        Whether accelerations were filtered before they were sampled, so that nothing of them folds back.
    """

    meshes: dict[str, float] = field(default_factory=dict)
    carriers: dict[str, float] = field(default_factory=dict)
    shafts: dict[str, float] = field(default_factory=dict)
    modes: dict[str, tuple[float, float]] = field(default_factory=dict)
    words: dict[str, str] = field(default_factory=dict)
    rate: float | None = None
    filtered: bool = False

    def over(self, turns_hz: float) -> Clues:
        """Return the clues as orders of a shaft that turns so often a second; modes have no order."""
        every = (self.meshes, self.carriers, self.shafts)
        meshes, carriers, shafts = ({name: value / turns_hz for name, value in of.items()} for of in every)
        return Clues(meshes, carriers, shafts, rate=self.rate / turns_hz if self.rate else None, filtered=self.filtered)


@dataclass(frozen=True)
class NamedLine:
    """A line and what explains it.

    Attributes
    ----------
    place
        On the spectrum's axis [Hz], or order [1], between bins where the peak is.
    amplitude
        At the bin [unit of the output].
    kind, name
        ``harmonic``, ``sideband``, ``shaft`` or ``mode``, and the name; "" where nothing explains the line.
    mode
        The mode that is near, whatever the line's name; "" for none.
    """

    place: float
    amplitude: float
    kind: str
    name: str
    mode: str


def find_clues(dataset: xr.Dataset, modes: Sequence[Mode] = ()) -> Clues:
    """Return what a span's lines can be explained by.

    Parameters
    ----------
    dataset
        The span that is analysed.
    modes
        From ``find_modes`` and ``describe_modes``; rigid-body modes are left out.
    """
    start = float(dataset["time"].values[0])
    passing = mesh_frequencies(dataset, start) if "mesh_phase" in dataset else {}
    meshes = {stage: value for stage, value in passing.items() if value > STANDING}
    speeds = shaft_speeds(dataset, start) if "speed" in dataset else {}
    turning = {name: abs(speed) / TURN for name, speed in speeds.items() if abs(speed) / TURN > STANDING}
    carriers = {name: value for name, value in turning.items() if name.endswith(".carrier")}
    shafts = {
        name: value
        for name, value in turning.items()
        if "." in name and name not in carriers and ".planet." not in name
    }
    vibrating = {f"mode {number}": mode for number, mode in enumerate(modes, start=1) if _vibrates(mode)}
    bands = {name: (mode.frequency_hz, abs(mode.damping_ratio) * mode.frequency_hz) for name, mode in vibrating.items()}
    words = {name: f"{mode.name or mode.kind}, {mode.frequency_hz:.4g} Hz" for name, mode in vibrating.items()}
    rate = sampling_rate(dataset) if speed_change(dataset) <= CHANGING else None
    filtered = dataset.attrs.get("oversample", 1) != 1
    return Clues(meshes, carriers, shafts, bands, words, rate, filtered)


def _vibrates(mode: Mode) -> bool:
    """Say whether a mode oscillates."""
    return mode.frequency_hz > 0.0 and mode.kind != "rigid" and abs(mode.damping_ratio) < 1.0


def name_lines(
    spectrum: Spectrum, clues: Clues, count: int = 12, highest: float | None = None
) -> tuple[NamedLine, ...]:
    """Return the strongest lines of an amplitude spectrum, strongest first, each with its explanation.

    Parameters
    ----------
    spectrum
        Over frequency, or over the turns of a shaft.
    clues
        In the unit of the spectrum's axis (``Clues.over`` for orders).
    count
        How many at most.
    highest
        Lines beyond this place on the axis are left out; the axis' end where left out.
    """
    inside = spectrum.axis <= (spectrum.axis[-1] if highest is None else highest)
    if inside.sum() < 3:
        return ()
    found = strongest_lines(spectrum.axis[inside], spectrum.value[inside], count, spectrum.separation, DUST)
    within, highest = WITHIN * spectrum.resolution, float(spectrum.axis[-1])
    rate = None if clues.filtered and spectrum.name.startswith("acceleration") else clues.rate
    named = []
    for line in found:
        place = spectrum.refine(line.frequency_hz)
        kind, name = explain_line(place, clues.meshes, within, clues.carriers, clues.shafts, clues.modes, highest, rate)
        named.append(NamedLine(place, line.amplitude, kind, name, nearest_mode(place, within, clues.modes)))
    return tuple(named)


def turns_per_second(angle: xr.DataArray) -> float:
    """Return how often a shaft turns a second [Hz], mean over the span."""
    time = angle["time"].values
    return float(np.abs(angle.values[-1] - angle.values[0]) / TURN / (time[-1] - time[0]))
