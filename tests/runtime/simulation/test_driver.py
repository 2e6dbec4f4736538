"""The march in C at its edges: engines that are broken into, samples that nobody takes, runs side by side."""

import re
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from ltcgear.runtime.model.cstruct import FAULTS, source
from ltcgear.runtime.model.load_tables import Signals
from ltcgear.runtime.simulation.driver import CAPACITY, March
from ltcgear.runtime.simulation.run_settings import RunSettings
from ltcgear.runtime.simulation.smooth_arc import Arc

from ..models import case

RATE = 1e5


def march_of(c, method, samples=5000):
    return March(c.point, RunSettings(samples / RATE, RATE, method, 1e-6), Signals((), {}))


def test_faults_have_the_numbers_of_the_c():
    names = re.search(r"enum \{([^}]*)\}", source())[1].split(",")
    assert [name.strip() for name in names] == [
        "DONE", "NOT_FINITE", "TOO_SMALL", "TOO_MANY", "TOGETHER", "NOT_LOCATED", "BESIDE", "UNBOUNDED", "STOPPED",
    ]  # fmt: skip
    assert len(FAULTS) == len(names)


def test_what_breaks_into_an_engine_is_raised_and_the_march_stays_where_it_was():
    march = march_of(case("psh"), "cvodes")
    march.proceed(segments=3)
    before, real = march.time, march.stepper.advance
    march.stepper.advance = lambda *given: (_ for _ in ()).throw(KeyboardInterrupt)
    with pytest.raises(KeyboardInterrupt):
        march.proceed(segments=1)
    assert march.time == before
    march.stepper.advance = real
    march.proceed(segments=1)
    assert march.time > before


def test_what_breaks_in_before_an_engine_begins_ends_the_march_too(monkeypatch):
    march = march_of(case("psh"), "cvodes")
    march.proceed(segments=3)
    before, lost = march.time, []

    def break_in(duration):
        raise KeyboardInterrupt

    monkeypatch.setattr(sys, "unraisablehook", lost.append)
    march.native.call_back(break_in)
    with pytest.raises(KeyboardInterrupt):
        march.proceed(segments=1)
    assert len(lost) == 1
    assert march.time == before


def test_samples_that_nobody_takes_stop_the_march():
    march = march_of(case("psh"), "erk")
    for _ in range(100):
        march.proceed(segments=1)
    assert 0 < march.state.filled <= CAPACITY
    times = march.native.arrays["sample_time"][: march.state.filled]
    assert times == pytest.approx(np.arange(1, march.state.filled + 1) / RATE, rel=1e-15)
    reached, march.state.filled = march.time, 0
    march.proceed(segments=1)
    assert march.time > reached


@pytest.mark.parametrize("method", ["erk", "cvodes"])
def test_runs_in_two_threads_are_those_of_one(method):
    c = case("psh")
    alone = c.run(method=method, t_end=0.05)
    with ThreadPoolExecutor(2) as pool:
        both = [future.result() for future in [pool.submit(c.run, method=method, t_end=0.05) for _ in range(2)]]
    for path in both:
        assert path.status == "done"
        assert np.array_equal(path.x, alone.x)
        assert path.counts == alone.counts


def test_an_arc_that_is_aimed_at_a_border_ends_with_the_run_at_the_latest():
    """An engine that first lets the teeth part shortly before the end, and when looked at again shortly after it."""
    c = case("hard-bounce")
    march = March(c.point, RunSettings(10 / 1e6, 1e6, "cvodes", 1e-6), Signals((), {}))
    end, start = march.state.end, c.at.x
    (gear,) = np.flatnonzero(start)
    parting = iter([0.97 * end])

    def advance(z, duration, origin, s, slope):
        speed = -start[gear] / next(parting, 1.05 * end)
        x = np.tile(start, (len(march.nodes.points), 1))
        x[:, gear] += speed * duration * march.nodes.points
        x[:, c.state(c.library.manifest.states[gear].name + ".rate")] = speed
        return Arc(duration, (x - origin) / march.frame.scale, np.zeros(len(x)))

    march.stepper.advance = advance
    march.proceed(segments=1)
    assert march.counts.segments > 2
    assert march.time == end
    assert march.counts.regimes == 0


def test_a_border_that_is_grazed_is_crossed_where_the_motion_crosses_it():
    """Read at 65 points, the distance seems to be negative at a dip that only comes near, before one that is."""
    c = case("psh", 'effects.mesh_stiffness = "mean"', 'effects.contact = "backlash"',
             'stages.psh.mesh.backlash = "0.1 mm"')  # fmt: skip
    march = march_of(c, "rosenbrock")
    state, s = c.state("psh.output.u"), np.zeros(0)
    which = list(c.library.manifest.holds).index("hold.psh.mesh")

    def distance(z):
        return march.regimes.seen(march.frame.origin + march.frame.scale * z, s)[which]

    unit = np.eye(len(march.z))[state]
    rest, slope = distance(0 * unit), distance(unit) - distance(0 * unit)
    parts = np.linspace(0, 1, 2001)

    def wanted(part):
        return 1.0001 + np.polynomial.chebyshev.Chebyshev.basis(16)(2 * part - 1) - 0.1 * part**8

    below = parts[wanted(parts) < 0]
    assert 0.55 < below[0] < 0.65
    whole = march.state.shortest = march.state.longest  # so that its nodes are taken as they are

    def advance(z, duration, origin, s, slopes):
        times = duration * march.nodes.points
        path = np.zeros((len(times), len(z)))
        path[:, state] = rest / slope * (wanted(times / whole) / wanted(0.0) - 1)
        return Arc(duration, path, np.zeros(len(times)))

    march.stepper.advance = advance
    march.proceed(segments=1)
    assert march.counts.segments == 2
    assert march.time == pytest.approx(below[0] * whole, rel=2e-3)
