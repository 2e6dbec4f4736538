"""The checks pass on every shipped scene, and each is seen to fail when something is broken."""

import tomllib
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from time import process_time

import pytest
import sympy as sp
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.checks import agree, identity, physics
from ltcgear.symbolic.checks.all_checks import check_model
from ltcgear.symbolic.checks.check import Check, judged
from ltcgear.symbolic.checks.zero import vanishing
from ltcgear.symbolic.elements.base import Element
from ltcgear.symbolic.elements.element_types import make
from ltcgear.symbolic.elements.key import ElementKey
from ltcgear.symbolic.mechanics import lower
from ltcgear.symbolic.mechanics.equations import Equations, derive
from ltcgear.symbolic.mechanics.frames import FrameMotion
from ltcgear.symbolic.mechanics.model import Instance, Model
from ltcgear.symbolic.scene.load import SHIPPED, load_scene, make_scene, shipped_scenes

FRICTION = {
    "effects.gravity": "on",
    "effects.mesh_friction": "pitch-point",
    "stages.lsp.sun_planet.friction.coefficient": "0.05",
    "stages.hsp.ring_planet.friction.coefficient": "0.05",
    "effects.bearing_friction": "on",
    "stages.hsp.pin.friction": "0.01",
    "stages.hsp.pin.diameter": "300 mm",
    "stages.lsp.pin.friction_damping": "10 N*m*s/rad",
}
PAPER = {"effects.mesh_law": "paper"}
OPPOSITE = {
    "stages.lsp.sun_planet.flank": "opposite",
    "stages.lsp.ring_planet.flank": "opposite",
    "stages.psh.mesh.flank": "printed",
}
SCENES = {name: (name, {}) for name in shipped_scenes()} | {
    "friction, gravity": ("rig-2mw", FRICTION),
    "paper law": ("rig-2mw", PAPER),
    "opposite flank": ("rig-2mw", OPPOSITE),
    "all at once": ("rig-2mw", FRICTION | PAPER | OPPOSITE),
    "no damping": ("rig-2mw", {"effects.damping": "off", "effects.mesh_damping": "off"}),
    "mean stiffness": ("hsp", {"effects.mesh_stiffness": "mean"}),
    "paper law, pair": ("psh", PAPER),
    "paper law, unloaded": ("lin-parker-4", PAPER),
}
MESH = {"damped": True, "contact": "bilateral", "error": False, "followed": False}
EXTERNAL = ElementKey.of("mesh", kind="external", law="involute", switched=True, **MESH)
INTERNAL = ElementKey.of("mesh", kind="internal", law="involute", switched=False, **MESH)
PRINTED = ElementKey.of("mesh", kind="external", law="paper", switched=True, **MESH)
RUBBING = ElementKey.of(
    "mesh_friction", kind="external", law="involute", switched=True, contact="bilateral", error=False
)
PIN, COUPLING, BEARING = (ElementKey.of(name, damped=True) for name in ("pin", "coupling", "ground_bearing"))
PIN_FRICTION, WEIGHT, TORQUE = (ElementKey(name) for name in ("pin_friction", "gravity", "external_torque"))


@cache
def model_of(label: str) -> Model:
    name, changes = SCENES[label]
    return build_model(load_scene(name, changes=changes))


@cache
def equations_of(label: str) -> Equations:
    return derive(model_of(label))


def instance_of(key: ElementKey) -> tuple[Instance, Model]:
    for label in ("rig-2mw", "friction, gravity", "paper law"):
        model = model_of(label)
        for instance in model.instances:
            if replace(instance.element, live=()) == key:
                return instance, model
    raise AssertionError(key)


def bench_of(key: ElementKey, element: Element | None = None) -> physics.ElementBench:
    return physics.ElementBench("test", make(key) if element is None else element, *instance_of(key))


def parameter(element: Element, name: str) -> sp.Symbol:
    return next(symbol for symbol in element.parameters if symbol.name == name)


def with_component(element: Element, number: int, factor: sp.Expr | float = -1) -> Element:
    at = element.freedoms[number]
    return replace(element, wrench={**element.wrench, at: factor * element.loads[number]})


def with_arm(element: Element, number: int) -> Element:
    """Give one torque the other gear's radius."""
    one, two = parameter(element, "r_1"), parameter(element, "r_2")
    factors = [two if factor == one else factor for factor in sp.Mul.make_args(element.loads[number])]
    return replace(element, wrench={**element.wrench, element.freedoms[number]: sp.Mul(*factors)})


def failed(checks: list[Check] | tuple[Check, ...]) -> set[str]:
    return {check.name for check in checks if not check.passed}


# --- everything passes


@pytest.mark.parametrize("label", SCENES)
def test_all_checks_pass(label: str) -> None:
    checks = check_model(model_of(label))
    assert not [check for check in checks if not check.passed]
    assert len({check.name for check in checks}) == len(checks) > 10
    assert all(type(c.passed) is bool and type(c.value) is float and type(c.tolerance) is float for c in checks)


def test_all_checks_pass_where_torque_drives_and_the_speed_is_free() -> None:
    raw = tomllib.loads((SHIPPED / "rig-2mw.toml").read_text("utf-8"))
    raw["loads"]["motor"] = {"member": "motor", "torque": "1.2e6 N*m", "initial_speed": "15 rpm"}
    model = build_model(make_scene(raw))
    assert model.reference == "torque"
    assert not failed(check_model(model))


def seconds(act: Callable[[], object]) -> float:
    start = process_time()
    act()
    return process_time() - start


def test_quick_enough() -> None:
    """Measured by what one derivation takes, element types at hand."""
    model, equations = model_of("rig-2mw"), equations_of("rig-2mw")
    agree.agreement(model, equations)
    derivation = min(seconds(lambda: derive(model)) for _ in range(3))
    assert seconds(lambda: agree.agreement(model, equations)) < 30 * derivation  # seen: 6
    assert seconds(lambda: check_model(model)) < 400 * derivation  # seen: 90


def test_not_a_number_never_passes() -> None:
    assert not judged("", float("nan"), 1.0, "").passed


# --- the zero test itself

X, Y, Z = sp.symbols("x y z", real=True)
A, B = sp.symbols("a b", positive=True)
ROOT = sp.sqrt(X**2 + Y**2)
ZERO = [
    ROOT**3 / ROOT - X**2 - Y**2,
    1 / (ROOT + Z) - (ROOT - Z) / (X**2 + Y**2 - Z**2),
    sp.sqrt(ROOT + A) ** 4 - (ROOT + A) ** 2,
    sp.tanh(X) * sp.cosh(X) - sp.sinh(X),
    sp.sin(X * Y) ** 4 - (1 - sp.cos(X * Y) ** 2) ** 2,
    sp.diff(sp.log(sp.cosh(X / A)), X) - sp.tanh(X / A) / A,
    sp.Rational(1, 3) * X / A + X / (6 * A) - X / (2 * A),
    sp.sqrt(A**2 * sp.sin(X) ** 2 + A**2 * sp.cos(X) ** 2) - A,
    (A + B) ** -2 - 1 / (A**2 + 2 * A * B + B**2),
]
NONZERO = [
    ROOT - X - Y,
    sp.sqrt((X + Y) ** 2) + X + Y,
    ROOT**2 - X**2 - Y**2 + sp.Rational(1, 10**30),
    sp.tanh(X) - sp.tanh(Y),
    sp.sin(X) ** 2 + sp.cos(Y) ** 2 - 1,
    1 / (X - X * (sp.sin(Y) ** 2 + sp.cos(Y) ** 2)),
]


@pytest.mark.parametrize("expression", ZERO)
def test_zero_is_found(expression: sp.Expr) -> None:
    assert vanishing([expression]) == [True]


@pytest.mark.parametrize("expression", NONZERO)
def test_anything_else_is_not_zero(expression: sp.Expr) -> None:
    assert vanishing([expression]) == [False]


def test_squares_and_shifts() -> None:
    assert vanishing([X**3 - X, X - 1], {X: sp.S.One}) == [True, False]
    assert vanishing([X**2 + Y**2 - 1, X**2 - Y**2], {Y: 1 - X**2}) == [True, False]
    assert vanishing([(X - Y) ** 2 - X**2 + 2 * X * Y - Y**2, X], shifts={X: Y}) == [True, False]


@pytest.mark.parametrize("key", [EXTERNAL, INTERNAL, PIN])
def test_element_proof_is_fast(key: ElementKey) -> None:
    model = model_of("rig-2mw")
    derive(model)
    derivation = min(seconds(lambda: derive(model)) for _ in range(3))
    assert seconds(lambda: identity.element_identity("", make(key))) < 10 * derivation  # seen: 1


# --- symbolic proofs fail


@pytest.mark.parametrize("key", [EXTERNAL, INTERNAL, PIN, COUPLING, WEIGHT, PIN_FRICTION])
def test_identity_sees_every_flipped_sign(key: ElementKey) -> None:
    element = make(key)
    for number, component in enumerate(element.loads):
        if component != 0:
            check = identity.element_identity("", with_component(element, number))
            assert (check.passed, check.value) == (False, 1.0)


@pytest.mark.parametrize("key", [EXTERNAL, INTERNAL])
@pytest.mark.parametrize("number", [2, 5])
def test_identity_sees_a_wrong_radius(key: ElementKey, number: int) -> None:
    broken = make(key)
    if number == 5:
        broken = with_component(broken, 5, parameter(broken, "r_1") / parameter(broken, "r_2"))
    else:
        broken = with_arm(broken, number)
    assert broken.loads != make(key).loads
    assert not identity.element_identity("", broken).passed


def test_identity_sees_a_damper_that_feeds_energy() -> None:
    element = make(EXTERNAL)
    check = identity.element_identity("", replace(element, dissipation=-element.dissipation))
    assert (check.passed, check.value) == (False, 6.0)


def test_paper_law_checks_fail_when_broken() -> None:
    element = make(PRINTED)
    instance, model = instance_of(PRINTED)
    flipped = with_component(element, 0)
    assert not identity.nominal_identity("", flipped).passed
    assert not identity.first_order("", flipped, instance, model).passed
    slightly = with_component(element, 2, sp.Rational(101, 100))
    assert not identity.nominal_identity("", slightly).passed
    assert not identity.first_order("", slightly, instance, model).passed
    assert not identity.damper_identity("", replace(element, dissipation=2 * element.dissipation)).passed


def test_paper_law_is_no_gradient_and_the_rest_is_told() -> None:
    assert not identity.element_identity("", make(PRINTED)).passed
    check = identity.first_order("", make(PRINTED), *instance_of(PRINTED))
    assert check.passed
    assert 1e-4 < check.value < 1e-2
    assert "3.575e+05 N" in check.note


@pytest.mark.parametrize("stage", ["lsp", "hsp", "psh"])
def test_stage_sees_a_broken_element(stage: str) -> None:
    def is_sun(key: ElementKey) -> bool:
        return key.type == "mesh" and key["kind"] == "external"

    def write(key: ElementKey) -> Element:
        element = make(key)
        return with_component(element, 5, 1 + sp.Rational(1, 10**6)) if is_sun(key) else element

    meshes = {"lsp": 4, "hsp": 3, "psh": 1}
    check = identity.stage_identity(model_of("rig-2mw"), stage, write)
    assert (check.passed, check.value) == (False, meshes[stage])


def test_identities_report_element_and_stages() -> None:
    wrong = failed(identity.identities(model_of("lsp"), lambda key: with_component(make(key), 0)))
    assert "stage lsp: Lagrange's and Newton's equations are the same" in wrong
    assert "planet bearing (damped): energies give the forces written by hand" in wrong


# --- routes to one right-hand side fail


def test_agreement_sees_accelerations_off_by_1e_8() -> None:
    equations = equations_of("rig-2mw")
    wrong = agree.agreement(model_of("rig-2mw"), replace(equations, xdot=equations.xdot * (1 + 1e-8)))
    assert "whole model: Lagrange's and Newton's forces and accelerations" in failed(wrong)


def test_agreement_sees_not_a_number() -> None:
    equations = equations_of("psh")
    broken = agree.agreement(model_of("psh"), replace(equations, xdot=equations.xdot * float("nan")))
    assert "whole model: Lagrange's and Newton's forces and accelerations" in failed(broken)


def test_agreement_sees_one_broken_wrench(monkeypatch: pytest.MonkeyPatch) -> None:
    def write(key: ElementKey) -> Element:
        return with_component(make(key), 2, 1 + 1e-7) if replace(key, live=()) == PIN else make(key)

    lower.element_function.cache_clear()
    with monkeypatch.context() as patch:
        patch.setattr(lower, "make", write)
        wrong = failed(agree.agreement(model_of("hsp"), derive(model_of("hsp"))))
    lower.element_function.cache_clear()
    assert wrong == {"whole model: Lagrange's and Newton's forces and accelerations"}


def test_agreement_sees_the_wrong_order_with_the_papers_law() -> None:
    equations = equations_of("paper law")
    wrong = agree.agreement(model_of("paper law"), replace(equations, xdot=equations.xdot * 1.001))
    assert "whole model: the paper's mesh law, to first order" in failed(wrong)


def test_frame_accelerations_see_a_flipped_coriolis_term() -> None:
    x, y, u = FrameMotion.symbols().newton()
    speed = FrameMotion.symbols().vy
    assert not agree.frame_accelerations([x.xreplace({speed: -speed}), y, u]).passed


def test_coordinates_see_a_force_left_unturned() -> None:
    model, equations = model_of("hsp"), equations_of("hsp")
    forces = equations.forces | {"hsp.planet.1": equations.forces["hsp.planet.1"] * (1 + 1e-9)}
    wrong = failed(agree.coordinates(model, replace(equations, forces=forces)))
    assert "inertial coordinates: forces are those of the turning frames" in wrong


def test_coordinates_see_a_missing_centrifugal_term() -> None:
    model, equations = model_of("hsp"), equations_of("hsp")
    places = equations.positions | {"hsp.planet.1": equations.positions["hsp.planet.1"] * (1 + 1e-9)}
    wrong = failed(agree.coordinates(model, replace(equations, positions=places)))
    assert "inertial coordinates: momentum changes by the forces" in wrong
    flat = replace(equations, angles=dict.fromkeys(equations.angles, equations.x[0] * 0))
    assert failed(agree.coordinates(model, flat))


# --- laws of physics fail


@pytest.mark.parametrize("key", [EXTERNAL, INTERNAL, PIN, COUPLING, WEIGHT, TORQUE])
def test_a_force_that_is_no_slope_is_seen(key: ElementKey) -> None:
    element = make(key)
    number = next(i for i, component in enumerate(element.loads) if component != 0)
    assert physics.conservative_force(bench_of(key)).passed
    assert not physics.conservative_force(bench_of(key, with_component(element, number))).passed


@pytest.mark.parametrize("key", [EXTERNAL, INTERNAL, PIN, RUBBING])
def test_unequal_reaction_is_seen(key: ElementKey) -> None:
    push, moment = physics.action_and_reaction(bench_of(key, with_component(make(key), 3, 1 + 1e-8)))
    assert not push.passed
    assert not moment.passed


@pytest.mark.parametrize("key", [EXTERNAL, INTERNAL])
def test_wrong_radius_unbalances_moments_only(key: ElementKey) -> None:
    push, moment = physics.action_and_reaction(bench_of(key, with_arm(make(key), 2)))
    assert (push.passed, moment.passed) == (True, False)


def test_benches_stand_at_working_deflections() -> None:
    values = bench_of(EXTERNAL).values()
    deflection = values["outputs"][list(make(EXTERNAL).outputs).index("deflection")]
    assert 1e-5 < abs(deflection).max() < 1e-3


@pytest.mark.parametrize("key", [EXTERNAL, PIN, BEARING, COUPLING])
def test_damper_that_feeds_energy_is_seen(key: ElementKey) -> None:
    element = make(key)
    name = "c_t" if key == COUPLING else "c"
    negative = {parameter(element, name): -parameter(element, name)}
    broken = replace(element, wrench={at: load.xreplace(negative) for at, load in element.wrench.items()})
    feeds, booked = physics.dissipated_power(bench_of(key, broken))
    assert (feeds.passed, booked.passed) == (False, False)


@pytest.mark.parametrize("key", [RUBBING, PIN_FRICTION])
def test_friction_with_the_papers_sign_is_seen(key: ElementKey) -> None:
    broken = replace(make(key), wrench={at: -load for at, load in make(key).wrench.items()})
    assert not physics.dissipated_power(bench_of(key, broken))[0].passed


def test_loss_that_is_not_booked_is_seen() -> None:
    broken = replace(make(PIN), dissipation=make(PIN).dissipation * (1 + 1e-8))
    feeds, booked = physics.dissipated_power(bench_of(PIN, broken))
    assert (feeds.passed, booked.passed) == (True, False)


@pytest.mark.parametrize(("name", "unit"), [("k_1", "N*m/rad"), ("c", "N/m"), ("r_1", ""), ("e_x", "m")])
def test_wrong_unit_of_a_parameter_is_seen(name: str, unit: str) -> None:
    element = make(EXTERNAL)
    broken = replace(element, parameters={**element.parameters, parameter(element, name): unit})
    assert not physics.homogeneous(bench_of(EXTERNAL, broken)).passed


def test_wrong_unit_of_an_output_is_seen() -> None:
    element = make(EXTERNAL)
    outputs = {**element.outputs, "force": replace(element.outputs["force"], unit="N*m")}
    assert not physics.homogeneous(bench_of(EXTERNAL, replace(element, outputs=outputs))).passed


def test_force_where_a_torque_is_due_is_seen() -> None:
    element = make(EXTERNAL)
    wrench = {**element.wrench, element.freedoms[2]: element.loads[0]}
    assert not physics.homogeneous(bench_of(EXTERNAL, replace(element, wrench=wrench))).passed


def test_whole_suite_reports_a_broken_element() -> None:
    wrong = failed(physics.physics(model_of("lsp"), lambda key: with_component(make(key), 0, 2)))
    assert "planet bearing (damped): action equals reaction" in wrong
    assert "housing bearing (damped): force is the slope of the energy" in wrong
