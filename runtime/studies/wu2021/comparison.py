"""Comparison of a simulation of the 2 MW rig with the paper's printed numbers."""

from __future__ import annotations

import math
import tomllib
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...analysis.lines import find_clues
from ...analysis.sharing import group_meshes
from ...model.members import Train
from ...results.amplitude_spectrum import Line, Sources, amplitude_spectrum, name_line, planar_spectrum, strongest_lines
from ...results.rounding import without_rounding
from ...results.statistics import (
    mesh_frequencies,
    pressure_angles,
    sampling_rate,
    shaft_speeds,
    statistics,
    steady_start,
    window,
)
from ...results.table import Cell, Table
from ...results.train_record import read_train

if TYPE_CHECKING:
    import xarray as xr

    from ...results.amplitude_spectrum import FloatArray

#: Unit of the printed forces [N].
PRINTED_FORCE = 1e5
#: The paper's lists end at 628.3 Hz; stronger lines above would only push ours out [Hz].
LIST_LIMIT = 700.0
LIST_LENGTH = 8
SEPARATION = 5.0  # [Hz]
NAMING = 0.5  # [Hz]
_SPEED = 30.0 / math.pi  # [r/min] per [rad/s]

_NOTES_7 = (
    "Speeds are magnitudes, means over the window; of several planets, the mean over the planets.",
    "HSP planet: the printed speed is relative to the carrier, so is the simulated one.",
    "HSP sun: 158.2 Hz follows from its speed relative to the carrier, not from 638.82 r/min alone.",
    "15 r/min and the tooth numbers give 638.90 r/min and 628.25 Hz; "
    "the printed 638.82 r/min would give 628.17 Hz, not the printed 628.3 Hz.",
    "Print is consistent in its mesh frequencies and in 15 and 80.45 r/min, all met to the last digit. 36.87 is 36.875 "
    "cut off; 189.84, 638.82 and 1794.75 are 0.013 to 0.017 % low: they are those of 80.44 r/min at the LSP sun, "
    "not of the 80.45 printed above.",
)
_NOTES_8 = (
    f"Ours: the up to {LIST_LENGTH} strongest lines below {LIST_LIMIT:.0f} Hz, strongest first, "
    f"at least {SEPARATION:.0f} Hz apart; amplitude of the acceleration [m/s^2], root-sum-square of the two axes.",
    "HSP ring gear: clamped in this model, so the acceleration of the HSP carrier stands for it.",
    "Front chassis and LSP bearing: the acceleration of an LSP planet; its bearing is carried by the front "
    "chassis. The LSP ring itself stays at rest, since opposite planets mesh in phase.",
    "The printed table gives the output shaft no simulated position; psh.output stands beside it.",
    "A name in brackets is the combination of mesh and carrier frequencies within one bin or 0.5 Hz; "
    "'?': none of these, so a free vibration or a distant sideband.",
)
_NOTES_9 = (
    "Mean, amplitude and load factor: each mesh's own, then the mean over the group. "
    "Load factor: largest force over mean force. pr.: printed. *: the component that print is nearer to.",
    "The printed factors are those of the printed mean and amplitude, (3.34 + 0.39) / 3.34 = 1.117 "
    "for 1.118, within the rounding of the two.",
)
_NO_ANGLE = (
    "The result carries no pressure angle: forces are normal to the flank, whereas four of the five "
    "printed means are near the tangential force at the pitch circle (LSP planet-ring: the normal one)."
)
_ANGLE = "tangent: tangential, the normal force times the cosine of the operating pressure angle; factors are the same."


@cache
def published() -> dict[str, Any]:
    """Read the printed tables of Wu et al. 2021 (``published/wu2021.toml``)."""
    source = Path(__file__).with_name("published") / "wu2021.toml"
    return tomllib.loads(source.read_text(encoding="utf-8"))


def compare(dataset: xr.Dataset, start_s: float | None = None) -> dict[str, Table]:
    """Compare a simulation with Tables 7, 8 and 9 of Wu et al. 2021.

    Parameters
    ----------
    dataset
        Simulation result of the paper's rig at its rated load. Rows whose
        variables or names are missing keep their printed half only.
    start_s
        First instant that counts as steady [s]; by default the middle of the record.

    Returns
    -------
    dict of Table
        ``"table7"`` (speeds and mesh frequencies), ``"table8"`` (acceleration
        lines) and ``"table9"`` (mesh forces and load factors).
    """
    dataset, start = without_rounding(dataset), steady_start(dataset) if start_s is None else start_s
    return {
        "table7": _table7(dataset, start),
        "table8": _table8(dataset, start),
        "table9": _table9(dataset, start),
    }


def _table7(dataset: xr.Dataset, start: float) -> Table:
    """Rotating speeds [r/min] and mesh frequencies [Hz]."""
    printed = published()["table7"]
    speeds = shaft_speeds(dataset, start) if "speed" in dataset else {}
    meshes = mesh_frequencies(dataset, start) if "mesh_phase" in dataset else {}
    rows = []
    for row in printed["rows"]:
        speed = _mean_speed(speeds, read_train(dataset), row["rotors"], row.get("relative_to"))
        rows.append(
            (
                row["position"],
                row["teeth"],
                speed,
                float(row["speed"]),
                meshes.get(row["stage"]),
                float(row["frequency"]),
            )
        )
    columns = ("Position", "Teeth", "r/min", "printed r/min", "mesh Hz", "printed mesh Hz")
    return Table(_title("table7"), columns, tuple(rows), _NOTES_7)


def _mean_speed(speeds: dict[str, float], train: Train, rotors: str, relative_to: str | None) -> float | None:
    """Magnitude of a group's mean speed [r/min], or None when it was not simulated."""
    own = [value for name, value in speeds.items() if train.group(name) == rotors]
    if not own or (relative_to is not None and relative_to not in speeds):
        return None
    frame = 0.0 if relative_to is None else speeds[relative_to]
    return abs(sum(own) / len(own) - frame) * _SPEED


def _table8(dataset: xr.Dataset, start: float) -> Table:
    """Strongest acceleration lines [Hz] by position."""
    rows = []
    for row in published()["table8"]["rows"]:
        for member in row["members"]:
            lines = _own_lines(dataset, member, start)
            places = (
                row["measured_position"],
                row.get("simulated_position", "").replace("& ", "&\n"),
                f"ours: {member}",
            )
            position = "\n".join(place for place in places if place)
            rows.append((position, _listed(row["measured"]), _listed(row.get("simulated", [])), lines))
    columns = ("Position", "measured", "printed", "ours: Hz (name) amplitude")
    resolution = sampling_rate(dataset) / window(dataset, start).sizes["time"]
    notes = (*_NOTES_8, f"Resolution of our spectra: {resolution:.3g} Hz.")
    return Table(_title("table8"), columns, tuple(rows), notes)


def _listed(frequencies: list[float]) -> str:
    """Frequencies as the paper lists them."""
    return "\n".join(str(value) for value in frequencies)


def _own_lines(dataset: xr.Dataset, member: str, start: float) -> str:
    """Named lines of the signal that represents a member, one below the other."""
    found = position_spectrum(dataset, member, start)
    if found is None:
        return "not simulated"
    _, _, frequency, amplitude = found
    clues = find_clues(window(dataset, start))
    lines = named_lines(frequency, amplitude, clues.sources)
    text = "\n".join(f"{line.frequency_hz:.1f} ({name or '?'}) {line.amplitude:.2g}" for line, name in lines)
    return text or "none above rounding"


def position_spectrum(
    dataset: xr.Dataset, member: str, start_s: float
) -> tuple[str, str, FloatArray, FloatArray] | None:
    """Spectrum of what a sensor at a member would see.

    Parameters
    ----------
    dataset
        Simulation result.
    member
        Member with ``acceleration_x`` and ``acceleration_y``; failing those, a
        bearing of the same name with ``bearing_force_x`` and ``bearing_force_y``.
    start_s
        First instant used [s].

    Returns
    -------
    signal, unit, frequency, amplitude
        What was used, its unit, the bins [Hz] and the amplitudes [unit], the
        root-sum-square of the axes (of a bearing, the force's magnitude); None
        if the result has neither.
    """
    part = window(dataset, start_s)
    rate = sampling_rate(part)
    if "acceleration_x" in part and member in part["member"].values:
        x, y = (part[f"acceleration_{axis}"].sel(member=member).values for axis in "xy")
        return f"acceleration of {member}", "m/s^2", *planar_spectrum(x, y, rate)
    if "bearing_force_x" in part and member in part["bearing"].values:
        x, y = (part[f"bearing_force_{axis}"].sel(bearing=member).values for axis in "xy")
        return f"bearing force of {member}", "N", *amplitude_spectrum((x**2 + y**2) ** 0.5, rate)
    return None


def named_lines(
    frequency: FloatArray,
    amplitude: FloatArray,
    sources: Sources,
    count: int = LIST_LENGTH,
    limit_hz: float = LIST_LIMIT,
) -> list[tuple[Line, str]]:
    """Pick the strongest lines and name each.

    Parameters
    ----------
    frequency, amplitude
        Spectrum, shape (m,) each [Hz], [any unit].
    sources
        Mesh frequencies and turns of carriers.
    count
        How many lines at most.
    limit_hz
        Lines above this frequency are left out [Hz].

    Returns
    -------
    list of (Line, str)
        Strongest first; the name is "" where no mesh frequency explains the line.
    """
    resolution = float(frequency[1])
    below = frequency <= limit_hz
    lines = strongest_lines(frequency[below], amplitude[below], count, max(SEPARATION, 2.0 * resolution))
    tolerance = max(resolution, NAMING)
    return [(line, name_line(line.frequency_hz, sources, tolerance)) for line in lines]


def _table9(dataset: xr.Dataset, start: float) -> Table:
    """Mesh forces [1e5 N] and load factors, one row for each component of each force."""
    groups = grouped_statistics(dataset, start)
    angles = pressure_angles(dataset)
    rows: list[tuple[Cell, ...]] = []
    for row in published()["table9"]["rows"]:
        group = row["meshes"]
        rows += _force_rows(row, groups.get(group), group_cosine(angles, read_train(dataset), group))
    columns = (
        "Position",
        "force",
        "mean",
        "mean pr.",
        "ampl.",
        "ampl. pr.",
        "factor",
        "factor pr.",
    )
    loads = "; ".join(f"{row['meshes']} {row['service_load']}" for row in published()["table4"]["rows"])
    notes = (*_NOTES_9, _ANGLE if angles else _NO_ANGLE, f"Service loads of Table 4 [1e5 N]: {loads}.")
    return Table(_title("table9") + ", forces in 1e5 N", columns, tuple(rows), notes)


def _force_rows(
    printed: dict[str, Any], found: dict[str, float] | None, cosine: float | None
) -> list[tuple[Cell, ...]]:
    """Rows of one mesh group: its normal force and, when the angle is known, the tangential one."""
    position, mean, amplitude, factor = (printed[key] for key in ("position", "mean", "amplitude", "load_factor"))
    if found is None:
        return [(position, "not simulated", None, mean, None, amplitude, None, factor)]
    scales = {"normal": 1.0} if cosine is None else {"normal": 1.0, "tangent": cosine}
    nearest = min(scales, key=lambda component: abs(scales[component] * found["mean"] - mean))
    return [
        (
            position,
            component + ("*" if component == nearest and len(scales) > 1 else ""),
            scale * found["mean"],
            mean,
            scale * found["amplitude"],
            amplitude,
            found["load_factor"],
            factor,
        )
        for component, scale in scales.items()
    ]


def grouped_statistics(dataset: xr.Dataset, start: float) -> dict[str, dict[str, float]]:
    """By mesh group: mean and amplitude [1e5 N], load factor [1]."""
    if "mesh_force" not in dataset:
        return {}
    found = statistics(dataset, start)
    groups = group_meshes(found, read_train(dataset))
    return {
        group: {
            "mean": sum(abs(found[mesh]["mean"]) for mesh in each) / len(each) / PRINTED_FORCE,
            "amplitude": sum(found[mesh]["amplitude"] for mesh in each) / len(each) / PRINTED_FORCE,
            "load_factor": sum(found[mesh]["load_factor"] for mesh in each) / len(each),
        }
        for group, each in groups.items()
    }


def group_cosine(angles: dict[str, float], train: Train, group: str) -> float | None:
    """Cosine of a mesh group's mean pressure angle, or None when it is not known."""
    own = [angle for mesh, angle in angles.items() if train.group(mesh) == group]
    return math.cos(sum(own) / len(own)) if own else None


def _title(key: str) -> str:
    """Title of a printed table with its citation."""
    entry = published()[key]
    return f"{entry['title']} ({entry['citation']})"
