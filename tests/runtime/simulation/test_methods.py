"""All methods side by side: the exact solution at tight tolerance, switchings in both directions, refusals."""

from types import SimpleNamespace

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.model.load_tables import Signals
from ltcgear.runtime.simulation.contact_events import EventFunctions
from ltcgear.runtime.simulation.driver import LONGEST, March
from ltcgear.runtime.simulation.methods import registry
from ltcgear.runtime.simulation.methods.registry import METHODS
from ltcgear.runtime.simulation.methods.stepper import SegmentProblem
from ltcgear.runtime.simulation.methods.sundials7 import STENCIL, SundaeStepper, interpolate
from ltcgear.runtime.simulation.run_settings import RunSettings, check_options
from ltcgear.runtime.simulation.smooth_arc import Frame
from ltcgear.runtime.simulation.trajectory import Counts
from ltcgear.runtime.studies.accuracy.reference import reference_methods

from .. import exact
from ..models import case

BACK = {"lsp": 'loads.ring.speed = "-15 rpm"'}
IN_PHASE = ("lsp", "stages.lsp.sun.teeth = 24", "stages.lsp.ring.teeth = 120")
"""Four planets whose meshes switch at one instant: sun and ring have multiples of four teeth."""


@pytest.mark.parametrize("method", METHODS)
def test_the_exact_solution_is_met_to_1e8(method):
    c = case("psh", *exact.SETTINGS)
    train = exact.Train(c.scene)
    path = c.run(method=method, rtol=1e-12, t_end=0.02)
    wanted = train.solve(path.time)
    given = path.x[:, [c.state(name) for name in (*exact.FREE, *(f"{name}.rate" for name in exact.FREE))]]
    assert path.status == "done"
    assert path.counts.events == path.expected_events == 25
    assert (np.abs(given - wanted).max(axis=0) / np.ptp(wanted, axis=0)).max() < 1e-8


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("method", ["adams", "sundae"])
def test_planets_in_phase_switch_together(method, way):
    c = case(*IN_PHASE, *((BACK["lsp"],) if way < 0 else ()))
    path = c.run(method=method, rtol=1e-5, t_end=0.2)
    jumps = np.abs(np.diff(path.levels, axis=0))
    for label in ("sun_planet", "ring_planet"):
        of = [i for i, mesh in enumerate(c.library.manifest.levels) if label in mesh]
        assert len(of) == 4
        assert (jumps[:, of] == jumps[:, of[:1]]).all()
        assert jumps[:, of].sum() > 40
    assert path.status == "done"
    assert path.counts.events == path.expected_events


def test_sundae_finds_the_switchings_by_itself(monkeypatch):
    # Told nothing but the longest segment, it ends its arcs at the instants of kinematics.
    c = case("psh", *exact.SETTINGS)
    told = []
    real = SundaeStepper.advance

    def noted(self, z, duration, *rest):
        arc = real(self, z, duration, *rest)
        told.append((duration, arc.duration))
        return arc

    monkeypatch.setattr(SundaeStepper, "advance", noted)
    path = c.run(method="sundae", rtol=1e-8, t_end=0.02)
    ends = np.cumsum([found for _, found in told])
    wanted = exact.Train(c.scene).switchings(0.02)[0]
    wanted = wanted[(wanted > 1e-9) & (wanted < 0.02)]
    nearest = np.abs(ends[:, None] - wanted).min(axis=0)
    assert len(wanted) == path.counts.events == 25
    assert nearest.max() < 1e-12
    assert sum(found < asked for asked, found in told) >= 25


def test_sundae_goes_on_past_samples_and_restarts_at_switchings_only():
    c = case("lsp")
    march = March(c.point, RunSettings(819 / 8192.0, 8192.0, "sundae", 1e-6), Signals((), {}))
    restarts, real = [], march.stepper._restart
    march.stepper._restart = lambda *given: (restarts.append(march.time), real(*given))
    instants = set()
    while march.state.done <= march.state.last:
        before = march.counts.events
        march.proceed(segments=1)
        march.state.filled = 0
        if march.counts.events > before:
            instants.add(march.time)
    assert march.counts.segments > len(instants)
    assert len(restarts) <= len(instants) + 1
    assert set(restarts[1:]) <= instants


def test_values_between_steps_are_those_of_a_polynomial():
    times = np.array([0.0, 1e-6, 1e-3, 0.02, 0.1, 0.3, 0.6, 0.9])
    wanted = np.linspace(0, 0.9, 57)
    power = np.arange(STENCIL)
    read = interpolate(times, times[:, None] ** power, wanted)
    assert np.abs(read - wanted[:, None] ** power).max() < 1e-10  # rounding, where points lie close


def test_a_method_whose_package_is_missing_is_refused(monkeypatch):
    monkeypatch.setattr(registry, "find_spec", lambda name: None)
    check_options("erk", 1e-6)
    with pytest.raises(LtcgearError, match=r"pip install 'ltcgear\[sundae\]'") as refused:
        check_options("sundae", 1e-6)
    assert refused.value.exit_code == 2


def test_segments_grow_where_the_fastest_mode_rests():
    stiff = case("lsp", 'stages.lsp.ring.bearing.stiffness = "2.6e15 N/m"')
    path = stiff.run(method="rosenbrock", rtol=1e-4, t_end=0.05)
    fine = stiff.run(method="rosenbrock", rtol=1e-6, t_end=0.05)
    # 8 rad of the fastest mode, 1e6 rad/s, would make 6250 segments.
    assert path.counts.segments < 500
    assert path.status == "done"
    forces, better = stiff.mesh_forces(path), stiff.mesh_forces(fine)
    assert (np.abs(forces - better).max(axis=0) / better.std(axis=0)).max() < 3e-3


def test_a_segment_that_its_nodes_do_not_resolve_is_integrated_again():
    c = case("lsp", 'stages.lsp.ring.bearing.stiffness = "2.6e15 N/m"')
    march = March(c.point, RunSettings(819 / 8192.0, 8192.0, "erk", 1e-6), Signals((), {}))
    resolving = march.state.longest
    march.state.longest = LONGEST * resolving
    march.proceed(segments=1)
    duration, path = march.state.reached, march.native.arrays["path"]
    left_out = np.abs(march.nodes.last_terms @ path).max(axis=0) / np.maximum(np.abs(path).max(axis=0), 1.0)
    assert resolving <= duration < 60 * resolving
    assert left_out.max() <= 1e-6


def test_every_integrator_is_one_record_that_makes_its_stepper():
    c = case("psh")
    frame, events = (
        Frame(c.at.x, np.ones(len(c.at.x))),
        EventFunctions(SimpleNamespace(index=()), None, c.p, np.zeros(0)),
    )
    problem = SegmentProblem(c.library, c.p, 1e-6, frame, np.array([1.0]), events)
    for name, method in METHODS.items():
        made = method.make(problem)
        assert method.name == name
        assert (made is None) == method.in_march
        assert made is None or (made.counts == Counts() and made.last == 0.0)
    assert reference_methods() == ["erk", "rosenbrock", "cvodes", "idas", "adams"]
