"""State matrix about an equilibrium, and the parameters that it is taken at."""

from dataclasses import dataclass, field

import numpy as np
from ltcgear.generated.contract import CLOSING, HELD, PULL, VARYING
from numpy.typing import NDArray

from .function import Kernel
from .library import Library

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Equilibrium:
    """A state without vibration.

    Attributes
    ----------
    x
        State vector: deviations at rest against the rigid motion.
    levels
        Mesh levels it holds for (their mean over a tooth pitch).
    residual
        Largest force left over the largest force at work.
    iterations
        Newton steps taken.
    signals
        Load signals it holds for.
    """

    x: Vector
    levels: Vector
    residual: float
    iterations: int
    signals: Vector = field(default_factory=lambda: np.zeros(0))

    @property
    def s(self) -> Vector:
        """Return levels and signals, the functions' second argument."""
        return np.concatenate([self.levels, self.signals])


def mean_levels(library: Library, x: Vector, p: Vector) -> Vector:
    """Return the mean level of each switched mesh: the share of double contact."""
    phases = Kernel(library.functions["phases"])
    share = phases(x, np.zeros(len(phases.arguments[1])), p)[2]
    return np.asarray(1.0 - share)


def inertias(library: Library, p: Vector) -> Vector:
    """Return the inertia [kg or kg m^2] that belongs to each deviation."""
    known = {name: i for i, (name, _) in enumerate(library.manifest.parameters)}
    return np.array([p[known[library.manifest.states[i].inertia]] for i in library.index("")])


def settled(library: Library, p: Vector) -> Vector:
    """Return the parameters with means over the mesh phase in place of what varies with it."""
    return replace_parameter(library, p, VARYING, 0.0)


def pulling(library: Library, p: Vector, share: float = 1.0) -> Vector:
    """Return the settled parameters with one-sided teeth that pull with a share of their stiffness."""
    return replace_parameter(library, settled(library, p), PULL, share)


def closed(library: Library, p: Vector) -> Vector:
    """Return the settled parameters with all contacts closed: no clearance, and every tooth pushing and pulling.

    The sign of normal forces under friction is that of the state.
    """
    values = replace_parameter(library, pulling(library, p), CLOSING, 1.0)
    contacts = {connection.hold for connection in library.manifest.connections if connection.hold}
    values[[name in contacts for name, _ in library.manifest.parameters]] = HELD
    return values


def replace_parameter(library: Library, p: Vector, name: str, value: float) -> Vector:
    """Return the parameters with another value of one, where the model has it."""
    return np.array(
        [value if known == name else old for (known, _), old in zip(library.manifest.parameters, p, strict=True)]
    )


def dense_jacobian(library: Library, nonzeros: Vector) -> Vector:
    """Return the dense Jacobian from its non-zeros."""
    sparsity = library.functions["jac_rhs"].sparsity_out(0)
    rows, columns = sparsity.get_triplet()
    full = np.zeros(sparsity.shape)
    full[rows, columns] = nonzeros
    return full


def state_matrix(library: Library, x: Vector, s: Vector, p: Vector) -> Vector:
    """Return d xdot / d x, shape (n, n)."""
    return dense_jacobian(library, Kernel(library.functions["jac_rhs"])(x, s, p, 0.0)[0])
