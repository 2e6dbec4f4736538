"""Extremes of mesh forces between samples, at the integrator's own nodes, both sides of every jump included."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class MeshExtremes:
    """The smallest and largest mesh forces of a run.

    Samples miss peaks: a force jumps with its stiffness and then swings at frequencies that the sampling
    rate does not resolve. Segments end at the jumps; the steps of ``erk``, and the nodes of other methods, do
    resolve the fastest mode. Where nothing switches the latter are samples, and add nothing to them.

    Attributes
    ----------
    lowest
        Smallest forces [N] up to the end of the run, shape (meshes,).
    steady
        Smallest and largest forces [N] in the second half of the run, shape (2, meshes).
    half
        Half of the run [s].
    """

    lowest: Vector
    steady: Vector
    half: float
