"""Outputs of a simulation made by hand, for analyses with closed forms."""

import numpy as np
import xarray as xr

UNITS = {
    "mesh_force": "N", "mesh_phase": "1", "mesh_deflection": "m", "speed": "rad/s", "twist": "rad", "angle": "rad",
    "bearing_force_x": "N", "bearing_force_y": "N", "displacement_x": "m", "displacement_y": "m",
    "acceleration_x": "m/s^2",
}  # fmt: skip
DIMENSIONS = {
    "mesh": "mesh",
    "speed": "rotor",
    "twist": "rotor",
    "bearing": "bearing",
    "displacement": "member",
    "acceleration": "member",
}


def times(seconds=1.0, rate=8192.0):
    return np.arange(round(seconds * rate)) / rate


def output(values, time, name="mesh_force", item="psh.mesh"):
    """One output over time, as a result gives it."""
    meta = {"units": UNITS[name], "long_name": name.replace("_", " ")}
    return xr.DataArray(values, {"time": time, "item": item}, ("time",), name, meta)


def result(time, parameters=None, **quantities):
    """A result of quantities, each item -> values."""
    data, coordinates = {}, {"time": time}
    for name, items in quantities.items():
        dimension = DIMENSIONS.get(name, DIMENSIONS.get(name.partition("_")[0]))
        coordinates[dimension] = list(items)
        columns = np.stack([np.broadcast_to(values, time.shape) for values in items.values()], axis=1)
        data[name] = (("time", dimension), columns, {"units": UNITS[name], "long_name": name.replace("_", " ")})
    if parameters:
        coordinates["parameter"] = list(parameters)
        data["parameter_value"] = (("parameter",), list(parameters.values()))
    return xr.Dataset(data, coordinates)


def band_limited(dataset, factor):
    """Mesh forces and accelerations of a run, filtered and decimated, with what tells how it turned."""
    from scipy.signal import decimate

    limited = dataset[["mesh_force", "acceleration_x", "acceleration_y", "mesh_phase", "speed", "reference_angle",
                       "speed_ratio", "twist"]].isel(time=slice(None, None, factor))  # fmt: skip
    for name in ("mesh_force", "acceleration_x", "acceleration_y"):
        values = decimate(dataset[name].transpose("time", ...).values, factor, 40 * factor, "fir", axis=0)
        limited[name] = limited[name].copy(data=values)
    rate = (limited.sizes["time"] - 1) / float(limited["time"][-1] - limited["time"][0])
    return limited.assign_attrs(dataset.attrs, band_hz=0.4 * rate)
