"""
A sweep
=======

Every number of a scene is a parameter of the compiled model, so a sweep compiles once.
``simulate_many`` spreads the runs over all cores. Here the speed of a parallel pair is
swept, and its dynamic factor drawn over the mesh frequency.
"""

# %%
# The shipped scene ``psh`` is the high-speed pair of the 2 MW gearbox, alone.

from math import tau

import matplotlib.pyplot as plt
import numpy as np
from ltcgear.runtime import build, simulate_many
from ltcgear.symbolic import build_model, generate, load_scene

model = build_model(load_scene("psh"))
library = build(generate(model))
values = model.values()
print([name for name in values if name.startswith(("loads.", "reference."))])

# %%
# Parameter sets are dictionaries, in SI. One number that changes is enough here: other
# speeds follow from it.

mesh_frequency = np.linspace(150.0, 1400.0, 51)
per_speed = 59 / tau  # the input wheel has 59 teeth
sense = np.sign(values["reference.speed"])
sets = [values | {"reference.speed": sense * f / per_speed} for f in mesh_frequency]
runs = list(simulate_many(library, sets, t_end=0.25, rate=16384.0))
print({run.summary["status"] for run in runs})

# %%
# The load factor is the largest mesh force over the mean, in the second half of the run.

factor = np.array([run.summary["forces"]["psh.mesh"]["load_factor"] for run in runs])
figure, axes = plt.subplots(layout="constrained")
axes.plot(mesh_frequency, factor, marker=".", label="psh.mesh")
axes.axvline(628.3, color="0.6", linestyle=":", label="scene's own speed")
axes.set(
    title="Load factor over speed",
    xlabel="mesh frequency [Hz]",
    ylabel="largest over mean mesh force [1]",
)
axes.legend()
plt.show()
print(f"largest factor {factor.max():.3f} at {mesh_frequency[factor.argmax()]:.0f} Hz")
