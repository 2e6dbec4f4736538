"""Result: a trajectory read into named quantities with units, and its NetCDF4 file."""

import json
import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from ltcgear.generated.errors import LtcgearError
from numpy.typing import NDArray

from .equilibrium import Equilibrium
from .extremes import MeshExtremes
from .integration import Outcome
from .kernel import Kernel
from .library import Library
from .reading import Rows, by_quantity
from .scaling import UNLOADED

if TYPE_CHECKING:
    import xarray as xr

Vector = NDArray[np.float64]

LONG_NAMES = {
    "mesh_force": "normal mesh force",
    "mesh_deflection": "mesh deflection along the line of action",
    "mesh_contact": "whether the flanks touch, 0 or 1",
    "mesh_phase": "mesh phase: teeth of gear 1 past the line of centres",
    "mesh_level": "mesh level, 0 single and 1 double contact",
    "mesh_friction": "tangential mesh force",
    "pressure_angle": "operating pressure angle",
    "pin_force_x": "planet bearing force, x",
    "pin_force_y": "planet bearing force, y",
    "pin_friction_torque": "planet bearing friction torque",
    "bearing_force_x": "bearing force, x",
    "bearing_force_y": "bearing force, y",
    "coupling_torque": "torque in the coupling",
    "support_torque": "torque in the torsional support",
    "acceleration_x": "acceleration of the centre, x",
    "acceleration_y": "acceleration of the centre, y",
    "velocity_x": "velocity of the centre, x",
    "velocity_y": "velocity of the centre, y",
    "displacement_x": "displacement of the centre in its stage's frame, x",
    "displacement_y": "displacement of the centre in its stage's frame, y",
    "speed": "rotational speed",
    "twist": "angle against the rigid motion",
    "angular_acceleration": "angular acceleration",
    "drive_torque": "torque of the drive that holds the speed",
    "load_torque": "torque of the load on its member",
}


def energy_residual(library: Library, p: Vector, at: Equilibrium, path: Outcome) -> float:
    """Return what is missing in the energy balance, over the strain energy of the start.

    Energy at the end less energy at the start, less work of loads, drives and dampers, less what the
    stiffness jumps put in; zero for an exact solution. Where there is less strain energy than `UNLOADED` a freedom
    (the size of vibrations that tolerances then refer to), it is taken over that, or over all work.
    """
    missing = path.energy[1] - path.energy[0] - path.work - path.jump_energy
    strain = float(Kernel(library.functions["energy"])(at.x, at.s, p)[0][1])
    freedoms = len(library.index(""))
    return missing / max(strain, abs(path.work) + abs(path.jump_energy), UNLOADED * freedoms)


def make_dataset(library: Library, rows: Rows, extremes: MeshExtremes | None = None) -> "xr.Dataset":
    """Write rows as an xarray Dataset.

    Parameters
    ----------
    library
        Model.
    rows
        Outputs, states and levels of kept samples (see ``reading``); there may be none.
    extremes
        Extremes of the mesh forces, where the run is over.

    Returns
    -------
    xarray.Dataset
        One variable per quantity over (time, item), with units and long names, and all states.
    """
    import xarray as xr

    manifest, columns = library.manifest, columns_of(library, rows)
    coordinates: dict[str, Any] = {"time": ("time", columns.pop("time"), {"units": "s", "long_name": "time"})}
    data: dict[str, Any] = {}
    for quantity, places in by_quantity(library).items():
        dimension = _dimension(library, quantity, places, coordinates)
        meta = {"units": manifest.reports[places[0]].unit or "1", "long_name": LONG_NAMES[quantity]}
        data[quantity] = (("time", dimension), columns[quantity], meta)
    if "mesh_force" in data and extremes is not None:
        data |= _extremes(extremes)
    if manifest.levels:
        coordinates["switched_mesh"] = list(manifest.levels)
        meta = {"units": "1", "long_name": LONG_NAMES["mesh_level"]}
        data["mesh_level"] = (("time", "switched_mesh"), columns["mesh_level"], meta)
    coordinates["state_name"] = [state.name for state in manifest.states]
    units = json.dumps([state.unit for state in manifest.states])
    meta = {"units": "SI", "long_name": "state vector", "state_units": units}
    data["state"] = (("time", "state_name"), columns["state"], meta)
    return xr.Dataset(data, coords=coordinates)


def columns_of(library: Library, rows: Rows) -> dict[str, NDArray[Any]]:
    """Return what changes over time in a result, by the variable's name, shapes (m,) and (m, items)."""
    found: dict[str, NDArray[Any]] = {"time": rows.time, "state": rows.x}
    if library.manifest.levels:
        found["mesh_level"] = rows.levels.astype(np.int8)
    return found | {quantity: rows.values[:, places] for quantity, places in by_quantity(library).items()}


def _dimension(library: Library, quantity: str, columns: list[int], coordinates: dict[str, Any]) -> str:
    """Return the dimension of a quantity's items, one of its own where another quantity has other items."""
    items = [library.manifest.reports[i].item for i in columns]
    shared = library.manifest.reports[columns[0]].dimension
    dimension = shared if coordinates.get(shared, items) == items else f"{quantity}_{shared}"
    coordinates[dimension] = items
    return dimension


def _extremes(extremes: MeshExtremes) -> dict[str, Any]:
    """Return the extremes of the mesh forces between samples, over the second half of the run."""
    names = {"lowest": extremes.steady[0], "highest": extremes.steady[1]}
    meta = {"units": "N", "from_s": extremes.half}
    return {
        f"mesh_force_{word}": ("mesh", values, meta | {"long_name": f"{word} mesh force, between samples too"})
        for word, values in names.items()
    }


def check_target(path: Path) -> None:
    """Refuse a result path that cannot be written, before anything is computed."""
    folder = path.resolve().parent
    if not folder.is_dir():
        raise LtcgearError(f"{path}: the folder {folder} does not exist; make it first")
    if path.is_dir():
        raise LtcgearError(f"{path}: is a folder; give a file name")
    try:
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        raise LtcgearError(f"{path}: the folder {folder} cannot be written: {error.strerror}") from error


def make_folder(path: Path) -> None:
    """Make a folder for results."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LtcgearError(f"{path}: cannot be made: {error.strerror}; give another folder") from error


def save(dataset: "xr.Dataset", path: Path) -> None:
    """Write a NetCDF4 file; it appears whole or not at all.

    Raises
    ------
    LtcgearError
        If the folder is missing or cannot be written.
    """
    check_target(path)
    handle, draft = tempfile.mkstemp(dir=path.resolve().parent, prefix=".draft-", suffix=".nc")
    os.close(handle)
    try:
        dataset.to_netcdf(draft, engine="netcdf4")
        Path(draft).chmod(0o644)
        Path(draft).replace(path)
    except OSError as error:
        raise LtcgearError(f"{path}: cannot be written: {error.strerror or error}") from error
    finally:
        Path(draft).unlink(missing_ok=True)


def load(path: Path) -> "xr.Dataset":
    """Read a result file into memory.

    Raises
    ------
    LtcgearError
        If it is missing, damaged or not a result of ltcgear.
    """
    import xarray as xr

    if not path.is_file():
        raise LtcgearError(f"{path}: no such result file; `ltcgear simulate SCENE -o {path}` writes one")
    try:
        with xr.open_dataset(path, engine="netcdf4") as opened:
            dataset = opened.load()
    except (OSError, ValueError, KeyError, RuntimeError) as error:
        raise LtcgearError(f"{path}: not a readable NetCDF4 file ({error}); simulate again") from error
    if "ltcgear" not in dataset.attrs:
        raise LtcgearError(f"{path}: not a result of ltcgear; give a file that `ltcgear simulate -o` wrote")
    return dataset
