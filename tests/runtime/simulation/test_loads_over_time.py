"""Loads over time and the slip law, against closed forms: integrals of tables, oscillators, Kloss's formula."""

from itertools import pairwise

import numpy as np
import pytest
from ltcgear.generated.contract import Signal
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.model.equilibrium import find_equilibrium
from ltcgear.runtime.model.function import Kernel
from ltcgear.runtime.model.load_tables import Signals
from ltcgear.runtime.model.rows import over_time
from ltcgear.runtime.results.dataset import make_dataset
from ltcgear.runtime.simulation.energy_balance import energy_residual
from ltcgear.runtime.simulation.integrate import integrate
from ltcgear.runtime.simulation.methods.registry import METHODS
from ltcgear.runtime.simulation.output_reader import sampled
from ltcgear.runtime.simulation.run_settings import RunSettings
from ltcgear.runtime.simulation.simulate import simulate
from ltcgear.symbolic.emit.pipeline import content_key

from ..model.test_contact_levels import border_count, nominal_phase, share_of
from ..models import case, change, make_case, raw_scene

RPM = 2 * np.pi / 60
I1, I2, K = 2.0, 3.0, 5e4


def shaft(*loads, **coupling):
    """Two rotors on a shaft, undamped unless told."""
    return {
        "title": "two rotors",
        "rotors": {"one": {"inertia": f"{I1} kg*m^2"}, "two": {"inertia": f"{I2} kg*m^2"}},
        "couplings": {"shaft": {"between": ["one", "two"], "stiffness": f"{K} N*m/rad", **coupling}},
        "loads": {f"load_{i}": load for i, load in enumerate(loads)},
    }


def table(unit, *rows):
    return [[f"{time!r} s", f"{value!r} {unit}"] for time, value in rows]


def torque(member, *rows, **keys):
    return {"member": member, "torque_over_time": table("N*m", *rows), **keys}


def speed(member, *rows):
    return {"member": member, "speed_over_time": table("rad/s", *rows)}


def shown(c, path):
    """Quantity -> item -> values over time."""
    y = over_time(c.library, "outputs", path.x, path.s, c.p)
    found = {}
    for i, report in enumerate(c.library.manifest.reports):
        found.setdefault(report.quantity, {})[report.item] = y[:, i]
    return found


def integral(rows, times):
    """The integral of a table from 0 to each time, exactly: trapezoids to every knot."""
    t, v = np.array(rows, dtype=float).T

    def to(end):
        knots = np.unique([0.0, end, *t[(t > 0) & (t < end)]])
        return np.trapezoid(np.interp(knots, t, v), knots)

    return np.array([to(time) for time in times])


# --- torque over time


STORM = [(-0.1, 0.0), (0.02, 0.0), (0.025, 900.0), (0.04, -300.0), (0.0401, 500.0), (0.09, 0.0)]


@pytest.mark.parametrize("method", METHODS)
def test_angular_momentum_is_the_integral_of_the_torque(method):
    c = make_case(shaft(torque("one", *STORM, initial_speed="0 rpm")))
    path = c.run(method=method, rtol=1e-8, t_end=0.12)
    speeds = shown(c, path)["speed"]
    momentum, wanted = I1 * speeds["one"] + I2 * speeds["two"], integral(STORM, path.time)
    assert path.status == "done"
    assert np.abs(momentum - wanted).max() < 1e-7 * np.abs(wanted).max()
    assert np.abs(shown(c, path)["load_torque"]["load_0"] - np.interp(path.time, *np.array(STORM).T)).max() < 1e-9
    assert abs(energy_residual(c.point, path)) < 1e-6


@pytest.mark.parametrize(("method", "rtol"), [("erk", 1e-8), ("cvodes", 1e-9)])
def test_a_ramp_with_kinks_is_met_exactly(method, rtol):
    start, end, top = 0.0123, 0.0377, 800.0
    rate = top / (end - start)
    c = make_case(shaft(torque("one", (start, 0.0), (end, top), initial_speed="0 rpm")))
    path = c.run(method=method, rtol=rtol, t_end=0.1, rate=9973.0)
    w = np.sqrt(K * (1 / I1 + 1 / I2))

    def ramp(t):  # u'' + w^2 u = t for t > 0, from rest
        return np.where(t > 0, t - np.sin(w * np.maximum(t, 0)) / w, 0.0) / w**2

    twist = rate / I1 * (ramp(path.time - start) - ramp(path.time - end))
    given = shown(c, path)["coupling_torque"]["shaft"]
    assert np.abs(given - K * twist).max() < 1e-7 * np.abs(K * twist).max()


# --- speed over time


@pytest.mark.parametrize("method", ["erk", "cvodes"])
def test_the_drive_of_a_speed_ramp_swings_about_inertia_times_acceleration(method):
    gain = 40.0
    c = make_case(shaft(speed("one", (0.0, 0.0), (10.0, 10 * gain))))
    path = c.run(method=method, rtol=1e-8, t_end=0.2)
    w = np.sqrt(K / I2)
    wanted = I1 * gain + I2 * gain * (1 - np.cos(w * path.time))  # u'' + w^2 u = -gain for the second rotor
    given, speeds = shown(c, path)["drive_torque"]["one"], shown(c, path)["speed"]
    # At the first sample the acceleration has just begun.
    assert np.abs(given - wanted).max() < 1e-6 * np.abs(wanted).max()
    assert np.abs(speeds["one"] - gain * path.time).max() < 1e-9 * gain
    assert np.abs(path.x[:, c.state("reference.angle")] - gain * path.time**2 / 2).max() < 1e-12
    assert abs(energy_residual(c.point, path)) < 1e-6


RUN_UP = [(0.0, 0.0), (0.2, 15 * RPM), (0.25, 15 * RPM), (0.35, 6 * RPM), (0.4, 0.0)]
THERE_AND_BACK = [
    (0.0, 5 * RPM),
    (0.1, 15 * RPM),
    (0.3, -15 * RPM),
    (0.35, -15 * RPM),
    (0.37, 0.0),
    (0.38, 0.0),
    (0.4, 9 * RPM),
]
FROM_STANDSTILL_TWICE = [(0.05, 0.0), (0.15, 12 * RPM), (0.2, 0.0), (0.25, 0.0), (0.35, 12 * RPM)]


def turning_points(rows, end):
    """Times between which a table does not change its sign."""
    t, v = np.array(rows, dtype=float).T
    zeros = [a - x * (b - a) / (y - x) for a, b, x, y in zip(t, t[1:], v, v[1:], strict=False) if x * y < 0]
    return np.unique([0.0, *(z for z in [*zeros, *t[v == 0]] if 0 < z < end), end])


def kinematic_count(c, rows, end):
    """Borders passed by all switched meshes, from the exact integral of the speed."""
    angles = integral(rows, turning_points(rows, end))
    total = 0
    for mesh in c.library.manifest.levels:
        tau, share = [nominal_phase(c, mesh, angle, 1.0) for angle in angles], share_of(c, mesh)
        total += sum(border_count(one, two, share) for one, two in pairwise(tau))
    return total


def driven_rig(rows, *settings):
    written = ", ".join(f'["{t!r} s", "{v!r} rad/s"]' for t, v in rows)
    return case("rig-2mw", "-loads.motor.speed", f"loads.motor.speed_over_time = [{written}]", *settings)


@pytest.mark.parametrize("method", ["erk", "cvodes"])
@pytest.mark.parametrize("rows", [RUN_UP, THERE_AND_BACK, FROM_STANDSTILL_TWICE], ids=["up", "back", "twice"])
def test_no_switching_of_a_start_a_stop_or_a_reversal_is_lost(rows, method):
    c = driven_rig(rows)
    path = c.run(method=method, rtol=1e-5, t_end=0.4)
    wanted = kinematic_count(c, rows, 0.4)
    assert path.status == "done"
    assert wanted > 300
    assert path.counts.events == path.expected_events == wanted
    angle = path.x[:, c.state("reference.angle")]
    assert np.abs(angle - integral(rows, path.time)).max() < 1e-11
    for i, mesh in enumerate(c.library.manifest.levels):
        tau, share = nominal_phase(c, mesh, angle, 1.0), share_of(c, mesh)
        part = np.mod(tau, 1.0)
        clear = np.min([np.abs(part - b) for b in (0.0, share, 1.0)], axis=0) > 1e-7
        assert (path.levels[clear, i] == (part[clear] >= share)).all()
    assert abs(energy_residual(c.point, path)) < 1e-5


def test_a_start_from_standstill_without_load_begins_at_rest():
    c = driven_rig([(0.1, 0.0), (0.2, 15 * RPM)], 'loads.generator.torque = "0 N*m"')
    path = c.run(method="erk", rtol=1e-6, t_end=0.15)
    still = path.time <= 0.1
    assert np.abs(c.mesh_forces(path)[still]).max() < 1e-2  # the tolerance, of 1e-6 J a freedom
    assert np.abs(c.mesh_forces(path)[~still]).max() > 1e3
    assert path.status == "done"


def test_two_speeds_in_one_ratio_hold_a_differential():
    """Willis: z_s w_s + z_r w_r = (z_s + z_r) w_c at every instant."""
    rows = [(0.0, 0.0), (0.05, 30.0), (0.1, -10.0)]
    half = ", ".join(f'["{t!r} s", "{-v / 2!r} rad/s"]' for t, v in rows)
    full = ", ".join(f'["{t!r} s", "{v!r} rad/s"]' for t, v in rows)
    settings = (
        'stages.hsp.ring.support = "bearing"',
        'stages.hsp.ring.bearing = { stiffness = "1e9 N/m", damping_ratio = 0.05 }',
        'stages.hsp.ring.mass = "500 kg"',
        'stages.hsp.ring.inertia = "100 kg*m^2"',
    )
    raw = raw_scene("hsp", *settings)
    raw["loads"] = {}
    for key, member, written in (("sun", "hsp.sun", full), ("ring", "hsp.ring", half)):
        change(raw, f'loads.{key}.member = "{member}"')
        change(raw, f"loads.{key}.speed_over_time = [{written}]")
    c = make_case(raw)
    path = c.run(method="erk", rtol=1e-7, t_end=0.1)
    speeds, stage = shown(c, path)["speed"], c.scene.stages["hsp"]
    zs, zr = stage.sun.teeth, stage.ring.teeth
    wanted = np.interp(path.time, *np.array(rows).T) * (zs - zr / 2) / (zs + zr)
    assert path.status == "done"
    assert speeds["hsp.ring"] == pytest.approx(-speeds["hsp.sun"] / 2, abs=1e-12)
    assert np.abs(speeds["hsp.carrier"] - wanted).max() < 0.03 * np.abs(wanted).max()  # it swings


# --- reversal of torque


BACK_AND_FORTH = [(0.0, -1.06e4), (0.05, -1.06e4), (0.06, 1.06e4), (0.12, 1.06e4), (0.13, -1.06e4)]


def test_a_torque_that_turns_over_changes_flanks_and_makes_no_energy():
    written = ", ".join(f'["{t!r} s", "{v!r} N*m"]' for t, v in BACK_AND_FORTH)
    settings = (
        'effects.contact = "backlash"',
        'stages.psh.mesh.backlash = "0.1 mm"',
        "-loads.output.torque",
        f"loads.output.torque_over_time = [{written}]",
    )
    c = case("psh", *settings)
    path = c.run(method="erk", rtol=1e-8, t_end=0.2)
    contact = shown(c, path)["mesh_contact"]
    front, back = contact["psh.mesh"], contact["psh.mesh.back"]
    before, amid, after = ((path.time > a) & (path.time < b) for a, b in ((0.0, 0.05), (0.1, 0.12), (0.18, 0.2)))
    assert path.status == "done"
    assert front[before].all()
    assert not back[before].any()
    assert back[amid].mean() > 0.9
    assert front[amid].mean() < 0.1
    assert front[after].mean() > 0.9
    assert ((front + back) == 0).any()  # the gap is crossed
    assert (front * back == 0).all()
    assert abs(energy_residual(c.point, path)) < 1e-5
    assert path.counts.events == path.expected_events > 100


@pytest.mark.parametrize("method", ["erk", "cvodes"])
def test_a_train_that_torque_stops_and_turns_back_loses_no_switching(method):
    settings = (
        "-loads.input.speed",
        'loads.input.torque = "0 N*m"',
        'loads.input.initial_speed = "-60 rpm"',
        "-loads.output.torque",
        'loads.output.torque_over_time = [["0 s", "-3 kN*m"], ["0.1 s", "-9 kN*m"]]',
    )
    c = case("psh", *settings)
    path = c.run(method=method, rtol=1e-7, t_end=0.2, rate=65536.0)
    angle = path.x[:, c.state("reference.angle")]
    turn = int(angle.argmin())
    assert 0 < turn < len(angle) - 1
    (mesh,) = c.library.manifest.levels
    tau, share = nominal_phase(c, mesh, angle / (-118 / 22 * (1 + 118 / 17)), 1.0), share_of(c, mesh)
    wanted = border_count(tau[0], tau[turn], share) + border_count(tau[turn], tau[-1], share)
    assert path.status == "done"
    assert path.counts.events == wanted > 20


# --- slip law


def machine(w_s, **keys):
    return {
        "member": "two",
        "slip": {"synchronous_speed": f"{w_s} rad/s", "breakdown_torque": "500 N*m", "breakdown_slip": 0.1},
        **keys,
    }


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("load", [320.0, -450.0, 0.0])
def test_the_steady_speed_under_a_torque_is_that_of_kloss(load, way):
    """T_b, w_b, torque T: z + 1/z = 2 T_b / T on the stable branch, z = T_b/T - sqrt((T_b/T)^2 - 1)."""
    w_s, T_b, w_b = 100.0 * way, 500.0, 10.0
    c = make_case(shaft({"member": "one", "torque": f"{load} N*m"}, machine(w_s, initial_speed=f"{w_s} rad/s"),
                        damping_ratio=0.1))  # fmt: skip
    path = c.run(method="erk", rtol=1e-8, t_end=3.0, rate=100.0)
    z = T_b / load - np.sign(load) * np.sqrt((T_b / load) ** 2 - 1) if load else 0.0
    assert shown(c, path)["speed"]["two"][-1] == pytest.approx(w_s + w_b * z, rel=1e-6)
    assert shown(c, path)["load_torque"]["load_1"][-1] == pytest.approx(-load, abs=1e-4)
    assert abs(energy_residual(c.point, path)) < 1e-6


@pytest.mark.parametrize("way", [1, -1])
def test_the_slip_law_has_its_breakdown_torque_and_slope(way):
    w_s, T_b, w_b = 100.0 * way, 500.0, 10.0
    c = make_case(shaft({"member": "one", "torque": "0 N*m", "initial_speed": f"{w_s} rad/s"}, machine(w_s)))
    outputs = Kernel(c.library.functions["outputs"])
    column = [(r.quantity, r.item) for r in c.library.manifest.reports].index(("load_torque", "load_1"))

    def at(speed):
        x = c.at.x.copy()
        x[c.state("reference.speed")] = speed
        return float(outputs(x, c.at.s, c.p)[0][column])

    speeds = w_s + np.linspace(-60, 60, 24001)
    curve = np.array([at(w) for w in speeds])
    assert np.abs(curve).max() == pytest.approx(T_b, rel=1e-12)
    assert speeds[curve.argmax()] == pytest.approx(w_s - w_b)  # drives below, by sense of rotation
    assert speeds[curve.argmin()] == pytest.approx(w_s + w_b)
    assert at(w_s) == 0.0
    assert (at(w_s + 1e-4) - at(w_s - 1e-4)) / 2e-4 == pytest.approx(-2 * T_b / w_b, rel=1e-8)
    assert at(w_s + way * 3.0) * way < 0  # faster than synchronous it brakes, whichever way it turns


def test_a_small_disturbance_dies_at_the_slope_of_the_slip_law():
    """Both rotors as one: I w' = -(2 T_b / w_b)(w - w_s)."""
    c = make_case(shaft({"member": "one", "torque": "0.05 N*m"}, machine(100.0, initial_speed="100 rad/s"),
                        damping_ratio=0.2))  # fmt: skip
    path = c.run(method="erk", rtol=1e-9, t_end=0.1, rate=1000.0)
    speeds = shown(c, path)["speed"]
    mean = (I1 * speeds["one"] + I2 * speeds["two"]) / (I1 + I2) - 100.0
    final = 0.05 / (2 * 500.0 / 10.0)
    rate = 2 * 500.0 / 10.0 / (I1 + I2)
    late = path.time > 0.02
    assert np.abs(mean - final * (1 - np.exp(-rate * path.time)))[late].max() < 0.01 * final


# --- tables on their way


def test_tables_are_numbers_and_no_structure():
    from ltcgear.symbolic.assembly import build_model
    from ltcgear.symbolic.scene.load import make_scene

    one, two, constant = (
        build_model(make_scene(shaft(load)))
        for load in (
            torque("one", (0.0, 1.0), (1.0, 2.0), initial_speed="0 rpm"),
            torque("one", (0.0, 5.0), (0.1, 7.0), (0.2, 7.5), initial_speed="3 rpm"),
            {"member": "one", "torque": "1 N*m", "initial_speed": "0 rpm"},
        )
    )
    assert content_key(one) == content_key(two) != content_key(constant)
    assert one.tables != two.tables
    assert not constant.signals
    assert not constant.tables


def test_a_run_without_its_tables_is_refused():
    c = make_case(shaft(torque("one", (0.0, 1.0), (1.0, 2.0), initial_speed="0 rpm")))
    for call in (
        lambda: find_equilibrium(c.library, c.p),
        lambda: integrate(c.point, RunSettings(0.1, 100.0, "erk", 1e-6)),
        lambda: simulate(c.library, c.model.values(), t_end=0.1, rate=100.0),
    ):
        with pytest.raises(LtcgearError, match=r"loads\.load_0\.torque_over_time is missing; .*model\.tables"):
            call()


def test_a_result_shows_loads_over_time():
    rows = ((0.0, 1.0), (0.01, 200.0), (0.03, -50.0))
    c = make_case(shaft(torque("one", *rows, initial_speed="0 rpm"), damping_ratio=0.05))
    options = {"t_end": 0.05, "rate": 2000.0, "tables": c.model.tables}
    result = simulate(c.library, c.model.values(), raw=True, **options)
    given = result.dataset["load_torque"].sel(load="load_0")
    assert given.values == pytest.approx(np.interp(result.dataset.time.values, *np.array(rows).T), abs=1e-9)
    assert given.attrs["units"] == "N*m"
    path = c.run(method="erk", rtol=1e-6, t_end=0.05, rate=2000.0)
    assert make_dataset(c.library, c.p, sampled(c.library, path, c.p))["load_torque"].shape == (101, 1)


def test_the_equilibrium_is_that_just_before_the_start():
    gain = 100.0
    steady = make_case(shaft(speed("one", (-1.0, -gain), (1.0, gain))))
    rising = make_case(shaft(speed("one", (0.0, 0.0), (1.0, gain))))
    twist = steady.state("two.u")
    assert steady.at.x[twist] == pytest.approx(-gain * I2 / K, rel=1e-12)  # the shaft accelerates the second rotor
    assert rising.at.x[twist] == 0.0
    path = steady.run(method="erk", rtol=1e-8, t_end=0.1)
    assert np.ptp(path.x[:, twist]) < 1e-6 * abs(steady.at.x[twist])


# --- signals alone


def test_signals_are_linear_between_rows_and_constant_beyond():
    kinds = [Signal("a", "N*m", "t", False, "a"), Signal("b", "N*m/s", "t", True, "b")]
    signals = Signals(kinds, {"t": [(1.0, -2.0), (3.0, 2.0), (4.0, 8.0)]})
    assert signals.knots.tolist() == [1.0, 2.0, 3.0, 4.0]  # the zero is one
    assert signals.over(np.array([0.0, 1.0, 1.5, 2.0, 3.0, 3.5, 4.0, 9.0])).tolist() == [
        [-2.0, 0.0], [-2.0, 2.0], [-1.0, 2.0], [0.0, 2.0], [2.0, 6.0], [5.0, 6.0], [8.0, 0.0], [8.0, 0.0]
    ]  # fmt: skip
    assert signals.before(3.0).tolist() == [2.0, 2.0]
    assert signals.at(3.0).tolist() == [2.0, 6.0]
    assert signals.rate(3.0).tolist() == [6.0, 0.0]
    assert [signals.next_knot(t) for t in (0.0, 1.0, 3.9, 4.0)] == [1.0, 2.0, 4.0, float("inf")]
    nothing = Signals([], {})
    assert nothing.at(0.0).shape == (0,)
    assert nothing.over(np.zeros(3)).shape == (3, 0)
    assert nothing.next_knot(0.0) == float("inf")


# --- the shipped scene


def test_the_start_up_scene_ends_where_its_loads_balance():
    c = case("start-up")
    path = c.run(method="erk", rtol=1e-6, t_end=1.8)
    found = shown(c, path)
    steps, w_s, w_b = 60 / 21, -1500 * RPM, 0.18 * 1500 * RPM
    z = (-530 * RPM * steps - w_s) / w_b
    held = -2 * 290.0 * z / (1 + z**2)
    for (start, stop), extra in (((1.35, 1.4), 0.0), ((1.7, 1.8), 60.0)):
        late = (path.time > start) & (path.time < stop)
        assert found["load_torque"]["generator"][late].mean() == pytest.approx(held, rel=2e-3)
        assert found["drive_torque"]["motor"][late].mean() == pytest.approx(steps * (held + extra), rel=5e-3)
        assert found["mesh_contact"]["pair.mesh"][late].all()
    pulled = (path.time > 0.2) & (path.time < 1.0)  # below synchronism the generator drives
    assert found["load_torque"]["generator"][pulled].max() < 0
    assert found["mesh_contact"]["pair.mesh.back"][pulled].mean() > 0.9
    rows = [(0.1, 0.0), (1.1, 530 * RPM)]
    tau, share = (
        60 / (2 * np.pi) * integral(rows, [1.8])[0],
        c.p[[n for n, _ in c.library.manifest.parameters].index("pair.mesh.single_share")],
    )
    assert path.counts.events == path.expected_events == border_count(0.0, tau, share)
    assert path.status == "done"
    assert abs(energy_residual(c.point, path)) < 1e-6


@pytest.mark.parametrize("load", [-1.06e4, -1.0])
def test_an_equilibrium_is_found_on_the_flank_behind_the_gap(load):
    settings = (
        'effects.contact = "backlash"',
        'stages.psh.mesh.backlash = "0.3 mm"',
        f'loads.output.torque = "{load} N*m"',
    )
    front, back = (case("psh", *settings, *more) for more in ((), ('stages.psh.mesh.flank = "printed"',)))
    one, two = ({**c.quantity("mesh_force", c.at.x, c.at.s)} for c in (front, back))
    assert front.model.values()["psh.mesh.flank"] == -1.0  # so the printed flank is the one behind the gap
    assert two["psh.mesh.back"][0] == pytest.approx(one["psh.mesh"][0], rel=2e-3)
    assert two["psh.mesh"][0] == one["psh.mesh.back"][0] == 0.0


def test_the_power_of_a_machine_is_given_by_loads_and_none_is_lost():
    c = make_case(shaft({"member": "one", "torque": "100 N*m"}, machine(-100.0, initial_speed="-90 rad/s")))
    path = c.run(method="erk", rtol=1e-7, t_end=0.05)
    balance = over_time(c.library, "energy", path.x, path.s, c.p)
    found = shown(c, path)
    power = 100.0 * found["speed"]["one"] + found["load_torque"]["load_1"] * found["speed"]["two"]
    assert np.abs(balance[:, 4]).max() == 0.0
    assert balance[:, 3] == pytest.approx(power, rel=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_many_reversals_at_odd_times_are_all_counted(seed):
    rng = np.random.default_rng(seed)
    times = np.sort(rng.uniform(0.0, 0.3, 40))
    rows = [(float(t), float(v)) for t, v in zip(times, rng.uniform(-60, 60, 40), strict=True)]
    written = ", ".join(f'["{t!r} s", "{v!r} rad/s"]' for t, v in rows)
    c = case("psh", "-loads.input.speed", f"loads.input.speed_over_time = [{written}]")
    path = c.run(method="erk", rtol=1e-4, t_end=0.3)
    angles = integral(rows, turning_points(rows, 0.3))
    share = share_of(c, "psh.mesh")
    sense = np.sign(rows[0][1])  # phases count up in the sense of the start
    wanted = sum(
        border_count(sense * 59 / (2 * np.pi) * a, sense * 59 / (2 * np.pi) * b, share) for a, b in pairwise(angles)
    )
    assert len(angles) > 10
    assert path.status == "done"
    assert path.counts.events == path.expected_events == wanted > 50


@pytest.mark.parametrize("pitches", range(3, 15))
def test_turning_back_on_a_border_is_no_lost_switching(pitches):
    """The border is touched, or passed there and back, as rounding has it; both are right."""
    up = 2 * (2 * np.pi / 59) * pitches / 0.05  # up to this speed and down to zero turns by whole pitches
    rows = [(0.0, 0.0), (0.037, up), (0.05, 0.0), (0.063, -up)]
    written = ", ".join(f'["{t!r} s", "{float(v)!r} rad/s"]' for t, v in rows)
    c = case("psh", "-loads.input.speed", f"loads.input.speed_over_time = [{written}]")
    path = c.run(method="erk", rtol=1e-4, t_end=0.0625)
    angles, share = integral(rows, [0.0, 0.05, 0.0625]), share_of(c, "psh.mesh")
    back = border_count(pitches - 0.01, 59 / (2 * np.pi) * angles[2], share)
    assert angles[1] == pytest.approx(2 * np.pi / 59 * pitches)
    assert path.status == "done"
    assert path.counts.events == path.expected_events
    assert path.counts.events in (2 * pitches - 1 + back, 2 * pitches + 1 + back)
