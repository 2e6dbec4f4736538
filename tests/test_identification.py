"""Identification: a twin whose numbers are known, derivatives against differences, and what is held before."""

from math import log

import numpy as np
import pytest
from benchmarks.identification.fitting import _Search, fit, spread_of
from benchmarks.identification.forecast import Forecast, Span, Target
from benchmarks.identification.posterior import Posterior
from benchmarks.identification.rig import combinations, rig_choices, rig_targets, rig_unknowns
from benchmarks.identification.screening import screen, spread_points
from benchmarks.identification.unknowns import Unknown, bounds_of, changes_of, read_unknowns
from ltcgear.generated.errors import LtcgearError
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.scene.load import load_scene

from .runtime.models import case

SPAN = Span(0.05, 0.02, 1e-8)
DAMPING = Unknown("mesh damping", ("stages.psh.mesh.damping_ratio",), "", 0.05, 0.01, 0.17, "a test")
WIDTH = Unknown("width", ("stages.psh.input.disc.width",), "mm", 200.0, 100.0, 320.0, "a test")
BEARING = Unknown("bearing", ("stages.psh.input.bearing.stiffness",), "N/m", 7.06e9, 2e9, 1.5e10, "a test")
PHASE = Unknown("phase", ("stages.psh.mesh.phase",), "", 0.1, -0.4, 0.6, "a test", logarithmic=False)
TORQUE = Unknown("torque", ("loads.output.torque",), "N*m", -1.06e4, -1.5e4, -0.5e4, "a test", logarithmic=False)
OUTPUTS = (
    ("mesh_force:psh.mesh", "load-factor"), ("mesh_force:psh.mesh", "vibration"), ("bearing_force_x:psh.input", "max"),
    ("bearing_force_y:psh.input", "min"),
)  # fmt: skip


def psh(z, unknowns):
    """The parameters of the parallel stage at a point."""
    return case("psh").library.parameters(build_model(load_scene("psh", changes_of(unknowns, np.array(z)))).values())


def twin(z, unknowns, sigma=1e-4):
    """Targets that the model itself shows at a point, each known to a part."""
    blank = [Target(f"{output} {measure}", output, measure, 0.0, 1.0) for output, measure in OUTPUTS]
    shown = Forecast(case("psh").library, psh(z, unknowns), blank, SPAN).values()
    return [
        Target(t.name, t.output, t.measure, float(y), abs(float(y)) * sigma) for t, y in zip(blank, shown, strict=True)
    ]


def known(found, targets):
    """What is known at the end of a fit."""
    residuals = np.array([(y - target.value) / target.sigma for y, target in zip(found.forecast, targets, strict=True)])
    return Posterior(found.z, residuals, found.jacobian)


def test_a_twin_gives_its_numbers_back():
    unknowns = [DAMPING, WIDTH, BEARING]
    truth = np.array([0.8, -0.5, 0.4])
    targets = twin(truth, unknowns)
    found = fit(case("psh").library, lambda z: psh(z, unknowns), unknowns, targets, SPAN)
    assert found.misfit < 1.0
    assert found.z == pytest.approx(truth, abs=0.02)
    assert (known(found, targets).narrowing < 0.05).all()
    assert known(found, targets).determined == pytest.approx(3.0, abs=0.01)
    assert found.forecast == pytest.approx([target.value for target in targets], rel=1e-3)


def test_a_number_that_nothing_speaks_of_stays_where_it_was():
    idle = Unknown("bore of the output gear", ("stages.psh.output.disc.inner_diameter",), "mm", 20.0, 1.0, 60.0, "test")
    unknowns = [DAMPING, idle]
    targets = twin([0.5, 0.0], unknowns, sigma=0.5)[:1]
    found = fit(case("psh").library, lambda z: psh(z, unknowns), unknowns, targets, SPAN)
    assert known(found, targets).narrowing[1] > 0.95
    assert abs(found.z[1]) < 0.1
    assert known(found, targets).determined < 1.0


def test_derivatives_of_residuals_are_those_of_differences():
    """Through the run (adjoint, peaks on jumps and between), the equilibrium, and the building of the model."""
    unknowns = [DAMPING, WIDTH, BEARING, PHASE, TORQUE]
    search = _Search(case("psh").library, lambda z: psh(z, unknowns), unknowns, twin([0.5] * 5, unknowns), SPAN, print)
    z = np.array([0.2, -0.1, 0.3, 0.15, -0.2])
    slopes = search.jacobian(z)
    h = 2e-4
    expected = np.array(
        [(search.residuals(z + step) - search.residuals(z - step)) / (2 * h) for step in np.eye(len(z)) * h]
    ).T
    assert slopes == pytest.approx(expected, rel=2e-4, abs=1e-4 * np.abs(expected).max())
    # Forces go with the torque, their ratio to the static one does not (but for what teeth give way).
    assert abs(slopes[0, 4]) < 0.02 * abs(slopes[1, 4])


def test_a_fit_tells_of_teeth_that_pull():
    """With the load turned round against the flank that the scene's load chose."""
    library, blank = case("psh").library, [Target("force", "mesh_force:psh.mesh", "mean", 0.0, 1.0)]
    load = [name for name, _ in library.manifest.parameters].index("loads.output.torque")

    def turned(z):
        p = psh(z, [DAMPING])
        p[load] *= -1
        return p

    assert Forecast(library, psh([0.0], [DAMPING]), blank, SPAN).warnings() == ()
    found = fit(library, turned, [DAMPING], blank, SPAN, most=1)
    assert found.forecast[0] < 0
    [text] = found.warnings
    assert text.startswith("psh.mesh: pulls with up to 1")


def test_spreads_of_numbers_that_follow():
    """Two unknowns of which one sum is known: the sum is sharp after the fit, the difference as vague as before."""
    jacobian = np.array([[30.0, 30.0]])
    assert spread_of(np.array([1.0, 1.0]), jacobian) == pytest.approx((np.sqrt(2), np.sqrt(2 / 1801)))
    assert spread_of(np.array([1.0, -1.0]), jacobian) == pytest.approx((np.sqrt(2), np.sqrt(2)))


def test_bounds_hold():
    unknowns = [Unknown("width", WIDTH.keys, "mm", 200.0, 195.0, 205.0, "a test")]
    found = fit(case("psh").library, lambda z: psh(z, unknowns), unknowns, twin([0.0], unknowns)[:1], SPAN)
    low, high = bounds_of(unknowns)
    assert ((low <= found.z) & (found.z <= high)).all()
    found = fit(case("psh").library, lambda z: psh(z, unknowns), unknowns, twin([6.0], unknowns), SPAN)
    assert found.z == pytest.approx(high, abs=1e-2)  # what explains the targets best lies beyond


def test_places_and_values_are_inverse_and_bounds_lie_two_sigmas_off():
    for unknown in (DAMPING, PHASE):
        for z in (-1.3, 0.0, 0.7):
            assert unknown.place(unknown.value(z)) == pytest.approx(z, abs=1e-12)
        assert max(map(abs, (unknown.place(unknown.low), unknown.place(unknown.high)))) == pytest.approx(2.0)
    assert DAMPING.width == pytest.approx(log(0.05 / 0.01) / 2)
    assert changes_of([WIDTH], np.zeros(1)) == {"stages.psh.input.disc.width": "200 mm"}


def test_points_are_spread_as_what_is_held_before_and_ranked():
    unknowns = [DAMPING, WIDTH, BEARING]
    points = spread_points(unknowns, 256, 1)
    low, high = bounds_of(unknowns)
    assert ((low <= points) & (points <= high)).all()
    assert np.abs(points.mean(axis=0)).max() < 0.1
    assert points.std(axis=0) == pytest.approx(0.93, abs=0.08)  # of a normal distribution cut at its bounds
    ranked = screen(lambda z: z - 1.0, points)
    sums = [total for total, _ in ranked]
    assert sums == sorted(sums)
    assert np.linalg.norm(ranked[0][1] - 0.5) < 0.5


def test_the_rig_s_unknowns_start_at_the_scene_and_cover_all_it_assumes_of_damping():
    raw = load_scene("rig-2mw")
    plain = build_model(raw).values()
    unknowns = rig_unknowns()
    same = build_model(load_scene("rig-2mw", changes_of(unknowns, np.zeros(len(unknowns))))).values()
    assert same == pytest.approx(plain, rel=1e-9)
    keys = {key for unknown in unknowns for key in unknown.keys}
    damped = {
        key for key, source in raw.sources.items() if key.endswith("damping_ratio") and source.startswith("assumed")
    }
    assert damped <= keys
    assert combinations()[0] == {choice.key: choice.values[0] for choice in rig_choices()}
    assert build_model(load_scene("rig-2mw", combinations()[0])).values() == plain
    assert len(combinations()) == 32


def test_the_rig_s_targets_are_table_9():
    targets = rig_targets()
    assert [target.value for target in targets] == [1.118, 1.134, 1.373, 1.349, 1.268]
    assert all(0.10 * (t.value - 1) <= t.sigma <= 0.12 * (t.value - 1) for t in targets)


@pytest.mark.parametrize(
    ("table", "reason"),
    [
        ({"low": 0.2}, "must rise"),
        ({"low": -1.0}, "must rise"),
        ({"high": ...}, "give name, keys"),
        ({"colour": "red"}, "colour"),
    ],
)
def test_unknowns_that_make_no_sense_are_refused(table, reason):
    good = {"name": "x", "keys": ["a.b"], "unit": "", "start": 0.1, "low": 0.01, "high": 0.5, "source": "a test"}
    assert read_unknowns([good])[0].start == 0.1
    bad = {key: value for key, value in (good | table).items() if value is not ...}
    with pytest.raises(LtcgearError, match=reason):
        read_unknowns([bad])
