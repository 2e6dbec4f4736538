"""The oracles against things outside them: energy, momentum, dissipation, and print."""

import numpy as np
import pytest

from reference import hand_forces as hand
from reference import lin_parker

KINDS = ("external", "internal")
LAWS = ("involute", "paper")
FLANKS = (1.0, -1.0)
SEEDS = range(20)
K, C = 1.7e8, 3.1e5
"""Mesh stiffness [N/m] and damping [N s/m]."""


def random_mesh(kind, s, seed):
    """Gear data and a state near a valid mesh that has turned several revolutions [m, rad, s]."""
    rng = np.random.default_rng([seed, KINDS.index(kind), int(s > 0)])
    r1, r2 = rng.uniform(0.8, 1.0), rng.uniform(0.25, 0.5)
    sigma = hand.SIGMA[kind]
    d0 = (r1 + sigma * r2) / np.cos(np.deg2rad(rng.uniform(18.0, 25.0)))
    gamma0, Dg = rng.uniform(-np.pi, np.pi), rng.uniform(-40.0, 40.0)
    d = d0 + rng.uniform(-2e-3, 2e-3)
    O1 = rng.uniform(-1e-2, 1e-2, 2)
    O2 = O1 + d * np.array([np.cos(gamma0 + Dg), np.sin(gamma0 + Dg)])
    th1 = Dg + rng.uniform(-30.0, 30.0)
    th2 = Dg - sigma * r1 / r2 * (th1 - Dg) + s * rng.uniform(2e-3, 8e-3)
    gear = {"r1": r1, "r2": r2, "d0": d0, "gamma0": gamma0, "turn": Dg + rng.uniform(-1.0, 1.0)}
    state = {"O1": O1, "th1": th1, "O2": O2, "th2": th2}
    motion = dict(zip(("V1", "V2"), rng.normal(size=(2, 2)), strict=True))
    motion |= dict(zip(("w1", "w2"), 5.0 * rng.normal(size=2), strict=True))
    return gear, state, motion


def at_rest():
    """No motion at all."""
    return {"V1": np.zeros(2), "V2": np.zeros(2), "w1": 0.0, "w2": 0.0}


def shifted(state, motion, h):
    """The state after the time h [s] at constant velocities."""
    rates = {"O1": "V1", "O2": "V2", "th1": "w1", "th2": "w2"}
    return {name: state[name] + h * motion[rate] for name, rate in rates.items()}


def mesh_slope(kind, s, gear, state):
    """-dV/dq, V = k delta^2/2, by central differences, in the order O1, th1, O2, th2."""
    h, q = 1e-6, np.hstack([state["O1"], state["th1"], state["O2"], state["th2"]])

    def energy(q):
        parts = {"O1": q[:2], "th1": q[2], "O2": q[3:5], "th2": q[5]}
        out = hand.mesh(kind, "involute", s, **gear, k=K, c=0.0, **parts, **at_rest())
        return 0.5 * K * out["deflection"] ** 2

    return np.array([(energy(q - step) - energy(q + step)) / (2 * h) for step in h * np.eye(6)])


def momentum(O1, O2, out):
    """Total force and total moment about the origin of a pair of bodies."""
    moment = out["T1"] + out["T2"] + hand.cross(O1, out["F1"]) + hand.cross(O2, out["F2"])
    return np.hstack([out["F1"] + out["F2"], moment])


def power(motion, out):
    """Power [W] that a pair's forces and torques feed to it."""
    linear = np.dot(out["F1"], motion["V1"]) + np.dot(out["F2"], motion["V2"])
    return linear + out["T1"] * motion["w1"] + out["T2"] * motion["w2"]


def friction(kind, s, gear, state, motion):
    """Pitch-point friction under a normal force of either sign."""
    radii = {"r1": gear["r1"], "r2": gear["r2"]}
    centres = {"O1": state["O1"], "O2": state["O2"]}
    return hand.pitch_point_friction(kind, s, **radii, N=-s * 2.0e5, mu=0.06, c_t=900.0, v0=0.01, **centres, **motion)


def random_pin(seed):
    """Keyword arguments of `hand.pin` at a seeded state several revolutions on, c chosen by the test."""
    rng = np.random.default_rng(seed)
    rho0, C, thC = rng.normal(size=2), 0.01 * rng.normal(size=2), rng.uniform(-40.0, 40.0)
    turn = np.array([[np.cos(thC), -np.sin(thC)], [np.sin(thC), np.cos(thC)]])
    P = C + turn @ rho0 + 1e-3 * rng.normal(size=2)
    VC, VP = rng.normal(size=(2, 2))
    return {"rho0": rho0, "C": C, "thC": thC, "VC": VC, "wC": rng.normal(), "P": P, "VP": VP}


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("s", FLANKS)
@pytest.mark.parametrize("kind", KINDS)
def test_involute_mesh_is_minus_the_energy_gradient(kind, s, seed):
    gear, state, _ = random_mesh(kind, s, seed)
    out = hand.mesh(kind, "involute", s, **gear, k=K, c=0.0, **state, **at_rest())
    assert abs(out["deflection"]) < 6e-3  # the branch of gamma is the right one after the turns
    forces = np.hstack([out["F1"], out["T1"], out["F2"], out["T2"]])
    np.testing.assert_allclose(forces, mesh_slope(kind, s, gear, state), atol=1e-6 * abs(out["force"]))


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("s", FLANKS)
@pytest.mark.parametrize("kind", KINDS)
def test_involute_damper_sees_the_deflection_rate(kind, s, seed):
    gear, state, motion = random_mesh(kind, s, seed)
    h = 1e-6
    after, before = (
        hand.mesh(kind, "involute", s, **gear, k=0.0, c=1.0, **shifted(state, motion, step), **motion)
        for step in (h, -h)
    )
    rate = hand.mesh(kind, "involute", s, **gear, k=0.0, c=1.0, **state, **motion)["force"]
    measured = (after["deflection"] - before["deflection"]) / (2 * h)
    assert rate == pytest.approx(measured, rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("s", FLANKS)
@pytest.mark.parametrize("kind", KINDS)
def test_rigid_rolling_leaves_no_deflection(kind, s, law):
    """Tooth counts as in eqs 2 and 18: rolling at the starting distance, whatever the carrier's turn."""
    r1, r2, d0 = (0.5, 0.25, 0.8) if kind == "external" else (1.0, 0.25, 0.8)
    for Dg, th1 in ((0.0, 0.3), (17.0, -4.0), (-31.0, 0.0)):
        th2 = Dg - hand.SIGMA[kind] * r1 / r2 * (th1 - Dg)
        O2 = d0 * np.array([np.cos(0.4 + Dg), np.sin(0.4 + Dg)])
        places = {"O1": np.zeros(2), "th1": th1, "O2": O2, "th2": th2}
        out = hand.mesh(kind, law, s, r1, r2, d0, 0.4, Dg + 0.5, 1.0, 0.0, **places, **at_rest())
        assert out["deflection"] == pytest.approx(0.0, abs=1e-13)


@pytest.mark.parametrize("s", FLANKS)
@pytest.mark.parametrize("kind", KINDS)
def test_laws_part_at_second_order(kind, s):
    """Halving the distance from the rigid mesh quarters the gap between the paper's law and the exact one."""
    gear, _, _ = random_mesh(kind, s, 0)
    r1, r2, d0 = gear["r1"], gear["r2"], gear["d0"]

    def gap(size):
        O2 = (d0 + size) * np.array([np.cos(gear["gamma0"]), np.sin(gear["gamma0"])])
        places = {"O1": np.zeros(2), "th1": size, "O2": O2, "th2": size}
        data = {"r1": r1, "r2": r2, "d0": d0, "gamma0": gear["gamma0"], "turn": 0.0, "k": 1.0, "c": 0.0}
        laws = [hand.mesh(kind, law, s, **data, **places, **at_rest())["deflection"] for law in LAWS]
        return laws[0] - laws[1]

    assert gap(1e-4) / gap(5e-5) == pytest.approx(4.0, rel=0.02)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("s", FLANKS)
@pytest.mark.parametrize("kind", KINDS)
def test_mesh_balances_and_its_damper_dissipates(kind, s, law, seed):
    gear, state, motion = random_mesh(kind, s, seed)
    both = hand.mesh(kind, law, s, **gear, k=K, c=C, **state, **motion)
    np.testing.assert_allclose(momentum(state["O1"], state["O2"], both), 0.0, atol=1e-9 * abs(both["force"]))
    damper = hand.mesh(kind, law, s, **gear, k=0.0, c=C, **state, **motion)
    assert power(motion, damper) == pytest.approx(-(damper["force"] ** 2) / C, rel=1e-9)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("s", FLANKS)
@pytest.mark.parametrize("kind", KINDS)
def test_tooth_friction_balances_and_dissipates(kind, s, seed):
    gear, state, motion = random_mesh(kind, s, seed)
    out = friction(kind, s, gear, state, motion)
    size = np.hypot(*out["F2"])
    np.testing.assert_allclose(momentum(state["O1"], state["O2"], out), 0.0, atol=1e-12 * size)
    assert power(motion, out) == pytest.approx(-size * abs(out["v_t"]), rel=1e-9)
    normal = hand.mesh(kind, "involute", s, **gear, k=K, c=0.0, **state, **motion)["F2"]
    assert np.dot(normal, out["F2"]) == pytest.approx(0.0, abs=1e-12 * size * np.hypot(*normal))


@pytest.mark.parametrize("s", FLANKS)
@pytest.mark.parametrize("kind", KINDS)
def test_rigid_rolling_does_not_slide_at_the_pitch_point(kind, s):
    gear, state, _ = random_mesh(kind, s, 1)
    w1 = 7.0
    motion = at_rest() | {"w1": w1, "w2": -hand.SIGMA[kind] * gear["r1"] / gear["r2"] * w1}
    assert friction(kind, s, gear, state, motion)["v_t"] == pytest.approx(0.0, abs=1e-13)


@pytest.mark.parametrize("seed", SEEDS)
def test_pin_balances_and_its_damper_dissipates(seed):
    where = random_pin(seed)
    out = hand.pin(K, C, **where)
    moment = out["TC"] + hand.cross(where["C"], out["FC"]) + hand.cross(where["P"], out["FP"])
    np.testing.assert_allclose(np.hstack([out["FP"] + out["FC"], moment]), 0.0, atol=1e-8)
    damper = hand.pin(0.0, C, **where)
    fed = damper["FP"] @ where["VP"] + damper["FC"] @ where["VC"] + damper["TC"] * where["wC"]
    assert fed == pytest.approx(-(damper["FP"] @ damper["FP"]) / C, rel=1e-9)


@pytest.mark.parametrize("seed", SEEDS)
def test_pin_spring_is_minus_the_energy_gradient(seed):
    where = random_pin(seed)
    h, q = 1e-6, np.hstack([where["P"], where["C"], where["thC"]])

    def energy(q):
        force = hand.pin(K, 0.0, **(where | {"P": q[:2], "C": q[2:4], "thC": q[4]}))["FP"]
        return force @ force / (2 * K)

    slope = [(energy(q - step) - energy(q + step)) / (2 * h) for step in h * np.eye(5)]
    out = hand.pin(K, 0.0, **where)
    size = np.hypot(*out["FP"])
    np.testing.assert_allclose(np.hstack([out["FP"], out["FC"], out["TC"]]), slope, atol=1e-6 * size)


@pytest.mark.parametrize("seed", SEEDS)
def test_remaining_elements_balance_and_dissipate(seed):
    rng = np.random.default_rng(seed)
    w1, w2, th1, th2 = rng.normal(size=4)
    V = rng.normal(size=2)
    TP, TC = hand.pin_friction(0.01, 0.3, 40.0, 0.05, 6.0e5, w1, w2)
    assert TP + TC == 0.0
    assert TP * w2 + TC * w1 < 0.0
    T1, T2 = hand.coupling(K, 0.0, th1, w1, th2, w2)
    assert T1 + T2 == 0.0
    assert T1 * (th1 - th2) < 0.0
    T1, T2 = hand.coupling(0.0, C, th1, w1, th2, w2)
    assert T1 * w1 + T2 * w2 < 0.0
    assert hand.support(0.0, C, th1, w1) * w1 < 0.0
    assert hand.support(K, 0.0, th1, w1) * th1 < 0.0
    assert hand.ground_bearing(0.0, C, V, V) @ V < 0.0
    assert hand.ground_bearing(K, 0.0, V, V) @ V < 0.0


@pytest.mark.parametrize("n", [3, 4, 5])
def test_lin_parker_frequencies_are_the_printed_ones(n):
    found = lin_parker.frequencies(n)
    assert len(found) == 3 * (3 + n)
    np.testing.assert_allclose(found, lin_parker.printed(n), rtol=4e-4, atol=0.05)


@pytest.mark.parametrize("n", [3, 4, 5])
def test_lin_parker_springs_are_those_of_the_hand_forces(n):
    """One column of K per coordinate from the forces' own small displacements, sun mesh of planet 2."""
    psi, alpha, k = 2.0 * np.pi / n, lin_parker.ALPHA, lin_parker.K_MESH
    e, t = np.array([np.cos(psi), np.sin(psi)]), np.array([-np.sin(psi), np.cos(psi)])
    stiffness = lin_parker.matrices(n)[1]
    for body, kind, (r1, r2) in ((3, "ring", (0.8, 0.3)), (6, "sun", (0.4, 0.3))):
        gear = ("internal" if kind == "ring" else "external", "involute", 1.0, r1, r2)
        d0 = (r1 + hand.SIGMA[gear[0]] * r2) / np.cos(alpha)
        for i, (o1, u1) in enumerate([((1e-7, 0.0), 0.0), ((0.0, 1e-7), 0.0), ((0.0, 0.0), 1e-7)]):
            places = {"O1": np.array(o1), "th1": u1 / r1, "O2": d0 * e, "th2": 0.0}
            out = hand.mesh(*gear, d0, psi, 0.0, k[kind], 0.0, **places, **at_rest())
            column = -np.array([out["F2"] @ e, out["F2"] @ t, out["T2"] / r2]) / 1e-7
            np.testing.assert_allclose(column, stiffness[12:15, body + i], rtol=1e-5, atol=1e-5 * k[kind])


@pytest.mark.parametrize("n", [2, 3, 5])
def test_kahraman_roots_are_those_of_the_torsional_matrices(n):
    """Springs on u_s + u_p - u_c (sun) and -u_p - u_c (fixed ring), u_c = r_c theta_c cos alpha."""
    k1, k2, m_p, m_c, m_s = 4.0e8, 3.0e8, 0.6, 6.0, 0.4
    stiffness = np.zeros((n + 2, n + 2))
    for i in range(n):
        for k, row in ((k1, {0: -1.0, 2 + i: -1.0}), (k2, {0: -1.0, 1: 1.0, 2 + i: 1.0})):
            spring = np.zeros(n + 2)
            spring[list(row)] = list(row.values())
            stiffness += k * np.outer(spring, spring)
    scale = 1.0 / np.sqrt([m_c, m_s, *n * [m_p]])
    squares = np.linalg.eigvalsh(scale[:, None] * stiffness * scale)
    found = lin_parker.kahraman(n, k1, k2, m_p, m_c, m_s)
    np.testing.assert_allclose(found**2, squares, rtol=1e-9, atol=1e-6 * k1)
