"""Rounding: what of a result is only rounding, or the integrator's tolerance.

Two rules decide, so that commands report 0 for 0:

- A train is *unstrained* where neither its loaded equilibrium nor any mesh at any time stores `LOADED`: to such trains
  the integrator's tolerance refers as to vibrations of 1e-6 J (``operating_point``), and what it leaves is far
  below that. All its forces and torques are 0, and where nothing turns either, all that moves.
- Otherwise an item of a quantity is 0 where it stays below `SHARE` of the largest value of that unit (members that
  symmetry holds at rest are 1e-13 to 1e-11 of it), and a force or torque is constant where it varies by less than
  `FLAT` of its own size, which is the tolerance by default. An acceleration is 0 where it is less than what that part
  of its stage's mesh forces gives to its mass.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from ..model.energy_levels import LOADED
from .train_record import read_train

if TYPE_CHECKING:
    import xarray as xr

    from .amplitude_spectrum import FloatArray

SHARE = 1e-9
"""Part of the largest value of its unit below which a value is rounding."""
FLAT = 1e-6
"""Variation of a force or torque over its size that is no vibration (as for ``accuracy.STILL``)."""
STILL = 6e-3
"""Speed below which nothing turns [rad/s]."""
LOADS, MOTIONS = ("N", "N*m"), ("m", "m/s", "m/s^2", "rad/s", "rad/s^2")
"""Units of what an unstrained train lacks, and of what moves."""


def without_rounding(dataset: xr.Dataset) -> xr.Dataset:
    """Return a result in which what is nothing but rounding is 0, and what varies by nothing else is constant.

    Parameters
    ----------
    dataset
        Simulation result, or a span of it; it stays as it is.
    """
    floors, changed = find_floors(dataset), {}
    for name in dataset.data_vars:
        data = dataset.variables[name]
        unit = str(data.attrs.get("units", ""))
        floor = floors.get("m", 0.0) if name == "twist" and floors.get("m") == np.inf else floors.get(unit)
        if floor is not None and data.dtype.kind == "f" and data.size:
            values = _without(data, np.maximum(floor, _thrust(dataset, data)), FLAT if unit in LOADS else SHARE)
            if values is not None:
                changed[name] = data.copy(data=values)
    if "statistics" in dataset:
        changed["statistics"] = _round_outputs(dataset["statistics"], floors)
    return dataset.assign(changed) if changed else dataset


def _round_outputs(found: xr.DataArray, floors: Mapping[str, float]) -> xr.Variable:
    """Return the statistics of outputs along the motion (statistic, output), those of what is rounding 0."""
    size = np.abs(found.sel(statistic=["min", "max"]).values).max(axis=0)
    floor = np.array([floors.get(str(unit), -1.0) for unit in found["output_unit"].values])
    return found.variable.copy(data=np.where(size <= floor, 0.0, found.values))


def _thrust(dataset: xr.Dataset, data: xr.Variable) -> FloatArray | float:
    """Return by member the acceleration that `FLAT` of its stage's mesh forces gives to its mass; 0 of all else."""
    if data.attrs["units"] != "m/s^2" or "mesh_force" not in dataset or "parameter_value" not in dataset:
        return 0.0
    known = dict(zip(map(str, dataset["parameter"].values), dataset["parameter_value"].values.tolist(), strict=True))
    top = np.abs(dataset["mesh_force"].transpose("time", ...).values).max(axis=0)
    train, largest = read_train(dataset), dict[str, float]()
    for mesh, size in zip(map(str, dataset["mesh"].values), top.tolist(), strict=True):
        largest[train.stage(mesh)] = max(largest.get(train.stage(mesh), 0.0), size)
    members = [str(member) for member in dataset.variables[data.dims[-1]].values]
    masses = [known.get(train.members[member].mass) or np.inf for member in members]
    forces = np.array([largest.get(train.stage(member), 0.0) for member in members])
    return np.asarray(FLAT * forces / np.array(masses))


def find_floors(dataset: xr.Dataset) -> dict[str, float]:
    """Return by unit the size up to which values are rounding; infinite where all are."""
    largest: dict[str, float] = {}
    for data in (dataset.variables[name] for name in dataset.data_vars):
        unit = str(data.attrs.get("units", ""))
        if unit in (*LOADS, *MOTIONS) and "time" in data.dims and data.size:
            top = float(np.nan_to_num(np.abs(data.values)).max())
            largest[unit] = max(largest.get(unit, 0.0), top)
    nothing = (LOADS + (MOTIONS if largest.get("rad/s", STILL) < STILL else ())) if is_unstrained(dataset) else ()
    return {unit: np.inf if unit in nothing else SHARE * top for unit, top in largest.items()}


def is_unstrained(dataset: xr.Dataset) -> bool:
    """Say whether a train is nowhere and never strained, so that its forces are rounding.

    A result without the equilibrium's strain energy and without forces and deflections of its meshes decides nothing.
    """
    static = dataset.attrs.get("static_strain_j")
    if static is None or not float(static) < LOADED or not {"mesh_force", "mesh_deflection"} <= set(dataset):
        return False
    force, deflection = (_peaks(dataset, name) for name in ("mesh_force", "mesh_deflection"))
    return force.shape == deflection.shape and bool((0.5 * force * deflection < LOADED).all())


def _peaks(dataset: xr.Dataset, quantity: str) -> FloatArray:
    """Return the largest size of each item of a quantity: of samples, and where there are none of the statistics."""
    signal = dataset[quantity].transpose("time", ...)
    if signal.sizes["time"]:
        return np.asarray(np.abs(signal.values).max(axis=0))
    if "statistics" not in dataset:
        return np.full(signal.shape[1:], np.inf)
    labels = [f"{quantity}:{item}" for item in signal[signal.dims[-1]].values]
    ends = dataset["statistics"].sel(output=labels, statistic=["min", "max"]).transpose("statistic", "output")
    return np.asarray(np.abs(ends.values).max(axis=0))


def round_statistics(found: Mapping[str, Mapping[str, float]], dataset: xr.Dataset) -> dict[str, dict[str, float]]:
    """Return statistics of mesh forces [N] in which what is rounding is 0, without a load factor.

    Parameters
    ----------
    found
        By mesh, as from ``statistics.statistics``.
    dataset
        The result they belong to.
    """
    largest = max((abs(one[end]) for one in found.values() for end in ("min", "max")), default=0.0)
    floor = np.inf if is_unstrained(dataset) else max(find_floors(dataset).get("N", 0.0), SHARE * largest)
    return round_below(found, floor)


def round_below(found: Mapping[str, Mapping[str, float]], floor: float) -> dict[str, dict[str, float]]:
    """Return statistics of mesh forces [N] in which what is not above a floor [N] is 0."""
    told = {}
    for mesh, one in found.items():
        size = max(abs(one["min"]), abs(one["max"]))
        none = dict.fromkeys(one, 0.0) | {"load_factor": float("nan")}
        factor = one["load_factor"] if abs(one["mean"]) > floor else float("nan")
        told[mesh] = none if size <= floor else dict(one) | {"load_factor": factor}
    return told


def _without(data: xr.Variable, floor: FloatArray | float, share: float) -> FloatArray | None:
    """Return an output's values, items that are rounding 0 and those that vary by no more constant; None if none is."""
    values = data.values
    rows = values[None] if "time" not in data.dims else np.moveaxis(values, data.dims.index("time"), 0)
    low, high = rows.min(axis=0), rows.max(axis=0)
    size = np.maximum(np.abs(low), np.abs(high))
    none, flat = size <= floor, (high - low <= share * size) & (high > low)
    if not (none & (size > 0.0)).any() and not flat.any():
        return None
    kept = np.where(none, 0.0, np.where(flat, 0.5 * (low + high), rows))
    return kept[0] if "time" not in data.dims else np.moveaxis(kept, 0, data.dims.index("time"))
