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
"""How close to a border [cycles] counts as being there."""


@dataclass(frozen=True)
class Phases:
    """Mesh phases at one instant: tau [cycles], rate [1/s], share of single contact."""

    tau: Vector
    rate: Vector
    share: Vector


def at_border(phases: Phases) -> Vector:
    """Return how close to a border [cycles] counts as being there: a billionth of a pitch, or rounding."""
    return np.asarray(AT_BORDER + 16 * np.finfo(float).eps * np.abs(phases.tau))


def cells_of(phases: Phases) -> Cells:
    """Return each phase's cell; at a border, the cell it is entering."""
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
    """Return the lower border of cells [cycles]."""
    return np.asarray(cells // 2 + np.where(cells % 2 == 1, share, 0.0))


def upper(cells: Cells, share: Vector) -> Vector:
    """Return the upper border of cells [cycles]."""
    return lower(cells + 1, share)


def time_to_border(cells: Cells, phases: Phases, gain: Vector | float = 0.0) -> float:
    """Return the time [s] to the next border; infinite where none is reached.

    The rates change by ``gain`` [1/s^2]. Borders are looked for in the present direction, from a standstill
    in that of the gain: what turns back on its way is to be looked at again from where it turns.
    """
    towards = np.where(phases.rate != 0, np.sign(phases.rate), np.sign(gain))
    ahead = towards * (np.where(towards > 0, upper(cells, phases.share), lower(cells, phases.share)) - phases.tau)
    rate = towards * phases.rate
    square = rate**2 + 2 * towards * gain * ahead
    reached = (towards != 0) & (square >= 0)
    if not reached.any():
        return float("inf")
    return max(float((2 * ahead[reached] / (rate[reached] + np.sqrt(square[reached]))).min()), 0.0)


def crossed(cells: Cells, before: Phases, after: Phases) -> tuple[Cells, float]:
    """Return the cells after a step, and the part of the step in which the first border is reached.

    The part is 1 unless a phase has gone beyond its border, by linear interpolation then. All phases
    that stand at a border together (planets in phase) switch together.
    """
    near = at_border(after)
    top, bottom = upper(cells, after.share), lower(cells, after.share)
    step = ((after.tau >= top - near) & (after.rate > 0)).astype(np.int64)
    step -= ((after.tau <= bottom + near) & (after.rate < 0)).astype(np.int64)
    beyond = (after.tau > top + near) | (after.tau < bottom - near)
    if not beyond.any():
        return cells + step, 1.0
    border = np.where(after.tau > top, top, bottom)[beyond]
    start, end = before.tau[beyond], after.tau[beyond]
    return cells, float(np.clip((border - start) / (end - start), 0.01, 0.999999999).min())
