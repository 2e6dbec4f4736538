"""Inputs of the linear model: transmission errors and torque ripple, zdot = A z + b(omega) u."""

from collections.abc import Iterable
from dataclasses import dataclass
from difflib import get_close_matches

import numpy as np
from ltcgear.generated.errors import LtcgearError
from numpy.typing import NDArray

from ..model.function import Kernel
from ..model.load_torques import given_torques
from ..model.members import train_of
from .system import Linear

Vector = NDArray[np.float64]
Complex = NDArray[np.complex128]
SLIGHT = 1e-9
"""Share of the largest of its kind below which a derivative is rounding."""


@dataclass(frozen=True)
class MeshPath:
    """A mesh as small motions z see it: N = force z + u, zdot = A z + push u, u an additional normal force.

    Attributes
    ----------
    mesh
        Its name.
    stiffness, damping
        k [N/m] and c [N s/m] of N = k delta + c d(delta)/dt, zero where the teeth are apart.
    force, deflection
        Rows of N and of delta, shape (n,): what a unit of each kept state makes of them.
    push
        What 1 N does to the rates of the kept states, shape (n,).
    """

    mesh: str
    stiffness: float
    damping: float
    force: Vector
    deflection: Vector
    push: Vector

    def of_error(self, omega: float) -> complex:
        """Return the normal force u of a transmission error of 1 m, which it takes from the deflection [N/m]."""
        return -(self.stiffness + 1j * omega * self.damping)


@dataclass(frozen=True)
class TorqueInput:
    """A ripple of a load's torque: zdot = A z + push u, u in N m."""

    load: str
    push: Vector


def find_paths(linear: Linear) -> dict[str, MeshPath]:
    """Return by name how normal forces of the meshes act on small motions.

    From the work: a normal force u does u d(delta), so its generalised forces are -u (d delta/d q)^T, and accelerations
    follow by the mass matrix. Of a mesh whose stiffness has levels, a level's own push is taken: with friction it
    has what follows from the normal force at a right angle to it, which the work does not see.
    """
    forces, deflections = linear.outputs("mesh_force"), linear.outputs("mesh_deflection")
    levels, springs = _pushes_of_levels(linear, forces), _read_springs(linear)
    paths = {}
    for mesh, force in forces.items():
        along = deflections[mesh][linear.positions]
        push = levels.get(mesh)
        if push is None:
            push = np.zeros(len(linear.kept))
            push[linear.rates] = -np.linalg.solve(linear.mass, along)
        stiffness, damping = springs.get(mesh) or project_spring(linear, along, force)
        paths[mesh] = MeshPath(mesh, stiffness, damping, force, deflections[mesh], push)
    return paths


def _read_springs(linear: Linear) -> dict[str, tuple[float, float]]:
    """Return k and c by mesh, of those whose stiffness is a parameter, or two and a level; none of apart teeth."""
    manifest, number = linear.library.manifest, linear.number
    values = Kernel(linear.library.functions["outputs"])(linear.at.x, linear.at.s, linear.p)[0].tolist()
    reports = zip(manifest.reports, values, strict=True)
    touching = {report.item: value for report, value in reports if report.quantity == "mesh_contact"}
    level = dict(zip(manifest.levels, linear.at.levels.tolist(), strict=True))
    train, found = train_of(manifest), {}
    for mesh in manifest.connections:
        if mesh.kind == "mesh" and mesh.stiffness:
            low, high = number[mesh.stiffness[0]], number[mesh.stiffness[-1]]
            k = low + (high - low) * level.get(train.front(mesh.item), 0.0)
            acts = touching.get(mesh.item, 1.0)
            found[mesh.item] = acts * k, acts * number.get(mesh.damping, 0.0)
    return found


def project_spring(linear: Linear, along: Vector, force: Vector) -> tuple[float, float]:
    """Return k and c of a mesh whose stiffness varies with its phase and is no parameter: from the force's derivatives.

    They are projected on those of the deflection, every freedom in units of its vibration.
    """
    size = linear.scale[linear.kept[linear.positions]]
    part = along * size**2 / max(float((along * size) @ (along * size)), 1e-300)
    return float(force[linear.positions] @ part), float(force[linear.rates] @ part)


def _pushes_of_levels(linear: Linear, forces: Iterable[str]) -> dict[str, Vector]:
    """Return the pushes of meshes that have a level and carry load, by mesh: d rates / d level over d N / d level."""
    rates = linear.derivative("rhs", 1).toarray()[linear.kept]
    outputs = linear.derivative("outputs", 1).toarray()
    rows = {r.item: i for i, r in enumerate(linear.library.manifest.reports) if r.quantity == "mesh_force"}
    levels = linear.library.manifest.levels
    gains = {mesh: float(outputs[rows[mesh], levels.index(mesh)]) for mesh in forces if mesh in levels}
    largest = max(map(abs, gains.values()), default=0.0)
    return {m: rates[:, levels.index(m)] / gain for m, gain in gains.items() if abs(gain) > SLIGHT * largest}


def find_torque(linear: Linear, load: str) -> TorqueInput:
    """Return how a load's torque acts on small motions; LtcgearError where there is no such torque."""
    manifest = linear.library.manifest
    name = given_torques(manifest).get(load)
    signals = [signal.name for signal in manifest.signals]
    parameters = [name for name, _ in manifest.parameters]
    for argument, names, first in ((2, parameters, 0), (1, signals, len(manifest.levels))):
        if name in names:
            column = linear.derivative("rhs", argument).toarray()[linear.kept, first + names.index(name)]
            return TorqueInput(load, column)
    raise LtcgearError(_unknown(load, [], list_torques(linear)))


def list_torques(linear: Linear) -> list[str]:
    """Return the loads whose torque is given, constant or over time."""
    return list(given_torques(linear.library.manifest))


def find_input(linear: Linear, name: str) -> MeshPath | TorqueInput:
    """Return what excites: a mesh by its transmission error, or a load by a ripple of its torque.

    Raises
    ------
    LtcgearError
        If neither a mesh nor a load with a torque has that name; the nearest names are told.
    """
    loads, paths = list_torques(linear), find_paths(linear)
    if name in paths:
        return paths[name]
    if name in loads:
        return find_torque(linear, name)
    raise LtcgearError(_unknown(name, list(paths), loads))


def _unknown(name: str, meshes: list[str], loads: list[str]) -> str:
    """Say that nothing of that name excites, and what does."""
    near = get_close_matches(name, [*meshes, *loads], 1, 0.4)
    guess = f"; did you mean {near[0]}?" if near else "."
    shown = ", ".join([*meshes[:4], *(["..."] if len(meshes) > 4 else [])]) or "none"
    return (
        f"excite {name}: neither a mesh nor a load whose torque is given{guess} "
        f"Meshes: {shown}; loads with a torque: {', '.join(loads) or 'none'}"
    )
