"""Quantities of hard cases: forces, scaled states, distance to the exact motion."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ...model.rows import over_time
from ...simulation.matrix_exponential import Exact
from ...simulation.trajectory import Trajectory
from .case import Bench, Finding

Vector = NDArray[np.float64]
TIGHTEST = 1e-12
"""The tolerance at which a method shows what it can do; below it, rounding adds up faster than steps shrink."""
EXACT = 1e-8
"""How near to the exact motion a method must come, over the standard deviation of what is compared."""


def outputs(bench: Bench, quantity: str, x: Vector, s: Vector) -> Vector:
    """Return one quantity of all its items at states of shape (times, n), shape (times, items)."""
    columns = [i for i, report in enumerate(bench.library.manifest.reports) if report.quantity == quantity]
    return over_time(bench.library, "outputs", x, s, bench.p)[:, columns]


def mesh_forces(bench: Bench, path: Trajectory) -> Vector:
    """Return all mesh forces of a run [N], shape (times, meshes)."""
    return outputs(bench, "mesh_force", path.x, path.s)


def off(found: Vector, wanted: Vector) -> float:
    """Return the largest difference of any column over the standard deviation of the one wanted."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return float((np.abs(found - wanted).max(axis=0) / wanted.std(axis=0)).max())


def against_exact(bench: Bench, exact: Exact, path: Trajectory, limit: float = EXACT) -> Iterator[Finding]:
    """Compare a run with the exact motion: jumps, levels at the samples, states, mesh forces."""
    x, levels = exact.solve(path.time)
    clear = exact.clear(path.time)
    yield Finding("jumps lost or doubled", abs(path.counts.events - exact.switchings(path.end)), 0)
    yield Finding("samples in the wrong contact", int((path.levels != levels)[clear].any(axis=1).sum()), 0)
    moving = x.std(axis=0) > 0
    yield Finding("states, off over std", off(path.x[:, moving], x[:, moving]), limit)
    if clear.any():
        forces, wanted = mesh_forces(bench, path), outputs(bench, "mesh_force", x, levels)
        yield Finding("mesh forces, off over std", off(forces[clear], wanted[clear]), limit)
