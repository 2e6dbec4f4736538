"""Eigenfrequencies against print, against matrices built by hand, and against closed forms."""

from collections import Counter

import numpy as np
import pytest
from ltcgear.runtime.modes import find_modes

from reference import lin_parker

from .models import case, make_case

PLANETS = (3, 4, 5)
TWO_PI = 2 * np.pi


def modes_of(c):
    return find_modes(c.library, c.at, c.p)


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
        assert list(mode.energy.values()) == sorted(mode.energy.values(), reverse=True)
        assert abs(mode.damping_ratio) < 1e-6
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
    assert list(modes[1].energy) == ["b", "a"]


def test_dtu_10_mw_fixed_free():
    # The generator's speed is held, so its end is fixed.
    loads = {"grid": {"member": "b", "speed": "9.6 rpm"}}
    modes = modes_of(make_case(rotors([DTU["rotor"], DTU["generator"]], [DTU["stiffness"]], loads=loads)))
    assert [mode.kind for mode in modes] == ["torsional"]
    assert modes[0].frequency_hz == pytest.approx(0.612, abs=5e-4)


@pytest.mark.parametrize("loads", [{}, {"motor": {"member": "a", "torque": "0 N*m", "initial_speed": "30 rpm"}}])
def test_three_rotors_in_a_row(loads):
    modes = modes_of(make_case(rotors([2.0, 3.0, 5.0], [700.0, 900.0], loads=loads)))
    K = np.array([[700, -700, 0], [-700, 1600, -900], [0, -900, 900.0]])
    squares = np.sort(np.linalg.eigvals(K / np.array([2.0, 3.0, 5.0])[:, None]).real)
    assert [mode.kind for mode in modes] == ["rigid", "torsional", "torsional"]
    assert frequencies(modes)[1:] == pytest.approx(np.sqrt(squares[1:]) / TWO_PI, rel=1e-9)


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
    from .models import TORQUE_DRIVEN

    held, free = modes_of(case("rig-2mw")), modes_of(case("rig-2mw", *TORQUE_DRIVEN))
    assert [mode.kind for mode in free].count("rigid") == 1
    assert len(free) == len(held) + 1


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
