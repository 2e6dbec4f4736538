"""Extremes of mesh forces: those of a fine sampling, whatever the sampling rate, and of the run alone."""

import numpy as np
import pytest
from ltcgear.runtime.model.load_tables import Signals
from ltcgear.runtime.model.rows import over_time
from ltcgear.runtime.simulation.driver import March
from ltcgear.runtime.simulation.run_settings import RunSettings
from ltcgear.runtime.simulation.smooth_arc import Arc

from ..models import case


def sampled_forces(found, path):
    """Return the mesh forces at the samples, shape (times, meshes)."""
    rows = [i for i, report in enumerate(found.library.manifest.reports) if report.quantity == "mesh_force"]
    return over_time(found.library, "outputs", path.x, path.levels, found.p)[:, rows]


@pytest.mark.parametrize("method", ["erk", "cvodes"])
def test_extremes_are_those_of_a_fine_sampling(method):
    found = case("psh")
    fine = found.run(method=method, rtol=1e-7, t_end=0.1, rate=800_000)
    forces = sampled_forces(found, fine)
    late = forces[fine.time >= 0.05]
    coarse = found.run(method=method, rtol=1e-7, t_end=0.1, rate=4096).extremes
    swing = np.ptp(forces)
    assert coarse.steady[0] == pytest.approx(late.min(axis=0), abs=5e-3 * swing)
    assert coarse.steady[1] == pytest.approx(late.max(axis=0), abs=5e-3 * swing)
    assert coarse.lowest == pytest.approx(forces.min(axis=0), abs=5e-3 * swing)
    plain = sampled_forces(found, found.run(method=method, rtol=1e-7, t_end=0.1, rate=4096))
    assert np.ptp(plain) < 0.97 * swing  # what samples alone would have told


def test_every_node_counts_but_none_beyond_the_end():
    found = case("psh", 'effects.mesh_stiffness = "mean"')
    march = March(found.point, RunSettings(257 / 257.0, 257.0, "rosenbrock", 1e-6), Signals((), {}))
    state = found.state("psh.output.u")
    turned = {0.1: 1.0, 0.4: 3.0, 0.9: -1.0, 1.003: 9.0}  # before half, its peak, steady, beyond the end

    def advance(z, duration, origin, s, slope):
        times = march.time + duration * march.nodes.points
        path = np.zeros((len(times), len(z)))
        for time, turn in turned.items():
            if times[0] <= time <= times[-1]:
                path[np.searchsorted(times, time), state] = turn
        return Arc(duration, path, np.zeros(len(times)))

    march.stepper.advance = advance
    while march.time < 1.0:
        march.proceed(segments=1)
    states = np.tile(march.frame.origin, (5, 1))
    states[1:, state] += march.frame.scale[state] * np.array([*turned.values()])
    rows = [i for i, report in enumerate(found.library.manifest.reports) if report.quantity == "mesh_force"]
    force = over_time(found.library, "outputs", states, found.at.levels, found.p)[:, rows[0]]
    assert len(set(force)) == 5
    assert march.extremes.lowest[0] == pytest.approx(force[:4].min(), rel=1e-12)
    assert march.extremes.steady[:, 0] == pytest.approx(sorted(force[[0, 3]]), rel=1e-12)


def test_a_peak_between_steps_is_that_of_the_parabola():
    found = case("psh", 'effects.mesh_stiffness = "mean"')
    march = March(found.point, RunSettings(8 / 8.0, 8.0, "rosenbrock", 1e-6), Signals((), {}))
    state = found.state("psh.output.u")

    def advance(z, duration, origin, s, slope):
        times = duration * march.nodes.points
        path = np.zeros((len(times), len(z)))
        path[:, state] = (times - 0.8) * (times - 0.55)
        return Arc(duration, path, np.zeros(len(times)))

    march.stepper.advance = advance
    march.proceed(segments=1)
    states = np.tile(march.frame.origin, (2, 1))
    states[1, state] += march.frame.scale[state] * -(0.125**2)
    rows = [i for i, report in enumerate(found.library.manifest.reports) if report.quantity == "mesh_force"]
    force = over_time(found.library, "outputs", states, found.at.levels, found.p)[:, rows[0]]
    assert np.abs(march.extremes.steady[:, 0] - force[1]).min() < 1e-9 * np.ptp(force)
