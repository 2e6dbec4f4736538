"""Linear system: the generated model about an operating point, in the coordinates that turn with the carriers."""

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import casadi as ca
import numpy as np
from ltcgear.generated.contract import RigidBody, State
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..model.contact_levels import Phases, cells_of, levels_of
from ..model.function import Kernel
from ..model.library import Library
from ..model.operating_point import OperatingPoint
from ..model.parameter_values import name_values
from ..model.phase_wrapping import TURN
from ..model.state_matrix import Equilibrium, settled

Vector = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True)
class Motions:
    """The absolute motions that store kinetic energy.

    Attributes
    ----------
    states
        Body and axis of each.
    mass
        Mass [kg] or inertia [kg m^2] of each.
    matrix
        Shape (motions, states of the model): what a unit of a state moves them, in the axes of their frames.
    parts
        What the body of each is in its stage.
    """

    states: list[State]
    mass: Vector
    matrix: Vector
    parts: list[str]


@dataclass(frozen=True)
class Linear:
    """Small motions z about an operating point: zdot = A z, y = C z.

    Attributes
    ----------
    library
        The model.
    at
        Where it is linearised.
    p
        The parameters that hold there: with means in place of what varies with the mesh phase, or with its
        value at one angle.
    scale
        Size of a vibration of every state of the model.
    kept
        The states of the model that are freedoms: where the speed is held, the reference angle is a clock.
    matrix
        A, shape (n, n), in SI units.
    motions
        The absolute motions.
    """

    library: Library
    at: Equilibrium
    p: Vector
    scale: Vector
    kept: Indices
    matrix: csr_array
    motions: Motions

    @cached_property
    def names(self) -> list[str]:
        """Return the names of the kept states."""
        return [self.library.manifest.states[i].name for i in self.kept]

    @cached_property
    def number(self) -> dict[str, float]:
        """Return the parameters by name."""
        return name_values(self.library.manifest, self.p)

    @cached_property
    def positions(self) -> Indices:
        """Return the indices of displacements among the kept states; ``rates`` has their rates in the same order."""
        moving = self.library.index("").tolist()
        free = "reference.speed" in self.names
        return self._places([*([self._state("reference.angle")] if free else []), *moving])

    @cached_property
    def rates(self) -> Indices:
        """Return the indices of the rates of ``positions`` among the kept states."""
        moving = self.library.index(".rate").tolist()
        free = "reference.speed" in self.names
        return self._places([*([self._state("reference.speed")] if free else []), *moving])

    @cached_property
    def mass(self) -> Vector:
        """Return the mass matrix of the displacements [kg, kg m, kg m^2]."""
        moved = self.motions.matrix[:, self.kept[self.positions]]
        return np.asarray(moved.T @ (self.motions.mass[:, None] * moved))

    def derivative(self, function: str, argument: int = 0) -> csr_array:
        """Return the derivative of a generated function's first result with respect to one of (x, s, p).

        Returns
        -------
        scipy.sparse.csr_array
            Shape (results, size of the argument); of x all states of the model, not only the kept ones.
        """
        jacobian = _jacobian(self.library.graphs[function], argument)
        values = Kernel(jacobian)(self.at.x, self.at.s, self.p)[0]
        return _sparse(jacobian.sparsity_out(0), values)

    def outputs(self, quantity: str) -> dict[str, Vector]:
        """Return by item how the reports of a quantity follow the kept states, shape (n,) each."""
        rows = self._outputs
        return {
            report.item: rows[i]
            for i, report in enumerate(self.library.manifest.reports)
            if report.quantity == quantity
        }

    @cached_property
    def _outputs(self) -> Vector:
        return np.asarray(self.derivative("outputs").toarray()[:, self.kept])

    def scaled(self) -> Vector:
        """Return A with every state in units of its vibration, dense: eigenvalues are those of A."""
        size = self.scale[self.kept]
        return np.asarray(self.matrix.toarray() * size[None, :] / size[:, None])

    def _state(self, name: str) -> int:
        return [state.name for state in self.library.manifest.states].index(name)

    def _places(self, states: list[int]) -> Indices:
        place = {state: k for k, state in enumerate(self.kept.tolist())}
        return np.array([place[state] for state in states], dtype=np.int64)


def linearise(at: OperatingPoint, turn: float | None = None) -> Linear:
    """Linearise a model about its operating point.

    The coordinates turn with the carriers, so gyroscopic and centrifugal terms are in the matrix.

    Parameters
    ----------
    at
        The model, its parameters and its equilibrium.
    turn
        Turns of the reference after which the meshes are held; means over the mesh phase where left out.
    """
    library = at.library
    names = [state.name for state in library.manifest.states]
    point = replace(at, p=settled(library, at.p)) if turn is None else replace(at, at=_turned(at, turn))
    known = library.manifest.reference == "speed"
    kept = np.array([i for i, name in enumerate(names) if not (known and name == "reference.angle")], dtype=np.int64)
    jacobian = library.functions["jac_rhs"]
    whole = _sparse(jacobian.sparsity_out(0), Kernel(jacobian)(point.at.x, point.at.s, point.p, 0.0)[0])
    return Linear(library, point.at, point.p, point.scale, kept, whole[kept][:, kept], _motions(point))


def _turned(point: OperatingPoint, turn: float) -> Equilibrium:
    """Return the equilibrium's state at another angle of the reference, with the levels that hold there."""
    library, at = point.library, point.at
    names = [state.name for state in library.manifest.states]
    x = at.x.copy()
    if "reference.angle" in names:
        x[names.index("reference.angle")] += TURN * turn
    tau, rate, share = (part.copy() for part in Kernel(library.functions["phases"])(x, at.s, point.p))
    return replace(at, x=x, levels=levels_of(cells_of(Phases(tau, rate, share))))


@lru_cache(maxsize=16)
def _jacobian(graph: ca.Function, argument: int) -> ca.Function:
    """Return the derivative of a graph's first result as a function of (x, s, p)."""
    symbols = [ca.SX.sym(graph.name_in(i), graph.sparsity_in(i)) for i in range(graph.n_in())]
    result = graph.call(symbols)[0]
    return ca.Function("derivative", symbols, [ca.jacobian(result, symbols[argument])])


def _sparse(sparsity: ca.Sparsity, values: Vector) -> csr_array:
    """Return a sparse matrix from CasADi's non-zeros."""
    rows, columns = sparsity.get_triplet()
    return csr_array((values.copy(), (rows, columns)), shape=sparsity.shape)


def _motions(point: OperatingPoint) -> Motions:
    """Describe the absolute motions: where no speed is held, the reference angle carries everything along."""
    library = point.library
    everything = library.manifest.states
    names = [state.name for state in everything]
    number = name_values(library.manifest, point.p)
    position = library.index("")
    states = [everything[i] for i in position]
    if library.manifest.reference == "torque":
        states += [state for state in everything if state.kind == "reference speed"]
    bodies = {body.name: body for body in library.manifest.bodies}
    matrix = np.zeros((len(states), len(names)))
    matrix[np.arange(len(position)), position] = 1.0
    if library.manifest.reference == "torque":
        place = {(state.body, state.axis): float(point.at.x[i]) for i, state in zip(position, states, strict=False)}
        matrix[:, names.index("reference.angle")] = [_carried(state, bodies, number, place) for state in states]
    mass = np.array([number[state.inertia] for state in states])
    return Motions(states, mass, matrix, [bodies[state.body].part for state in states])


def _carried(
    state: State, bodies: dict[str, RigidBody], number: dict[str, float], place: dict[tuple[str, str], float]
) -> float:
    """Return how far a unit of reference angle carries a body along an axis, in the axes of its frame.

    Angles follow by the speed ratio; a planet is carried round by its frame, which turns with its carrier.
    """
    body = bodies[state.body]
    if state.turns:
        return number.get(body.ratio, 0.0)
    turn = number.get(bodies[body.frame].ratio, 0.0) if body.frame else 0.0
    other, sign = ("y", -1.0) if state.axis == "x" else ("x", 1.0)
    nominal = number[body.place["xy".index(other)]] if body.place else 0.0
    return sign * turn * (nominal + place[state.body, other])
