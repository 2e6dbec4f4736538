"""Operating point: a model with its parameters at the loaded equilibrium, and what follows from them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .energy_levels import LOADED, UNLOADED
from .function import Kernel
from .library import Library
from .state_matrix import Equilibrium, closed, inertias, pulling, state_matrix

Vector = NDArray[np.float64]
Complex = NDArray[np.complex128]
EigenPairs = tuple[Complex, Complex]
"""Eigenvalues [1/s], shape (m,), and the shapes that go with them in scaled coordinates, shape (n, m)."""


@dataclass(frozen=True, eq=False)
class OperatingPoint:
    """A model at its loaded equilibrium.

    Derived quantities are computed once, on first use; parameters and state must not be changed in place.

    Attributes
    ----------
    library, p, at
        Model, parameters, shape (n_p,), and loaded equilibrium.
    """

    library: Library
    p: Vector
    at: Equilibrium

    @cached_property
    def strain(self) -> float:
        """Return the strain energy [J]."""
        return float(Kernel(self.library.functions["energy"])(self.at.x, self.at.s, self.p)[0][1])

    @cached_property
    def scale(self) -> Vector:
        """Return the vibration scale of every state: the amplitude at which it alone stores a small energy.

        The energy is 1e-4 of the mean strain energy per freedom of the loaded equilibrium (1e-6 J unloaded),
        so that all kinds of coordinates have equal weight: x = sqrt(2 E / k), v = sqrt(2 E / m). One relative
        tolerance thus refers to deflections of about a hundredth of the static ones.
        """
        library, at = self.library, self.at
        position, rate, mass = library.index(""), library.index(".rate"), inertias(library, self.p)
        energy = 1e-4 * self.strain / len(mass) if self.strain > LOADED else UNLOADED
        matrix = state_matrix(library, at.x, at.s, pulling(library, self.p))
        diagonal = -np.diag(matrix[np.ix_(rate, position)]) * mass
        stiffest = float(np.max(diagonal / mass))
        floor = (1e-8 * stiffest if stiffest > 0 else 1.0) * mass  # where nothing holds anything, 1 rad/s sets the size
        scale = np.ones(len(at.x))
        scale[position] = np.sqrt(2 * energy / np.maximum(diagonal, floor))
        scale[rate] = np.sqrt(2 * energy / mass)
        return scale

    @cached_property
    def spectrum(self) -> EigenPairs:
        """Return eigenvalues and shapes with all contacts closed, at the mean mesh levels."""
        return self._eigen(self.at.s)

    @cached_property
    def stiffest_spectrum(self) -> EigenPairs:
        """Return eigenvalues and shapes where the model is stiffest: both pairs in contact, teeth closed."""
        return self._eigen(np.concatenate([np.ones(len(self.at.levels)), self.at.signals]))

    @property
    def fastest(self) -> float:
        """Return the largest modulus [1/s] of an eigenvalue with all contacts closed."""
        return float(np.abs(self.spectrum[0]).max())

    @property
    def fastest_body(self) -> str:
        """Return the body, with its axis, that the fastest motion moves most."""
        values, shapes = self.spectrum
        shape = np.abs(shapes[:, int(np.abs(values).argmax())] * self.scale)[self.library.index(".rate")]
        energy = inertias(self.library, self.p) * shape**2
        state = self.library.manifest.states[self.library.index("")[int(energy.argmax())]]
        return f"{state.body} ({state.axis})"

    def _eigen(self, s: Vector) -> EigenPairs:
        """Return eigenvalues and shapes at levels and signals, with all contacts closed."""
        matrix = state_matrix(self.library, self.at.x, s, closed(self.library, self.p))
        values, shapes = np.linalg.eig(matrix * self.scale[None, :] / self.scale[:, None])
        return values.astype(np.complex128), shapes.astype(np.complex128)
