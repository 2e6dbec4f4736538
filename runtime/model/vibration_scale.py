"""Vibration scale of each state, to which tolerances refer, and the fastest mode."""

import numpy as np
from numpy.typing import NDArray

from .energy_levels import LOADED, UNLOADED
from .equilibrium import Equilibrium, closed, inertias, pulling, state_matrix
from .function import Kernel
from .library import Library

Vector = NDArray[np.float64]


def vibration_scale(library: Library, at: Equilibrium, p: Vector) -> Vector:
    """Return a size for every state: the motion in which it alone stores one small energy.

    The energy is 1e-4 of the mean strain energy per freedom of the loaded equilibrium (1e-6 J unloaded),
    so that coordinates of all kinds weigh alike: x = sqrt(2 E / k), v = sqrt(2 E / m). One relative
    tolerance thus refers to deflections of about a hundredth of the static ones.
    """
    position, rate, mass = library.index(""), library.index(".rate"), inertias(library, p)
    strain = float(Kernel(library.functions["energy"])(at.x, at.s, p)[0][1])
    energy = 1e-4 * strain / len(mass) if strain > LOADED else UNLOADED
    matrix = state_matrix(library, at.x, at.s, pulling(library, p))
    diagonal = -np.diag(matrix[np.ix_(rate, position)]) * mass
    speed = np.sqrt(2 * energy / mass)
    stiffest = float(np.max(diagonal / mass))
    floor = (1e-8 * stiffest if stiffest > 0 else 1.0) * mass  # where nothing holds anything, 1 rad/s sets the size
    scale = np.ones(len(at.x))
    scale[position] = np.sqrt(2 * energy / np.maximum(diagonal, floor))
    scale[rate] = speed
    return scale


def fastest(library: Library, at: Equilibrium, p: Vector) -> float:
    """Return the largest eigenvalue's modulus [1/s] of the linearised model, all its contacts closed."""
    scale = vibration_scale(library, at, p)
    matrix = state_matrix(library, at.x, at.s, closed(library, p)) * scale[None, :] / scale[:, None]
    return float(np.abs(np.linalg.eigvals(matrix)).max())
