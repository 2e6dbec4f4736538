"""Derivatives of eigenvalues: against differences, and against matrices built by hand where a pair splits."""

from dataclasses import replace

import numpy as np
import pytest
from ltcgear.runtime.linear.modes import find_modes
from ltcgear.runtime.linear.sensitivity import differentiate_modes
from ltcgear.runtime.linear.system import linearise
from ltcgear.runtime.model.building import build
from ltcgear.runtime.model.equilibrium import find_equilibrium
from ltcgear.runtime.model.operating_point import OperatingPoint
from ltcgear.runtime.studies.sensitivity.items import list_modes
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.mechanics.model import Parameter
from ltcgear.symbolic.scene.load import make_scene

from reference import lin_parker

from ..models import Case, case, make_case, raw_scene

EXACT, ROUNDING = 1e-6, 2e-13
"""Relative error of derivatives; what rounding takes of an eigenvalue, over the largest."""
TORQUE_DRIVEN = (
    "-loads.input.speed",
    'loads.input.torque = "-2.9e4 N*m"',
    'loads.input.initial_speed = "-639 rpm"',
)
OVERDAMPED = (
    "-stages.psh.output.bearing.damping_ratio",
    'stages.psh.output.bearing.damping = "1.5e6 N*s/m"',
)
SWITCHES = ("varying", "pull", "closing")
"""Parameters that are no numbers of a gearbox: they choose what is computed."""


def linear_of(c, p=None, turn=None):
    p = c.p if p is None else p
    return linearise(OperatingPoint(c.library, p, find_equilibrium(c.library, p, tables=c.model.tables)), turn)


def derivatives(c, numbers=None, turn=None):
    linear = linear_of(c, turn=turn)
    return differentiate_modes(linear, find_modes(linear), numbers, None if turn is None else c.at)


def step_of(name, unit, value):
    """How far a parameter may move while nothing bends: a thousandth, or a micron of a place."""
    return 1e-6 if unit == "m" and "base_radius" not in name else 1e-3 * (abs(value) or 1.0)


def difference(c, i, h, items, turn):
    """d lambda / dp by central differences, extrapolated twice; repeated eigenvalues by their branches."""

    def moved(step):
        p = c.p.copy()
        p[i] += step
        values = np.linalg.eigvals(linear_of(c, p, turn).scaled())
        found = []
        for item in items:
            near = values[np.argsort(np.abs(values - item.mode.eigenvalue))[: item.repeated]]
            found.append(near[np.argsort(-np.abs(near))])
        return found

    def central(step):
        up, down = moved(step), moved(-step)
        return [(a - b[::-1]) / (2 * step) for a, b in zip(up, down, strict=True)]

    rows = [central(h / 2**k) for k in range(3)]
    out = []
    for one, two, three in zip(*rows, strict=True):
        first, second = (4 * two - one) / 3, (4 * three - two) / 3
        out.append((16 * second - first) / 15)
    return out


def numbers_of(c):
    for i, (name, unit) in enumerate(c.library.manifest.parameters):
        if not (name.startswith("hold.") or name.rsplit(".", 1)[-1] in SWITCHES):
            yield i, name, unit


def check_against_differences(c, chosen, every=1, turn=None):
    """Compare, and return how many derivatives were large enough to be compared to 1e-6."""
    found, groups = derivatives(c, turn=turn), {}
    for item in found:
        groups.setdefault(item.mode.group, []).append(item)
    groups = {key: items for key, items in groups.items() if {item.number for item in items} & set(chosen)}
    firsts, compared = [items[0] for items in groups.values()], 0
    top = np.abs(np.linalg.eigvals(linear_of(c, turn=turn).scaled())).max()
    for i, name, unit in list(numbers_of(c))[::every]:
        step = step_of(name, unit, c.p[i])
        by_differences, rounding = difference(c, i, step, firsts, turn), ROUNDING * top / step
        for items, expected in zip(groups.values(), by_differences, strict=True):
            values = np.array([item.eigenvalue[i] for item in items])
            order = np.argsort(-(np.conj(items[0].mode.eigenvalue) * expected).real, kind="stable")
            error = np.abs(values - expected[order]).max()
            large = np.abs(expected).max()
            assert error <= EXACT * large + rounding, (name, values, expected)
            compared += rounding < EXACT * large
    return compared


# --- differences


@pytest.mark.parametrize(
    ("name", "settings", "numbers", "turn"),
    [
        ("psh", (), [1, 2, 3, 4, 5], None),
        ("psh", (), [1, 3], 0.013),
        ("psh", ('effects.contact = "backlash"', 'effects.gravity = "on"', 'effects.mesh_law = "paper"'), [1, 2], None),
        ("psh", OVERDAMPED, [1, 2, 3, 4, 5], None),
        ("hsp", (), [5, 9], None),
        ("lin-parker-4", (), [3, 4, 5], None),
        ("start-up", (), [1, 4], None),
        ("psh", TORQUE_DRIVEN, [1, 2, 4, 5], None),
    ],
)
def test_derivatives_are_those_of_differences(name, settings, numbers, turn):
    assert check_against_differences(case(name, *settings), numbers, turn=turn) > 5


def test_derivatives_of_the_rig():
    c = case("rig-2mw")
    single = [item.number for item in derivatives(c) if item.repeated == 1]
    assert check_against_differences(c, single[::6], every=8) > 8


def test_frequency_and_damping_follow_the_eigenvalue():
    c = case("psh")
    item = derivatives(c, [2])[0]
    i = [name for name, _ in c.library.manifest.parameters].index("psh.output.bearing.damping")
    h, found = 1e-3 * c.p[i], []
    for sign in (1, -1):
        p = c.p.copy()
        p[i] += sign * h
        found.append(find_modes(linear_of(c, p))[1])
    up, down = found
    assert item.frequency_hz[i] == pytest.approx((up.frequency_hz - down.frequency_hz) / (2 * h), rel=1e-3)
    assert item.damping_ratio[i] == pytest.approx((up.damping_ratio - down.damping_ratio) / (2 * h), rel=1e-5)


def test_a_scaled_train_scales_its_frequencies():
    """All stiffnesses up by one part and all masses too: no frequency moves. Stiffnesses alone: by half a part."""
    c = case("lin-parker-5")
    units = [unit for _, unit in c.library.manifest.parameters]
    stiff, heavy = ("N/m", "N*m/rad"), ("kg", "kg*m^2")
    for item in derivatives(c):
        relative = item.frequency_hz * c.p / item.mode.frequency_hz
        by = {kind: sum(r for r, unit in zip(relative, units, strict=True) if unit in kind) for kind in (stiff, heavy)}
        assert by[stiff] == pytest.approx(0.5, abs=1e-9)
        assert by[heavy] == pytest.approx(-0.5, abs=1e-9)


# --- repeated


def planet_of_its_own(raw, planet, mesh):
    """A stage in which one planet's mesh has a stiffness of its own, which the language of scenes does not know."""
    scene = make_scene(raw)
    model = build_model(scene)
    name, own = f"gear.{mesh}.{planet}", f"gear.{mesh}.{planet}.stiffness"
    stiffness = next(p for p in model.parameters if p.name == f"gear.{mesh}.stiffness")
    instances = tuple(
        replace(item, bind={key: own if value == stiffness.name else value for key, value in item.bind.items()})
        if item.name == name
        else item
        for item in model.instances
    )
    parameters = (*model.parameters, Parameter(own, stiffness.value, stiffness.unit))
    model = replace(model, instances=instances, parameters=parameters)
    return Case(scene, model, build(obtain(model))), own


def test_a_pair_splits_as_the_matrices_by_hand_say():
    """One spring is of rank one: of every pair one mode stays, the other moves by the square of its elongation."""
    c, own = planet_of_its_own(raw_scene("lin-parker-4"), 1, "sun_planet")
    i = [name for name, _ in c.library.manifest.parameters].index(own)
    mass, stiffness = lin_parker.matrices(4)
    one = np.zeros_like(stiffness)
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(lin_parker.K_MESH, "sun", 1.0)
        patch.setitem(lin_parker.K_MESH, "ring", 0.0)
        patch.setattr(lin_parker, "K_PIN", 0.0)
        lin_parker._add_planet(one, 0.0, 9)
    weight = 1 / np.sqrt(np.diag(mass))
    values, shapes = np.linalg.eigh(weight[:, None] * stiffness * weight)
    pairs = 0
    for item in derivatives(c):
        near = np.abs(values / (2 * np.pi * item.mode.frequency_hz) ** 2 - 1) < 1e-6
        moved = weight[:, None] * shapes[:, near]
        expected = np.sort(np.linalg.eigvalsh(moved.T @ one @ moved))[::-1] / (8 * np.pi**2 * item.mode.frequency_hz)
        assert item.repeated == len(expected)
        if item.repeated == 2:
            pairs += 1
            assert any(item.frequency_hz[i] == pytest.approx(v, rel=1e-6, abs=1e-6 * expected[0]) for v in expected)
    assert pairs == 12


def test_a_pair_splits_as_predicted():
    c, own = planet_of_its_own(raw_scene("lin-parker-4"), 1, "sun_planet")
    i = [name for name, _ in c.library.manifest.parameters].index(own)
    pair = [item for item in derivatives(c) if item.repeated == 2][:2]
    step = 1e-4 * c.p[i]
    p = c.p.copy()
    p[i] += step
    found = np.array([mode.frequency_hz for mode in find_modes(linear_of(c, p))])
    predicted = np.array([item.mode.frequency_hz + step * item.frequency_hz[i] for item in pair])
    gap = predicted[0] - predicted[1]
    assert gap > 1e-5
    for value in predicted:
        assert np.abs(found - value).min() < 1e-3 * gap


def test_an_overdamped_mode_is_told_by_its_slower_part():
    c = case("psh", *OVERDAMPED)
    items = list_modes(c.library, c.p)["items"]
    slow = [item for item in items if item["notes"]]
    assert slow
    values = np.abs(np.linalg.eigvals(linear_of(c).scaled()).real) / (2 * np.pi)
    for item in slow:
        assert np.abs(values / item["value"] - 1).min() < 1e-9


# --- loose trains


def test_a_torque_that_unbalances_has_no_derivative():
    """Two gears that roll on each other without a support: with one torque changed nothing balances."""
    raw = raw_scene("psh")
    raw["loads"] = {
        "a": {"member": "psh.input", "torque": "1000 N*m"},
        "b": {"member": "psh.output", "torque": f"{1000 * 21 / 59} N*m"},
    }
    raw["effects"] = {"mesh_stiffness": "mean"}
    c = make_case(raw)
    for item in derivatives(c):
        lost = {n for (n, _), v in zip(c.library.manifest.parameters, item.eigenvalue, strict=True) if np.isnan(v)}
        assert {"loads.a.torque", "loads.b.torque"} <= lost
        assert not lost & {"psh.mesh.stiffness", "psh.input.mass", "psh.output.bearing.stiffness"}
