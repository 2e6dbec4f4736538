"""Sensitivity of the loaded equilibrium to the parameters, by the adjoint of its force balance."""

from functools import cached_property

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from ..model.equilibrium import LOOSE, ROUNDING, start_state, unit_scale
from ..model.function import Kernel
from ..model.library import Library
from ..model.state_matrix import Equilibrium, inertias, settled, state_matrix
from .gradients import Gradients

Vector = NDArray[np.float64]
PUSHING = 1e-6
"""Share of the forces at work from which a parameter counts as pushing along a motion without stiffness."""


class Balance:
    """The equilibrium's forces F(x, s, p) = 0 about the place where they balance.

    A number J(x, s) that is read there has dJ = dJ/dx dx + dJ/ds ds with dF/dx dx = - dF/dp dp - dF/ds ds. One
    system with the transposed stiffness gives what each force is worth to J, and that the derivatives with respect
    to all parameters at once (the adjoint of the implicit function theorem).

    Parameters
    ----------
    gradients
        Derivatives of the model's right-hand side.
    p, at
        Parameters, and the equilibrium as ``find_equilibrium`` returns it.
    """

    def __init__(self, gradients: Gradients, p: Vector, at: Equilibrium) -> None:
        self.gradients, self.library, self.at = gradients, gradients.library, at
        self.p = settled(self.library, p)
        self.position, self.rate = self.library.index(""), self.library.index(".rate")
        self.mass = inertias(self.library, self.p)
        matrix = state_matrix(self.library, at.x, at.s, self.p)
        self.stiffness = stiffness = -matrix[np.ix_(self.rate, self.position)] * self.mass[:, None]
        self.scale = unit_scale(self.library, stiffness)
        self.left, self.singular, self.right = np.linalg.svd(stiffness * np.outer(self.scale, self.scale))
        self.loose = self.singular <= LOOSE * len(self.mass) * self.singular[0]

    def pull_back(self, of_x: Vector, of_s: Vector | None = None) -> Vector:
        """Return dJ/dp at the equilibrium that moves with p.

        Parameters
        ----------
        of_x
            dJ/dx, shape (n,).
        of_s
            dJ/ds, where J is read at the mean levels that the equilibrium has; 0 where left out.

        Returns
        -------
        numpy.ndarray
            Shape (n_p,); NaN where no equilibrium is left once the parameter moves (see ``unbalancing``).
        """
        names = [name for name, _ in self.library.manifest.parameters]
        states = [state.name for state in self.library.manifest.states]
        inverse = np.where(self.loose, 0.0, 1.0 / np.where(self.loose, 1.0, self.singular))
        worth = self.scale * (self.left @ (inverse * (self.right @ (self.scale * of_x[self.position]))))
        x, s, p = self._forces(worth)
        x, s = x + of_x, s + (0.0 if of_s is None else of_s)
        gradient = p - self._of_share(s[: len(self.at.levels)])
        if "reference.speed" in states:  # a start state, see equilibrium.start_state
            gradient[names.index("reference.speed")] += x[states.index("reference.speed")]
        gradient[self.unbalancing] = np.nan
        return gradient

    @cached_property
    def unbalancing(self) -> NDArray[np.bool_]:
        """Return the parameters that drive a motion without stiffness: other values have no equilibrium."""
        start = start_state(self.library, self.p)
        load = Kernel(self.library.functions["rhs"])(start, self.at.s, self.p)[0][self.rate] * self.mass
        forces = np.abs(self.stiffness) @ (np.abs(self.at.x[self.position]) + ROUNDING) + np.abs(load)
        pushing = np.zeros(len(self.p), dtype=np.bool_)
        for one in self.left[:, self.loose].T:
            worth = one * self.scale
            pushing |= np.abs(self._forces(worth)[2] * self.p) > PUSHING * float(np.abs(worth) @ forces)
        return pushing

    def _forces(self, worth: Vector) -> tuple[Vector, Vector, Vector]:
        """Return the gradients of worth' F with respect to x, s and p."""
        weights = np.zeros(len(self.at.x))
        weights[self.rate] = worth * self.mass
        return self.gradients.of_rates(self.at.x, self.at.s, self.p, weights)

    def _of_share(self, weights: Vector) -> Vector:
        """Return the gradient of weights' (share of single contact) with respect to p."""
        if not len(weights):
            return np.zeros(len(self.p))
        return self._share(self.at.x, self.at.s, self.p, weights)[0].copy()

    @cached_property
    def _share(self) -> Kernel:
        return share_gradient(self.library)


def share_gradient(library: Library) -> Kernel:
    """Return the kernel of the gradient of weights' (share of single contact) with respect to p."""
    graph = library.graphs["phases"]
    point = [ca.SX.sym(graph.name_in(i), graph.sparsity_in(i)) for i in range(graph.n_in())]
    weights = ca.SX.sym("w", graph.size1_out(2))
    value = ca.dot(weights, graph.call(point)[2])
    return Kernel(ca.Function("share", [*point, weights], [ca.densify(ca.gradient(value, point[2]))]))
