"""
Your own scene
==============

A scene file is read, changed by key, and simulated. The file is ``winch.toml`` of the
guide :doc:`/from-drawing`: a winch drive with one planetary stage.
"""

# %%
# Read it
# -------
# ``load_scene`` takes a path, or the name of a shipped scene. Values are in SI from here
# on, and where each number comes from is kept.

from pathlib import Path

import matplotlib.pyplot as plt
from ltcgear.generated.errors import SceneError
from ltcgear.runtime import build, simulate
from ltcgear.symbolic import build_model, generate, load_scene

path = Path("winch.toml")
print("\n".join(path.read_text("utf-8").splitlines()[:12]))
scene = load_scene(path)
print("...", scene.stages["gear"].module, "m;", scene.sources["stages.gear.module"])

# %%
# What is wrong with it
# ---------------------
# Every defect is told with its key, the reason and the cure, all of them at once. The
# second argument changes values by their keys, as ``--set`` does on the command line.

try:
    load_scene(
        path,
        {
            "effects.contact": "gap",
            "couplings.drum_shaft.stiffness": "1.29e6 N*m",
            "loads.drum.member": "drun",
        },
    )
except SceneError as error:
    print(error)

# %%
# Change it
# ---------
# One pin is 40 um away from its place, along the pin circle. How far the planets share
# the load then depends on the sun: one that floats moves until they do, one in a stiff
# bearing cannot.

error = {
    "effects.planet_position_error": "on",
    "stages.gear.position_errors": '[{ planet = 1, tangential = "40 um" }]',
}
held = {
    "stages.gear.sun.support": "bearing",
    "stages.gear.sun.bearing": '{ stiffness = "1e9 N/m", damping_ratio = 0.02 }',
}
forces = {}
for name, changes in {"floating sun": error, "sun in a bearing": error | held}.items():
    model = build_model(load_scene(path, changes))
    result = simulate(build(generate(model)), model.values(), t_end=0.4, rate=8192.0)
    found = result.summary["forces"]
    forces[name] = [found[f"gear.sun_planet.{i}"]["mean"] for i in (1, 2, 3)]
    print(name, result.summary["status"], [f"{force:.0f} N" for force in forces[name]])

# %%
# The supports are structure, so each of the two is a model of its own, with its own C;
# numbers alone would need none.

figure, axes = plt.subplots(layout="constrained")
for shift, (name, values) in zip((-0.2, 0.2), forces.items(), strict=True):
    axes.bar(
        [i + shift for i in (1, 2, 3)],
        [value / 1e3 for value in values],
        width=0.36,
        label=name,
    )
axes.set(
    title="Sun against planets, one pin 40 um out of place",
    xlabel="planet",
    ylabel="mean normal force [kN]",
)
axes.set_xticks([1, 2, 3])
axes.legend()
plt.show()
