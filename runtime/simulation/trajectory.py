"""Trajectory of an integration: its samples, what they have cost, and how it went."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ..results.peaks import MeshExtremes

Vector = NDArray[np.float64]
Told = Callable[[float], None]


@dataclass
class Counts:
    """What a run has cost; added up over segments."""

    steps: int = 0
    rhs: int = 0
    jacobian: int = 0
    rejected: int = 0
    segments: int = 0
    events: int = 0
    regimes: int = 0


@dataclass(frozen=True)
class Block:
    """Samples that follow each other: times [s], states, levels, load signals, shapes (m,) and (m, ...).

    ``phi`` and ``turns`` are the reference angle [rad] less whole turns and these, ``steps`` the steps that the
    integrator had made, shapes (m,).
    """

    time: Vector
    x: Vector
    levels: Vector
    signals: Vector
    phi: Vector
    turns: NDArray[np.int64]
    steps: Vector

    @property
    def s(self) -> Vector:
        """Return levels and signals, the functions' second argument, shape (m, l + k)."""
        return np.hstack([self.levels, self.signals])


@dataclass(frozen=True)
class Points:
    """Successive points of the motion and their quadrature weights [s]: see ``model/c/points.c``.

    What is not listed is that of a ``Block``.

    Attributes
    ----------
    weight
        Shape (m,); sums over it are integrals over time.
    x
        States, the reference angle less whole turns, shape (m, n).
    """

    time: Vector
    weight: Vector
    x: Vector
    levels: Vector
    signals: Vector
    turns: NDArray[np.int64]

    @property
    def s(self) -> Vector:
        """Return levels and signals, the functions' second argument, shape (m, l + k)."""
        return np.hstack([self.levels, self.signals]) if self.signals.shape[1] else self.levels


Joined = TypeVar("Joined", Block, Points)


def join(blocks: list[Joined]) -> Joined:
    """Join what follows each other."""
    return type(blocks[0])(**{name: np.concatenate([vars(b)[name] for b in blocks]) for name in vars(blocks[0])})


@dataclass(frozen=True)
class Outcome:
    """How an integration went, up to its end or its failure.

    Attributes
    ----------
    work
        Work done on the system by loads and drives less losses [J].
    jump_energy
        Energy that the stiffness jumps put in [J].
    energy
        Kinetic and potential energy at the start and at the end [J].
    counts
        Steps, right-hand sides, Jacobians, segments, events.
    expected_events
        Number of switchings by kinematics, from the mesh phases at the start, where they turn back, and at the end.
    extremes
        Smallest and largest mesh forces.
    status
        ``done``, or why it stopped and what to do.
    end
        Time reached [s].
    last
        States, levels and load signals, and parameters there.
    seconds
        Time taken to set the integrator up (it may have to be compiled), to integrate and to read outputs [s].
    """

    work: float
    jump_energy: float
    energy: tuple[float, float]
    counts: Counts
    expected_events: int
    extremes: MeshExtremes
    status: str
    end: float
    last: tuple[Vector, Vector, Vector]
    seconds: dict[str, float]


@dataclass(frozen=True)
class Trajectory(Outcome, Block):
    """An integration with all its samples."""
