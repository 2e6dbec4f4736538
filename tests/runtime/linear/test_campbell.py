"""Eigenfrequencies over speed: gyroscopic splitting, tracking, orders, crossings, and how hard they excite."""

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.cli.number_ranges import read_range
from ltcgear.runtime.linear.campbell import sweep_load, sweep_speed
from ltcgear.runtime.linear.crossings import find_crossings
from ltcgear.runtime.linear.excitation import find_harmonics
from ltcgear.runtime.linear.inputs import find_paths
from ltcgear.runtime.linear.modes import find_modes
from ltcgear.runtime.linear.orders import list_orders, list_sides, phases_of
from ltcgear.runtime.linear.response import propagate, respond
from ltcgear.runtime.linear.system import linearise

from ..models import case, make_case

TWO_PI = 2 * np.pi
TEETH = {"sun": 24, "ring": 72, "planet": 24}


def stage(held="ring", driven="sun", braked="carrier", teeth=TEETH, rpm=1000, mean=True, **changes):
    """A planetary stage of three planets: one member fixed, one at a speed, one loaded."""
    supports = {name: {"support": "fixed" if name == held else "bearing"} for name in ("sun", "ring", "carrier")}
    bearing = {"bearing": {"stiffness": "2e8 N/m", "damping_ratio": 0.02}, "mass": "6 kg", "inertia": "0.03 kg*m^2"}
    members = {name: given | (bearing if given["support"] == "bearing" else {}) for name, given in supports.items()}
    for name in ("sun", "ring"):
        members[name] |= {"teeth": teeth[name]}
    return {
        "title": "stage",
        "effects": {"mesh_stiffness": "mean"} if mean else {},
        "stages": {
            "gear": {
                "kind": "planetary", "planets": 3, "module": "3 mm", "pressure_angle": "20 deg", **members,
                "planet": {"teeth": teeth["planet"], "mass": "1.5 kg", "inertia": "0.001 kg*m^2"},
                "sun_planet": {"stiffness": "3e8 N/m", "damping_ratio": 0.02},
                "ring_planet": {"stiffness": "4e8 N/m", "damping_ratio": 0.02},
                "pin": {"stiffness": "2e8 N/m", "damping_ratio": 0.02}, **changes,
            }
        },
        "loads": {
            "drive": {"member": f"gear.{driven}", "speed": f"{rpm} rpm"},
            "brake": {"member": f"gear.{braked}", "torque": "300 N*m"},
        },
    }  # fmt: skip


def campbell_of(raw, *values):
    c = make_case(raw)
    return c, sweep_speed(c.library, c.p, np.array(values) if values else None)


# --- a mass on an isotropic spring, seen from a frame that turns at Omega: |omega_0 +- Omega|


def soft_sun():
    """The sun hangs on a soft bearing, and its meshes hold it with next to nothing; the carrier turns."""
    raw = stage(driven="carrier", braked="sun", sun_planet={"stiffness": "1e-4 N/m"})
    raw["stages"]["gear"]["sun"]["bearing"] = {"stiffness": "1.5e5 N/m"}
    raw["effects"]["damping"] = "off"
    raw["loads"]["brake"]["torque"] = "0 N*m"
    return raw


def test_frequencies_split_as_the_frame_turns():
    own = np.sqrt(1.5e5 / 6) / TWO_PI
    speeds = np.linspace(0, 1200, 41)
    _, found = campbell_of(soft_sun(), *speeds)
    turns = np.abs(found.turns)
    assert turns == pytest.approx(found.values / 60)
    assert (found.tracks >= 0).all()
    tracks = [found.frequencies(k) for k in range(found.tracks.shape[1])]
    for wanted in (own + turns, own - turns):
        assert (wanted > 0).all()
        assert min(np.abs(track - wanted).max() for track in tracks) < 1e-6 * own


def test_no_mode_is_lost_and_none_is_counted_twice():
    for raw in (soft_sun(), stage()):
        _, found = campbell_of(raw)
        for point, column in zip(found.modes, found.tracks, strict=True):
            assert sorted(column[column >= 0]) == list(range(len(point)))
        assert found.number(0) == found.first
    assert found.values[found.at_home] == pytest.approx(1000)


# --- orders


MOTIONS = {
    # held, driven: pitches a turn of the driven member, sides as (name, order, spread)
    ("ring", "carrier"): (72, {("carrier", 1, 1), ("ring pass", 3, 3), ("sun pass", 9, 3)}),
    ("ring", "sun"): (18, {("carrier", 0.25, 1), ("ring pass", 0.75, 3), ("sun pass", 2.25, 3)}),
    ("sun", "carrier"): (24, {("carrier", 1, 1), ("ring pass", 1, 3), ("sun pass", 3, 3)}),
    ("carrier", "sun"): (24, {("ring pass", 1, 3), ("sun pass", 3, 3)}),
}
"""By hand (Willis): Z_S (rho_S - rho_C) = -Z_R (rho_R - rho_C)."""


@pytest.mark.parametrize(("held", "driven"), MOTIONS)
def test_orders_of_a_planetary_stage(held, driven):
    pitches, sides = MOTIONS[held, driven]
    braked = next(name for name in ("sun", "carrier", "ring") if name not in (held, driven))
    c = make_case(stage(held, driven, braked))
    orders = list_orders(c.library.manifest, c.p, 2)
    assert [(order.name, order.order) for order in orders] == [("gear", pitches), ("2 gear", 2 * pitches)]
    found = {(side.name, abs(side.order), side.spread) for side in list_sides(c.library.manifest, c.p, "gear")}
    assert {name for name, *_ in found} == {name for name, *_ in sides}
    for name, order, spread in sides:
        known = next(side for side in found if side[0] == name)
        assert known[1:] == (pytest.approx(abs(order), rel=1e-12), spread)
    every = list_orders(c.library.manifest, c.p, 1, sidebands=True)
    assert len(every) == 1 + 2 * len(sides)
    for order in every[1:]:
        name, sign, side = order.name.split(" ", 2)
        step = next(value for known, value, _ in found if known == side)
        assert (name, order.order) == ("gear", pytest.approx(pitches + (1 if sign == "+" else -1) * step))


def test_orders_of_pairs_count_through_the_train():
    c = case("rig-2mw")
    orders = {order.name: order.order for order in list_orders(c.library.manifest, c.p, 1)}
    assert orders["lsp"] == 118
    frequencies_hz = {name: order * 15 / 60 for name, order in orders.items()}
    # Printed: Wu et al. 2021, section 4.
    assert frequencies_hz == pytest.approx({"lsp": 29.5, "hsp": 158.227, "psh": 628.255}, abs=1e-3)


def test_a_stage_has_the_same_phases_in_whatever_train_it_turns():
    """Alone the carrier is the reference; in the rig it turns against the reference, 118/22 times as fast."""
    alone, rig = case("hsp"), case("rig-2mw")
    speeds = {"hsp": -1.0, "rig-2mw": 1.0}
    found = []
    for name, c in (("hsp", alone), ("rig-2mw", rig)):
        orders = [o for o in list_orders(c.library.manifest, c.p, 2, sidebands=True) if o.stage == "hsp"]
        meshes = [f"hsp.{group}.{i}" for group in ("sun_planet", "ring_planet") for i in (1, 2, 3)]
        found.append([(o.name, phases_of(c.library.manifest, c.p, o, meshes, speeds[name])) for o in orders])
    assert len(found[0]) == len(found[1]) == 14
    for (one, first), (two, second) in zip(*found, strict=True):
        assert one == two
        assert np.exp(1j * first) == pytest.approx(np.exp(1j * second), abs=1e-9)


# --- crossings


def pair(**mesh):
    """A pair that only turns, its input held: one freedom of the mass I_2 / r_2^2."""
    wheel = {"support": "rigid", "inertia": "0.02 kg*m^2"}
    return {
        "title": "pair that only turns",
        "effects": {"lateral": "off"},
        "stages": {
            "gear": {
                "kind": "pair", "module": "3 mm", "pressure_angle": "20 deg",
                "input": wheel | {"teeth": 25}, "output": wheel | {"teeth": 40},
                "mesh": {"stiffness": "3e8 N/m", "damping": "400 N*s/m"} | mesh,
            }
        },
        "loads": {
            "drive": {"member": "gear.input", "speed": "-900 rpm"},
            "brake": {"member": "gear.output", "torque": "300 N*m"},
        },
    }  # fmt: skip


def pair_frequency(k=3e8):
    radius = 40 * 3e-3 / 2 * np.cos(np.deg2rad(20))
    return np.sqrt(k * radius**2 / 0.02) / TWO_PI


def test_crossings_are_where_algebra_puts_them():
    c, found = campbell_of(pair(), *np.linspace(0, 2500, 30))
    crossings = find_crossings(found, list_orders(c.library.manifest, c.p, 6))
    by_order = {crossing.order.harmonic: crossing for crossing in crossings}
    wanted = {h: 60 * pair_frequency() / (25 * h) for h in range(1, 7)}
    assert set(by_order) == {h for h, rpm in wanted.items() if rpm < 2500}
    assert len(crossings) == len(by_order) >= 3
    for harmonic, crossing in by_order.items():
        assert crossing.value == pytest.approx(wanted[harmonic], rel=1e-9)
        assert crossing.frequency_hz == pytest.approx(pair_frequency(), rel=1e-9)
        assert crossing.margin == pytest.approx(wanted[harmonic] / 900 - 1)
        assert crossing.modes == (1,)
    assert {np.sign(crossing.margin) for crossing in crossings} == {-1.0, 1.0}


def test_an_order_that_stays_crosses_where_the_load_moves_the_mode():
    """Teeth whose stiffness does not change are the same at every load: no crossing, and modes that stand."""
    c = make_case(pair())
    found = sweep_load(c.library, c.p, np.linspace(0.5, 2, 4))
    assert found.values.tolist() == [0.5, 1.0, 1.5, 2.0]
    assert np.ptp(found.frequencies(0)) < 1e-9 * pair_frequency()
    assert find_crossings(found, list_orders(c.library.manifest, c.p, 3)) == []
    forces = [linear.at.x for linear in found.linears]
    twist = c.state("gear.output.u")
    assert forces[3][twist] == pytest.approx(4 * forces[0][twist], rel=1e-9)


def test_strength_is_the_response_in_resonance():
    c, found = campbell_of(pair())
    crossing = find_crossings(found, list_orders(c.library.manifest, c.p, 6))[0]
    linear = found.linears[found.at_home]
    response = respond(linear, "gear.mesh", np.array([crossing.frequency_hz]))
    assert crossing.sensitivity == pytest.approx(1e-6 * abs(response.of("mesh_force", "gear.mesh")[0]), rel=5e-3)


def test_the_force_of_a_crossing_is_what_a_run_shows():
    """Two levels 0.2 % apart in resonance: amplitude of the first harmonic, little enough to be linear."""
    raw = pair(double_factor=1.002, damping="2000 N*s/m")
    c, found = campbell_of(raw)
    k = c.p[[n for n, _ in c.library.manifest.parameters].index("gear.mesh.stiffness_single")]
    assert k == 3e8
    mean = found.frequencies(0)[found.at_home]
    raw["loads"]["drive"]["speed"] = f"{float(-60 * mean / 25)!r} rpm"
    c, found = campbell_of(raw, *np.linspace(0.8, 1.2, 5) * 60 * mean / 25)
    (crossing,) = find_crossings(found, list_orders(c.library.manifest, c.p, 1))
    assert crossing.margin == pytest.approx(0, abs=1e-6)
    periods, samples = 20, 64
    path = c.run(t_end=0.1 + periods / mean, rate=samples * mean, method="erk", rtol=1e-9)
    last = slice(-periods * samples, None)
    wave = np.exp(-1j * TWO_PI * mean * path.time[last]) * 2 / (periods * samples)
    amplitude = abs(wave @ c.quantity("mesh_force", path.x, path.s)["gear.mesh"][last])
    assert crossing.force == pytest.approx(amplitude, rel=3e-3)


@pytest.mark.parametrize(
    ("sun", "ring", "planet"), [(24, 72, 24), (25, 71, 23), (23, 73, 25)]
)  # Z_S / 3 whole, and one to either side
def test_planets_excite_the_modes_that_their_phases_allow(sun, ring, planet):
    """Parker 2000, J. Sound Vib. 236:561: h Z_S / n whole excites rotational modes only, one off translational ones."""
    raw = stage(driven="carrier", braked="sun", teeth={"sun": sun, "ring": ring, "planet": planet}, rpm=1000)
    raw["effects"] = {}
    for mesh in ("sun_planet", "ring_planet"):
        raw["stages"]["gear"][mesh] |= {"double_factor": 1.3}
    c, found = campbell_of(raw, *np.linspace(10, 6000, 25))
    crossings = find_crossings(found, list_orders(c.library.manifest, c.p, 3))
    assert len(crossings) > 10
    for crossing in crossings:
        # Phases of the meshes, and forces while bodies stand still: two routes to whom the planets excite.
        top = max(other.force for other in crossings if other.order == crossing.order)
        assert (crossing.sensitivity > 1e-3) == (crossing.force > 1e-4 * top), crossing
    reached = {}
    for crossing in crossings:
        kind = found.mode(found.at_home, crossing.modes[0] - found.first).kind
        whole = crossing.order.harmonic * sun % 3 == 0
        if kind == ("rotational" if whole else "translational"):
            reached.setdefault((kind, crossing.modes), []).append(crossing.sensitivity)
        elif kind in ("rotational", "translational"):
            assert crossing.sensitivity == 0, (crossing.order, crossing.frequency_hz)
    assert {kind for kind, _ in reached} == {"rotational"} if sun == 24 else {"rotational", "translational"}
    assert sun == 24 or any(kind == "translational" and len(strengths) > 1 for (kind, _), strengths in reached.items())
    for (kind, _), strengths in reached.items():
        if kind == "rotational":
            assert min(strengths) > 1
        elif len(strengths) > 1:
            # The carrier turns, so one of a pair whirls forwards, one backwards: the first harmonic meets the one,
            # the second the other.
            assert max(strengths) > 1
            assert min(strengths) < 1e-6 * max(strengths)


@pytest.mark.parametrize("rpm", [700, -700])
def test_sidebands_reach_the_modes_that_go_round_with_them(rpm):
    """Planet i stands at theta_i, its ring mesh at Z_R theta_i: beside it, cos(Z_R theta_i) cos(theta_i) is modulated
    by the carrier's turn, so the upper sideband has (Z_R + 1) / n whole for rotational modes, the lower (Z_R - 1) / n.
    """
    raw = stage(driven="carrier", braked="sun", teeth={"sun": 25, "ring": 71, "planet": 23}, rpm=rpm)
    c, found = campbell_of(raw, *np.linspace(10, 6000, 25))
    crossings = find_crossings(found, list_orders(c.library.manifest, c.p, 1, sidebands=True))
    reached = set()
    for crossing in crossings:
        kind = found.mode(found.at_home, crossing.modes[0] - found.first).kind
        if crossing.sensitivity > 1e-3:
            reached.add((crossing.order.name, kind))
        assert (crossing.force is None) == bool(crossing.order.side)
    assert ("gear + carrier", "rotational") in reached
    assert {kind for name, kind in reached if name == "gear - carrier"} == {"translational"}
    assert {kind for name, kind in reached if "pass" in name} == {"translational"}


def test_what_stands_near_speed_zero_is_ranked_last():
    """A soft shaft meets every order at a few turns: hardest excited of all, but where the train only starts."""
    raw = pair(double_factor=1.4)
    raw["rotors"] = {"drum": {"inertia": "30 kg*m^2"}}
    raw["couplings"] = {
        "shaft": {"between": ["gear.output", "drum"], "stiffness": "2e5 N*m/rad", "damping_ratio": 0.01}
    }
    raw["loads"]["brake"]["member"] = "drum"
    c, found = campbell_of(raw)
    crossings = find_crossings(found, list_orders(c.library.manifest, c.p, 3))
    slow = [crossing.value < 0.1 * found.home for crossing in crossings]
    assert slow == sorted(slow)
    assert 0 < sum(slow) < len(slow)
    assert max(crossing.force for crossing in crossings) == crossings[slow.index(True)].force > crossings[0].force
    for part in (crossings[: slow.index(True)], crossings[slow.index(True) :]):
        assert [one.force for one in part] == sorted((one.force for one in part), reverse=True)


def test_without_damping_the_force_is_unbounded():
    raw = pair()
    raw["effects"]["mesh_damping"] = "off"
    c, found = campbell_of(raw)
    crossings = find_crossings(found, list_orders(c.library.manifest, c.p, 6))
    assert crossings
    assert {(crossing.sensitivity, crossing.force) for crossing in crossings} == {(None, None)}


# --- bad input


@pytest.mark.parametrize("text", ["", "1:2", "1:2:3:4", "a:2:3", "2:1:5", "1:1:5", "-1:2:5", "nan:2:5", "0:inf:5",
                                  "0:1:1", "0:1:2.5"])  # fmt: skip
def test_ranges_that_are_none_are_refused(text):
    with pytest.raises(LtcgearError, match=r"--speed .*FIRST:LAST:NUMBER"):
        read_range("--speed", text, "0:20:61")


def test_ranges():
    assert read_range("--speed", "0:20:5", "0:20:61").tolist() == [0, 5, 10, 15, 20]


def test_a_train_without_a_speed_is_refused():
    standing = case("lin-parker-3")
    with pytest.raises(LtcgearError, match=r"the train stands.*loads.NAME.speed"):
        sweep_speed(standing.library, standing.p)
    with pytest.raises(LtcgearError, match="no load of the scene has a torque"):
        sweep_load(standing.library, standing.p, np.array([0.5, 1.0]))
    raw = stage()
    raw["loads"]["drive"] = {"member": "gear.sun", "speed_over_time": [["0 s", "10 rpm"], ["1 s", "20 rpm"]]}
    ramp = make_case(raw)
    with pytest.raises(LtcgearError, match="follows a table over time"):
        sweep_speed(ramp.library, ramp.p, tables=ramp.model.tables)


# --- what stiffness that varies does in a whole stage


@pytest.mark.parametrize("rpm", [-900, 900])
def test_an_error_is_a_force_of_its_own_phase(rpm):
    """With e = A cos(2 pi tau) and tau 0.15 ahead it is -(k + i omega c) A exp(0.3 pi i), whichever way gears turn."""
    raw = pair(transmission_error={"amplitudes": ["1e-7 m"]}, phase=0.15, damping="30000 N*s/m")
    raw["effects"] |= {"transmission_error": "on"}
    raw["loads"]["drive"]["speed"] = f"{rpm} rpm"
    c = make_case(raw)
    omega = TWO_PI * 25 * 900 / 60
    found = find_harmonics(linearise(c.point), c.p, 2)["gear.mesh"]
    wanted = -(3e8 + 1j * omega * 3e4) * 1e-7 * np.exp(0.3j * np.pi)
    assert found == pytest.approx(np.array([wanted, 0.0]), abs=1e-6 * abs(wanted))


def test_every_mesh_of_a_stage_vibrates_as_its_harmonics_make_it():
    """Teeth 0.2 % stiffer in double contact: first and second harmonic of the motion at every mesh, phases too."""
    raw = stage(mean=False, driven="carrier", braked="sun", teeth={"sun": 25, "ring": 71, "planet": 23}, rpm=700)
    for mesh in ("sun_planet", "ring_planet"):
        raw["stages"]["gear"][mesh] |= {"double_factor": 1.002, "damping_ratio": 0.05}
    c = make_case(raw)
    linear = linearise(c.point)
    paths, own, pitch = find_paths(linear), find_harmonics(linear, c.p, 2), 71 * 700 / 60
    slowest = min(abs(mode.eigenvalue.real) for mode in find_modes(linear))
    periods, samples = 20, 64
    settled = np.ceil(15 / slowest * pitch) / pitch
    path = c.run(t_end=settled + periods / pitch, rate=samples * pitch, method="erk", rtol=1e-10)
    last = slice(-periods * samples - 1, -1)
    # Deflections have no jumps that samples would blur.
    motions = c.quantity("mesh_deflection", path.x[last], path.s[last])
    for harmonic in (1, 2):
        omega = TWO_PI * pitch * harmonic
        push = sum(paths[mesh].push * own[mesh][harmonic - 1] for mesh in paths)
        moved = propagate(linear, push, np.array([omega]))[0]
        wave = np.exp(-1j * omega * path.time[last]) * 2 / (periods * samples)
        largest = max(abs(wave @ motion) for motion in motions.values())
        for mesh, motion in motions.items():
            assert abs(paths[mesh].deflection @ moved - wave @ motion) < 1e-3 * largest, (mesh, harmonic)
