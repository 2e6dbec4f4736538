"""Survey of a result: all that ``ltcgear analyse`` reports on a span."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from ltcgear.generated.errors import LtcgearError

from ..results.rounding import round_statistics, without_rounding
from ..results.select import split_output
from ..results.statistics import statistics
from ..results.train_record import read_train
from .bearings import BearingLoad, list_bearing_loads
from .cycles import Cycles, count_cycles
from .duration import LoadDuration, find_load_duration
from .envelope import Envelope, Sidebands, choose_band, find_envelope, find_sidebands
from .lines import DUST, Clues, NamedLine, find_clues, name_lines, turns_per_second
from .orbits import Orbit, find_orbit, list_members
from .order_spectrum import choose_shaft, find_order_spectrum, shaft_angle
from .sharing import LoadShare, find_leads, find_load_share, list_groups
from .span import CHANGING, cut, speed_change
from .spectrum import Spectrum, find_density, find_spectrum
from .trace import list_items, phase_of, pick, select_output
from .transmission import TransmissionError, find_transmission_error, read_pairs
from .waterfall import Waterfall, find_waterfall, mesh_courses

if TYPE_CHECKING:
    import xarray as xr

    from ..linear.modes import Mode
    from .trace import FloatArray

LINES = 12
CENTRES = 3
"""Harmonics of its mesh about which an output's sidebands are read."""


@dataclass(frozen=True)
class Options:
    """What a survey is asked for.

    Attributes
    ----------
    start_s, stop_s
        Span [s]; the second half of the record where left out.
    outputs
        QUANTITY:ITEM; the first mesh of every group where empty.
    shaft
        Rotor over whose turns orders are found; the fastest of each output's stage where left out.
    band
        Edges of the envelope's band [Hz]; about the strongest harmonic of the output's mesh where left out.
    window
        One of ``spectra.WINDOWS``.
    resolution_hz
        Of the waterfall.
    lines
        Most lines that are named for each output.
    """

    start_s: float | None = None
    stop_s: float | None = None
    outputs: tuple[str, ...] = ()
    shaft: str | None = None
    band: tuple[float, float] | None = None
    window: str = "hann"
    resolution_hz: float | None = None
    lines: int = LINES


@dataclass(frozen=True)
class Seen:
    """What is found of one output: its spectra, and what their lines are."""

    output: str
    spectrum: Spectrum
    density: Spectrum
    lines: tuple[NamedLine, ...]
    waterfall: Waterfall
    courses: dict[str, FloatArray]
    envelope: Envelope
    envelope_lines: tuple[NamedLine, ...]
    sidebands: tuple[Sidebands, ...]
    orders: Spectrum | None = None
    order_lines: tuple[NamedLine, ...] = ()


@dataclass(frozen=True)
class Survey:
    """What was found in a span of a result."""

    span: xr.Dataset
    start_s: float
    stop_s: float
    clues: Clues
    seen: tuple[Seen, ...]
    forces: dict[str, dict[str, float]]
    shares: tuple[LoadShare, ...]
    errors: tuple[TransmissionError, ...]
    durations: tuple[LoadDuration, ...]
    cycles: tuple[Cycles, ...]
    bearings: tuple[BearingLoad, ...]
    orbits: tuple[Orbit, ...]
    notes: tuple[str, ...] = field(default=())


def analyse(dataset: xr.Dataset, options: Options | None = None, modes: Sequence[Mode] = ()) -> Survey:
    """Find what a result shows: lines, forces, shares, transmission errors, durations, cycles, bearings and orbits.

    Parameters
    ----------
    dataset
        Simulation result.
    options
        What is asked for.
    modes
        By which lines may be named, from ``describe_modes``.

    Raises
    ------
    LtcgearError
        If the span, an output, the shaft, the band or the window cannot serve.
    """
    asked, dataset = options or Options(), without_rounding(dataset)
    part, notes = cut(dataset, asked.start_s, asked.stop_s), []
    time = part["time"].values
    change = speed_change(part)
    if change > CHANGING:
        notes.append(f"speeds change by {change:.0%} in the span: lines over frequency are smeared, orders are not")
    clues, train = find_clues(part, modes), read_train(part)
    wide = dataset if asked.start_s is None and asked.stop_s is None else part
    outputs = asked.outputs or tuple(_default_outputs(part))
    seen = tuple(_see(part, wide, output, clues, asked, notes) for output in outputs)
    groups, meshes = list_groups(part), list_items(part, "mesh_force")
    shares = [_share(part, group, notes) for group, members in groups.items() if len(members) > 1]
    leads = find_leads(part)
    return Survey(
        part, float(time[0]), float(time[-1]), clues, seen,
        round_statistics(statistics(part, float(time[0])), dataset) if meshes else {},
        tuple(share for share in shares if share is not None), tuple(_errors(part, leads)),
        tuple(_durations(part, leads)), tuple(_cycles(part, leads, notes)), list_bearing_loads(part),
        tuple(find_orbit(part, member, dataset) for member in list_members(part) if not train.is_planet(member)),
        tuple(dict.fromkeys(notes)),
    )  # fmt: skip


def _default_outputs(part: xr.Dataset) -> list[str]:
    """Return the outputs analysed by default: the first mesh of each group, else the rotors' speeds."""
    leads = [f"mesh_force:{mesh}" for mesh in find_leads(part)]
    return leads or [f"speed:{rotor}" for rotor in list_items(part, "speed")[:4]]


def _see(
    part: xr.Dataset, wide: xr.Dataset, output: str, clues: Clues, asked: Options, notes: list[str]
) -> Seen:  # fmt: skip
    """Analyse one output; with two axes density, waterfall and envelope are those of x."""
    signals = select_output(part, output)
    spectrum = find_spectrum(*signals, window=asked.window)
    lines = name_lines(spectrum, clues, asked.lines, signals=signals)
    waterfall = find_waterfall(select_output(wide, output)[0], resolution_hz=asked.resolution_hz, speed=_lead(wide))
    mesh = clues.meshes.get(_stage(part, output), max(clues.meshes.values(), default=0.0))
    band = asked.band or choose_band(spectrum, mesh, highest_hz=clues.band.end_hz)
    envelope = find_envelope(signals[0], *band, window=asked.window)
    found = name_lines(envelope.spectrum, clues, asked.lines, envelope.high_hz - envelope.low_hz)
    sidebands = tuple(_sidebands(spectrum, _stage(part, output), clues)) if speed_change(part) <= CHANGING else ()
    orders, order_lines = _orders(part, output, clues, asked, notes)
    courses = mesh_courses(wide, waterfall)
    density = find_density(signals[0], window=asked.window)
    return Seen(output, spectrum, density, lines, waterfall, courses, envelope, found, sidebands, orders, order_lines)


def _stage(part: xr.Dataset, output: str) -> str:
    """Return the stage of an output's item."""
    return read_train(part).stage(split_output(output)[1])


def _lead(part: xr.Dataset) -> xr.DataArray | None:
    """Return the speed of the first rotor that turns, by which a waterfall may go; None without rotors."""
    rotors = list_items(part, "speed")
    return pick(part, "speed", rotors[0]) if rotors else None


def _sidebands(spectrum: Spectrum, stage: str, clues: Clues) -> list[Sidebands]:
    """Read sidebands about the first harmonics of an output's own mesh, at the turns of its stage's members."""
    mesh, turning = clues.meshes.get(stage, 0.0), clues.carriers | clues.shafts
    found = [
        find_sidebands(spectrum, (f"{harmonic} {stage}", harmonic * mesh), (name, turns))
        for harmonic in range(1, CENTRES + 1)
        for name, turns in turning.items()
        if mesh > 0.0 and clues.stages[name] == stage and 3.0 * turns < mesh and harmonic * mesh <= clues.band.end_hz
    ]
    loud = DUST * float(spectrum.value[1:].max())
    return [one for one in found if one is not None and one.amplitude > loud and one.depth > 0.0]


def _orders(
    part: xr.Dataset, output: str, clues: Clues, asked: Options, notes: list[str]
) -> tuple[Spectrum | None, tuple[NamedLine, ...]]:
    """Find the order spectrum of an output; where nobody named a shaft and none can serve, this is noted."""
    shaft = asked.shaft or choose_shaft(part, _stage(part, output))
    if shaft is None:
        return None, ()
    try:
        angle = shaft_angle(part, shaft)
        signal, end = select_output(part, output)[0], clues.band.end_hz
        found = find_order_spectrum(signal, angle, window=asked.window, highest_hz=end)
    except LtcgearError as error:
        if asked.shaft is not None:
            raise
        notes.append(f"no orders of {output}: {error}")
        return None, ()
    return found, name_lines(found, clues.over(turns_per_second(angle)), asked.lines)


def _share(part: xr.Dataset, group: str, notes: list[str]) -> LoadShare | None:
    """Return a group's shares; one that carries nothing is noted."""
    try:
        return find_load_share(part, group)
    except LtcgearError as error:
        notes.append(str(error))
        return None


def _errors(part: xr.Dataset, leads: Sequence[str]) -> list[TransmissionError]:
    """Return the transmission errors of some meshes, by angles too if the result has the gears."""
    known = [mesh for mesh in leads if mesh in list_items(part, "mesh_deflection")]
    found = [find_transmission_error(part, mesh) for mesh in known]
    fronts = [read_train(part).front(mesh) for mesh in known]
    return found + [find_transmission_error(part, mesh, "angles") for mesh in fronts if mesh in read_pairs(part)]


def _durations(part: xr.Dataset, leads: Sequence[str]) -> list[LoadDuration]:
    """Return the load-duration distributions of meshes that turn."""
    phases = {mesh: phase_of(part, mesh) for mesh in leads}
    return [
        find_load_duration(pick(part, "mesh_force", mesh), phase)
        for mesh, phase in phases.items()
        if phase is not None and np.ptp(phase.values) >= 1.0
    ]


def _cycles(part: xr.Dataset, leads: Sequence[str], notes: list[str]) -> list[Cycles]:
    """Return rainflow counts of some meshes; where the library is missing, this is noted."""
    try:
        return [count_cycles(pick(part, "mesh_force", mesh)) for mesh in leads]
    except LtcgearError as error:
        notes.append(str(error))
        return []
