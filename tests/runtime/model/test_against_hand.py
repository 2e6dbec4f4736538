"""The compiled right-hand side and outputs against a whole model written by hand in inertial coordinates."""

import numpy as np
import pytest
from ltcgear.runtime.model.function import Kernel

from ..hand_model import HandModel
from ..hand_newton import kinetic, newton
from ..models import case, make_case, quick_case, raw_scene
from ..variants import (
    BACKLASH,
    CARRIER_BEARING,
    DAMPERS,
    FRICTION,
    ONE_FLANK,
    POSITION_ERRORS,
    RIGID_PINS,
    RIGID_SHAFTS,
    SMOOTH,
    TORQUE,
    TORSIONAL,
    VARIANTS,
)

STATES = 100
TOLERANCE = 1e-9
"""3e-10 at most is found: speed ratios are doubles, and 1e-16 of a hundred metres rolled is 1e-14 m."""
SAMPLED = 1e-6
"""Where the product samples a table and the hand integrates it."""
OPTIMISED = ("rig", "all at once", "smooth", "backlash")
"""Variants that are compiled as for users."""
CENTRE_OF_MASS = ("acceleration_x", "acceleration_y")
DETAILS = {
    "parted flanks do not rub": ((ONE_FLANK, *FRICTION, *DAMPERS), ("mesh_friction",)),
    "the back flank rubs": ((*BACKLASH, *FRICTION, *DAMPERS), ("acceleration",)),
    "damping ratios refer to the member's own inertia, pins": (
        (RIGID_PINS, *CARRIER_BEARING),
        ("bearing_force_x", "coupling_torque"),
    ),
    "damping ratios refer to the member's own inertia, shafts": ((RIGID_SHAFTS,), ("mesh_force",)),
    "accelerations are the centre's, as velocities are": ((RIGID_PINS, *POSITION_ERRORS, *DAMPERS), CENTRE_OF_MASS),
    "a torsional back flank sees the pin's place": (
        (TORSIONAL, *POSITION_ERRORS, *BACKLASH, *DAMPERS),
        ("mesh_deflection",),
    ),
    "a torsional phase sees the pin's place": (
        (TORSIONAL, *POSITION_ERRORS, *SMOOTH, TORQUE, *DAMPERS),
        ("gear_phase", "mesh_phase", "mesh_force"),
    ),
}
"""Settings whose laws are easily got wrong, and the quantities that show it."""
SHOWN_BY_HAND = {
    "mesh_force", "mesh_deflection", "mesh_contact", "pressure_angle", "mesh_phase", "gear_phase", "mesh_friction",
    "pin_force_x", "pin_force_y", "pin_friction_torque", "bearing_force_x", "bearing_force_y", "coupling_torque",
    "support_torque", "speed", "angular_acceleration", "acceleration_x", "acceleration_y", "velocity_x", "velocity_y",
    "drive_torque", "acceleration", "kinetic",
}  # fmt: skip
"""All that is compared; twists and displacements are the states themselves."""


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
        moved_by_hand, holding = newton(by_hand, motions, result.forces)
        product = dict(zip(keys, outputs(x, s, c.p)[0].copy(), strict=True))
        moved = by_hand.accelerations(names, x, rhs(x, s, c.p)[0])
        product |= {("acceleration", *key): value for key, value in moved.items()}
        product["kinetic", ""] = energy(x, s, c.p)[0][0]
        wished = result.outputs | {("acceleration", *key): value for key, value in moved_by_hand.items()}
        wished |= body_outputs(by_hand, motions, moved_by_hand, holding)
        wished["kinetic", ""] = kinetic(by_hand, motions)
        for into, values in ((given, product), (wanted, wished)):
            for key, value in values.items():
                into.setdefault(key, []).append(float(value))
    return given, wanted


def body_outputs(by_hand, motions, accelerations, holding):
    """Accelerations, speeds and drive torques as the outputs name them."""
    shown = {(f"acceleration_{axis}", name): value for (name, axis), value in accelerations.items() if axis != "u"}
    for name in by_hand.members:
        if getattr(by_hand.members[name], "support", "") != "fixed":
            shown["speed", name] = motions[name].w
            shown["angular_acceleration", name] = accelerations.get((by_hand.leader[name], "u"), 0.0)
    moving = {name for name, axis in accelerations if axis == "x"}
    shown |= {(f"velocity_{axis}", name): motions[name].V[i] for name in moving for i, axis in enumerate("xy")}
    return shown | {("drive_torque", name): holding[by_hand.leader[name]] for name in by_hand.driven}


def assert_equal(c, lead, tolerance, quantities):
    """Compare quantities; what the product shows must be known by hand, and the other way round."""
    given, wanted = compare(c, lead)
    compared = {key for key in wanted if key[0] in quantities}
    assert {key for key in given if key[0] in quantities} == compared
    errors = {}
    for key in compared:
        wished = np.array(wanted[key])
        errors[key] = np.abs(np.array(given[key]) - wished).max() / max(np.abs(wished).max(), 1e-300)
    worst = max(errors, key=errors.get)
    assert errors[worst] < tolerance, f"{worst}: {errors[worst]:.2e}"


@pytest.mark.parametrize("variant", [variant for variant in VARIANTS if variant != "all at once"])
def test_the_compiled_model_is_the_hand_written_one(variant):
    settings = VARIANTS[variant]
    sampled = any("table = [" in setting for setting in settings)
    build = case if variant in OPTIMISED else quick_case
    assert_equal(build("rig-2mw", *settings), "motor", SAMPLED if sampled else TOLERANCE, SHOWN_BY_HAND)


@pytest.mark.usefixtures("shipped_flags")
def test_the_largest_model_is_the_hand_written_one_as_users_compile_it():
    all_at_once = make_case(raw_scene("rig-2mw", *VARIANTS["all at once"]))
    assert_equal(all_at_once, "motor", TOLERANCE, SHOWN_BY_HAND)


@pytest.mark.parametrize("detail", DETAILS)
def test_details_of_the_laws_are_the_hand_written_ones(detail):
    settings, quantities = DETAILS[detail]
    assert_equal(quick_case("rig-2mw", *settings), "motor", TOLERANCE, quantities)


def test_the_compiled_gear_at_rest_is_the_hand_written_one():
    assert_equal(case("lin-parker-4"), None, TOLERANCE, SHOWN_BY_HAND)


def test_the_comparison_notices_a_wrong_number():
    c = case("rig-2mw")
    wrong = case("rig-2mw", 'stages.hsp.pin.stiffness = "4.20000001e9 N/m"')
    given, wanted = compare(c, "motor"), compare(wrong, "motor")
    key = ("acceleration", "hsp.planet.2", "x")
    difference = np.abs(np.subtract(given[0][key], wanted[1][key])).max()
    assert difference > 1e-9 * np.abs(given[0][key]).max()
