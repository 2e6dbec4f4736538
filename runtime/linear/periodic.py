"""Periodic linear system: A over the mesh phase at a held speed, zdot = A(t) z with A(t + T) = A(t)."""

from collections.abc import Iterator
from dataclasses import dataclass
from difflib import get_close_matches
from fractions import Fraction
from functools import cached_property
from math import ceil, gcd, lcm, pi

import casadi as ca
import numpy as np
from ltcgear.generated.contract import Clock
from ltcgear.generated.errors import LtcgearError
from numpy.typing import NDArray

from ..model.equilibrium import find_equilibrium
from ..model.function import Kernel
from ..model.library import Library
from ..model.members import Train, train_of
from ..model.operating_point import OperatingPoint
from ..model.phase_wrapping import Clocks
from ..model.state_matrix import Equilibrium
from .system import Linear, linearise

Vector = NDArray[np.float64]
MOST = 100_000
"""The most jumps, or steps between jumps, that a common period may have."""
TOGETHER = 1e-11
"""Instants closer than this share of the shortest tooth pitch are one."""
CHUNK = 256
"""Matrices held in memory at a time."""


@dataclass(frozen=True)
class Periodic:
    """A linear system whose stiffness varies with the mesh phase; all else in A is as at the start.

    Attributes
    ----------
    linear
        The system about the mean loaded equilibrium, with means in place of what varies.
    p
        The parameters.
    cycles
        Pitches that each varying mesh goes through in a period, negative where its phase falls.
    period
        The time T [s] after which all of them have gone through whole pitches.
    borders
        Parts of the period at which levels jump, with 0 and 1.
    follows
        Whether A changes between the jumps too.
    whole
        Whether these are all the meshes whose phase A follows.
    """

    linear: Linear
    p: Vector
    cycles: dict[str, int]
    period: float
    borders: Vector
    follows: bool
    whole: bool

    @property
    def meshes(self) -> list[str]:
        """Return the meshes whose stiffness varies."""
        return list(self.cycles)

    @property
    def mesh_frequencies(self) -> dict[str, float]:
        """Return the mesh frequencies [Hz] by stage."""
        train = train_of(self.linear.library.manifest)
        return {train.stage(mesh): abs(n) / self.period for mesh, n in self.cycles.items()}

    def steps(self, count: int) -> tuple[Vector, Vector]:
        """Return starts and lengths, in parts of the period, of steps that stop at every jump.

        Parameters
        ----------
        count
            Steps in a period, about; one from jump to jump where A is constant there.
        """
        lengths = np.diff(self.borders)
        parts = np.array([ceil(length * count) if self.follows else 1 for length in lengths])
        ends = [np.linspace(a, b, n + 1) for a, b, n in zip(self.borders, self.borders[1:], parts, strict=False)]
        starts = np.concatenate([each[:-1] for each in ends])
        return starts, np.repeat(lengths / parts, parts)

    def sample(self, places: Vector) -> Vector:
        """Return A [1/s] at parts of the period that no jump falls on, states in sizes of their vibration.

        Returns
        -------
        numpy.ndarray
            Shape (m, n, n).
        """
        matrices = [self._at(float(place)) for place in places]
        return np.array(matrices).reshape(len(places), *self.linear.matrix.shape)

    def samples(self, count: int) -> Iterator[tuple[Vector, Vector, Vector]]:
        """Yield lengths of steps and A at the two Gauss points of each, a chunk of steps at a time."""
        starts, lengths = self.steps(count)
        for first in range(0, len(starts), CHUNK):
            start, length = starts[first : first + CHUNK], lengths[first : first + CHUNK]
            if not self.follows:
                middle = self.sample(start + length / 2)
                yield length, middle, middle
                continue
            apart = length / np.sqrt(12)
            yield length, self.sample(start + length / 2 - apart), self.sample(start + length / 2 + apart)

    def mean(self, count: int) -> Vector:
        """Return the mean of the samples over the period, shape (n, n)."""
        parts = (np.tensordot(length, one + two, 1) / 2 for length, one, two in self.samples(count))
        return np.asarray(sum(parts))

    @cached_property
    def _sampler(self) -> "_Sampler":
        return _Sampler(self)

    def _at(self, place: float) -> Vector:
        return self._sampler.matrix(place)


class _Sampler:
    """Evaluates A at parts of a period; where it is constant between jumps, each set of levels once."""

    def __init__(self, periodic: Periodic) -> None:
        library, self.at = periodic.linear.library, periodic.linear.at
        self.p, self.follows = periodic.p.copy(), periodic.follows
        names = [name for name, _ in library.manifest.parameters]
        started = [(names.index(c.start), periodic.cycles[c.mesh]) for c in _running(library, list(periodic.cycles))]
        self.starts = np.array([index for index, _ in started], dtype=np.int64)
        self.advance = np.array([float(cycles) for _, cycles in started])
        self.switched = np.array([mesh in periodic.cycles for mesh in library.manifest.levels], dtype=np.bool_)
        self.jacobian, self.phases = (Kernel(library.functions[name]) for name in ("jac_rhs", "phases"))
        self.places = library.functions["jac_rhs"].sparsity_out(0).get_triplet()
        self.kept, size = periodic.linear.kept, periodic.linear.scale
        self.ratio = size[None, :] / size[:, None]
        self.known: dict[bytes, Vector] = {}

    def matrix(self, place: float) -> Vector:
        p = self.p.copy()
        p[self.starts] += self.advance * place
        levels = self.at.levels.copy()
        tau, _, share = self.phases(self.at.x, self.at.s, p)
        levels[self.switched] = (np.mod(tau, 1.0) >= share)[self.switched]
        if self.follows:
            return self._evaluate(levels, p)
        key = levels.tobytes()
        if key not in self.known:
            self.known[key] = self._evaluate(levels, self.p)
        return self.known[key]

    def _evaluate(self, levels: Vector, p: Vector) -> Vector:
        s = np.concatenate([levels, self.at.signals])
        full = np.zeros_like(self.ratio)
        full[self.places] = self.jacobian(self.at.x, s, p, 0.0)[0]
        return np.asarray((full * self.ratio)[np.ix_(self.kept, self.kept)])


def vary(
    library: Library, p: Vector, mesh: str | None = None, speed: float | None = None, at: Equilibrium | None = None
) -> Periodic:
    """Find what of a model's A varies with the mesh phase, and its common period.

    Parameters
    ----------
    library, p
        The model and its parameters.
    mesh
        A mesh, the meshes of one kind or a stage (``lsp.sun_planet.1``, ``lsp.sun_planet``, ``lsp``) whose stiffness
        varies while that of all others has its mean; all where left out.
    speed
        Another speed of the reference [rad/s].
    at
        The mean loaded equilibrium, sought where left out.

    Raises
    ------
    LtcgearError
        If no constant speed is held, nothing varies, the mesh is unknown, or the common period is too long.
    SolverError
        If there is no equilibrium.
    """
    check_periodic(library)
    if speed is not None:
        p = _at_speed(library, p, speed)
    followed, train = _followed(library), train_of(library.manifest)
    clocks = Clocks(library.manifest, p)
    moving = {name: course for name, course in clocks.by_mesh.items() if course.advance}
    varying = [name for name in moving if name in followed or name in library.manifest.levels]
    chosen = choose_meshes(train, varying, list(clocks.by_mesh), mesh)
    pitches = {name: (moving[name].period if name in followed else 1) for name in chosen}
    turns = _common([Fraction(pitches[name]) / abs(moving[name].advance) for name in chosen])
    reference = _speed(library, p)
    sense = 1 if reference > 0 else -1
    cycles = {name: sense * int(moving[name].advance * turns) for name in chosen}
    total = sum(abs(n) for n in cycles.values())
    if 2 * total > MOST:
        raise LtcgearError(_too_long(train, cycles))
    at = find_equilibrium(library, p) if at is None else at
    period = float(turns) * 2 * pi / abs(reference)
    point = OperatingPoint(library, p, at)
    follows = any(name in followed for name in chosen)
    whole = len(chosen) == len(varying)
    return Periodic(linearise(point), p, cycles, period, _borders(point, cycles), follows, whole)


def check_periodic(library: Library) -> None:
    """Refuse a model whose speed is not held and constant."""
    manifest = library.manifest
    if manifest.reference == "rest":
        raise LtcgearError("stability: the train stands still, so no stiffness varies; hold one, loads.NAME.speed")
    if manifest.reference == "torque":
        raise LtcgearError(
            "stability: the speed follows from the torques, so nothing is periodic; hold it: give one load a speed "
            "in place of its torque and initial_speed"
        )
    if manifest.signals:
        named = list(dict.fromkeys(signal.table for signal in manifest.signals))
        constant = ", ".join(signal.quantity for signal in manifest.signals if not signal.slope)
        raise LtcgearError(
            f"stability: nothing is periodic where loads change over time; give {constant} in place of "
            f"{', '.join(named)}"
        )


def choose_meshes(train: Train, varying: list[str], known: list[str], wanted: str | None) -> list[str]:
    """Return the varying meshes with a name: a mesh, the meshes of one kind, or a stage."""
    if not varying:
        raise LtcgearError(
            "stability: no stiffness varies; set effects.mesh_stiffness to two-level, smooth, fourier, table or "
            "computed, and give the mesh what that needs (double_factor, face_width or stiffness_table)"
        )
    if wanted is None:
        return varying

    def belong(names: list[str]) -> list[str]:
        return [name for name in names if wanted in (train.stage(name), train.group(name), name)]

    found = belong(varying)
    if found:
        return found
    if belong(known):
        raise LtcgearError(f"--mesh {wanted}: its stiffness does not vary; {_listed(train, varying)} do")
    near = get_close_matches(wanted, [*_kinds(train, varying), *varying], 1, 0.4)
    cure = f"did you mean {near[0]}?" if near else f"there are {_listed(train, varying)}"
    raise LtcgearError(f"--mesh {wanted!r:.60}: unknown; {cure}")


def reference_speed(library: Library, p: Vector) -> float:
    """Return the reference's speed [rad/s] of a model whose speed is held; LtcgearError where it is not."""
    check_periodic(library)
    return _speed(library, p)


def _speed(library: Library, p: Vector) -> float:
    speed = _held_speed(library, p)
    if speed == 0:
        raise LtcgearError(
            "stability: at a speed of 0 no stiffness varies; give the load that is held another loads.NAME.speed, or "
            "the command a --speed above 0"
        )
    return speed


def take_sense(library: Library, p: Vector, size: float) -> float:
    """Return a speed of the reference [rad/s] of a given magnitude in the scene's sense, forwards if it is at rest."""
    check_periodic(library)
    return -size if _held_speed(library, p) < 0 else size


def _held_speed(library: Library, p: Vector) -> float:
    """Return the speed [rad/s] at which the reference is held."""
    return float(p[[name for name, _ in library.manifest.parameters].index("reference.speed")])


def _at_speed(library: Library, p: Vector, speed: float) -> Vector:
    """Return the parameters with another speed of the reference."""
    names = [name for name, _ in library.manifest.parameters]
    changed = p.copy()
    changed[names.index("reference.speed")] = speed
    return changed


def _followed(library: Library) -> set[str]:
    """Return the meshes whose phase A follows between the jumps."""
    graph = library.graphs["jac_rhs"]
    symbols = [ca.SX.sym(graph.name_in(i), graph.sparsity_in(i)) for i in range(graph.n_in())]
    depends = ca.which_depends(graph.call(symbols)[0].nz[:], symbols[2], 1, False)
    names = {name for (name, _), found in zip(library.manifest.parameters, depends, strict=True) if found}
    return {clock.mesh for clock in library.manifest.clocks if clock.mesh and clock.start in names}


def _running(library: Library, meshes: list[str]) -> list[Clock]:
    """Return the clocks of some meshes."""
    return [clock for clock in library.manifest.clocks if clock.mesh in meshes]


def _common(lengths: list[Fraction]) -> Fraction:
    """Return the least common multiple of lengths."""
    return Fraction(lcm(*(each.numerator for each in lengths)), gcd(*(each.denominator for each in lengths)))


def _borders(point: OperatingPoint, cycles: dict[str, int]) -> Vector:
    """Return the parts of the period at which a level jumps: single contact begins at 0 and lasts for its share."""
    library, at = point.library, point.at
    tau, _, share = (part.copy() for part in Kernel(library.functions["phases"])(at.x, at.s, point.p))
    found = [np.array([0.0, 1.0])]
    for i, mesh in enumerate(library.manifest.levels):
        n = cycles.get(mesh, 0)
        for border in (0.0, share[i]) if n else ():
            found.append(np.sort(np.mod((border - tau[i] + np.arange(abs(n))) / n, 1.0)))
    places = np.sort(np.concatenate(found))
    near = TOGETHER / max(abs(n) for n in cycles.values())
    apart = np.append(np.diff(places) > near, True)
    places = places[apart]
    places[0], places[-1] = 0.0, 1.0
    return np.asarray(places)


def _too_long(train: Train, cycles: dict[str, int]) -> str:
    """Say how long the common period of some meshes is, and what to do."""
    stages = dict.fromkeys(map(train.stage, cycles))
    most = {stage: max(abs(n) for mesh, n in cycles.items() if train.stage(mesh) == stage) for stage in stages}
    counts = ", ".join(f"{count} of {stage}" for stage, count in most.items())
    return (
        f"stability: the common period of all meshes is too long: {counts} pitches; choose whose stiffness varies, "
        f"the others at their means: --mesh {next(iter(stages))}"
    )


def _kinds(train: Train, meshes: list[str]) -> list[str]:
    """Return the stages of meshes, and their groups."""
    return list(dict.fromkeys([*map(train.stage, meshes), *map(train.group, meshes)]))


def _listed(train: Train, meshes: list[str]) -> str:
    """List stages and kinds of meshes."""
    return ", ".join(_kinds(train, meshes))
