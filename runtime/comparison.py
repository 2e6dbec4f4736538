"""Comparison: a simulation of the 2 MW rig beside the numbers its paper printed."""

from __future__ import annotations

import math
import tomllib
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .spectra import Line, amplitude_spectrum, name_line, planar_spectrum, strongest_lines
from .statistics import (
    group_of,
    mesh_frequencies,
    mesh_statistics,
    pressure_angles,
    sampling_rate,
    shaft_speeds,
    steady_start,
    window,
)
from .tables import Cell, Table

if TYPE_CHECKING:
    import xarray as xr

    from .spectra import FloatArray

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
)
_NOTES_8 = (
    f"Ours: the up to {LIST_LENGTH} strongest lines below {LIST_LIMIT:.0f} Hz, strongest first, "
    f"at least {SEPARATION:.0f} Hz apart; amplitudes are the root-sum-square of the two axes.",
    "HSP ring gear: clamped in this model, so the acceleration of the HSP carrier stands for it.",
    "Front chassis and LSP bearing: the acceleration of the LSP ring, which that bearing carries.",
    "The printed table gives the output shaft no simulated position; psh.output stands beside it.",
    "A name in brackets is the combination of mesh frequencies within one bin or 0.5 Hz; '?' is unexplained.",
)
_NOTES_9 = (
    "Mean, amplitude and load factor: each mesh's own, then the mean over the group; "
    "beside it the worst mesh's factor. Load factor: largest force over mean force.",
    "The printed factors are those of the printed mean and amplitude, (3.34 + 0.39) / 3.34 = 1.117 "
    "for 1.118, within the rounding of the two.",
)
_NO_ANGLE = (
    "The result carries no pressure angle: forces are normal to the flank, whereas four of the five "
    "printed means are near the tangential force at the pitch circle (LSP planet-ring: the normal one)."
)
_ANGLE = "Tangential: normal force times the cosine of the operating pressure angle; factors are the same."


@cache
def published() -> dict[str, Any]:
    """Read the printed tables of Wu et al. 2021 (``published/wu2021.toml``)."""
    source = Path(__file__).with_name("published") / "wu2021.toml"
    return tomllib.loads(source.read_text(encoding="utf-8"))


def compare(dataset: xr.Dataset, start_s: float | None = None) -> dict[str, Table]:
    """Set a simulation beside Tables 7, 8 and 9 of Wu et al. 2021.

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
    start = steady_start(dataset) if start_s is None else start_s
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
        speed = _mean_speed(speeds, row["rotors"], row.get("relative_to"))
        rows.append(
            (
                row["position"],
                row["teeth"],
                *_beside(speed, float(row["speed"])),
                *_beside(meshes.get(row["stage"]), float(row["frequency"])),
            )
        )
    words = ("simulated", "printed", "difference")
    columns = (
        "Position",
        "Teeth",
        *(f"Speed {word} [r/min]" for word in words),
        *(f"Mesh frequency {word} [Hz]" for word in words),
    )
    return Table(_title("table7"), columns, tuple(rows), _NOTES_7)


def _mean_speed(speeds: dict[str, float], rotors: str, relative_to: str | None) -> float | None:
    """Magnitude of a group's mean speed [r/min], or None when it was not simulated."""
    own = [value for name, value in speeds.items() if group_of(name) == rotors]
    if not own or (relative_to is not None and relative_to not in speeds):
        return None
    frame = 0.0 if relative_to is None else speeds[relative_to]
    return abs(sum(own) / len(own) - frame) * _SPEED


def _beside(simulated: float | None, printed: float) -> tuple[float | None, float, float | None]:
    """Set a simulated value beside the printed one and their difference."""
    return simulated, printed, None if simulated is None else simulated - printed


def _table8(dataset: xr.Dataset, start: float) -> Table:
    """Strongest acceleration lines [Hz] by position."""
    meshes = mesh_frequencies(dataset, start) if "mesh_phase" in dataset else {}
    rows = [
        (
            row["measured_position"],
            _listed(row["measured"]),
            row.get("simulated_position", ""),
            _listed(row.get("simulated", [])),
            *_own_lines(dataset, member, start, meshes),
        )
        for row in published()["table8"]["rows"]
        for member in row["members"]
    ]
    columns = (
        "Measured position",
        "Measured [Hz]",
        "Simulated position (paper)",
        "Simulated (paper) [Hz]",
        "Our signal",
        "Our lines [Hz] (name) amplitude",
    )
    resolution = sampling_rate(dataset) / window(dataset, start).sizes["time"]
    notes = (*_NOTES_8, f"Resolution of our spectra: {resolution:.3g} Hz.")
    return Table(_title("table8"), columns, tuple(rows), notes)


def _listed(frequencies: list[float]) -> str:
    """Frequencies as the paper lists them."""
    return ", ".join(str(value) for value in frequencies)


def _own_lines(dataset: xr.Dataset, member: str, start: float, meshes: dict[str, float]) -> tuple[str, str | None]:
    """Name of the signal that stands for a member, and its named lines one below the other."""
    found = position_spectrum(dataset, member, start)
    if found is None:
        return f"{member} (not simulated)", None
    signal, unit, frequency, amplitude = found
    lines = named_lines(frequency, amplitude, meshes)
    text = "\n".join(f"{line.frequency_hz:.1f} ({name or '?'}) {line.amplitude:.3g}" for line, name in lines)
    return f"{signal} [{unit}]", text


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
    meshes: dict[str, float],
    count: int = LIST_LENGTH,
    limit_hz: float = LIST_LIMIT,
) -> list[tuple[Line, str]]:
    """Pick the strongest lines and name each.

    Parameters
    ----------
    frequency, amplitude
        Spectrum, shape (m,) each [Hz], [any unit].
    meshes
        Mesh frequency by gear set [Hz].
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
    return [(line, name_line(line.frequency_hz, meshes, tolerance)) for line in lines]


def _table9(dataset: xr.Dataset, start: float) -> Table:
    """Mesh forces [1e5 N] and load factors, one row for each component of each force."""
    groups = _grouped_statistics(dataset, start)
    angles = pressure_angles(dataset)
    loads = {row["meshes"]: float(row["service_load"]) for row in published()["table4"]["rows"]}
    rows: list[tuple[Cell, ...]] = []
    for row in published()["table9"]["rows"]:
        group = row["meshes"]
        rows += _force_rows(row, loads[group], groups.get(group), _group_cosine(angles, group))
    columns = (
        "Position",
        "Component",
        "Mean simulated [1e5 N]",
        "Mean printed [1e5 N]",
        "Nearer to print",
        "Amplitude simulated [1e5 N]",
        "Amplitude printed [1e5 N]",
        "Load factor simulated",
        "Load factor worst mesh",
        "Load factor printed",
        "Service load Table 4 [1e5 N]",
    )
    return Table(_title("table9"), columns, tuple(rows), (*_NOTES_9, _ANGLE if angles else _NO_ANGLE))


def _force_rows(
    printed: dict[str, Any], load: float, found: dict[str, float] | None, cosine: float | None
) -> list[tuple[Cell, ...]]:
    """Rows of one mesh group: its normal force and, when the angle is known, the tangential one."""
    position, mean, amplitude, factor = (printed[key] for key in ("position", "mean", "amplitude", "load_factor"))
    if found is None:
        return [(position, "not simulated", None, mean, None, None, amplitude, None, None, factor, load)]
    scales = {"normal": 1.0} if cosine is None else {"normal": 1.0, "tangential": cosine}
    nearest = min(scales, key=lambda component: abs(scales[component] * found["mean"] - mean))
    return [
        (
            position,
            component,
            scale * found["mean"],
            mean,
            None if cosine is None else ("yes" if component == nearest else "no"),
            scale * found["amplitude"],
            amplitude,
            found["load_factor"],
            found["worst"],
            factor,
            load,
        )
        for component, scale in scales.items()
    ]


def _grouped_statistics(dataset: xr.Dataset, start: float) -> dict[str, dict[str, float]]:
    """By mesh group: mean and amplitude [1e5 N], mean and worst load factor [1]."""
    if "mesh_force" not in dataset:
        return {}
    members: dict[str, list[dict[str, float]]] = {}
    for mesh, values in mesh_statistics(dataset, start).items():
        members.setdefault(group_of(mesh), []).append(values)
    return {
        group: {
            "mean": sum(abs(one["mean"]) for one in each) / len(each) / PRINTED_FORCE,
            "amplitude": sum(one["amplitude"] for one in each) / len(each) / PRINTED_FORCE,
            "load_factor": sum(one["load_factor"] for one in each) / len(each),
            "worst": max(one["load_factor"] for one in each),
        }
        for group, each in members.items()
    }


def _group_cosine(angles: dict[str, float], group: str) -> float | None:
    """Cosine of a mesh group's mean pressure angle, or None when it is not known."""
    own = [angle for mesh, angle in angles.items() if group_of(mesh) == group]
    return math.cos(sum(own) / len(own)) if own else None


def _title(key: str) -> str:
    """Title of a printed table with its citation."""
    entry = published()[key]
    return f"{entry['title']} ({entry['citation']})"
