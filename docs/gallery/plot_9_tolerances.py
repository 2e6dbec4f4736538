"""
Tolerances and speeds
=====================

A sweep simulates a scene at many points and keeps a few numbers of each run. Here pins
stand where their tolerance lets them, at random, and the planets' loads are counted; then
a pair of gears is run at many speeds, and its spectra are drawn one above another.
"""

# %%
# Pins out of place
# -----------------
# The low-speed stage of the 2 MW gearbox has four planets and a sun that floats. Each of
# the four pins stands off its place along the pin circle, normally distributed with a
# deviation of 20 um. The model is compiled once; a point is a set of its numbers. Half a
# run is four mesh periods, so that means are over whole periods.

import tempfile
from math import cos, erf, radians, sqrt
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from ltcgear.runtime import (
    OperatingPoint,
    build,
    find_equilibrium,
    find_modes,
    linearise,
    load_sweep,
    sweep,
)
from ltcgear.runtime.view.figures.sweep_figures import draw_spectra, draw_sweep
from ltcgear.runtime.view.tables.sweep_tables import list_tables
from ltcgear.symbolic import Template, build_model, generate, load_scene

folder = Path(tempfile.mkdtemp())
planets = ", ".join(f"{{planet = {number}}}" for number in (1, 2, 3, 4))
template = Template(
    "lsp",
    {
        "effects.planet_position_error": "on",
        "stages.lsp.position_errors": f"[{planets}]",
    },
)
pins = [f"stages.lsp.position_errors.{place}.tangential" for place in range(4)]
sweep(
    template,
    [f"{pin}=0 um:20 um" for pin in pins],
    folder / "pins.nc",
    sample="normal",
    points=80,
    seed=1,
    metrics=["load_share"],
    t_end=8 / 29.5,
    workers=1,
)
pinned = load_sweep(folder / "pins.nc")
for table in list_tables(pinned, ["mesh_load_factor"]):
    table.print()
figure = draw_sweep(pinned)["load_share"]
plt.show()

# %%
# What statics say
# ----------------
# A planet gives way to its two meshes as one spring: both carry the same force F, and its
# pin 2 F cos(alpha). An error e takes 2 cos(alpha) e from the deflection of that spring::
#
#     1 / K = 1 / k_sun + 1 / k_ring + 4 cos^2(alpha) / k_pin
#
# A sun that floats moves until the forces on it balance. Of four planets' errors that
# leaves only what alternates: opposite planets carry alike, and the largest share is::
#
#     K_gamma = 1 + 2 K cos(alpha) / F * |e_1 - e_2 + e_3 - e_4| / 4

values = build_model(load_scene("lsp")).values()


def mean_stiffness(mesh):
    """Mean over a mesh cycle [N/m]."""
    single, double, share = (
        values[f"lsp.{mesh}.{name}"]
        for name in ("stiffness_single", "stiffness_double", "single_share")
    )
    return share * single + (1 - share) * double


cosine = cos(radians(20))
compliance = 1 / mean_stiffness("sun_planet") + 1 / mean_stiffness("ring_planet")
stiffness = 1 / (compliance + 4 * cosine**2 / values["lsp.pin.stiffness"])
force = values["loads.sun.torque"] / 4 / values["lsp.sun_planet.base_radius_1"]
per_metre = 2 * stiffness * cosine / force

errors = 1e-6 * np.stack([pinned[pin].values for pin in pins], axis=1)
static = 1 + per_metre * np.abs(errors @ [1, -1, 1, -1]) / 4
simulated = pinned["mesh_load_factor"].sel(group="lsp.sun_planet").values
print(f"20 um at one pin: {1e2 * per_metre * 20e-6 / 4:.2f} % of a planet's load")
print(f"simulation against statics: {np.abs(simulated - static).max():.4f} at most")
assert np.abs(simulated - static).max() < 0.02 * (static.max() - 1)

# %%
# The alternating sum of four normal errors is normal, with twice their deviation; so the
# factor's distribution is half a bell.

deviation = per_metre * 20e-6 * 2 / 4
place = np.linspace(1, simulated.max(), 200)
figure, axes = plt.subplots(layout="constrained")
axes.step(np.sort(simulated), np.arange(1, 81) / 80, where="post", label="80 simulations")
axes.plot(
    place, [erf((x - 1) / deviation / sqrt(2)) for x in place], label="statics, all pins"
)
axes.set(
    title="How evenly four planets share the load",
    xlabel="largest share of a planet [1]",
    ylabel="share of gearboxes below [1]",
)
axes.legend()
plt.show()

# %%
# Over speed
# ----------
# The high-speed pair at 41 speeds, a spectrum each. Lines that lean go with the mesh;
# they grow where they pass an eigenfrequency, which stays where it is.

sweep(
    Template("psh"),
    ["loads.input.speed=-900 rpm:-100 rpm:41"],
    folder / "speeds.nc",
    metrics=["forces", "spectrum:mesh_force:psh.mesh"],
    t_end=0.4,
    workers=1,
)
run_up = load_sweep(folder / "speeds.nc")
figure = draw_spectra(run_up, "spectrum:mesh_force:psh.mesh", 2000.0)
plt.show()

# %%
# The load factor over the mesh frequency, with the eigenfrequencies of the same pair,
# linearised with its mean stiffness. It is largest where a harmonic meets one of them.

model = build_model(load_scene("psh", {"effects.mesh_stiffness": "mean"}))
library = build(generate(model))
p = library.parameters(model.values())
modes = find_modes(linearise(OperatingPoint(library, p, find_equilibrium(library, p))))
own = [mode.frequency_hz for mode in modes if 100.0 < mode.frequency_hz < 2000.0]

passing = run_up["mesh_frequency"].sel(gear_set="psh")
factor = run_up["load_factor"].sel(mesh="psh.mesh")
figure, axes = plt.subplots(layout="constrained")
axes.plot(passing, factor, marker=".", label="psh.mesh")
for harmonic, dash in ((1, "-"), (2, "--"), (3, ":")):
    for number, frequency in enumerate(own):
        label = f"eigenfrequency / {harmonic}" if number == 0 else None
        axes.axvline(frequency / harmonic, color="0.6", lw=1, ls=dash, label=label)
axes.set(
    title="Load factor over speed",
    xlabel="mesh frequency [Hz]",
    ylabel="largest over mean mesh force [1]",
    xlim=(passing.min(), passing.max()),
)
axes.legend()
plt.show()
print("eigenfrequencies:", ", ".join(f"{frequency:.0f} Hz" for frequency in own))
