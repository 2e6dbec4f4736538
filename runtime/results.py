"""Result: a trajectory read into named quantities with units, and its NetCDF4 file."""

import json
import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from ltcgear.generated.errors import LtcgearError
from numpy.typing import NDArray

from .clocks import Clocks
from .equilibrium import Equilibrium
from .integration import Trajectory
from .kernel import Kernel
from .library import Library
from .scaling import UNLOADED

if TYPE_CHECKING:
    import xarray as xr

Vector = NDArray[np.float64]

MARGIN = 32
"""Samples by which a signal is mirrored beyond its ends before it is filtered."""

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


def energy_residual(library: Library, p: Vector, at: Equilibrium, path: Trajectory) -> float:
    """Return what is missing in the energy balance, over the strain energy of the start.

    Energy at the end less energy at the start, less work of loads, drives and dampers, less what the
    stiffness jumps put in; zero for an exact solution. Where there is less strain energy than `UNLOADED` a freedom
    (the size of vibrations that tolerances then refer to), it is taken over that, or over all work.
    """
    missing = path.energy[1] - path.energy[0] - path.work - path.jump_energy
    strain = float(Kernel(library.functions["energy"])(at.x, at.s, p)[0][1])
    freedoms = len(library.index(""))
    return missing / max(strain, abs(path.work) + abs(path.jump_energy), UNLOADED * freedoms)


def outputs_of(library: Library, p: Vector, path: Trajectory) -> Vector:
    """Evaluate the outputs along a trajectory, shape (m, n_y); mesh phases count on over all turns."""
    clocks = Clocks(library.manifest, p)
    values = clocks.outputs(library.functions["outputs"], path.x, path.s, path.phi, path.turns)
    for column, report in enumerate(library.manifest.reports):
        if report.quantity == "mesh_phase":
            values[:, column] += clocks.unwound(report.item, path.turns)
    return values


def sampled(library: Library, p: Vector, path: Trajectory, oversample: int) -> tuple[NDArray[np.int64], Vector]:
    """Read the outputs at every ``oversample``-th time, accelerations free of aliases.

    Stiffness jumps make accelerations jump, so their spectrum has no end, and samples taken as they are
    show tones above half the sampling rate as false lines below it. Here the mean acceleration between
    samples (the difference of velocities, which are continuous) goes through SciPy's zero-phase FIR filter,
    whose band ends gently: lines up to 0.4 of the sampling rate are free of aliases.

    Returns
    -------
    rows, values
        Which samples of the trajectory are kept, shape (m,), and the outputs there, shape (m, n_y).
    """
    values = outputs_of(library, p, path)
    rows: NDArray[np.int64] = np.arange(0, len(path.time), oversample, dtype=np.int64)
    if oversample == 1 or len(rows) < 2 * MARGIN or "velocity_x" not in _by_quantity(library):
        return rows, values[rows]
    from scipy.signal import decimate

    kept = values[rows]
    columns = _by_quantity(library)
    for axis in "xy":
        mean = np.gradient(values[:, columns[f"velocity_{axis}"]], path.time, axis=0)
        longer = np.pad(mean, ((MARGIN * oversample,) * 2, (0, 0)), mode="reflect")
        filtered = decimate(longer, oversample, ftype="fir", axis=0, zero_phase=True)
        kept[:, columns[f"acceleration_{axis}"]] = filtered[MARGIN : MARGIN + len(rows)]
    return rows, kept


def make_dataset(library: Library, p: Vector, path: Trajectory, oversample: int = 1) -> "xr.Dataset":
    """Read a trajectory into an xarray Dataset.

    Parameters
    ----------
    library, p
        Model and parameters, shape (n_p,).
    path
        The trajectory.
    oversample
        How many samples of the trajectory make one of the result (see ``sampled``).

    Returns
    -------
    xarray.Dataset
        One variable per quantity over (time, item), with units and long names, and all states.
    """
    import xarray as xr

    rows, values = sampled(library, p, path, oversample)
    coordinates: dict[str, Any] = {"time": ("time", path.time[rows], {"units": "s", "long_name": "time"})}
    data: dict[str, Any] = {}
    for quantity, columns in _by_quantity(library).items():
        dimension = _dimension(library, quantity, columns, coordinates)
        meta = {"units": library.manifest.reports[columns[0]].unit or "1", "long_name": LONG_NAMES[quantity]}
        data[quantity] = (("time", dimension), values[:, columns], meta)
    if "mesh_force" in data:
        data |= _extremes(path)
    if library.manifest.levels:
        coordinates["switched_mesh"] = list(library.manifest.levels)
        meta = {"units": "1", "long_name": LONG_NAMES["mesh_level"]}
        data["mesh_level"] = (("time", "switched_mesh"), path.levels[rows].astype(np.int8), meta)
    coordinates["state_name"] = [state.name for state in library.manifest.states]
    units = json.dumps([state.unit for state in library.manifest.states])
    data["state"] = (
        ("time", "state_name"), path.x[rows], {"units": "SI", "long_name": "state vector", "state_units": units},
    )  # fmt: skip
    return xr.Dataset(data, coords=coordinates)


def _dimension(library: Library, quantity: str, columns: list[int], coordinates: dict[str, Any]) -> str:
    """Return the dimension of a quantity's items, one of its own where another quantity has other items."""
    items = [library.manifest.reports[i].item for i in columns]
    shared = library.manifest.reports[columns[0]].dimension
    dimension = shared if coordinates.get(shared, items) == items else f"{quantity}_{shared}"
    coordinates[dimension] = items
    return dimension


def _extremes(path: Trajectory) -> dict[str, Any]:
    """Return the extremes of the mesh forces between samples, over the second half of the run."""
    found = path.extremes.steady
    names = {"lowest": found[0], "highest": found[1]}
    meta = {"units": "N", "from_s": path.extremes.half}
    return {
        f"mesh_force_{word}": ("mesh", values, meta | {"long_name": f"{word} mesh force, between samples too"})
        for word, values in names.items()
    }


def _by_quantity(library: Library) -> dict[str, list[int]]:
    """Return quantity -> columns of the output vector."""
    columns: dict[str, list[int]] = {}
    for i, report in enumerate(library.manifest.reports):
        columns.setdefault(report.quantity, []).append(i)
    return columns


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
    floats = {name: variable for name, variable in dataset.items() if variable.dtype.kind == "f"}
    encoding = {name: {"zlib": True, "complevel": 1, "shuffle": True} for name in floats}
    handle, draft = tempfile.mkstemp(dir=path.resolve().parent, prefix=".draft-", suffix=".nc")
    os.close(handle)
    try:
        dataset.to_netcdf(draft, engine="netcdf4", encoding=encoding)
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
