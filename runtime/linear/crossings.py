"""Resonance crossings: where an excitation order meets an eigenfrequency, and how strongly it excites."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from ..model.members import train_of
from ..model.ties import order_by_size
from ..results.rounding import SHARE
from .campbell import LOAD, SPEED, Campbell
from .excitation import find_harmonics
from .inputs import MeshPath, find_paths
from .modes import Mode
from .orders import Order, phases_of

Vector = NDArray[np.float64]
Complex = NDArray[np.complex128]
MICRON = 1e-6
STARTING = 0.1
"""Part of the scene's speed, or of the axis' end where it has none, below which a train only starts or stops."""


@dataclass(frozen=True)
class Crossing:
    """An order that meets an eigenfrequency.

    Attributes
    ----------
    order, modes
        The order, and the numbers of the mode and of those that are repeated with it.
    value, frequency_hz
        Where on the axis, and at which frequency.
    margin
        How far beyond the scene's own value, as a part of it; negative below.
    mesh
        The mesh that the order excites most.
    sensitivity
        Amplitude of its force [N] that a transmission error of 1 um of its group makes through this mode, in
        resonance; None without damping.
    force
        Amplitude [N] that follows from the stiffness and errors of the scene, largest mesh of the stage; None for a
        sideband, whose modulation is not known, and without damping.
    """

    order: Order
    modes: tuple[int, ...]
    value: float
    frequency_hz: float
    margin: float
    mesh: str
    sensitivity: float | None
    force: float | None


def find_crossings(campbell: Campbell, orders: Sequence[Order]) -> list[Crossing]:
    """Find where orders cross eigenfrequencies, those that excite most first.

    A steady amplitude counts only where a train runs: crossings below `STARTING` of its speed, which every soft mode
    has with every order, come last.

    Parameters
    ----------
    campbell
        The modes along the axis.
    orders
        The orders.
    """
    harmonics = max((order.harmonic for order in orders), default=0)
    points = [_Point(campbell, i, harmonics) for i in range(len(campbell.values))]
    # Over speed, deflections change by centrifugal forces alone: the meshes are those at the scene's own speed.
    meshes = points if campbell.axis == LOAD else [points[campbell.at_home]] * len(points)
    found: dict[tuple[Order, int, int, int], Crossing] = {}
    for column in range(campbell.tracks.shape[1]):
        frequency = campbell.frequencies(column)
        for order in orders:
            for nth, (value, hertz) in enumerate(_meet(campbell, frequency, order)):
                point = int(np.abs(np.where(np.isfinite(frequency), campbell.values, np.inf) - value).argmin())
                mode = campbell.mode(point, column)
                if mode is None or not mode.eigenvalue.imag:
                    continue
                margin = value / campbell.home - 1 if campbell.home else float("nan")
                key, number = (order, point, mode.group, nth), (campbell.number(column),)
                if key in found:
                    found[key] = replace(found[key], modes=found[key].modes + number)
                    continue
                excited = meshes[point].excited(order, mode, campbell.modes[point])
                found[key] = Crossing(order, number, value, hertz, margin, *excited)
    slow = STARTING * (campbell.home or float(campbell.values[-1])) if campbell.axis == SPEED else 0.0
    return sorted(found.values(), key=lambda crossing: _rank(crossing, slow))


def _rank(crossing: Crossing, slow: float) -> tuple[bool, bool, float, float]:
    """Sort by force, then by sensitivity, both up to rounding; unbounded first, crossings near speed 0 last."""
    without = crossing.sensitivity is None
    force, sensitivity = (float(f"{value or 0.0:.9g}") for value in (crossing.force, crossing.sensitivity))
    return (crossing.value < slow, not without, -force, -sensitivity)


def _meet(campbell: Campbell, frequency: Vector, order: Order) -> list[tuple[float, float]]:
    """Return where an order meets a mode: value on the axis and frequency [Hz]."""
    known = np.flatnonzero(np.isfinite(frequency))
    runs = np.split(known, np.flatnonzero(np.diff(known) > 1) + 1)
    return [met for run in runs if len(run) > 1 for met in _meet_along(campbell, frequency, order, run)]


def _meet_along(
    campbell: Campbell, frequency: Vector, order: Order, run: NDArray[np.int64]
) -> list[tuple[float, float]]:
    """Return where an order meets a mode between neighbouring points."""
    values = campbell.values[run]
    mode = PchipInterpolator(values, frequency[run])
    driven = PchipInterpolator(values, order.order * np.abs(campbell.turns[run]))
    gap = np.asarray(mode(values) - driven(values))
    met = values[gap == 0].tolist()
    for i in np.flatnonzero(gap[:-1] * gap[1:] < 0):
        met.append(brentq(lambda value: float(mode(value) - driven(value)), values[i], values[i + 1]))
    return [(value, float(mode(value))) for value in met]


class _Point:
    """A point of the axis, as the orders excite its modes; computed once it is asked for."""

    def __init__(self, campbell: Campbell, point: int, harmonics: int) -> None:
        self.linear, self.p = campbell.linears[point], campbell.parameters[point]
        self.train = train_of(self.linear.library.manifest)
        self.harmonics, self.speed = harmonics, float(campbell.turns[campbell.at_home])

    @cached_property
    def paths(self) -> dict[str, MeshPath]:
        return find_paths(self.linear)

    @cached_property
    def own(self) -> dict[str, Complex]:
        return find_harmonics(self.linear, self.p, self.harmonics)

    def excited(self, order: Order, mode: Mode, modes: Sequence[Mode]) -> tuple[str, float | None, float | None]:
        """Return the mesh that an order excites most through a mode, its sensitivity and its own force [N]."""
        meshes = [mesh for mesh in self.paths if self.train.stage(mesh) == order.stage]
        omega, same = abs(mode.eigenvalue.imag), [other for other in modes if other.group == mode.group]
        if not -mode.eigenvalue.real > 1e-12 * omega:
            return meshes[0], None, None
        best, most = meshes[0], -1.0
        manifest = self.linear.library.manifest
        for group in dict.fromkeys(map(self.train.group, meshes)):
            members = [mesh for mesh in meshes if self.train.group(mesh) == group]
            phase = np.exp(1j * phases_of(manifest, self.p, order, members, self.speed))
            pushed = {m: self.paths[m].of_error(omega) * MICRON * q for m, q in zip(members, phase, strict=True)}
            forces = self._forces(omega, same, pushed, members)
            if forces.max() > most:
                best, most = members[order_by_size(forces, members)[0]], float(forces.max())
        if order.side:
            return best, most, None
        pushed = {mesh: complex(self.own[mesh][order.harmonic - 1]) for mesh in meshes}
        return best, most, float(self._forces(omega, same, pushed, meshes).max())

    def _forces(self, omega: float, modes: list[Mode], pushed: dict[str, complex], meshes: list[str]) -> Vector:
        """Return the amplitudes of mesh forces [N] that modes, one or a repeated one, make at a frequency [rad/s]."""
        push = sum((self.paths[mesh].push * force for mesh, force in pushed.items()), np.zeros(1, np.complex128))
        total = np.zeros(len(meshes), dtype=np.complex128)
        for mode in modes:
            moved = (mode.left.conj() @ push) / (1j * omega - mode.eigenvalue)
            total += moved * np.array([self.paths[mesh].force @ mode.shape for mesh in meshes])
        sizes = np.abs(total)
        return np.where(
            # What is left where planets cancel each other is rounding.
            sizes > SHARE * MICRON * max(abs(self.paths[mesh].of_error(omega)) for mesh in pushed),
            sizes,
            0.0,
        )
