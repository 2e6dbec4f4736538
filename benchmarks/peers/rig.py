"""The rig that peers are compared on: its model, its switching instants, and how far a run is from the reference."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from ltcgear.runtime.model.building import build
from ltcgear.runtime.model.contact_levels import Phases, cells_of, levels_of, upper
from ltcgear.runtime.model.equilibrium import find_equilibrium
from ltcgear.runtime.model.function import Kernel
from ltcgear.runtime.model.library import Library
from ltcgear.runtime.model.operating_point import OperatingPoint
from ltcgear.runtime.model.rows import over_time
from ltcgear.runtime.model.state_matrix import Equilibrium
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.scene.load import load_scene
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Rate = Callable[[Vector, Vector], Vector]
"""A right-hand side: (x, levels) to x', of a vector that lasts until the next call."""
SCENE, T_END, RATE = "rig-2mw", 0.05, 8000.0
"""Scene, time that is simulated [s], samples a second [Hz]."""
TOGETHER = 1e-12
"""Switching instants [s] closer than this are one."""
AGREES = 1e-9
"""How far the accelerations of a peer may be from ours, over the largest of their kind."""


@dataclass(frozen=True)
class Segment:
    """Time between two switching instants [s] and the mesh levels that hold in it."""

    start: float
    end: float
    levels: Vector


@dataclass(frozen=True)
class Rig:
    """A scene at its equilibrium, ready to run."""

    library: Library
    values: Mapping[str, float]
    p: Vector
    at: Equilibrium

    @cached_property
    def scale(self) -> Vector:
        """Return the size of each state to which absolute tolerances refer."""
        return OperatingPoint(self.library, self.p, self.at).scale

    @cached_property
    def times(self) -> Vector:
        """Return the instants [s] that are compared."""
        return np.arange(round(T_END * RATE) + 1) / RATE

    @cached_property
    def segments(self) -> tuple[Segment, ...]:
        """Return the stretches between switching instants, by the phases of the rigid motion."""
        tau, rate, share = (a.copy() for a in Kernel(self.library.functions["phases"])(self.at.x, self.at.s, self.p))
        phases = Phases(tau, rate, share)
        cells, found, now = cells_of(phases), [], 0.0
        while now < T_END:
            due = np.divide(upper(cells, share) - tau, rate, out=np.full(len(tau), np.inf), where=rate > 0)
            end = min(float(due.min(initial=np.inf)), T_END)
            found.append(Segment(now, end, levels_of(cells)))
            cells, now = cells + (due <= end + TOGETHER), end
        return tuple(found)

    def forces(self, x: Vector) -> Vector:
        """Return the mesh forces [N] at the compared instants, shape (times, meshes)."""
        levels = np.array([self.segments[i].levels for i in self._place()])
        y = over_time(self.library, "outputs", x, levels.reshape(len(x), -1), self.p)
        return y[:, [i for i, r in enumerate(self.library.manifest.reports) if r.quantity == "mesh_force"]]

    def _place(self) -> NDArray[np.int64]:
        """Return the segment that each compared instant lies in: on a border, the one that ends there."""
        ends = np.array([segment.end for segment in self.segments])
        return np.searchsorted(ends, self.times - TOGETHER)

    @cached_property
    def inside(self) -> list[NDArray[np.int64]]:
        """Return the compared instants of each segment, those after the start."""
        place = self._place()
        return [np.flatnonzero((place == i) & (self.times > 0)) for i in range(len(self.segments))]

    def states(self, count: int = 20) -> Iterator[tuple[Vector, Vector]]:
        """Draw states about the equilibrium, ten vibrations' sizes away, with levels between 0 and 1."""
        rng = np.random.default_rng(5)
        for _ in range(count):
            x = self.at.x + 10 * self.scale * rng.normal(size=len(self.scale))
            yield x, rng.uniform(0, 1, len(self.library.manifest.levels))


def open_rig(scene: str = SCENE, settings: Mapping[str, str] | None = None) -> Rig:
    """Build a scene and find its equilibrium."""
    model = build_model(load_scene(scene, dict(settings or {})))
    library, values = build(obtain(model)), model.values()
    p = library.parameters(values)
    return Rig(library, values, p, find_equilibrium(library, p))


def disagreement(rig: Rig, rate: Rate) -> float:
    """Return by how much a peer's rates differ from ours at most, over the largest of each kind."""
    ours = Kernel(rig.library.functions["rhs"])
    worst = 0.0
    for x, levels in rig.states():
        wanted, found = ours(x, levels, rig.p)[0].copy(), np.array(rate(x, levels))
        sizes = np.array([kind_size(rig, wanted, i) for i in range(len(wanted))])
        worst = max(worst, float(np.max(np.abs(found - wanted) / sizes)))
    return worst


def kind_size(rig: Rig, rates: Vector, i: int) -> float:
    """Return the largest rate of a state's kind (unit)."""
    states = rig.library.manifest.states
    same = [j for j, state in enumerate(states) if state.unit == states[i].unit]
    return float(np.abs(rates[same]).max()) or 1.0


def error(rig: Rig, x: Vector, reference: Vector) -> float:
    """Return the error of mesh forces: root mean square over that of the reference's vibration, the worst mesh."""
    found = rig.forces(x)
    return float((np.sqrt(np.mean((found - reference) ** 2, axis=0)) / reference.std(axis=0)).max())
