"""Smooth segments of a motion, and the scaling in which they are integrated."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Frame:
    """The affine scaling x = x_ref + S z, shapes (n,)."""

    origin: Vector
    scale: Vector


@dataclass(frozen=True)
class Arc:
    """A piece of smooth motion: its duration [s], z and the work done on the system [J] at its nodes.

    Shapes (nodes, n) and (nodes,), the start included. An engine that finds switchings itself may end
    before the time it was asked for.
    """

    duration: float
    z: Vector
    work: Vector
