"""Eigenfrequencies against print, against matrices built by hand, and against closed forms."""

from collections import Counter
from math import copysign

import numpy as np
import pytest
from ltcgear.runtime.linear.modes import find_modes
from ltcgear.runtime.linear.system import linearise

from reference import lin_parker

from ..models import case, make_case

PLANETS = (3, 4, 5)
TWO_PI = 2 * np.pi


def modes_of(c):
    return find_modes(linearise(c.point))


def lin_parker_modes(n):
    return modes_of(case(f"lin-parker-{n}"))


def frequencies(modes):
    return np.array([mode.frequency_hz for mode in modes])


# --- Lin and Parker 1999


@pytest.mark.parametrize("n", PLANETS)
def test_frequencies_are_the_printed_ones(n):
    found, printed = frequencies(lin_parker_modes(n)), lin_parker.printed(n)
    assert len(found) == len(printed) == 3 * (3 + n)
    assert found[0] == 0.0
    assert np.abs(found[1:] / printed[1:] - 1).max() < 4e-4


@pytest.mark.parametrize("n", PLANETS)
def test_frequencies_are_those_of_the_matrices_by_hand(n):
    found, by_hand = frequencies(lin_parker_modes(n)), lin_parker.frequencies(n)
    assert np.abs(found[1:] / by_hand[1:] - 1).max() < 1e-6
    assert by_hand[0] < 1e-3 * by_hand[1]


@pytest.mark.parametrize("n", PLANETS)
def test_classes_and_multiplicities_are_the_published_ones(n):
    modes = lin_parker_modes(n)
    assert Counter(mode.kind for mode in modes) == Counter(
        rigid=1, rotational=5, translational=12, planet=3 * (n - 3)
    ) - Counter(planet=0)
    for kind, printed, times in (
        ("rotational", lin_parker.PRINTED_SINGLE[n][1:], 1),
        ("translational", lin_parker.PRINTED_DOUBLE[n], 2),
        ("planet", lin_parker.PRINTED_PLANET if n > 3 else (), n - 3),
    ):
        found = [mode.frequency_hz for mode in modes if mode.kind == kind]
        assert found == pytest.approx(np.repeat(np.sort(printed), times), rel=4e-4)
        groups = np.reshape(found, (-1, max(times, 1)))
        assert (np.ptp(groups, axis=1) < 1e-6 * groups[:, 0]).all() or times <= 1


@pytest.mark.parametrize("n", PLANETS)
def test_shares_of_energy_add_up_and_fit_the_class(n):
    for mode in lin_parker_modes(n):
        if mode.kind == "rigid":
            assert mode.energy == {}
            continue
        assert sum(mode.energy.values()) == pytest.approx(1.0)
        assert (np.diff(list(mode.energy.values())) < 1e-9).all()  # largest first; ties stand by name
        assert mode.damping_ratio == 0.0
        assert copysign(1.0, mode.damping_ratio) == 1.0
        if mode.kind == "planet":
            assert sum(share for body, share in mode.energy.items() if ".planet." not in body) < 1e-9


def test_at_rest_nothing_is_found_twice():
    modes = lin_parker_modes(4)
    assert frequencies(modes).tolist() == sorted(frequencies(modes))


# --- torsional trains


def rotors(inertias, couplings, **extra):
    """Rotors a, b, ... in a row."""
    names = "abcdef"[: len(inertias)]
    return {
        "title": "rotors in a row",
        "rotors": {name: {"inertia": f"{value} kg*m^2"} for name, value in zip(names, inertias, strict=True)},
        "couplings": {
            f"c{i}": {"between": list(names[i : i + 2]), "stiffness": f"{k} N*m/rad"} for i, k in enumerate(couplings)
        },
        **extra,
    }


DTU = {"rotor": 156.7374e6, "generator": 1500.5 * 50**2, "stiffness": 2317025352.0}
"""DTU 10 MW turbine, generator referred to the low-speed side [kg m^2, N m/rad] (READING.md)."""


def test_dtu_10_mw_free_free():
    modes = modes_of(make_case(rotors([DTU["rotor"], DTU["generator"]], [DTU["stiffness"]])))
    assert [mode.kind for mode in modes] == ["rigid", "torsional"]
    assert modes[1].frequency_hz == pytest.approx(4.003, abs=5e-4)
    reduced = 1 / (1 / DTU["rotor"] + 1 / DTU["generator"])
    assert modes[1].frequency_hz == pytest.approx(np.sqrt(DTU["stiffness"] / reduced) / TWO_PI, rel=1e-9)
    assert list(modes[1].energy) == ["b turning", "a turning"]


def test_dtu_10_mw_fixed_free():
    # The generator's speed is held, so its end is fixed.
    loads = {"grid": {"member": "b", "speed": "9.6 rpm"}}
    modes = modes_of(make_case(rotors([DTU["rotor"], DTU["generator"]], [DTU["stiffness"]], loads=loads)))
    assert [mode.kind for mode in modes] == ["torsional"]
    assert modes[0].frequency_hz == pytest.approx(0.612, abs=5e-4)


def driven(member, speed="30 rpm"):
    """A torque whose member's angle is the reference."""
    return {"motor": {"member": member, "torque": "0 N*m", "initial_speed": speed}}


@pytest.mark.parametrize("loads", [{}, driven("a"), driven("b"), driven("c")])
def test_three_rotors_in_a_row(loads):
    modes = modes_of(make_case(rotors([2.0, 3.0, 5.0], [700.0, 900.0], loads=loads)))
    K = np.array([[700, -700, 0], [-700, 1600, -900], [0, -900, 900.0]])
    root = np.sqrt([2.0, 3.0, 5.0])
    squares, shapes = np.linalg.eigh(K / np.outer(root, root))
    assert [mode.kind for mode in modes] == ["rigid", "torsional", "torsional"]
    assert frequencies(modes)[1:] == pytest.approx(np.sqrt(squares[1:]) / TWO_PI, rel=1e-9)
    for mode, shape in zip(modes[1:], shapes.T[1:], strict=True):
        assert mode.energy == pytest.approx(dict(zip(("a turning", "b turning", "c turning"), shape**2, strict=True)))


@pytest.mark.parametrize("loads", [{}, driven("a"), driven("b")])
def test_two_rotors_share_the_energy_against_their_inertias(loads):
    modes = modes_of(make_case(rotors([2.0, 3.0], [700.0], loads=loads)))
    assert [mode.kind for mode in modes] == ["rigid", "torsional"]
    assert list(modes[1].energy) == ["a turning", "b turning"]
    assert list(modes[1].energy.values()) == pytest.approx([0.6, 0.4], rel=1e-9)
    assert str(modes[1].damping_ratio) == "0.0"


def test_geared_rotors_share_the_energy_whichever_leads():
    """A stiff mesh of ratio -2: shares as of inertias 2 and 3 on one shaft once referred to it."""
    gear = {"support": "rigid", "inertia": "1e-4 kg*m^2"}
    pair = {
        "kind": "pair", "center_distance": "300 mm",
        "input": {**gear, "base_radius": f"{200 * np.cos(np.radians(20)):.17g} mm"},
        "output": {**gear, "base_radius": f"{100 * np.cos(np.radians(20)):.17g} mm"},
        "mesh": {"stiffness": "1e10 N/m"},
    }  # fmt: skip
    shafts = {
        "one": {"between": ["a", "pair.input"], "stiffness": "700 N*m/rad"},
        "two": {"between": ["pair.output", "b"], "stiffness": "1e7 N*m/rad"},
    }
    for lead in ("a", "b"):
        raw = {**rotors([2.0, 0.75], [], loads=driven(lead)), "stages": {"pair": pair}, "couplings": shafts}
        raw["effects"] = {"mesh_stiffness": "mean"}
        mode = modes_of(make_case(raw))[1]
        assert mode.kind == "torsional"
        assert [mode.energy[f"{name} turning"] for name in "ab"] == pytest.approx([0.6, 0.4], rel=1e-3)


@pytest.mark.parametrize("lead", ["gear.carrier", "gear.sun"])
def test_planets_carried_by_the_frame_count_as_at_rest(lead):
    """At a creeping speed the reference angle only renames the motions: classes and shares stay."""
    slow = (f'loads.m.member = "{lead}"', 'loads.m.torque = "0 N*m"', 'loads.m.initial_speed = "1e-6 rad/s"')
    rest, free = lin_parker_modes(3), modes_of(case("lin-parker-3", *slow))
    assert frequencies(free)[1:] == pytest.approx(frequencies(rest)[1:], rel=1e-6)
    assert Counter(mode.kind for mode in free) == Counter(mode.kind for mode in rest)
    # Translational modes come in pairs of equal frequency, whose shapes are not unique.
    single = [[mode.energy for mode in modes if mode.kind == "rotational"] for modes in (rest, free)]
    assert len(single[0]) == 5
    for at_rest, creeping in zip(*single, strict=True):
        assert creeping == pytest.approx(at_rest, abs=1e-6)


@pytest.mark.parametrize("zeta", [0.001, 0.2, 0.99, 1.5, 4.0])
def test_damping_ratio_of_one_rotor_on_a_torsional_support(zeta):
    inertia, stiffness = 3.0, 1200.0
    damping = 2 * zeta * np.sqrt(stiffness * inertia)
    support = {"stiffness": f"{stiffness} N*m/rad", "damping": f"{damping:.17g} N*m*s/rad"}
    raw = rotors([inertia], [])
    raw["rotors"]["a"]["torsional_support"] = support
    (mode,) = modes_of(make_case(raw))
    assert mode.kind == "torsional"
    assert mode.frequency_hz == pytest.approx(np.sqrt(stiffness / inertia) / TWO_PI, rel=1e-9)
    assert mode.damping_ratio == pytest.approx(zeta, rel=1e-9)


def test_a_damping_ratio_is_the_one_asked_for():
    raw = rotors([3.0], [])
    raw["rotors"]["a"]["torsional_support"] = {"stiffness": "1200 N*m/rad", "damping_ratio": 0.07}
    assert modes_of(make_case(raw))[0].damping_ratio == pytest.approx(0.07, rel=1e-9)


def test_two_overdamped_rotors_keep_their_damping_ratios():
    """Two rotors apart from each other, one overdamped more than the other: slow and fast belong by pairs."""
    raw, wanted = rotors([1.0, 1.0], []), []
    for name, stiffness, zeta in (("a", 100.0, 1.3), ("b", 400.0, 3.0)):
        damping = 2 * zeta * np.sqrt(stiffness)
        raw["rotors"][name]["torsional_support"] = {
            "stiffness": f"{stiffness} N*m/rad",
            "damping": f"{damping:.17g} N*m*s/rad",
        }
        wanted.append((np.sqrt(stiffness) / TWO_PI, zeta))
    found = [(mode.frequency_hz, mode.damping_ratio) for mode in modes_of(make_case(raw))]
    assert np.array(found) == pytest.approx(np.array(wanted), rel=1e-9)


@pytest.mark.parametrize("loads", [{}, driven("a")])
def test_a_free_shaft_with_drag_decays_in_a_mode_of_its_own(loads):
    """One eigenvalue is zero, -c/I has no partner: it is neither paired nor dropped."""
    raw = rotors([2.0, 3.0], [700.0], loads=loads)
    for name, drag in (("a", 0.4), ("b", 0.6)):
        raw["rotors"][name]["drag"] = f"{drag} N*m*s/rad"
    rigid, decay, swing = modes_of(make_case(raw))
    assert (rigid.kind, decay.kind, swing.kind) == ("rigid", "torsional", "torsional")
    assert (decay.frequency_hz, decay.damping_ratio) == (pytest.approx(0.2 / TWO_PI, rel=1e-9), 1.0)
    assert decay.energy == pytest.approx({"b turning": 0.6, "a turning": 0.4}, rel=1e-6)
    assert swing.damping_ratio == pytest.approx(0.1 / np.sqrt(700 * (1 / 2 + 1 / 3)), rel=1e-9)


# --- what grows


def pendulum(line_of_centres, *settings):
    """A carrier with one planet as a pendulum; its inertia about the centre, the torque of its weight."""
    c = case(
        "lin-parker-3",
        "stages.gear.planets = 1",
        f'stages.gear.line_of_centres = "{line_of_centres} deg"',
        'effects.gravity = "on"',
        *settings,
    )
    v = c.model.values()
    sun, planet, ring, d = 34.0, 45.0, 124.0, 86.8861225527e-3
    inertia = (
        v["gear.carrier.inertia"]
        + v["gear.planet.mass"] * d**2
        + v["gear.planet.inertia"] * (1 - ring / planet) ** 2
        + v["gear.sun.inertia"] * (1 + ring / sun) ** 2
    )
    return modes_of(c), inertia, v["gear.planet.mass"] * 9.80665 * d


def test_a_hanging_pendulum_swings():
    modes, inertia, weight = pendulum(-90)
    assert modes[0].kind == "rotational"
    assert modes[0].frequency_hz * TWO_PI == pytest.approx(np.sqrt(weight / inertia), rel=1e-3)


@pytest.mark.parametrize(("stiffness", "drag"), [(0.0, 0.0), (0.2, 0.0), (0.2, 0.03), (0.2, 1.0)])
def test_an_inverted_pendulum_falls(stiffness, drag):
    """I l^2 + c l + k - m g d = 0 has one root that grows and one that decays, and no oscillation."""
    settings = []
    if stiffness:
        settings.append(f'stages.gear.carrier.torsional_support.stiffness = "{stiffness} N*m/rad"')
    if drag:
        settings.append(f'stages.gear.carrier.drag = "{drag} N*m*s/rad"')
    modes, inertia, weight = pendulum(90, *settings)
    roots = np.roots([inertia, drag, stiffness - weight])
    slow = modes[:2]
    assert sorted(mode.frequency_hz * TWO_PI for mode in slow) == pytest.approx(sorted(np.abs(roots)), rel=2e-3)
    (falls,) = [mode for mode in modes if mode.kind == "divergent"]
    (decays,) = [mode for mode in slow if mode.kind == "rotational"]
    assert (falls.damping_ratio, decays.damping_ratio) == (-1.0, 1.0)
    assert falls.frequency_hz * TWO_PI == pytest.approx(max(roots), rel=2e-3)
    assert next(iter(falls.energy)) == "gear.carrier turning"
    assert all(mode.damping_ratio >= 0 for mode in modes if mode is not falls)


def test_damping_that_turns_with_the_carrier_excites_slower_whirl():
    """Dampers of the pins make whirl grow in which its frequency is below the carrier's speed, 300 rad/s."""
    weak = [f'stages.gear.{part}.bearing.stiffness = "1e4 N/m"' for part in ("sun", "ring", "carrier")]
    drive = ('loads.m.member = "gear.carrier"', 'loads.m.speed = "300 rad/s"')
    pins = ('stages.gear.pin.damping = "1e4 N*s/m"', 'effects.damping = "on"')
    modes = modes_of(case("lin-parker-3", *weak, *drive, *pins))
    growing = [mode for mode in modes if mode.damping_ratio < -0.01]
    assert [mode.kind for mode in growing] == ["translational"]
    assert growing[0].damping_ratio > -1.0
    assert growing[0].frequency_hz * TWO_PI < 300


# --- the rig


def test_the_rig_s_modes():
    c = case("rig-2mw")
    modes = modes_of(c)
    freedoms = len(c.library.index(""))
    assert len(modes) == freedoms
    assert all(mode.kind != "rigid" for mode in modes)
    assert frequencies(modes)[0] > 0.5
    assert all(0 <= mode.damping_ratio < 0.5 for mode in modes)
    assert modes[0].kind == "mixed" or modes[0].kind in ("torsional", "rotational")


def test_the_rig_free_to_turn_has_one_rigid_mode_more():
    from ..models import TORQUE_DRIVEN

    held, free = modes_of(case("rig-2mw")), modes_of(case("rig-2mw", *TORQUE_DRIVEN))
    assert [mode.kind for mode in free].count("rigid") == 1
    assert len(free) == len(held) + 1
    # The first mode twists the train between its two ends; held, the motor counts as clamped.
    assert list(free[1].energy)[:2] == ["motor turning", "generator turning"]
    assert not any(part.startswith("motor") for part in held[0].energy)
    assert Counter(mode.kind for mode in free[2:]) == Counter(mode.kind for mode in held[1:])


def test_kahraman_s_torsional_modes_of_a_stage_with_stiff_bearings():
    """Pins and bearings 1e6 times stiffer than the meshes leave Kahraman's torsional model."""
    n, k = 4, 5e8
    stiff = [f'stages.gear.{part}.bearing.stiffness = "1e15 N/m"' for part in ("sun", "carrier")]
    c = case(
        "lin-parker-4",
        'stages.gear.ring.support = "fixed"',
        "-stages.gear.ring.bearing",
        "-stages.gear.ring.torsional_support",
        'stages.gear.pin.stiffness = "1e15 N/m"',
        *stiff,
    )
    values = c.model.values()
    d, alpha = 86.8861225527e-3, lin_parker.ALPHA
    carrier = (values["gear.carrier.inertia"] + n * values["gear.planet.mass"] * d**2) / (d * np.cos(alpha)) ** 2
    wanted = lin_parker.kahraman(n, k, k, lin_parker.INERTIA["planet"], carrier, lin_parker.INERTIA["sun"])
    low = [mode for mode in modes_of(c) if mode.frequency_hz < 1e5]
    assert [mode.frequency_hz * TWO_PI for mode in low][1:] == pytest.approx(wanted[1:], rel=1e-5)
    assert low[0].kind == "rigid"
