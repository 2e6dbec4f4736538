"""
A new element
=============

A rubber coupling stiffens as it winds up. ltcgear has no such law, so this page writes
one: its energy and its torque by hand, the product's own checks on both, the C with it,
and a run against the closed form.
"""

# %%
# The element
# -----------
# An element joins ports (the motion of bodies as it sees them), each with the axes that it
# knows; this one sees angles only. It is written down twice, and the two share nothing but
# symbols: ``potential`` and ``dissipation``, from which Lagrange's forces follow, and
# ``wrench``, by hand: what acts on a port along or about an axis. ``element_type`` enters
# it into the list of element types. With the twist phi = theta_1 - theta_2 the law is
# T = k phi + k_3 phi^3, Duffing's, and a damper.

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np
from ltcgear.generated.errors import CheckError
from ltcgear.runtime import build, find_equilibrium, find_modes, linearise, simulate
from ltcgear.symbolic import SceneBuilder, build_model, check_model, generate
from ltcgear.symbolic.elements.axes import THETA
from ltcgear.symbolic.elements.base import Element, Output, Port, element_type, positive
from ltcgear.symbolic.elements.key import ElementKey
from ltcgear.symbolic.mechanics.model import Parameter
from scipy.integrate import solve_ivp

K, K3, C = positive("k_t"), positive("k_3"), positive("c_t")


@element_type
def stiffening_coupling() -> Element:
    """Write a torsional spring with a cubic part, and a damper."""
    one, two = Port.numbered(1, (THETA,)), Port.numbered(2, (THETA,))
    twist, rate = one.theta - two.theta, one.omega - two.omega
    torque = K * twist + K3 * twist**3 + C * rate
    return Element(
        title="stiffening coupling",
        joins="coupling",
        ports=(one, two),
        parameters={K: "N*m/rad", K3: "N*m/rad^3", C: "N*m*s/rad"},
        potential=K * twist**2 / 2 + K3 * twist**4 / 4,
        dissipation=C * rate**2 / 2,
        wrench={(one, THETA): -torque, (two, THETA): torque},
        outputs={"torque": Output(torque, "N*m", "coupling_torque")},
        source="Duffing 1918, Erzwungene Schwingungen bei veränderlicher Eigenfrequenz",
    )


# %%
# Where it works
# --------------
# The scene has an ordinary coupling. Its instance in the model is given the new type and
# one parameter more; ``bind`` says which parameter of the model each symbol of the
# element is.

scene = (
    SceneBuilder("rubber coupling")
    .rotor("motor", inertia="2 kg*m^2")
    .rotor("pump", inertia="3 kg*m^2")
    .coupling("rubber", "motor", "pump", stiffness="8000 N*m/rad", damping="4 N*m*s/rad")
    .load("drive", "motor", speed="1000 rpm")
    .load("brake", "pump", torque_over_time=[["0.05 s", "-900 N*m"], ["0.0501 s", "0 N*m"]])
    .build()
)
plain = build_model(scene)
(linear_coupling,) = [item for item in plain.instances if item.group == "coupling"]
print(linear_coupling)


def stiffened(model, law="stiffening_coupling"):
    """Put the new element in the coupling's place."""
    bind, key = linear_coupling.bind | {"k_3": "couplings.rubber.cubic"}, ElementKey(law)
    instances = tuple(
        replace(item, element=key, bind=bind) if item == linear_coupling else item
        for item in model.instances
    )
    number = Parameter("couplings.rubber.cubic", 6.0e5, "N*m/rad^3")
    return replace(model, instances=instances, parameters=(*model.parameters, number))


model = stiffened(plain)

# %%
# The checks
# ----------
# ``check_model`` is what ``ltcgear check`` runs: here it proves symbol by symbol that
# the energies give the torque, that the element does not mind how it is turned, that its
# units fit, and it compares two derivations of the whole model.

for check in check_model(model):
    print("passed" if check.passed else "FAILED", check.name)

# %%
# The same check stands before every emission. With a sign wrong in the force by hand, no
# C comes out:


@element_type
def wrong_coupling() -> Element:
    """Write the same element with a mistake."""
    right = stiffening_coupling()
    wrench = {at: load.subs(K3, -K3) for at, load in right.wrench.items()}
    return replace(right, wrench=wrench)


try:
    generate(stiffened(plain, "wrong_coupling"))
except CheckError as error:
    print(error)
else:
    raise AssertionError("the wrong sign passed")

# %%
# The C
# -----
# Operations of the right-hand side with the linear law and with the new one:

artifact = generate(model)
for name, made in {"linear": generate(plain), "stiffening": artifact}.items():
    print(f"{name:12s}{made.manifest.functions['rhs'].operations} operations")
start = artifact.c.index("/* rhs:")
print(artifact.c[start : start + 900])

# %%
# Against closed forms
# --------------------
# The drive holds its speed, so the pump winds the coupling up by the real root of
# k phi + k_3 phi^3 = T and vibrates about it with omega^2 = (k + 3 k_3 phi^2) / I.

library = build(artifact)
p = library.parameters(model.values())
at = find_equilibrium(library, p, tables=model.tables)
(mode,) = [mode for mode in find_modes(linearise(library, p, at)) if mode.kind != "rigid"]
twist = max(np.roots([6.0e5, 0.0, 8000.0, -900.0]), key=np.real).real
frequency = np.sqrt((8000.0 + 3 * 6.0e5 * twist**2) / 3.0) / (2 * np.pi)
print(f"wind-up {twist:.6f} rad")
print(f"eigenfrequency {mode.frequency_hz:.5f} Hz, closed form {frequency:.5f} Hz")
assert abs(mode.frequency_hz / frequency - 1) < 1e-6

# %%
# And in time: the pump's torque ends at 0.05 s. SciPy integrates the one equation of
# motion beside it, and gives samples of the instant; so does ``raw``.

result = simulate(
    library,
    model.values(),
    tables=model.tables,
    t_end=0.6,
    rate=2000.0,
    rtol=1e-8,
    raw=True,
)
time = result.dataset["time"].values
found = -result.dataset["twist"].sel(rotor="pump").values


def pump(t, state):
    """Return the rates of the twist and of its rate."""
    load = np.interp(t, [0.05, 0.0501], [900.0, 0.0])
    return [
        state[1],
        (load - 8000.0 * state[0] - 6.0e5 * state[0] ** 3 - 4.0 * state[1]) / 3.0,
    ]


beside = solve_ivp(
    pump, (0.0, time[-1]), [twist, 0.0], t_eval=time, rtol=1e-10, atol=1e-12, max_step=1e-3
).y[0]
print(f"largest difference {np.abs(found - beside).max():.1e} rad")
assert np.abs(found - beside).max() < 1e-6

figure, axes = plt.subplots(layout="constrained")
axes.plot(time, found, label="ltcgear")
axes.plot(time, beside, linestyle="--", label="SciPy")
axes.set(title="Wind-up of the rubber coupling", xlabel="time [s]", ylabel="twist [rad]")
axes.legend()
plt.show()

# %%
# Into the house
# --------------
# There is one list of element types, so an element from outside works as those
# from inside do. One thing it cannot do: ``ltcgear.symbolic.emit.pipeline.obtain``, which
# keeps C between runs, does not see a change of an element that stands outside; use
# ``generate``. To make such a law part of ltcgear, so that a scene can call for it:
#
# 1. The element goes into a file in ``symbolic/elements``, with its source, its plain name,
#    the kind of connection it belongs to and the quantities it reports.
# 2. The effect is a row in ``symbolic/schema/effects.py``: name, values, the value that
#    leaves it out, help, source, what it needs and excludes. Validation, help, costs and
#    the page :doc:`/effects` follow from it.
# 3. Its numbers get a key with a unit in ``symbolic/schema/scene_schema.py``, where
#    ``faults`` tells what is wrong with them.
# 4. ``symbolic/assembly`` places the instance when the effect is on, and nothing otherwise:
#    ``draft.number`` for each parameter, ``draft.place`` for the element.
# 5. Tests: a closed form or a published number for the law; data for every pair of
#    effects (``tests/runtime/everything.py``) and a variant for the energy balance
#    (``variants.py`` beside it). The checks above need nothing: they take every element
#    type of a model. :doc:`/scenes` gets the key, :doc:`/method` the law, and ``make
#    docs regenerate`` rewrites what follows from the code.
