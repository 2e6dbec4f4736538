"""Hard cases of contact and friction: every case with every method, and the closed forms they are judged by."""

from functools import cache
from math import pi

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.model.building import build
from ltcgear.runtime.studies.selftest import contact_cases, dead_band, friction_cases, pair
from ltcgear.runtime.studies.selftest.case import Bench
from ltcgear.runtime.studies.selftest.impact import Impact
from ltcgear.runtime.studies.selftest.pair import TorsionalPair
from ltcgear.runtime.studies.selftest.planets import RubbingPlanets
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.scene.load import load_scene
from scipy.integrate import solve_ivp

CASES = {case.name: case for case in (*contact_cases.CASES, *friction_cases.CASES)}
PAIR = TorsionalPair(0.8, 2e8, 0.07, 100.0, 0.0)


@cache
def made(name, changes):
    model = build_model(load_scene(name, dict(changes)))
    return Bench(build(obtain(model)), model.values(), model.tables)


def opened(name, changes):
    return made(name, tuple(sorted(changes.items())))


def wrong(name, method, long=False):
    """What a case finds above its limits, or why it is refused, as text."""
    try:
        found = list(CASES[name].check(opened, method, long))
    except LtcgearError as error:
        return [str(error)]
    assert found
    return [f"{item.what}: {item.value:.2e}, {item.limit:.2e} at most" for item in found if not item.right]


@pytest.mark.parametrize("name", ["bounce", "grazing", "impact", "zero-gap", "reversal"])
def test_a_loose_tolerance_is_found_wrong(name, monkeypatch):
    monkeypatch.setattr(contact_cases, "RTOL", 1e-2)
    assert wrong(name, "erk")


@pytest.mark.parametrize(
    ("name", "key", "factor"),
    [
        ("bounce", "pair.output.inertia", 1.001),
        ("impact", "pair.mesh.damping", 1.001),
        ("dead-band", "pair.mesh.transmission_error_cos_1", 1.02),
        ("dead-band-steps", "couplings.damper.damping", 1.01),
        ("flanks", "pair.mesh.base_radius_2", 1.001),
        ("friction-stop", "gear.pin.friction", 1.001),
        ("friction-standstill", "gear.pin.diameter", 1.001),
        ("friction-turn", "gear.sun_planet.friction.coefficient", -1.0),
        ("friction-nothing", "gear.pin.friction_load", 0.0),
        ("rattle", "contact.pull", 0.1),
        ("grazing", "pair.mesh.stiffness", 1.0001),
        ("zero-gap", "pair.mesh.backlash", 1e-9),
        ("reversal", "contact.pull", 0.1),
    ],
)
def test_another_number_in_the_model_is_found_wrong(name, key, factor, monkeypatch):
    """The model runs with a number that the closed form does not know."""
    vector = Bench.p.func

    def changed(bench):
        p = vector(bench).copy()
        names = [known for known, _ in bench.library.manifest.parameters]
        if key in names:
            p[names.index(key)] = p[names.index(key)] * factor or factor
        return p

    monkeypatch.setattr(Bench, "p", property(changed))
    made.cache_clear()
    assert wrong(name, "rosenbrock")
    made.cache_clear()


# --- closed forms


def fallen(right, start, end, times):
    """Integrate by brute force."""
    done = solve_ivp(right, (0.0, end), start, "DOP853", times, rtol=1e-10, atol=1e-16, max_step=2e-6)
    return done.y


def test_bounces_are_those_of_a_one_sided_spring():
    size, end = 4 * PAIR.static, 2.5 * contact_cases.bounce_period(PAIR, 4 * PAIR.static)
    times = np.linspace(0, end, 300)

    def right(t, y):
        return [y[1], (PAIR.torque / PAIR.r - PAIR.k * max(y[0], 0.0)) / PAIR.m]

    x, _ = fallen(right, [PAIR.static, size * PAIR.omega], end, times)
    assert contact_cases.bounce(PAIR, size, times) == pytest.approx(x, abs=1e-6 * size)


def test_an_impact_is_that_of_a_damper_that_never_pulls():
    damped = TorsionalPair(0.8, 2e8, 0.07, 100.0, 2e3)
    impact = Impact(damped, 10 * damped.static * damped.omega)
    end = 2 * impact.end
    times = np.linspace(0, end, 300)

    def force(x, v):
        return max(damped.k * x + damped.c * v, 0.0) if x > 0 else 0.0

    def right(t, y):
        return [y[1], (damped.torque / damped.r - force(*y)) / damped.m]

    x, v = fallen(right, [1e-15, impact.v], end, times)
    found = impact.motion(times)
    assert found[0] == pytest.approx(x, abs=1e-6 * x.max())
    assert found[1] == pytest.approx(v, abs=1e-6 * impact.v)
    assert found[2][1:] == pytest.approx([force(*y) for y in zip(x[1:], v[1:], strict=True)], abs=1e-5 * found[2].max())
    assert impact.motion(np.array([impact.end]))[0] > 0.1 * impact.touching(impact.end / 2)[0]


def test_landings_are_read_off_a_flight():
    time = np.linspace(0.0, 1.0, 12)
    fall = PAIR.static * PAIR.omega**2
    depth, speed = fall * (time**2 - 0.7**2) / 2, fall * time
    assert contact_cases.landings(PAIR, time, depth, speed) == pytest.approx([0.7], rel=1e-12)


def test_rubbing_planets_obey_coulomb_between_two_limits():
    train = RubbingPlanets((0.0, 0.0, 6e-4), (0.04, 0.12, 0.04), (300.0, 900.0), 1e-3, 1e-6, 0.0)
    load = 2 * 300.0 / 3 / 0.04 * np.cos(20 * pi / 180)
    assert train.gain(1.0) == pytest.approx(-load * 1e-3 / 6e-4, rel=1e-12)
    assert train.stopping_angle(50.0) == pytest.approx(50.0**2 / 2 / (load * 1e-3 / 6e-4), rel=1e-9)
    # The torque that is to overcome friction presses on the bearings too.
    more = 3 * load * 1e-3
    assert train.limit() == pytest.approx(300.0 + more / (1 - more / 600.0), rel=1e-5)


def test_the_small_amplitude_is_that_of_a_linear_oscillator():
    scene = dead_band.DeadBand(opened("hard-dead-band", {}))
    assert (scene.force, scene.error, scene.zeta) == pytest.approx((0.1, 0.05, 0.05), rel=1e-5)
    assert dead_band.small_amplitude(scene, 1e3) == pytest.approx(0.05, rel=1e-5)
    assert dead_band.small_amplitude(scene, 1.0) == pytest.approx(0.05 / 0.1 * np.sqrt(1.01), rel=1e-4)


def test_a_start_is_the_equilibrium_but_for_what_is_given():
    bench = opened("hard-bounce", {})
    at = pair.started(bench, pair_output_u_rate=3.0)
    assert at.x.tolist() == [*bench.at.x[:2], 3.0]
    assert bench.at.x[2] == 0.0
