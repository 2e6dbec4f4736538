"""Mesh levels as discrete states: single or double contact, by the mesh phase (eqs 9-11).

A phase tau is in cell 2 n while n <= tau < n + share (single contact, level 0) and in cell 2 n + 1
until n + 1 (double contact, level 1). Cells are whole numbers, so no switching is lost or doubled.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Cells = NDArray[np.int64]


AT_BORDER = 1e-9
"""Distance [cycles] from a switching point that counts as being on it."""


@dataclass(frozen=True)
class Phases:
    """Mesh phases at one instant: tau [cycles], rate [1/s], share of single contact."""

    tau: Vector
    rate: Vector
    share: Vector


def at_border(phases: Phases) -> Vector:
    """Return the distance [cycles] from a switching point that counts as on it: a billionth of a pitch, or rounding."""
    return np.asarray(AT_BORDER + 16 * np.finfo(float).eps * np.abs(phases.tau))


def cells_of(phases: Phases) -> Cells:
    """Return each phase's cell; at a switching point, the cell it is entering."""
    near = at_border(phases)
    whole = np.floor(phases.tau + near)
    part = phases.tau - whole
    cells = (2 * whole + (part >= phases.share - near)).astype(np.int64)
    leaving = (phases.rate < 0) & (np.abs(phases.tau - lower(cells, phases.share)) <= near)
    return np.asarray(cells - leaving)


def levels_of(cells: Cells) -> Vector:
    """Return the levels: 0 in single contact, 1 in double contact."""
    return np.asarray(cells % 2, dtype=np.float64)


def lower(cells: Cells, share: Vector) -> Vector:
    """Return the lower bound of cells [cycles]."""
    return np.asarray(cells // 2 + cells % 2 * share)


def upper(cells: Cells, share: Vector) -> Vector:
    """Return the upper bound of cells [cycles]."""
    return lower(cells + 1, share)


def expected_switchings(now: Phases, cells: Cells, since: Cells, free: bool) -> int:
    """Return the switchings from some cells on, by kinematics.

    At a switching point the cells of the integration count if the train is at rest or may reverse (``free``), whether
    or not it has left its last cell.
    """
    beside = np.minimum(np.abs(now.tau - lower(cells, now.share)), np.abs(now.tau - upper(cells, now.share)))
    kept = ((now.rate == 0) | free) & (beside <= at_border(now))
    return int(np.abs(np.where(kept, cells, cells_of(now)) - since).sum())
