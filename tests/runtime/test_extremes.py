"""Extremes of mesh forces: those of a fine sampling, whatever the sampling rate, and of the run alone."""

import numpy as np
import pytest
from ltcgear.runtime.extremes import MeshExtremes
from ltcgear.runtime.kernel import over_time

from .models import case


def sampled_forces(found, path):
    """Return the mesh forces at the samples, shape (times, meshes)."""
    rows = [i for i, report in enumerate(found.library.manifest.reports) if report.quantity == "mesh_force"]
    return over_time(found.library.functions["outputs"], [path.x, path.levels, found.p])[:, rows]


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
    turned = np.array([0.0, 3.0, -1.0, 9.0]) * 1e-5  # before half, its peak, steady, beyond the end
    states = np.tile(found.at.x, (4, 1))
    states[:, found.state("psh.output.u")] += turned
    rows = [i for i, report in enumerate(found.library.manifest.reports) if report.quantity == "mesh_force"]
    force = over_time(found.library.functions["outputs"], [states, found.at.levels, found.p])[:, rows[0]]
    extremes = MeshExtremes(found.library, found.p, 4, end=1.0)
    extremes.note(states, found.at.levels, found.p, np.array([0.1, 0.4, 0.9, 1.1]))
    assert len(set(force)) == 4
    assert extremes.lowest[0] == pytest.approx(force[:3].min(), rel=1e-12)
    assert extremes.steady[:, 0] == pytest.approx(force[2], rel=1e-12)
    for sign in (1, -1):  # a peak inside a segment, upwards and downwards
        states[:, found.state("psh.output.u")] = found.at.x[found.state("psh.output.u")] + sign * turned
        extremes.note(states, found.at.levels, found.p, np.array([0.5, 0.6, 0.7, 2.0]))
        steady = over_time(found.library.functions["outputs"], [states[:3], found.at.levels, found.p])[:, rows[0]]
        peak = np.argmax(np.abs(steady - steady[0]))
        assert peak == 1
        assert steady[peak] == pytest.approx(extremes.steady[int(steady[peak] > steady[0]), 0], rel=1e-12)
