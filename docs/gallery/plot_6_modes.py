"""
Modes and a Campbell diagram
============================

The compiled model is linearised at its loaded equilibrium. Its eigenfrequencies are
compared with published ones, and the orders of the meshes are laid over them.
"""

# %%
# Published frequencies
# ---------------------
# ``lin-parker-4`` is the planetary gear of Lin and Parker 1999, J. Vib. Acoust. 121:316,
# with four planets, at rest.

import matplotlib.pyplot as plt
import numpy as np
from ltcgear.runtime import (
    OperatingPoint,
    build,
    describe_modes,
    find_equilibrium,
    find_modes,
    linearise,
)
from ltcgear.runtime.linear.campbell import sweep_speed
from ltcgear.runtime.linear.orders import list_orders
from ltcgear.symbolic import build_model, generate, load_scene

model = build_model(load_scene("lin-parker-4"))
library = build(generate(model))
p = library.parameters(model.values())
linear = linearise(OperatingPoint(library, p, find_equilibrium(library, p)))
for mode in describe_modes(linear, find_modes(linear)):
    print(
        f"{mode.frequency_hz:10.2f} Hz  {mode.kind:14s} x{mode.multiplicity}  {mode.name}"
    )

# %%
# For the translational modes the paper prints 727.0, 1091.0, 1892.8, 2342.5, 7189.9 and
# 10437.6 Hz.

# %%
# Campbell
# --------
# Gyroscopic terms and the equilibrium depend on speed, so the modes are followed from
# speed to speed. Where an order of a mesh crosses an eigenfrequency there is a
# resonance; ``ltcgear campbell`` also tells how strongly the order excites it.

model = build_model(load_scene("winch.toml"))
library = build(generate(model))
p = library.parameters(model.values())
campbell = sweep_speed(library, p, np.linspace(0.0, 3000.0, 16))
orders = list_orders(library.manifest, p, harmonics=3)

figure, axes = plt.subplots(layout="constrained")
for column in range(campbell.tracks.shape[1]):
    axes.plot(campbell.values, campbell.frequencies(column), color="0.3", linewidth=1)
for order in orders:
    axes.plot(
        campbell.values,
        order.order * campbell.values / 60,
        linestyle="--",
        label=f"mesh order {order.name}",
    )
axes.axvline(campbell.home, color="0.6", linestyle=":", label="scene's own speed")
axes.set(
    title="Winch drive",
    xlabel="speed of the motor [rpm]",
    ylabel="frequency [Hz]",
    ylim=(0, 2500),
)
axes.legend()
plt.show()
