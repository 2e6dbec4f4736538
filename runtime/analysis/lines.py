"""Spectral lines: the strongest peaks, named by the meshes, carriers, shafts and modes that explain them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from ..model.members import CARRIER, PLANET, Train
from ..results.amplitude_spectrum import Sources, explain_line, nearest_mode, strongest_lines
from ..results.statistics import mesh_frequencies, shaft_speeds
from ..results.train_record import read_train
from .band import Band, find_band
from .decay import decays_as
from .order_spectrum import TURN
from .spectrum import Spectrum
from .waterfall import STANDING

if TYPE_CHECKING:
    import xarray as xr

    from ..linear.modes import Mode

WITHIN = 0.6
"""How far a line may be from what it is named after [bins], where others near it push it."""
DUST = 1e-4
"""Share of the strongest line below which peaks are left out."""
SAME = 1e-4
"""Relative difference below which two members turn alike: means over a span differ by vibration."""
NEIGHBOURS, ENOUGH = (-2, -1, 1, 2), 3
"""Whole orders beside a line at which a comb has lines too, and at how many of them at least."""


@dataclass(frozen=True)
class Clues:
    """What lines are explained by.

    Attributes
    ----------
    meshes, carriers, shafts
        Mesh frequency by gear set, and turns a second of carriers and of other members [Hz]. Those of gears of a stage
        whose carrier turns are counted against the carrier too (``lsp.sun/carrier``), planets so only: as often a
        tooth meets the same planet.
    modes
        ``mode 7`` -> eigenfrequency and half of the half-power bandwidth [Hz], damping ratio times the former.
    words
        ``mode 7`` -> what moves in it.
    band
        How far lines are true [Hz].
    stages
        Of carriers and shafts, by name.
    """

    meshes: dict[str, float] = field(default_factory=dict)
    carriers: dict[str, float] = field(default_factory=dict)
    shafts: dict[str, float] = field(default_factory=dict)
    modes: dict[str, tuple[float, float]] = field(default_factory=dict)
    words: dict[str, str] = field(default_factory=dict)
    band: Band = field(default_factory=lambda: Band(inf, raw=False))
    stages: dict[str, str] = field(default_factory=dict)

    @property
    def sources(self) -> Sources:
        """Return what turns and meshes, shafts left out, as the paper names lines."""
        return Sources(self.meshes, self.carriers, stages=self.stages)

    def over(self, turns_hz: float) -> Clues:
        """Return the clues as orders of a shaft that turns so often a second; modes have no order.

        An order spectrum ends where it is true at the highest speed, so nothing more is said of its band.
        """
        every = (self.meshes, self.carriers, self.shafts)
        meshes, carriers, shafts = ({name: value / turns_hz for name, value in of.items()} for of in every)
        return Clues(meshes, carriers, shafts, stages=self.stages)


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
    start, train = float(dataset["time"].values[0]), read_train(dataset)
    passing = mesh_frequencies(dataset, start) if "mesh_phase" in dataset else {}
    meshes = {stage: value for stage, value in passing.items() if value > STANDING}
    speeds = shaft_speeds(dataset, start) if "speed" in dataset else {}
    turning = {name: speed / TURN for name, speed in speeds.items() if abs(speed) / TURN > STANDING}
    turning = {name: value for name, value in turning.items() if train.is_geared(name)}
    carriers = {name: abs(value) for name, value in turning.items() if train.members[name].part == CARRIER}
    shafts = {name: abs(v) for name, v in turning.items() if name not in carriers and not train.is_planet(name)}
    stages = {name: train.stage(name) for name in (carriers | shafts)}
    known = list((carriers | shafts).values())
    for name, stage, value in _against_carriers(turning, train):
        if value > STANDING and not any(abs(value - other) < SAME * value for other in known):
            shafts[name], stages[name] = value, stage
            known.append(value)
    vibrating = {f"mode {number}": mode for number, mode in enumerate(modes, start=1) if _vibrates(mode)}
    bands = {name: (mode.frequency_hz, abs(mode.damping_ratio) * mode.frequency_hz) for name, mode in vibrating.items()}
    words = {name: f"{mode.name or mode.kind}, {mode.frequency_hz:.4g} Hz" for name, mode in vibrating.items()}
    return Clues(meshes, carriers, shafts, bands, words, find_band(dataset), stages)


def _against_carriers(turning: Mapping[str, float], train: Train) -> Iterator[tuple[str, str, float]]:
    """Yield how often gears turn against the carrier of their stage [Hz], with the stage.

    Of equal planets the first represents all.
    """
    for name, value in turning.items():
        stage, part = train.members[name].stage, train.members[name].part
        carrier = turning.get(train.part(stage, CARRIER))
        if name == train.part(stage, PLANET) or (carrier is not None and part in ("sun", "ring")):
            yield f"{stage}.{part}/carrier", stage, abs(value - (carrier or 0.0))


def _vibrates(mode: Mode) -> bool:
    """Say whether a mode oscillates."""
    return mode.frequency_hz > 0.0 and mode.kind != "rigid" and abs(mode.damping_ratio) < 1.0


def name_lines(
    spectrum: Spectrum,
    clues: Clues,
    count: int = 12,
    highest: float | None = None,
    signals: Sequence[xr.DataArray] = (),
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
        Lines beyond this place on the axis are left out, as are those beyond the band.
    signals
        The outputs that the spectrum was taken of: by them it is seen whether a line decays as a mode does, without
        which none is named after a mode.
    """
    end = min(clues.band.end_hz, float(spectrum.axis[-1]) if highest is None else highest)
    inside = spectrum.axis <= end
    if inside.sum() < 3:
        return ()
    found = strongest_lines(spectrum.axis[inside], spectrum.value[inside], count, spectrum.separation, DUST)
    within = WITHIN * spectrum.resolution
    # What turns more slowly than lines are placed explains any of them, and none.
    carriers, shafts = (
        {name: turns for name, turns in of.items() if turns > 2.0 * within} for of in (clues.carriers, clues.shafts)
    )
    sources, named = Sources(clues.meshes, carriers, shafts, stages=clues.stages), []
    for line in found:
        place = spectrum.refine(line.frequency_hz)
        combs = {name: turns for name, turns in (carriers | shafts).items() if _comb(spectrum, place, turns)}
        kind, name = explain_line(place, replace(sources, combs=combs), within, end)
        near = nearest_mode(place, within, clues.modes)
        if not kind and near and decays_as(signals, place, TURN * clues.modes[near][1]):
            kind, name = "mode", near
        named.append(NamedLine(place, line.amplitude, kind, name, near))
    return tuple(named)


def _comb(spectrum: Spectrum, place: float, turns: float) -> bool:
    """Say whether a line is one of many at the distance of a shaft's turns, as a fault makes them."""
    if turns < spectrum.separation + spectrum.resolution:
        return False
    return sum(spectrum.peak(place + step * turns) > 0.0 for step in NEIGHBOURS) >= ENOUGH


def turns_per_second(angle: xr.DataArray) -> float:
    """Return how often a shaft turns a second [Hz], mean over the span."""
    time = angle["time"].values
    return float(np.abs(angle.values[-1] - angle.values[0]) / TURN / (time[-1] - time[0]))
