"""Hard cases of friction: coming to rest, standing, slipping, starting and turning back."""

from collections.abc import Iterable
from dataclasses import replace
from math import pi

import numpy as np

from ...model.function import Kernel
from ...model.members import train_of
from ...simulation.energy_balance import energy_residual
from ...simulation.trajectory import Trajectory
from .case import Bench, Finding, HardCase, Open
from .pair import read, read_power_lost
from .planets import RubbingPlanets

SCENE = "hard-friction"
RTOL = 1e-8
BEGUN = 1000 * 2 * pi / 60
"""Speed of a planet [rad/s] from which a train coasts to rest."""
SHIFTED = 3e-5
"""What closed forms are off by: bearings give way by some 30 um, which turns the lines of action a little."""
ROUNDING = 1e-7
"""Acceleration [m/s^2, rad/s^2] that rounding makes of no force at all."""
TURN = {
    "loads.sun": '{ member = "gear.sun", speed_over_time = [["0.01 s", "0 rpm"], ["0.06 s", "600 rpm"], '
    '["0.11 s", "-600 rpm"]] }',
    "loads.ring": '{ member = "gear.ring", torque_over_time = [["0 s", "900 N*m"], ["0.03 s", "900 N*m"], '
    '["0.08 s", "-900 N*m"]] }',
}
"""Loads that start the sun from rest and turn it back, and take the torque through zero while it turns."""
RUBS = '{ coefficient = 0.08, speed = "1 cm/s" }'


def _everything(opened: Open, law: str) -> Bench:
    """Return the scene with teeth that rub by one law, jumps of stiffness, backlash, and the loads of ``TURN``."""
    keys = {"friction": RUBS, "double_factor": "1.4"}
    meshes = {f"stages.gear.{mesh}.{key}": keys[key] for mesh in ("sun_planet", "ring_planet") for key in keys}
    effects = {"mesh_friction": law, "contact": "backlash", "mesh_stiffness": "two-level"}
    return opened(SCENE, {**meshes, **TURN, **{f"effects.{name}": value for name, value in effects.items()}})


def _changed(bench: Bench, **values: float) -> Bench:
    """Return the bench with other values, ``__`` in their names standing for a dot."""
    known = {key.replace("__", "."): value for key, value in values.items()}
    return replace(bench, values={**bench.values, **known})


def _from(opened: Open, speed: float) -> Bench:
    """Return the scene with a planet's speed at the start [rad/s], counted as the sun's torque turns it."""
    return opened(SCENE, {"loads.sun.initial_speed": f"{speed!r} rad/s"})


def _turned(bench: Bench, path: Trajectory) -> float:
    """Return by how much planet 1 has turned [rad]."""
    names = [state.name for state in bench.library.manifest.states]
    moved = path.x[-1] - path.x[0]
    rigid = bench.values["gear.planet.speed_ratio"] * moved[names.index("reference.angle")]
    return float(-rigid - moved[names.index("gear.planet.1.u")])


def _never_negative(bench: Bench, path: Trajectory, text: str) -> Finding:
    """Find whether any sample dissipates less than nothing, over the largest."""
    lost = read_power_lost(bench, path)
    return Finding(f"power made by friction, {text}, over the largest lost", float(-lost.min() / lost.max()), 0.0)


def check_stop(opened: Open, method: str, long: bool) -> Iterable[Finding]:
    """Let a balanced train coast to rest on its bearings, and let the regularising speed v_0 fall.

    With a friction T_c tanh w / v_0 it turns pi^2 / 6 (v_0 / w)^2 further than Coulomb's w^2 / 2 a.
    """
    scene = _from(opened, BEGUN)
    for slow in (10.0, 3.0, 1.0) if long else (10.0, 1.0):
        bench = _changed(scene, gear__pin__friction_speed=slow)
        train, text = RubbingPlanets.of(bench.values), f"at v_0 = {slow:g} rad/s"
        brake = -train.gain(1.0)
        path = bench.run(method, t_end=2 * BEGUN / brake, rate=20000.0, rtol=RTOL)
        turned, coulomb = _turned(bench, path), BEGUN**2 / 2 / brake
        yield Finding(f"stopping angle {text}", abs(turned / train.stopping_angle(BEGUN) - 1), 1e-5)
        more = (turned / coulomb - 1) / (slow / BEGUN) ** 2
        yield Finding(f"what it turns beyond Coulomb's law {text}", abs(more / (pi**2 / 6) - 1), 0.05)
        yield _never_negative(bench, path, text)


def check_standstill(opened: Open, method: str, long: bool) -> Iterable[Finding]:
    """Load a resting train with nine tenths of what its bearings hold, and with eleven."""
    scene = _from(opened, 0.0)
    balance = scene.values["loads.sun.torque"]
    margin = RubbingPlanets.of(scene.values).limit() - balance
    for slow in (0.1, 0.01):
        bench = _changed(scene, loads__sun__torque=balance + 0.9 * margin, gear__pin__friction_speed=slow)
        path = bench.run(method, t_end=0.02, rate=20000.0, rtol=RTOL)
        creep, wanted = -read(bench, path, "speed")["gear.planet.1"][-1], RubbingPlanets.of(bench.values).creep
        yield Finding(f"creep below the limit, v_0 = {slow:g} rad/s", abs(creep / wanted - 1), SHIFTED)
        yield _never_negative(bench, path, f"v_0 = {slow:g} rad/s")
    bench = _changed(scene, loads__sun__torque=balance + 1.1 * margin)
    path = bench.run(method, t_end=0.04, rate=20000.0, rtol=RTOL)
    speed, half = -read(bench, path, "speed")["gear.planet.1"], len(path.time) // 2
    gain = (speed[-1] - speed[half]) / (path.time[-1] - path.time[half])
    # What drives is the small difference between torque and friction: eleven times more of the error.
    yield Finding(
        "acceleration above the limit", abs(gain / RubbingPlanets.of(bench.values).gain(1.0) - 1), 11 * SHIFTED
    )
    yield _never_negative(bench, path, "above the limit")


def check_turn(opened: Open, method: str, long: bool) -> Iterable[Finding]:
    """Start a stage with all frictions from rest, take its torque through zero and turn it back."""
    for law in ("pitch-point", "sliding"):
        bench = _everything(opened, law)
        path = bench.run(method, t_end=0.12, rate=50000.0 if long else 20000.0, rtol=RTOL)
        yield _never_negative(bench, path, law)
        residual = energy_residual(bench.point, path)
        yield Finding(f"energy balance, {law}, over all work", abs(residual), 1e-6)
        expected = np.nan if path.expected_events is None else path.expected_events
        yield Finding(f"jumps of stiffness lost or doubled, {law}", abs(path.counts.events - expected), 0)
        forces, train = read(bench, path, "mesh_force"), train_of(bench.library.manifest)
        back = max(float(force.max()) for mesh, force in forces.items() if train.front(mesh) != mesh)
        yield Finding(f"other flanks that never touch, {law}", float(back <= 0), 0)
        yield Finding(f"largest pull, {law}, over the largest push", -path.extremes.lowest.min() / back, 1e-9)


def check_nothing(opened: Open, method: str, long: bool) -> Iterable[Finding]:
    """Evaluate a stage with all frictions where nothing is loaded and nothing moves."""
    for law in ("pitch-point", "sliding"):
        bench = _everything(opened, law)
        bench = replace(bench, tables=dict.fromkeys(bench.tables, ((0.0, 0.0), (1.0, 0.0))))
        at, functions = bench.at, bench.library.functions
        right = Kernel(functions["rhs"])(at.x, at.s, bench.p)[0]
        slope = Kernel(functions["jac_rhs"])(at.x, at.s, bench.p, 0.0)[0]
        lost = int((~np.isfinite(right)).sum() + (~np.isfinite(slope)).sum())
        yield Finding(f"values of right-hand side and Jacobian that are not finite, {law}", lost, 0)
        yield Finding(f"largest acceleration, {law}", float(np.abs(right).max()), ROUNDING)


CASES: tuple[HardCase, ...] = (
    HardCase(
        "friction-stop",
        "planet bearings that bring a train to rest",
        "stopping angle by a quadrature of the regularised law, and Coulomb's as its speed falls; no power made",
        check_stop,
    ),
    HardCase(
        "friction-standstill",
        "planet bearings that hold a torque, and slip",
        "creep v_0 artanh T / T_c below Coulomb's limit, the rigid train's acceleration above it",
        check_standstill,
    ),
    HardCase(
        "friction-turn",
        "start from rest, torque through zero and turning back with every friction on",
        "power lost is never negative; the energy balance closes; jumps of stiffness are those of kinematics",
        check_turn,
    ),
    HardCase(
        "friction-nothing",
        "friction without force and without speed",
        "right-hand side and Jacobian are finite, and nothing moves",
        check_nothing,
        integrates=False,
    ),
)
