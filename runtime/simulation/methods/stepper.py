"""Stepper: what integrates one segment of smooth motion, whichever library it comes from.

All integrate z with x = x_ref + S z, so that one relative tolerance refers to vibrations and not to how far a shaft
has turned.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...model.library import Library
from ..smooth_arc import Arc, Frame
from ..trajectory import Counts

Vector = NDArray[np.float64]
MOST_STEPS = 1_000_000
"""Steps in a segment above which an integrator gives up."""
CONSTANT = np.zeros(0)
"""Rates of the load signals of a model that has none."""


class Borders(Protocol):
    """Event functions: zero where the equations change.

    Attributes
    ----------
    count
        How many there are.
    """

    count: int

    def distances(self, x: Vector, s: Vector) -> Vector:
        """Return them for a state, levels and signals: positive before an event, zero at it, shape (count,)."""


@dataclass(frozen=True)
class SegmentProblem:
    """What a stepper is made for.

    Attributes
    ----------
    library, p
        Model and parameters.
    rtol
        Relative tolerance; the absolute one is the same times the scale of each state.
    frame
        Scaling.
    nodes
        Output times within a segment, in 0..1 with 1 last, shape (m,).
    events
        The event functions, for a stepper with root finding.
    """

    library: Library
    p: Vector
    rtol: float
    frame: Frame
    nodes: Vector
    events: Borders


class Stepper(Protocol):
    """Integrates one segment.

    One that ``finds_borders`` is not given the next switching instant, and ends its segment where it finds an event.

    Attributes
    ----------
    counts
        What it has cost so far.
    last
        First step of the next segment [s], its only state; 0 without state.
    """

    counts: Counts
    last: float
    finds_borders: bool

    def advance(self, z: Vector, duration: float, origin: Vector, s: Vector, slope: Vector = CONSTANT) -> Arc:
        """Return the motion from z on.

        ``s`` are levels and load signals at the segment's start, ``slope`` the signals' rates.
        """

    def renumber(self, p: Vector) -> None:
        """Continue with other parameters, shape (n_p,)."""
