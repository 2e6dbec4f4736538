"""Tables of the report: mesh forces, speeds, loads, bearings."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from ...results.statistics import steady_start, window
from ...results.table import Cell, Table

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    import xarray as xr

Row = tuple[Cell, ...]
FEWEST = 4
"""Samples that statistics need."""


def write_cell(cell: Cell) -> str:
    """Write a cell of a page, numbers with five digits; a dash for nothing."""
    if cell is None or (isinstance(cell, float) and not math.isfinite(cell)):
        return "-"
    if not isinstance(cell, float):
        return str(cell)
    size = abs(cell)
    return f"{cell:.4e}" if size >= 1e6 or 0 < size < 1e-3 else f"{cell:,.0f}" if size >= 1e4 else f"{cell:.5g}"


def list_tables(dataset: xr.Dataset, forces: Mapping[str, Mapping[str, float]]) -> list[Table]:
    """Return the tables of a result, over the second half of the record.

    Parameters
    ----------
    dataset
        The record.
    forces
        Statistics of the mesh forces, extremes between samples included.
    """
    if dataset.sizes["time"] < FEWEST:
        return []
    return [*_forces(forces), *_speeds(dataset), *_loads(dataset), *_bearings(dataset)]


def _forces(forces: Mapping[str, Mapping[str, float]]) -> Iterator[Table]:
    """List the mesh forces."""
    keys = ("mean", "min", "max", "rms", "load_factor")
    if forces:
        yield Table(
            "Mesh forces, second half of the record",
            ("mesh", "mean [N]", "min [N]", "max [N]", "rms [N]", "load factor [1]"),
            tuple((name, *(_number(force.get(key)) for key in keys)) for name, force in forces.items()),
            ("Load factor: the largest force over the mean, extremes between samples included.",),
        )


def _number(value: float | None) -> float:
    """Return a number, or NaN where there is none."""
    return math.nan if value is None else float(value)


def _speeds(dataset: xr.Dataset) -> Iterator[Table]:
    """List the speeds of the rotors."""
    data = _steady(dataset, "speed")
    if data is not None:
        factor = 30 / math.pi
        rows = [
            (name, value.mean() * factor, value.min() * factor, value.max() * factor, value.mean() / (2 * math.pi))
            for name, value in data.items()
        ]
        yield Table(
            "Speeds, second half of the record",
            ("rotor", "mean [rpm]", "min [rpm]", "max [rpm]", "mean [Hz]"),
            tuple((name, *map(float, row)) for name, *row in rows),
            ("Counter-clockwise is positive.",),
        )


def _loads(dataset: xr.Dataset) -> Iterator[Table]:
    """List the torques of drives, loads and couplings."""
    rows: list[Row] = []
    for kind, variable in (("drive", "drive_torque"), ("load", "load_torque"), ("coupling", "coupling_torque")):
        for name, value in (_steady(dataset, variable) or {}).items():
            rows.append((name, kind, *(float(v) for v in (value.mean(), value.min(), value.max()))))
    if rows:
        yield Table(
            "Torques, second half of the record", ("name", "kind", "mean [N m]", "min [N m]", "max [N m]"), tuple(rows)
        )


def _bearings(dataset: xr.Dataset) -> Iterator[Table]:
    """List the root mean squares of the bearings' forces."""
    rows: list[Row] = []
    for kind in ("bearing", "pin"):
        x, y = (_steady(dataset, f"{kind}_force_{axis}") or {} for axis in "xy")
        for name in x:
            size = np.hypot(x[name], y[name])
            rows.append((name, kind, *(float(v) for v in (np.sqrt(np.mean(size**2)), size.mean(), size.max()))))
    if rows:
        yield Table(
            "Bearings, second half of the record", ("bearing", "kind", "rms [N]", "mean [N]", "max [N]"), tuple(rows),
            ("Magnitude of the force in the plane; pins carry planets.",),
        )  # fmt: skip


def _steady(dataset: xr.Dataset, variable: str) -> dict[str, Any] | None:
    """Return a quantity by item over the second half of the record; None if there is none."""
    if variable not in dataset:
        return None
    data = window(dataset[[variable]], steady_start(dataset))[variable]
    dimension = next(name for name in data.dims if name != "time")
    values = data.transpose("time", dimension).values
    return dict(zip(map(str, data[dimension].values), values.T, strict=True))
