"""Transmission error: by how much gears run behind rigid, perfect ones, on the line of action."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from ltcgear.generated.errors import LtcgearError

from ..results.amplitude_spectrum import window_samples
from .order_spectrum import TURN
from .trace import FloatArray, list_items, phase_of, pick, read_trace

if TYPE_CHECKING:
    import xarray as xr

HARMONICS = 6
DEFINITIONS = {
    "deflection": "deflection of the teeth along the line of action",
    "angles": "s [r_1 (u_1 - u_C) + sigma r_2 (u_2 - u_C)] from the gears' angles",
}
"""What each definition is."""


@dataclass(frozen=True)
class TransmissionError:
    """The transmission error of a mesh.

    Attributes
    ----------
    mesh
        Its name.
    definition
        ``deflection`` or ``angles``, see `DEFINITIONS`.
    time, value
        Instants [s] and transmission error [m], shape (n,) each; positive where the loaded flank is pressed.
    mean, peak_to_peak, vibration
        Mean, largest less smallest, and standard deviation [m].
    harmonics
        Amplitudes of the first harmonics of the mesh frequency [m].
    """

    mesh: str
    definition: str
    time: FloatArray
    value: FloatArray
    mean: float
    peak_to_peak: float
    vibration: float
    harmonics: tuple[float, ...]


def find_transmission_error(dataset: xr.Dataset, mesh: str, definition: str = "deflection") -> TransmissionError:
    """Return the dynamic transmission error of a mesh (Ozguven and Houser 1988, J. Sound Vib. 121:383).

    By ``angles`` it is what encoders on both shafts would measure: mesh deflection, errors of teeth, and deflection of
    bearings. By ``deflection`` it is what the teeth alone yield. The two are equal for perfect gears that only turn.

    Parameters
    ----------
    dataset
        Result, or a span of it.
    mesh
        Such as ``psh.mesh``.
    definition
        ``deflection`` or ``angles``.

    Raises
    ------
    LtcgearError
        If there is no such mesh, or the result lacks what the definition needs.
    """
    if definition not in DEFINITIONS:
        raise LtcgearError(f"transmission error by {definition}: must be by one of {', '.join(DEFINITIONS)}")
    meshes = list_items(dataset, "mesh_deflection")
    if mesh not in meshes:
        raise LtcgearError(f"{mesh}: no such mesh; there are {', '.join(meshes) or 'none'}")
    deflection = read_trace(pick(dataset, "mesh_deflection", mesh))
    value = deflection.values if definition == "deflection" else _by_angles(dataset, mesh)
    phase = phase_of(dataset, mesh)
    harmonics = harmonics_of(value, np.zeros(value.size) if phase is None else phase.values)
    return TransmissionError(
        mesh, definition, deflection.time, value, float(value.mean()), float(np.ptp(value)), float(value.std()),
        harmonics,
    )  # fmt: skip


def harmonics_of(value: FloatArray, phase: FloatArray, count: int = HARMONICS) -> tuple[float, ...]:
    """Return the amplitudes of harmonics of a phase [cycles], over a Hann window; NaN over fewer than four cycles."""
    if abs(phase[-1] - phase[0]) < 4.0:
        return (float("nan"),) * count
    weights = window_samples("hann", value.size)
    rest = (value - np.average(value, weights=weights)) * weights
    return tuple(
        float(2.0 * np.abs((rest * np.exp(-1j * TURN * h * phase)).sum()) / weights.sum()) for h in range(1, count + 1)
    )


def _by_angles(dataset: xr.Dataset, mesh: str) -> FloatArray:
    """Return the transmission error from the gears' twists against the rigid motion [m]."""
    pair, sheet = read_pairs(dataset).get(mesh), json.loads(dataset.attrs.get("sheet", "{}"))
    if pair is None:
        raise LtcgearError(f"{mesh}: the result does not hold the base radii; simulate again, or take the deflection")
    carried = (disc["body"] for disc in sheet["discs"] if (disc["stage"], disc["part"]) == (pair["stage"], "carrier"))
    carrier = _twist(dataset, next(carried, ""))
    turned = [_twist(dataset, pair[gear]) - carrier for gear in ("one", "two")]
    radius_1, radius_2 = pair["radii"]
    return np.asarray(pair["flank"] * (radius_1 * turned[0] + pair["sense"] * radius_2 * turned[1]), dtype=np.float64)


def read_pairs(dataset: xr.Dataset) -> dict[str, dict[str, Any]]:
    """Return a result's meshes by name, from its layout; none in older files."""
    return {pair["name"]: pair for pair in json.loads(dataset.attrs.get("sheet", "{}")).get("meshes", ())}


def _twist(dataset: xr.Dataset, member: str) -> FloatArray:
    """Return a member's angle against the rigid motion [rad]; zero for one that is held."""
    if member not in list_items(dataset, "twist"):
        return np.zeros(dataset.sizes["time"])
    return read_trace(pick(dataset, "twist", member)).values


def parameter(dataset: xr.Dataset, name: str) -> float | None:
    """Return a parameter of the model, None if the result does not hold it."""
    if "parameter_value" not in dataset or name not in dataset["parameter"].values:
        return None
    return float(dataset["parameter_value"].sel(parameter=name))
