"""Strain energy of small motions: how much each element of the model takes."""

import casadi as ca
import numpy as np
from ltcgear.generated.contract import Connection, Manifest
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..model.function import Kernel
from ..model.members import train_of
from ..model.ties import largest_first
from .system import Linear

Complex = NDArray[np.complex128]
Vector = NDArray[np.float64]
STIFFNESS_UNITS = ("N/m", "N*m/rad")
FORCES = {
    "mesh_force": "mesh",
    "pin_force_x": "pin",
    "pin_force_y": "pin",
    "bearing_force_x": "bearing",
    "bearing_force_y": "bearing",
    "coupling_torque": "coupling",
    "support_torque": "support",
}
"""Outputs that are an element's own force, and the kind of connection that it is."""


class Energies:
    """The second variation of a model's strain energy, element by element.

    The strain energy V is of first degree in all stiffnesses together. So is v' V_xx v / 2 for a displacement v,
    which is the sum of k d/dk of it over all stiffnesses k (Euler). Elements that share a stiffness divide its part
    as the squares of their forces.

    Parameters
    ----------
    linear
        The model and its operating point.
    """

    def __init__(self, linear: Linear) -> None:
        self.linear = linear
        manifest = linear.library.manifest
        self._reports = [i for i, report in enumerate(manifest.reports) if report.quantity in FORCES]
        found = _elements(manifest)
        self.elements = list(dict.fromkeys(element.name for element in found))
        place = {name: k for k, name in enumerate(self.elements)}
        self._element_of = np.array([place[element.name] for element in found], dtype=np.int64)
        self._stiffness = [i for i, (_, unit) in enumerate(manifest.parameters) if unit in STIFFNESS_UNITS]
        self._owners = _owners(
            {element.name: element for element in found}, [manifest.parameters[i][0] for i in self._stiffness]
        )
        self._kernel = self._make()

    def _make(self) -> Kernel:
        """Return the function (x, s, p, v) -> k d(v' V_xx v / 2)/dk, forces of v."""
        graphs = self.linear.library.graphs
        energy = graphs["energy"]
        x, s, p = (ca.SX.sym(energy.name_in(i), energy.sparsity_in(i)) for i in range(3))
        v = ca.SX.sym("v", x.numel())
        strain = energy.call([x, s, p])[0][1]
        second = ca.jtimes(ca.jtimes(strain, x, v), x, v) / 2
        parts = (p * ca.densify(ca.gradient(second, p)))[self._stiffness]
        forces = ca.densify(ca.jtimes(graphs["outputs"].call([x, s, p])[0][self._reports], x, v))
        return Kernel(ca.Function("strain", [x, s, p, v], [parts, forces]))

    def of_shape(self, shape: Complex) -> dict[str, float]:
        """Return the strain energy [J] of a motion by element, the mean over its cycle times two, largest first.

        Under load an element that is pressed may give back energy as it tilts: its part is then below zero.

        Parameters
        ----------
        shape
            Kept states, shape (n,); only displacements count.
        """
        linear = self.linear
        moving = np.zeros(len(linear.at.x), dtype=complex)
        moving[linear.kept] = shape
        held = np.setdiff1d(np.arange(len(moving)), linear.library.index(""))
        moving[held] = 0.0
        total, squares = np.zeros(len(self._stiffness)), np.zeros(len(self.elements))
        for v in (moving.real, moving.imag):
            parts, forces = self._kernel(linear.at.x, linear.at.s, linear.p, v)
            total += parts
            squares += np.bincount(self._element_of, forces**2, len(self.elements))
        weights = self._owners @ squares
        each = squares * (self._owners.T @ np.divide(total, weights, out=np.zeros_like(total), where=weights > 0))
        return largest_first(dict(zip(self.elements, each.tolist(), strict=True)))


def _elements(manifest: Manifest) -> list[Connection]:
    """Return by force among the reports the element whose it is; both flanks of a mesh are one."""
    train = train_of(manifest)
    known = {(item.kind, item.item): item for item in manifest.connections}
    forces = ((FORCES[report.quantity], report.item) for report in manifest.reports if report.quantity in FORCES)
    return [known[kind, train.front(item) if kind == "mesh" else item] for kind, item in forces]


def _owners(elements: dict[str, Connection], stiffnesses: list[str]) -> csr_array:
    """Return which elements have a stiffness, 1 or 0, shape (stiffnesses, elements): all of a group, or one."""
    place = {name: i for i, name in enumerate(stiffnesses)}
    pairs = [
        (place[name], k)
        for k, element in enumerate(elements.values())
        for name in (*element.stiffness, *element.profile)
        if name in place
    ]
    rows, columns = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
    return csr_array((np.ones(len(pairs)), (rows, columns)), shape=(len(stiffnesses), len(elements)))
