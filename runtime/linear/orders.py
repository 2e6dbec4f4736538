"""Excitation orders: mesh harmonics and sidebands per revolution of the reference."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import atan2

import numpy as np
from ltcgear.generated.contract import Manifest
from numpy.typing import NDArray

from ..model.members import train_of
from ..model.parameter_values import name_values
from ..model.phase_wrapping import TURN, Clocks

Vector = NDArray[np.float64]
SIDES = (-1, 1)
"""Distances of the sidebands on both sides of a mesh order, in steps."""


@dataclass(frozen=True)
class Side:
    """What modulates the meshes of a stage.

    Attributes
    ----------
    name
        ``carrier``, ``ring pass`` or ``sun pass``.
    order
        Cycles in a turn of the reference, positive where the planets go round in its sense against what they pass.
    spread
        Cycles of the modulation from one place round the stage to the same again: planet i, at the angle psi_i,
        sees it spread psi_i ahead, in the sense of ``order``.
    """

    name: str
    order: float
    spread: int


@dataclass(frozen=True)
class Order:
    """An order of excitation.

    Attributes
    ----------
    name
        ``2 psh``, or ``psh + ring pass`` for a sideband; plain ``psh`` is its first.
    stage, harmonic
        The gear set, and which harmonic of its mesh frequency.
    order
        Cycles in a turn of the reference.
    spread
        Of a sideband, how its phase goes round the stage where the reference turns counter-clockwise (see ``Side``);
        0 of a harmonic.
    side
        What modulates, empty for a harmonic.
    """

    name: str
    stage: str
    harmonic: int
    order: float
    spread: int = 0
    side: str = ""


def list_orders(manifest: Manifest, p: Vector, harmonics: int, sidebands: bool = False) -> list[Order]:
    """List harmonics of every gear set's mesh frequency, and their first sidebands where asked for.

    One turn of the reference moves a mesh by Z (rho - rho_C) pitches, rho being the speed ratios of gear 1 and of
    the carrier, Z the teeth of gear 1; the whole numbers of the teeth make it exact.
    """
    orders = []
    for stage, advance in mesh_advances(manifest, p).items():
        for harmonic in range(1, harmonics + 1):
            name = stage if harmonic == 1 else f"{harmonic} {stage}"
            middle = harmonic * abs(advance)
            orders.append(Order(name, stage, harmonic, middle))
            for side in list_sides(manifest, p, stage) if sidebands else []:
                for step in SIDES:
                    sign = "+" if step > 0 else "-"
                    value, spread = middle + step * abs(side.order), step * side.spread
                    spread = -spread if side.order < 0 else spread
                    if value > 0:
                        orders.append(Order(f"{name} {sign} {side.name}", stage, harmonic, value, spread, side.name))
    return orders


def mesh_advances(manifest: Manifest, p: Vector) -> dict[str, float]:
    """Return by gear set the pitches that pass in one turn of the reference; those with meshes at rest are left out."""
    courses, train = Clocks(manifest, p).by_mesh, train_of(manifest)
    return {train.stage(mesh): float(course.advance) for mesh, course in courses.items() if course.advance}


def list_sides(manifest: Manifest, p: Vector, stage: str) -> list[Side]:
    """List what modulates the meshes of a stage: its carrier's turns, and its planets' passes over ring and sun."""
    number, parts = name_values(manifest, p), {body.name: body.part for body in manifest.bodies}
    meshes = {mesh.item: mesh for mesh in manifest.connections if mesh.kind == "mesh" and not mesh.back}
    train, sides = train_of(manifest), dict[str, Side]()
    for clock in manifest.clocks:
        if train.stage(clock.mesh) != stage or parts[meshes[clock.mesh].bodies[1]] != "planet":
            continue
        carrier = number.get(clock.frame, 0.0)
        relative = carrier - number.get(clock.ratio, 0.0)
        planets = sum(other.group == meshes[clock.mesh].group for other in meshes.values())
        gear = parts[meshes[clock.mesh].bodies[0]]
        if carrier:
            sides["carrier"] = Side("carrier", carrier, 1)
        if relative:
            sides[gear] = Side(f"{gear} pass", planets * relative, planets)
    return list(sides.values())


def phases_of(manifest: Manifest, p: Vector, order: Order, meshes: Sequence[str], speed: float) -> Vector:
    """Return the phases [rad] with which an order excites meshes of its stage, shape (meshes,).

    The h-th harmonic of a mesh at phase tau is h tau cycles ahead, whatever its shape; planets differ by
    their mesh phases, which is what decides about the modes that are excited (Parker 2000, J. Sound Vib. 236:561).

    Parameters
    ----------
    speed
        Of the reference [rad/s]; its sign is the direction of the phases.
    """
    number = name_values(manifest, p)
    starts = {clock.mesh: number[clock.start] for clock in manifest.clocks if clock.mesh}
    courses, turning = Clocks(manifest, p).by_mesh, -1.0 if speed < 0 else 1.0
    found = []
    for mesh in meshes:
        counting = 1.0 if float(courses[mesh].advance) * speed >= 0 else -1.0
        place = atan2(number.get(f"{mesh}.e_y", 0.0), number.get(f"{mesh}.e_x", 1.0))
        found.append(counting * TURN * order.harmonic * starts[mesh] + turning * order.spread * place)
    return np.array(found)
