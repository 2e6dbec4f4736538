"""Tooth stiffness against standards, published fits and closed forms."""

from dataclasses import replace
from math import cos, log, pi, radians, sin, sqrt, tan

import numpy as np
import pytest
from ltcgear.symbolic.gears import gear_geometry
from ltcgear.symbolic.gears import tooth_stiffness as ts
from ltcgear.symbolic.gears.tooth_stiffness import Material, Tooth
from ltcgear.symbolic.schema.scene_schema import Gear, Stage

ALPHA = radians(20)


def tooth(teeth, shift=0.0, module=1e-3, **more):
    return Tooth(teeth, module, ALPHA, shift, **more)


# One, two, width [m], centre distance [m]; the first is Tian's (2004) pair, the rest those of the 2 MW rig.
PAIRS = {
    "tian": (tooth(19, module=3.175e-3), tooth(48, module=3.175e-3), 0.016, 33.5 * 3.175e-3),
    "lsp sun": (tooth(22, module=0.016), tooth(48, module=0.016), 0.4, 0.56),
    "lsp ring": (tooth(48, module=0.016), tooth(118, module=0.016, internal=True), 0.4, 0.56),
    "hsp sun": (tooth(17, 0.31, 0.012), tooth(50, 0.22, 0.012), 0.25, 0.408),
    "hsp ring": (tooth(50, 0.22, 0.012), tooth(118, 0.22, 0.012, internal=True), 0.25, 0.408),
}
pairs = pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS.keys())


def reference_stage(one):
    return Stage.model_validate({"module": f"{one.module!r} m", "pressure_angle": f"{one.pressure_angle!r} rad"})


def reference_gear(one):
    return Gear.model_validate({"teeth": one.teeth, "profile_shift": one.profile_shift, "support": "fixed"})


def compliance(one, roll, **more):
    return float(ts.tooth_compliance(one, np.asarray(roll), **more))


def test_theoretical_single_stiffness_of_iso_tr_6336_30():
    """Example 1 of ISO/TR 6336-30:2017 (helical 17/103), as quoted in gfsReboucas/Drivetrain, ISO_6336.m."""
    assert ts.iso_theoretical_stiffness(18.905, 114.543, 0.145, 0.0) == pytest.approx(17.85584, rel=1e-3)


def test_iso_mesh_stiffness_of_a_textbook_rack():
    """ISO 6336-1: c' is near 14 and c_gamma near 20 N/(mm um) for common spur gears of solid disc design."""
    one, two = tooth(25, dedendum=1.2), tooth(75, dedendum=1.2)
    single, mean = ts.iso_6336_stiffness(one, two, 1e-3)
    assert single / 1e6 == pytest.approx(14, rel=0.05)
    assert mean / 1e6 == pytest.approx(20, rel=0.1)


@pytest.mark.parametrize("teeth", [17, 20, 25, 30, 40, 48])
@pytest.mark.parametrize("height", [0.0, 0.3, 0.6])
def test_one_tooth_against_a_published_finite_element_fit(teeth, height):
    """Kuang & Yang 1992 (ASME DE-43-1:81), as commonly quoted: a tooth loaded some modules above the pitch circle."""
    n = np.array([1, teeth, teeth**2, teeth**3])
    level = n @ [3.867, 1.612, -0.02916, 0.0001553]
    slope = n @ [2.637, -1.222, 0.02217, -0.0001179]
    one = tooth(teeth)
    roll = sqrt(((one.pitch_radius + height * one.module) / one.base_radius) ** 2 - 1)
    assert Material().E / compliance(one, roll) / 1e9 == pytest.approx(level + slope * height, rel=0.25)


@pairs
def test_iso_single_stiffness_is_the_highest_of_a_pair(pair):
    one, two, width, distance = pair
    phase, k = ts.mesh_stiffness(*pair)
    alone = phase < 2 - ts.path_of_contact(one, two, distance).contact_ratio
    single, mean = ts.iso_6336_stiffness(one, two, width, distance)
    assert k[alone].max() == pytest.approx(single, rel=0.3)
    assert k.mean() == pytest.approx(mean, rel=0.3)
    assert 1.5 < k[~alone].mean() / k[alone].mean() < 2


def test_cantilevers_of_closed_form():
    length, half, nu = 3.0, 0.7, 0.25
    points, weights = np.polynomial.legendre.leggauss(20)
    u, w = length / 2 * (1 + points), length / 2 * weights
    zero, right = np.asarray(0.0), np.asarray(pi / 2)
    thick = 2 * half
    prism = ts.cantilever_compliance(u, np.full(20, half), w, zero, zero, nu)
    assert prism == pytest.approx(4 * (length / thick) ** 3 + 1.2 * 2 * (1 + nu) * length / thick, rel=1e-12)
    column = ts.cantilever_compliance(u, np.full(20, half), w, right, zero, nu)
    assert column == pytest.approx(length / thick, rel=1e-12)
    eccentric = ts.cantilever_compliance(u, np.full(20, half), w, right, np.asarray(0.2), nu)
    assert eccentric == pytest.approx(length / thick + 12 * 0.2**2 * length / thick**3, rel=1e-12)
    wedge = ts.cantilever_compliance(1 + u, 0.3 * (1 + u), w, zero, zero, nu)
    assert wedge == pytest.approx((1.5 / 0.3**3 + 1.2 * (1 + nu) / 0.3) * log(1 + length), rel=1e-8)


def test_hertz_term():
    """Yang & Sun 1985: steel of 206 GPa and 0.3 gives 177.8 N/(mm um), and it adds to the teeth's compliance."""
    assert Material().contact_modulus == pytest.approx(1.7779e11, rel=1e-4)
    one, two, width, distance = PAIRS["tian"]
    roll = tan(ALPHA)
    k = ts.single_pair_stiffness(one, two, width, distance, 0.0)
    teeth = (compliance(one, roll) + compliance(two, roll)) / (2.06e11 * width)
    assert 1 / (1 / k - teeth) == pytest.approx(pi * 2.06e11 * width / (4 * (1 - 0.09)), rel=1e-9)


def test_foundation_polynomials_stay_in_their_published_bounds():
    """Sainsot et al. 2004, Table 1, gives ranges of L*, M*, P*, Q*; well inside its domain the fit keeps to them."""
    h, theta = np.meshgrid(np.linspace(2, 6, 60), np.linspace(0.03, 0.1, 60))
    values = np.tensordot(ts.SAINSOT, [theta**-2.0, h**2, h / theta, 1 / theta, h, np.ones_like(h)], 1).reshape(4, -1)
    low, high = np.array([(6.82, 6.94), (1.08, 3.29), (2.56, 13.47), (0.141, 0.62)]).T
    assert np.all(values.min(axis=1) > low - 0.03)
    assert np.all(values.max(axis=1) < high + 0.03)


def test_a_bore_softens():
    solid, bored = tooth(48), tooth(48, bore_radius=tooth(48).root_radius / 2)
    assert compliance(bored, 0.4) > 1.1 * compliance(solid, 0.4)


@pytest.mark.parametrize("one", [tooth(19), tooth(60, 0.2), tooth(118, 0.22, internal=True)])
def test_the_integrals_against_brute_force(one):
    """Thin slices of the profile in polar coordinates, without the involute's own parameter."""
    roll, nu, slices = 0.42 if not one.internal else 0.34, 0.3, 200_000
    sign = 1 if one.internal else -1
    half_angle = pi / (2 * one.teeth) - sign * 2 * one.profile_shift * tan(ALPHA) / one.teeth
    contact = one.base_radius * sqrt(1 + roll**2)
    radius = np.linspace(max(one.root_radius, one.base_radius * (1 + 1e-12)), contact, slices)
    pressure = np.arccos(one.base_radius / radius)
    angle = half_angle - sign * (tan(ALPHA) - ALPHA) + sign * (np.tan(pressure) - pressure)
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    if one.root_radius < one.base_radius:
        below = np.linspace(sqrt(one.root_radius**2 - y[0] ** 2), x[0], slices)[:-1]
        x, y = np.concatenate([below, x]), np.concatenate([np.full(slices - 1, y[0]), y])
    load = pressure[-1] + sign * angle[-1]
    moment = (abs(x[-1] - x) * cos(load) - y[-1] * sin(load)) ** 2 / (2 / 3 * y**3)
    area = (1.2 * 2 * (1 + nu) * cos(load) ** 2 + sin(load) ** 2) / (2 * y)
    beam = abs(np.trapezoid(moment + area, x))
    body = float(ts.foundation_compliance(one, np.asarray(load), nu))
    assert compliance(one, roll) == pytest.approx(beam + body, rel=1e-6)


def test_ring_and_gear_of_many_teeth_are_the_same_rack():
    ring, gear = tooth(10**6, internal=True), tooth(10**6)
    assert compliance(ring, tan(ALPHA)) == pytest.approx(compliance(gear, tan(ALPHA)), rel=1e-4)


@pairs
def test_swapping_the_gears_reverses_the_mesh(pair):
    one, two, width, distance = pair
    path = ts.path_of_contact(one, two, distance)
    for position in (path.start, path.start / 3, 0.0, path.end):
        swapped = ts.single_pair_stiffness(two, one, width, distance, -position)
        assert ts.single_pair_stiffness(*pair, position) == pytest.approx(swapped, rel=1e-12)
    there, back = (
        ts.mesh_stiffness(*pair, samples=4000)[1],
        ts.mesh_stiffness(two, one, width, distance, samples=4000)[1],
    )
    assert there.mean() == pytest.approx(back.mean(), rel=1e-3)
    assert there.max() == pytest.approx(back.max(), rel=1e-3)


@pairs
def test_scaling(pair):
    one, two, width, distance = pair
    k = ts.mesh_stiffness(*pair)[1]
    np.testing.assert_allclose(ts.mesh_stiffness(one, two, 2 * width, distance)[1], 2 * k, rtol=1e-12)
    np.testing.assert_allclose(ts.mesh_stiffness(*pair, Material(E=3 * 2.06e11))[1], 3 * k, rtol=1e-12)
    large, mate = replace(one, module=5 * one.module), replace(two, module=5 * two.module)
    np.testing.assert_allclose(ts.mesh_stiffness(large, mate, width, 5 * distance)[1], k, rtol=1e-9)
    assert ts.iso_6336_stiffness(one, two, width, distance, Material(E=1.03e11))[0] == pytest.approx(
        ts.iso_6336_stiffness(one, two, width, distance)[0] / 2
    )


@pairs
def test_contact_ratio_and_distance_agree_with_the_gear_geometry(pair):
    one, two, _, distance = pair
    sigma = -1 if two.internal else 1
    stage, gear, mate = reference_stage(one), reference_gear(one), reference_gear(two)
    first, second = (mate, gear) if two.internal else (gear, mate)  # there the ring comes first
    ratio = gear_geometry.contact_ratio(stage, first, second, sigma, distance)
    assert ts.path_of_contact(one, two, distance).contact_ratio == pytest.approx(ratio, rel=1e-12)
    free = gear_geometry.standard_centre_distance(stage, first, second, sigma)
    assert ts.working_distance(one, two) == pytest.approx(free, rel=1e-12)
    assert ts.working_distance(two, one) == pytest.approx(free, rel=1e-12)


@pairs
def test_single_contact_begins_at_phase_zero_and_lasts_two_less_the_contact_ratio(pair):
    one, two, _, distance = pair
    path = ts.path_of_contact(one, two, distance)
    phase, k = ts.mesh_stiffness(*pair, samples=5000)
    alone = phase < 2 - path.contact_ratio
    lead = path.end + (phase - 1) * path.base_pitch
    expected = [ts.single_pair_stiffness(*pair, s) for s in lead[alone][::50]]
    np.testing.assert_allclose(k[alone][::50], expected, rtol=1e-12)
    assert k[~alone].min() > 1.3 * k[alone].max()
    last = ts.single_pair_stiffness(*pair, lead[-1]) + ts.single_pair_stiffness(*pair, lead[-1] - path.base_pitch)
    assert k[-1] == pytest.approx(last, rel=1e-12)


@pytest.mark.parametrize("one", [tooth(17), tooth(50, 0.22), tooth(118, internal=True)])
def test_integration_has_converged(one):
    roll = np.linspace(one.root_roll + 0.1, one.tip_roll, 7) if not one.internal else np.linspace(one.tip_roll, 0.4, 7)
    fine = ts.tooth_compliance(one, roll, nodes=100)
    errors = [np.max(np.abs(ts.tooth_compliance(one, roll, nodes=n) / fine - 1)) for n in (4, 10, ts.NODES)]
    assert errors[0] > errors[1]
    assert errors[1] < 1e-5
    assert errors[2] < 1e-12


@pairs
def test_the_mean_converges_with_the_samples(pair):
    coarse, fine = (ts.mesh_stiffness(*pair, samples=n)[1].mean() for n in (200, 20_000))
    assert coarse == pytest.approx(fine, rel=0.005)


@pytest.mark.parametrize(
    ("call", "reason"),
    [
        (lambda: tooth(2), "3 teeth"),
        (lambda: tooth(12, 1.5), "pointed tips"),
        (lambda: tooth(20, internal=True), "base circle"),
        (lambda: tooth(118, internal=True, bore_radius=0.1), "no bore"),
        (lambda: tooth(20, bore_radius=0.001), "bore_radius must lie"),
        (lambda: ts.path_of_contact(tooth(20), tooth(30, module=2e-3), 0.025), "differ in module"),
        (lambda: ts.path_of_contact(tooth(80, internal=True), tooth(90, internal=True), 0.005), "smaller external"),
        (lambda: ts.path_of_contact(tooth(60), tooth(60, internal=True), 0.005), "smaller external"),
        (lambda: ts.path_of_contact(tooth(20), tooth(30), 0.02), "no working pressure angle"),
        (lambda: ts.path_of_contact(tooth(20), tooth(30), 0.0268), "contact ratio"),
        (lambda: ts.path_of_contact(tooth(12), tooth(80), 0.046), "below its involute"),
        (lambda: ts.single_pair_stiffness(tooth(20), tooth(30), 0.01, 0.025, 0.1), "position must lie"),
        (lambda: ts.working_distance(tooth(20, -2.0), tooth(30, -2.0)), "pointed|no working|no root"),
    ],
)
def test_what_makes_no_mesh_is_refused(call, reason):
    with pytest.raises(ValueError, match=reason):
        call()
