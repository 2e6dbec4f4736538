"""
A result and its file
=====================

A run is written to a file, read again, and looked at by name: a mesh force, the angle of a
shaft, the transmission error between two of them.
"""

# %%
# Write and read
# --------------
# ``simulate`` keeps a run in memory, ``record`` writes it to a file while it goes on. The
# file is NetCDF4 and holds all that the run was made of, the scene included; plain xarray
# opens it too.

import tempfile
from math import cos, radians
from pathlib import Path

import matplotlib.pyplot as plt
import xarray as xr
from ltcgear.runtime import build, load, record
from ltcgear.symbolic import build_model, describe_scene, generate, load_scene

scene = load_scene("winch.toml")
model = build_model(scene)
path = Path(tempfile.mkdtemp()) / "winch.nc"
record(
    build(generate(model)),
    model.values(),
    path,
    t_end=0.3,
    rate=32768.0,
    attributes=describe_scene(scene, Path("winch.toml").read_text("utf-8")),
)
result = load(path)
print(f"{path.stat().st_size / 1e6:.1f} MB, {result.summary['status']}")
print(result.mesh, result.rotor, sep="\n")

# %%
# What there is of each, with its unit:

print(result.mesh["gear.sun_planet.1"])
print(result.mesh["gear.sun_planet.1"].force.attrs)
with xr.open_dataset(path) as plain:
    print(sorted(plain.data_vars)[:8], "...")

# %%
# Load factor
# -----------
# The summary counts extremes between samples too, so its load factor is a bit larger than
# that of the samples.

force = result.mesh["gear.sun_planet.1"].force.sel(time=slice(0.15, None))
print(f"samples: {float(force.max() / force.mean()):.4f}")
print(f"summary: {result.summary['forces']['gear.sun_planet.1']['load_factor']:.4f}")

# %%
# Transmission error
# ------------------
# A rotor's ``angle`` counts whole turns. What the output lacks of the input's angle over
# the ratio is the transmission error: the wind-up under load, and what vibrates about it.

ratio = 1 + 78 / 18
error = result.rotor["gear.carrier"].angle - result.rotor["gear.sun"].angle / ratio
window = error.sel(time=slice(0.28, None))
figure, axes = plt.subplots(layout="constrained")
axes.plot(1e3 * window["time"], 1e6 * window, label="carrier against sun")
axes.set(
    title="Transmission error of the winch's stage",
    xlabel="time [ms]",
    ylabel="angle of the carrier [urad]",
)
axes.legend()
plt.show()
print(f"mean {1e6 * float(window.mean()):.1f}, spread {1e6 * float(window.std()):.2f} urad")

# %%
# By hand: the carrier's torque times its lag is the force times the deflection of all
# meshes and pins, with the mean of 1/k over a tooth pitch, at contact ratios 1.475 and
# 1.856.

F, k, alpha_s, alpha_r = 2956.0, 7e8, radians(23.057), radians(16.409)
softness = sum((2 - ratio + (ratio - 1) / 1.75) / k for ratio in (1.475, 1.856))
pin = F * (cos(alpha_s) + cos(alpha_r))
lag = 3 * (F**2 * softness + pin**2 / 4e8) / 1600.0
print(f"by hand {1e6 * lag:.1f} urad")
assert abs(-float(window.mean()) / lag - 1) < 0.02
