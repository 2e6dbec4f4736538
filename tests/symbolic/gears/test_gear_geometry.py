"""Gear geometry against closed forms and published examples."""

from math import acos, atan, cos, degrees, pi, radians, sin, sqrt, tan

import pytest
from ltcgear.symbolic.gears import gear_geometry
from ltcgear.symbolic.gears.gear_geometry import contact_ratio, inverse_involute, involute, standard_centre_distance
from ltcgear.symbolic.schema.scene_schema import Gear, Stage

ALPHA = "20 deg"


def tooth_system(module="1 mm", angle=ALPHA, **more):
    return Stage.model_validate({"module": module, "pressure_angle": angle, **more})


def gear(teeth, shift=0.0):
    return Gear.model_validate({"teeth": teeth, "profile_shift": shift, "support": "fixed"})


def working_angle(stage, one, two, sigma):
    """Return the working pressure angle [deg] from the centre distance, cos a_w = sum of r_b / a."""
    distance = standard_centre_distance(stage, one, two, sigma)
    return degrees(
        acos((gear_geometry.base_radius(stage, one) + sigma * gear_geometry.base_radius(stage, two)) / distance)
    )


@pytest.mark.parametrize("angle", [0.01, 0.5, 5, 14.5, 20, 25, 45, 60, 80, 89, 89.9])
def test_inverse_involute_is_the_inverse(angle):
    assert inverse_involute(involute(radians(angle))) == pytest.approx(radians(angle), rel=1e-8)


@pytest.mark.parametrize("value", [1e-12, 1e-6, 0.014904, 1.0, 10.0, 1e3, 1e6])
def test_inverse_involute_solves_its_equation(value):
    angle = inverse_involute(value)
    assert 0 < angle < pi / 2
    assert involute(angle) == pytest.approx(value, rel=1e-3 if value < 1e-9 or value > 1e3 else 1e-9)


@pytest.mark.parametrize("value", [0.0, -1e-9, -1.0, float("nan")])
def test_inverse_involute_refuses_what_has_no_solution(value):
    with pytest.raises(ValueError, match="no working pressure angle"):
        inverse_involute(value)


def test_involute_table():
    """inv 20 deg = 0.014904, inv 14.5 deg = 0.005545, inv 25 deg = 0.029975 (any involute table, e.g. DIN 3960)."""
    assert involute(radians(20)) == pytest.approx(0.014904, abs=5e-7)
    assert involute(radians(14.5)) == pytest.approx(0.005545, abs=5e-7)
    assert involute(radians(25)) == pytest.approx(0.029975, abs=5e-7)


def test_base_radius_of_spur_and_helical_gears():
    assert gear_geometry.base_radius(tooth_system("16 mm"), gear(118)) == pytest.approx(
        0.944 * cos(radians(20)), rel=1e-14
    )
    helical = tooth_system("9 mm", helix_angle="8 deg")
    module, alpha = gear_geometry.transverse(helical)
    assert module == pytest.approx(0.009 / cos(radians(8)), rel=1e-14)
    assert degrees(alpha) == pytest.approx(20.18, abs=0.005)  # READING.md: 20.18 deg
    assert gear_geometry.base_radius(helical, gear(59)) == pytest.approx(59 * module / 2 * cos(alpha), rel=1e-14)


def test_a_given_base_radius_is_taken():
    given = Gear.model_validate({"base_radius": "45 mm", "support": "fixed"})
    assert gear_geometry.base_radius(tooth_system(), given) == 0.045


def closed_form(z1, z2):
    """Contact ratio of a standard external pair with m = 1 (ISO 21771): both tip flanks less the overlap."""
    alpha = radians(20)
    flank = (sqrt((z / 2 + 1) ** 2 - (z / 2 * cos(alpha)) ** 2) for z in (z1, z2))
    return (sum(flank) - (z1 + z2) / 2 * sin(alpha)) / (pi * cos(alpha))


@pytest.mark.parametrize(
    ("z1", "z2", "printed"),
    [
        # KHK Stock Gears, Gear Technical Reference, contact ratio of standard spur gears, alpha = 20 deg
        (20, 40, 1.635),
        (20, 20, 1.557),
        # R. L. Norton, Machine Design, gear mesh example: 19 and 37 teeth, 20 deg, full depth
        (19, 37, 1.62),
    ],
)
@pytest.mark.parametrize("module", ["1 mm", "16 mm", "1 inch"])
def test_contact_ratio_of_standard_pairs(z1, z2, printed, module):
    stage = tooth_system(module)
    distance = standard_centre_distance(stage, gear(z1), gear(z2), 1)
    found = contact_ratio(stage, gear(z1), gear(z2), 1, distance)
    assert found == pytest.approx(printed, abs=0.006 if printed == 1.62 else 6e-4)
    assert found == pytest.approx(closed_form(z1, z2), rel=1e-12)
    assert contact_ratio(stage, gear(z2), gear(z1), 1, distance) == pytest.approx(found, rel=1e-12)


def test_contact_ratio_tends_to_that_of_a_rack():
    """Two racks: 2 m / (sin a cos a) over the base pitch; 1.981 at 20 deg is the bound of all standard pairs."""
    stage, many = tooth_system(), gear(100000)
    found = contact_ratio(stage, many, many, 1, standard_centre_distance(stage, many, many, 1))
    bound = 2 / (sin(radians(20)) * cos(radians(20))) / pi
    assert found == pytest.approx(bound, rel=1e-3)
    assert bound == pytest.approx(1.981, abs=5e-4)


def test_contact_ratio_of_an_internal_pair():
    """LSP of Wu et al. 2021 (planet 48 in ring 118, 16 mm, 20 deg), by the tip circles in the ring's own terms."""
    stage, ring, planet = tooth_system("16 mm"), gear(118), gear(48)
    distance = standard_centre_distance(stage, ring, planet, -1)
    assert distance == pytest.approx((118 - 48) / 2 * 0.016, rel=1e-12)
    alpha, m = radians(20), 0.016
    flank_planet = sqrt((25 * m) ** 2 - (24 * m * cos(alpha)) ** 2)
    flank_ring = sqrt((58 * m) ** 2 - (59 * m * cos(alpha)) ** 2)
    expected = (flank_planet - flank_ring + distance * sin(alpha)) / (pi * m * cos(alpha))
    assert contact_ratio(stage, ring, planet, -1, distance) == pytest.approx(expected, rel=1e-12)
    assert 1.6 < expected < 2.0  # an internal pair has more than the external one of the same teeth


def test_a_profile_shifted_external_pair():
    """D. Bolsover, bolsover.com, Profile Shifted External Spur Gears: m 3, 12 and 24 teeth, x 0.6 and 0.36.

    Printed: inv of the working angle 0.034317, 26.0888 deg, centre distance 56.500 mm (rounded input),
    base diameters 33.8289 and 67.6579 mm.
    """
    stage, one, two = tooth_system("3 mm"), gear(12, 0.6), gear(24, 0.36)
    assert 2e3 * gear_geometry.base_radius(stage, one) == pytest.approx(33.8289, abs=6e-5)
    assert 2e3 * gear_geometry.base_radius(stage, two) == pytest.approx(67.6579, abs=6e-5)
    assert gear_geometry.working_involute(stage, one, two, 1) == pytest.approx(0.034317, abs=6e-6)
    assert working_angle(stage, one, two, 1) == pytest.approx(26.0888, abs=3e-3)
    assert 1e3 * standard_centre_distance(stage, one, two, 1) == pytest.approx(56.500, abs=2e-3)


def test_a_profile_shifted_helical_pair():
    """Gear generating profile shift calculations by ISO 21771:2007 (scribd.com document 376176518).

    m_n 3.5, z 31 and 30, alpha_n 20 deg, sum of shifts 0.651877131252; printed: alpha_t 21.2990642859 deg,
    reference distance 114.3447280708 mm, working angle 23.8707609654 deg, working distance 116.5 mm.
    """
    beta = acos(3.5 * 61 / 2 / 114.3447280708)
    stage = tooth_system("3.5 mm", helix_angle=f"{beta!r} rad")
    one, two = gear(31, 0.291), gear(30, 0.651877131252 - 0.291)
    assert degrees(gear_geometry.transverse(stage)[1]) == pytest.approx(21.2990642859, abs=1e-9)
    assert working_angle(stage, one, two, 1) == pytest.approx(23.8707609654, abs=1e-8)
    assert 1e3 * standard_centre_distance(stage, one, two, 1) == pytest.approx(116.5, abs=1e-8)


def test_a_profile_shifted_internal_pair():
    """KHK Stock Gears, Gear Technical Reference, internal gear: m 3, 16 in 24 teeth, x 0 and 0.5.

    Printed: inv of the working angle 0.060401, 31.0937 deg, centre distance 13.1683 mm.
    """
    stage, ring, pinion = tooth_system("3 mm"), gear(24, 0.5), gear(16)
    assert gear_geometry.working_involute(stage, ring, pinion, -1) == pytest.approx(0.060401, abs=1e-6)
    assert working_angle(stage, ring, pinion, -1) == pytest.approx(31.0937, abs=1e-4)
    assert 1e3 * standard_centre_distance(stage, ring, pinion, -1) == pytest.approx(13.1683, abs=1e-4)


def test_the_rig_s_hsp_runs_at_408_mm():
    """READING.md: 402 mm sun-planet and 408 mm planet-ring without shift; 0.53 brings sun-planet to 408 mm."""
    stage = tooth_system("12 mm")
    assert standard_centre_distance(stage, gear(17), gear(50), 1) == pytest.approx(0.402, rel=1e-12)
    assert standard_centre_distance(stage, gear(118), gear(50), -1) == pytest.approx(0.408, rel=1e-12)
    shifted = standard_centre_distance(stage, gear(17, 0.31), gear(50, 0.22), 1)
    assert shifted == pytest.approx(0.408, abs=1e-4)
    assert standard_centre_distance(stage, gear(118, 0.22), gear(50, 0.22), -1) == pytest.approx(0.408, rel=1e-12)


def test_shifts_that_cancel_leave_the_standard_distance():
    stage = tooth_system("5 mm", helix_angle="12 deg")
    module, _ = gear_geometry.transverse(stage)
    assert standard_centre_distance(stage, gear(20, 0.3), gear(40, -0.3), 1) == pytest.approx(30 * module, rel=1e-12)


@pytest.mark.parametrize(("z1", "z2", "cut"), [(20, 40, False), (12, 40, True), (3, 3, True), (17, 17, False)])
def test_interference_of_external_pairs(z1, z2, cut):
    """A 20 deg rack undercuts below 17.1 teeth; 17 teeth clear up to 1309 (Shigley, interference)."""
    stage = tooth_system()
    distance = standard_centre_distance(stage, gear(z1), gear(z2), 1)
    assert gear_geometry.interference(stage, gear(z1), gear(z2), 1, distance) is cut


def test_interference_of_internal_pairs():
    stage = tooth_system()
    for z_ring, z_planet, cut in [(118, 48, False), (40, 14, True)]:
        distance = standard_centre_distance(stage, gear(z_ring), gear(z_planet), -1)
        assert gear_geometry.interference(stage, gear(z_ring), gear(z_planet), -1, distance) is cut


def test_transverse_angle_is_that_of_the_paper_s_psh():
    assert gear_geometry.transverse(tooth_system("9 mm", helix_angle="8 deg"))[1] == pytest.approx(
        atan(tan(radians(20)) / cos(radians(8))), rel=1e-15
    )
