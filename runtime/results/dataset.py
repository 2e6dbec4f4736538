"""Dataset of a run: its samples as named quantities with units."""

import json
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..model.layout import lay_out
from ..model.library import Library
from ..model.members import train_of
from ..model.parameter_values import name_values
from ..model.quantity_names import LONG_NAMES
from .file_content import FileContent
from .file_schema import FORM
from .samples import Rows, by_quantity
from .statistics import STATISTICS, Statistics
from .train_record import TRAIN, write_train

if TYPE_CHECKING:
    import xarray as xr

Vector = NDArray[np.float64]


def make_dataset(library: Library, p: Vector, rows: Rows, statistics: Statistics | None = None) -> "xr.Dataset":
    """Return the content of a result as an xarray Dataset; see ``make_content``."""
    return make_content(library, p, rows, statistics).to_xarray()


def make_content(library: Library, p: Vector, rows: Rows, statistics: Statistics | None = None) -> FileContent:
    """Return the content of a result.

    Parameters
    ----------
    library, p
        Model and its parameters, shape (n_p,).
    rows
        Outputs, states and levels of kept samples (see ``samples``); there may be none.
    statistics
        Statistics of the outputs along the motion, where the run reached its end.

    Returns
    -------
    FileContent
        One variable per quantity over (time, item), with units and long names; the reference's angle, the integrator's
        steps and all states over time; the parameters; the members' positions in the drawing as attribute ``sheet``,
        and what members and meshes are as ``train``.
    """
    manifest, columns = library.manifest, columns_of(library, rows)
    coordinates: dict[str, Any] = {"time": ("time", columns.pop("time"), {"units": "s", "long_name": "time"})}
    data: dict[str, Any] = {
        name: ("time", columns[name], {"units": unit, "long_name": LONG_NAMES[name]})
        for name, unit in (("reference_angle", "rad"), ("steps", "1"))
    }
    for quantity, places in by_quantity(library).items():
        dimension = _dimension(library, quantity, places, coordinates)
        meta = {"units": manifest.reports[places[0]].unit or "1", "long_name": LONG_NAMES[quantity]}
        data[quantity] = (("time", dimension), columns[quantity], meta)
    data |= _statistics(library, statistics, coordinates) if statistics is not None else {}
    if manifest.levels:
        coordinates["switched_mesh"] = list(manifest.levels)
        meta = {"units": "1", "long_name": LONG_NAMES["mesh_level"]}
        data["mesh_level"] = (("time", "switched_mesh"), columns["mesh_level"], meta)
    data |= _parameters(library, p, coordinates)
    coordinates["state_name"] = [state.name for state in manifest.states]
    units = json.dumps([state.unit for state in manifest.states])
    meta = {"units": "SI", "long_name": "state vector", "state_units": units}
    data["state"] = (("time", "state_name"), columns["state"], meta)
    attributes = {
        "result_format": FORM, "sheet": json.dumps(asdict(lay_out(library, p))), TRAIN: write_train(train_of(manifest)),
    }  # fmt: skip
    return FileContent.of(data, coordinates, attributes)


def columns_of(library: Library, rows: Rows) -> dict[str, NDArray[Any]]:
    """Return what changes over time in a result, by the variable's name, shapes (m,) and (m, items)."""
    found: dict[str, NDArray[Any]] = {"time": rows.time, "state": rows.x, "steps": rows.steps}
    angles = [i for i, state in enumerate(library.manifest.states) if state.name == "reference.angle"]
    found["reference_angle"] = rows.x[:, angles[0]] if angles else np.zeros(len(rows.time))
    if library.manifest.levels:
        found["mesh_level"] = rows.levels.astype(np.int8)
    return found | {quantity: rows.values[:, places] for quantity, places in by_quantity(library).items()}


def _parameters(library: Library, p: Vector, coordinates: dict[str, Any]) -> dict[str, Any]:
    """Return the parameters with their units, and the rotors' speeds over the reference's; 0 for one that rests."""
    parameters, number = library.manifest.parameters, name_values(library.manifest, p)
    coordinates["parameter"] = list(number)
    coordinates["parameter_unit"] = ("parameter", [unit or "1" for _, unit in parameters])
    data: dict[str, Any] = {"parameter_value": ("parameter", p.copy(), {"long_name": LONG_NAMES["parameter_value"]})}
    if "rotor" in coordinates:
        ratios = [speed_ratio(library, number, rotor) for rotor in coordinates["rotor"]]
        data["speed_ratio"] = ("rotor", ratios, {"units": "1", "long_name": LONG_NAMES["speed_ratio"]})
    return data


def speed_ratio(library: Library, number: dict[str, float], rotor: str) -> float:
    """Return a rotor's speed over the reference's; the reference itself needs no parameter for it."""
    if any(state.name == "reference.speed" and state.body == rotor for state in library.manifest.states):
        return 1.0
    ratio = next(body.ratio for body in library.manifest.bodies if body.name == rotor)
    return number[ratio] if ratio else 0.0


def _dimension(library: Library, quantity: str, columns: list[int], coordinates: dict[str, Any]) -> str:
    """Return the dimension of a quantity's items, one of its own where another quantity has other items."""
    items = [library.manifest.reports[i].item for i in columns]
    shared = library.manifest.reports[columns[0]].dimension
    dimension = shared if coordinates.get(shared, items) == items else f"{quantity}_{shared}"
    coordinates[dimension] = items
    return dimension


def _statistics(library: Library, found: Statistics, coordinates: dict[str, Any]) -> dict[str, Any]:
    """Return the statistics of all outputs along the motion."""
    reports = library.manifest.reports
    coordinates["statistic"] = list(STATISTICS)
    coordinates["output"] = [f"{report.quantity}:{report.item}" for report in reports]
    coordinates["output_unit"] = ("output", [report.unit or "1" for report in reports])
    meta = {"long_name": LONG_NAMES["statistics"], "from_s": found.span[0], "to_s": found.span[1]}
    return {"statistics": (("statistic", "output"), found.values, meta)}
