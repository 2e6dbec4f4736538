"""Sweeps without an engine: data sets of functions of the varied numbers, and of runs one after another."""

import json

import numpy as np
import xarray as xr
from ltcgear.runtime.simulation.simulate import simulate
from ltcgear.runtime.studies.sweep.design import Design
from ltcgear.runtime.studies.sweep.metrics import measure

from .models import make_case, raw_scene


def as_sweep(design: Design, status: list[str] | None = None, **metrics) -> xr.Dataset:
    """A sweep's data set whose metrics are arrays over the points, or pairs of items and such arrays."""
    data = {"status": ("point", status or ["done"] * design.size), "warnings": ("point", [""] * design.size)}
    coordinates = dict(design.coordinates())
    for name, values in metrics.items():
        items, numbers = values if isinstance(values, tuple) else (None, values)
        dims = ("point",) if items is None else ("point", f"{name}_item")
        data[name] = (dims, np.asarray(numbers, dtype=float), {"units": "1", "long_name": name})
        if items is not None:
            coordinates[f"{name}_item"] = items
    return xr.Dataset(data, coordinates, {"design": json.dumps(design.to_json())})


def run_sweep(design: Design, name: str, settings: tuple[str, ...], metrics: list[str], **options) -> xr.Dataset:
    """A sweep of a scene by plain runs; where only numbers vary its library is compiled once."""
    rows = []
    for point in range(design.size):
        case = make_case(put(raw_scene(name, *settings), design.changes(point)))
        rows.append(measure(simulate(case.library, case.model.values(), **options), metrics))
    united = xr.concat(rows, "point").assign_coords(design.coordinates())
    united["status"], united["warnings"] = ("point", ["done"] * design.size), ("point", [""] * design.size)
    return united.assign_attrs(design=json.dumps(design.to_json()))


def put(raw, changes):
    """Make changes to a raw scene; a whole number is a place in a list."""
    for key, value in changes.items():
        *path, last = key.split(".")
        table = raw
        for part in path:
            table = table[int(part)] if isinstance(table, list) else table.setdefault(part, {})
        table[last] = float(value) if value.replace(".", "").isdecimal() else value
    return raw
