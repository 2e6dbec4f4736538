"""
A stage in Python
=================

A planetary stage is put together with ``SceneBuilder``, turned into equations and C, and
simulated. The mean mesh forces are compared with statics.
"""

# %%
# The scene
# ---------
# The builder takes the tables and keys of a TOML scene (:doc:`/scenes`), quantities as
# text with a unit. ``build`` checks all of it at once. The sun floats: nothing but its
# three meshes holds it.

from math import cos, radians

import matplotlib.pyplot as plt
from ltcgear.runtime import build, simulate
from ltcgear.symbolic import SceneBuilder, build_model, generate

mesh = {"double_factor": 1.5, "damping_ratio": 0.05}
bearing = {"stiffness": "5e8 N/m", "damping_ratio": 0.03}
scene = (
    SceneBuilder("Planetary stage")
    .planetary(
        "stage",
        planets=3,
        module="5 mm",
        pressure_angle="20 deg",
        ring={"teeth": 73, "support": "fixed"},
        sun={"teeth": 23, "disc": {"outer_diameter": "115 mm", "width": "60 mm"}},
        planet={
            "teeth": 25,
            "disc": {
                "outer_diameter": "125 mm",
                "width": "60 mm",
                "inner_diameter": "60 mm",
            },
        },
        carrier={
            "support": "bearing",
            "bearing": bearing,
            "disc": {"outer_diameter": "260 mm", "width": "90 mm"},
        },
        sun_planet={"stiffness": "8e8 N/m", **mesh},
        ring_planet={"stiffness": "9e8 N/m", **mesh},
        pin={"stiffness": "6e8 N/m", "damping_ratio": 0.03},
    )
    .load("drive", "stage.sun", speed="1500 rpm")
    .load("brake", "stage.carrier", torque="-3 kN*m")
    .build()
)

# %%
# Equations, C, simulation
# ------------------------
# ``build_model`` keeps what the scene's effects call for. ``generate`` derives the
# equations, checks them (Lagrange's against Newton's) and writes them as C; ``build``
# compiles it. The run begins in the loaded equilibrium.

model = build_model(scene)
artifact = generate(model)
library = build(artifact)
result = simulate(library, model.values(), t_end=0.1, rate=1e5)

manifest, summary = artifact.manifest, result.summary
rhs = manifest.functions["rhs"]
print(f"{len(manifest.states)} states, {rhs.operations} operations a call")
print(f"{summary['status']} by {summary['method']}")
counts = summary["counts"]
print(f"stiffness jumps: {counts['events']}, by kinematics {counts['expected_events']}")
print(f"energy balance open by {summary['energy_residual']:.1e} of the strain energy")

# %%
# Mesh forces
# -----------
# The result's data are an `xarray <https://xarray.dev>`_ dataset with units. 23 sun
# teeth on three planets leave their meshes a third of a tooth pitch apart, so their
# forces follow each other.

forces = result.dataset["mesh_force"].sel(time=slice(0.06, 0.066))
figure, axes = plt.subplots(layout="constrained")
for name in ("stage.sun_planet.1", "stage.sun_planet.2", "stage.sun_planet.3"):
    axes.plot(1e3 * forces["time"], forces.sel(mesh=name) / 1e3, label=name)
axes.set(title="Normal mesh forces", xlabel="time [ms]", ylabel="force [kN]")
axes.legend()
plt.show()

# %%
# By statics the sun's torque is the carrier's over the ratio 1 + 73/23, shared by three
# meshes at the base radius.

torque = 3000.0 / (1 + 73 / 23)
statics = torque / (3 * 23 * 5e-3 / 2 * cos(radians(20)))
mean = summary["forces"]["stage.sun_planet.1"]["mean"]
print(f"mean force: {mean:.0f} N, by statics {statics:.0f} N")
print(f"mesh frequency: {1500 / 60 * 23 * 73 / (23 + 73):.2f} Hz")
assert abs(mean / statics - 1) < 0.01
