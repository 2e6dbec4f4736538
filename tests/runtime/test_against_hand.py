"""The compiled right-hand side and outputs against a whole model written by hand in inertial coordinates."""

import numpy as np
import pytest
from ltcgear.runtime.kernel import Kernel

from .hand_model import HandModel
from .models import TORQUE_DRIVEN, case
from .variants import BEARING_FRICTION, FRICTION, GRAVITY, ODD, OPPOSITE, PAPER

STATES = 100
TOLERANCE = 1e-10
VARIANTS = {
    "rig": ("rig-2mw", "motor"),
    "paper law": ("rig-2mw", "motor", PAPER),
    "mesh friction": ("rig-2mw", "motor", *FRICTION),
    "bearing friction": ("rig-2mw", "motor", *BEARING_FRICTION),
    "gravity": ("rig-2mw", "motor", GRAVITY),
    "opposite flank": ("rig-2mw", "motor", *OPPOSITE),
    "torque-driven": ("rig-2mw", "motor", *TORQUE_DRIVEN),
    "mean stiffness, undamped": (
        "rig-2mw",
        "motor",
        'effects.mesh_stiffness = "mean"',
        'effects.damping = "off"',
        'effects.mesh_damping = "off"',
    ),
    "all at once": (
        "rig-2mw",
        "motor",
        PAPER,
        GRAVITY,
        *FRICTION,
        *BEARING_FRICTION,
        *OPPOSITE,
        *TORQUE_DRIVEN,
        *ODD,
    ),
    "at rest, torsional support": ("lin-parker-4", None),
}
SHOWN_BY_HAND = {
    "mesh_force", "mesh_deflection", "pressure_angle", "mesh_phase", "mesh_friction", "pin_force_x", "pin_force_y",
    "pin_friction_torque", "bearing_force_x", "bearing_force_y", "coupling_torque", "support_torque",
}  # fmt: skip
"""Outputs of elements; those of bodies are compared on their own."""


def random_states(c, seed):
    """States of the generated model and levels, at the sizes of a running gearbox and beyond."""
    rng = np.random.default_rng(seed)
    for _ in range(STATES):
        x = np.empty(len(c.library.manifest.states))
        for i, state in enumerate(c.library.manifest.states):
            size = 0.1 if state.name.endswith(".rate") else 1e-4
            x[i] = size * rng.uniform(-1, 1)
            if state.name == "reference.angle":
                x[i] = rng.uniform(-50, 50)
            if state.name == "reference.speed":
                x[i] = rng.uniform(1, 2)
        yield x, rng.uniform(0, 1, len(c.library.manifest.levels))


def compare(c, lead, seed=2021):
    """(key -> product's values, key -> the hand's values) over the states."""
    by_hand = HandModel(c.scene, lead)
    names, levels = [s.name for s in c.library.manifest.states], c.library.manifest.levels
    rhs, outputs = Kernel(c.library.functions["rhs"]), Kernel(c.library.functions["outputs"])
    energy = Kernel(c.library.functions["energy"])
    keys = [(r.quantity, r.item) for r in c.library.manifest.reports]
    given, wanted = {}, {}
    for x, s in random_states(c, seed):
        motions = by_hand.motions(names, x)
        result = by_hand.evaluate(motions, dict(zip(levels, s, strict=True)))
        newton = by_hand.newton(result.forces)
        product = dict(zip(keys, outputs(x, s, c.p)[0].copy(), strict=True))
        moved = by_hand.accelerations(names, x, rhs(x, s, c.p)[0])
        product |= {("acceleration", *key): value for key, value in moved.items()}
        product["kinetic", ""] = energy(x, s, c.p)[0][0]
        wished = result.outputs | {("acceleration", *key): value for key, value in newton.items()}
        wished |= body_outputs(by_hand, motions, newton, result.forces)
        wished["kinetic", ""] = kinetic(by_hand, motions)
        for into, values in ((given, product), (wanted, wished)):
            for key, value in values.items():
                into.setdefault(key, []).append(float(value))
    return given, wanted


def kinetic(by_hand, motions):
    """Kinetic energy [J]."""
    from .hand_model import on_disc

    total = 0.0
    for name, member in by_hand.members.items():
        mass, inertia = on_disc(member)
        if getattr(member, "support", "rigid") in ("bearing", "floating"):
            total += mass * (motions[name].V @ motions[name].V) / 2
        if getattr(member, "support", "") != "fixed":
            total += inertia * motions[name].w ** 2 / 2
    return total


def body_outputs(by_hand, motions, newton, forces):
    """Accelerations, speeds and drive torques as the outputs name them."""
    shown = {(f"acceleration_{axis}", name): value for (name, axis), value in newton.items() if axis != "u"}
    turning = [n for n, member in by_hand.members.items() if getattr(member, "support", "") != "fixed"]
    shown |= {("speed", name): motions[name].w for name in turning}
    moving = {name for name, axis in newton if axis == "x"}
    shown |= {(f"velocity_{axis}", name): motions[name].V[i] for name in moving for i, axis in enumerate("xy")}
    return shown | {("drive_torque", name): -forces[name][2] for name in by_hand.driven}


@pytest.mark.parametrize("variant", VARIANTS)
def test_the_compiled_model_is_the_hand_written_one(variant):
    name, lead, *settings = VARIANTS[variant]
    given, wanted = compare(case(name, *settings), lead)
    assert set(wanted) <= set(given)
    assert {key for key in given if key[0] in SHOWN_BY_HAND} <= set(wanted)
    errors = {}
    for key, values in wanted.items():
        wished = np.array(values)
        errors[key] = np.abs(np.array(given[key]) - wished).max() / max(np.abs(wished).max(), 1e-300)
    worst = max(errors, key=errors.get)
    assert errors[worst] < TOLERANCE, f"{worst}: {errors[worst]:.2e}"


def test_the_comparison_notices_a_wrong_number():
    c = case("rig-2mw")
    wrong = case("rig-2mw", 'stages.hsp.pin.stiffness = "4.20000001e9 N/m"')
    given, wanted = compare(c, "motor"), compare(wrong, "motor")
    key = ("acceleration", "hsp.planet.2", "x")
    difference = np.abs(np.subtract(given[0][key], wanted[1][key])).max()
    assert difference > 1e-9 * np.abs(given[0][key]).max()
