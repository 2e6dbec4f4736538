"""The oracle's laws over the mesh phase against closed forms, and its stiffness torque against an energy."""

import numpy as np
import pytest

from reference import hand_forces as hand
from reference import hand_profiles as profiles


def test_the_polygon_of_a_triangle_has_the_textbook_series():
    """Triangle wave 1 - 4 |tau| on half a period about zero: cosine terms 8 / (pi n)^2 for odd n."""
    mean, cosines, sines = profiles.polygon_terms([(0.0, 1.0), (0.5, -1.0)], 5)
    odd = np.array([1, 0, 1, 0, 1])
    assert mean == pytest.approx(0.0)
    assert cosines == pytest.approx(odd * 8 / (np.pi * np.arange(1, 6)) ** 2, abs=1e-15)
    assert sines == pytest.approx(np.zeros(5), abs=1e-15)


def test_the_square_wave_has_the_textbook_series():
    """+1 and -1 for half a period each: sine terms 4 / (pi n) for odd n."""
    mean, cosines, sines = profiles.square_terms(1.0, -1.0, 0.5, 5)
    assert mean == pytest.approx(0.0)
    assert cosines == pytest.approx(np.zeros(5), abs=1e-15)
    assert sines == pytest.approx(np.array([1, 0, 1, 0, 1]) * 4 / (np.pi * np.arange(1, 6)))


def test_a_long_series_of_a_polygon_is_the_polygon():
    pairs = [(0.05, 2.1), (0.3, 2.6), (0.9, 1.9)]
    terms = profiles.polygon_terms(pairs, 400)
    for tau in (0.0, 0.2, 0.55, 0.97):
        wanted = np.interp(tau, *np.array(pairs).T, period=1.0)
        assert float(profiles.wave(tau, *terms)[0]) == pytest.approx(wanted, abs=1e-3)


@pytest.mark.parametrize(
    "law",
    [
        lambda tau: profiles.smooth_levels(tau, 1.0, 1.5, 0.37, 0.2),
        lambda tau: profiles.wave(tau, 1.0, [0.3, -0.1], [0.2, 0.05]),
        lambda tau: profiles.tooth_window(tau, 7, 21, 0.37),
    ],
)
def test_slopes_are_those_of_the_values(law):
    for tau in np.linspace(-30.03, 40.01, 2003):
        rise = (law(tau + 1e-6)[0] - law(tau - 1e-6)[0]) / 2e-6
        assert float(law(tau)[1]) == pytest.approx(float(rise), abs=1e-4)


def test_smooth_levels_are_those_of_the_two_levels_away_from_the_edges():
    """Their mean is that of the two levels whatever the width, since the step is odd about its middle."""
    assert profiles.smooth_levels(3.185, 1.0, 1.5, 0.37, 0.2) == (1.0, 0.0)
    assert profiles.smooth_levels(-2.3, 1.0, 1.5, 0.37, 0.2) == (1.5, 0.0)
    taus = (np.arange(2000) + 0.5) / 2000
    mean = np.mean([float(profiles.smooth_levels(tau, 1.0, 1.5, 0.37, 0.2)[0]) for tau in taus])
    assert mean == pytest.approx(0.37 + 1.5 * 0.63, rel=1e-6)


def test_teeth_share_the_load_completely():
    """Errors of one size on all teeth shift the flank by that size, always; one alone comes back each turn."""
    for tau in np.linspace(-12.0, 55.0, 301):
        windows = [profiles.tooth_window(tau, tooth, 21, 0.37) for tooth in range(21)]
        assert np.sum(windows, axis=0) == pytest.approx([1.0, 0.0], abs=1e-9)
        assert profiles.tooth_window(tau + 21, 4, 21, 0.37)[0] == pytest.approx(windows[4][0], abs=1e-9)


@pytest.mark.parametrize("pushes_only", [False, True])
@pytest.mark.parametrize("s", [1, -1])
@pytest.mark.parametrize("kind", ["external", "internal"])
def test_forces_of_a_stiffness_by_angle_are_the_gradient_of_its_energy(kind, s, pushes_only):
    """V = k(th1 - gamma) <delta>^2 / 2 over all six coordinates; a stretch of 0.1 mm, a steep stiffness."""
    r1, r2, d0 = (0.3, 0.1, 0.43) if kind == "external" else (0.3, 0.1, 0.213)
    gear = {"kind": kind, "law": "involute", "s": s, "r1": r1, "r2": r2, "d0": d0, "gamma0": 0.4, "turn": 0.0}
    rest = {"V1": np.zeros(2), "w1": 0.0, "V2": np.zeros(2), "w2": 0.0}

    def evaluate(q):
        O1, O2 = q[:2], q[3:5]
        psi = q[2] - np.arctan2(O2[1] - O1[1], O2[0] - O1[0])
        k, slope = 1e9 * (1 + 0.3 * np.sin(20 * psi)), 6e9 * np.cos(20 * psi)
        places = {"O1": O1, "th1": q[2], "O2": O2, "th2": q[5]}
        out = hand.mesh(**gear, k=k, c=0.0, **places, **rest, pushes_only=pushes_only, slope=slope)
        stretch = max(out["deflection"], 0.0) if pushes_only else out["deflection"]
        return out, k * stretch**2 / 2

    q = np.array([0.0, 0.0, s * 3e-4, d0 * np.cos(0.4), d0 * np.sin(0.4), 0.0], np.longdouble)
    out, energy = evaluate(q)
    assert energy > 1.0
    forces = [*out["F1"], out["T1"], *out["F2"], out["T2"]]
    steps = 1e-8 * np.eye(6, dtype=np.longdouble)
    wanted = [-(evaluate(q + h)[1] - evaluate(q - h)[1]) / 2e-8 for h in steps]
    assert np.array(forces, float) == pytest.approx(np.array(wanted, float), rel=1e-6, abs=1e-6 * float(out["force"]))
    assert abs(hand.cross(q[3:5], out["F2"]) + out["T1"] + out["T2"]) < 1e-9 * abs(out["T1"])
