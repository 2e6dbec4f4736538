"""Integrate: segments of smooth motion between switching instants, sampled on a uniform grid."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from time import perf_counter

import numpy as np
from ltcgear.generated.errors import SolverError
from numpy.typing import NDArray

from .equilibrium import Equilibrium, inertias, pulling, state_matrix
from .extremes import MeshExtremes
from .kernel import Kernel
from .library import Library
from .nodes import Chebyshev, Nodes, Uniform
from .signals import Pairs, Signals
from .stepper import MULTISTEP, Counts, Frame, make_stepper
from .switching import Cells, Phases, at_border, cells_of, crossed, levels_of, lower, time_to_border, upper

Vector = NDArray[np.float64]
Told = Callable[[float], None]
LOADED, UNLOADED = 1e-9, 1e-6
"""Strain energy [J] above which a train counts as loaded; energy a freedom that stands for it in one that is not."""
CURE = "try another --method or a larger --rtol, and look at the last samples for a member that runs away"


@dataclass(frozen=True)
class Trajectory:
    """What an integration gave, up to its end or its failure.

    Attributes
    ----------
    time, x, levels, signals
        Sample times [s], states, mesh levels and load signals, shapes (m,), (m, n), (m, l), (m, k).
    work
        Work done on the system by loads and drives less losses [J].
    jump_energy
        Energy that the stiffness jumps put in [J].
    energy
        Kinetic and potential energy at the start and at the end [J].
    counts
        Steps, right-hand sides, Jacobians, segments, events.
    expected_events
        Switchings between the first and the last mesh phases, and those where a speed over time passes
        through zero; None if a mesh has turned back anywhere else.
    extremes
        Smallest and largest mesh forces.
    status
        ``done``, or why it stopped and what to do.
    end
        Time reached [s].
    seconds
        Time taken to set the integrator up (it may have to be compiled) and to integrate [s].
    """

    time: Vector
    x: Vector
    levels: Vector
    work: float
    jump_energy: float
    energy: tuple[float, float]
    counts: Counts
    expected_events: int | None
    extremes: MeshExtremes
    status: str
    end: float
    seconds: dict[str, float]
    signals: Vector

    @property
    def s(self) -> Vector:
        """Return levels and signals, the functions' second argument, shape (m, l + k)."""
        return np.hstack([self.levels, self.signals])


def vibration_scale(library: Library, at: Equilibrium, p: Vector) -> Vector:
    """Return a size for every state: the motion in which it alone stores one small energy.

    The energy is 1e-4 of the mean strain energy per freedom of the loaded equilibrium (1e-6 J unloaded),
    so that coordinates of all kinds weigh alike: x = sqrt(2 E / k), v = sqrt(2 E / m). One relative
    tolerance thus refers to deflections of about a hundredth of the static ones.
    """
    position, rate, mass = library.index(""), library.index(".rate"), inertias(library, p)
    strain = float(Kernel(library.functions["energy"])(at.x, at.s, p)[0][1])
    energy = 1e-4 * strain / len(mass) if strain > LOADED else UNLOADED
    matrix = state_matrix(library, at.x, at.s, pulling(library, p))
    diagonal = -np.diag(matrix[np.ix_(rate, position)]) * mass
    speed = np.sqrt(2 * energy / mass)
    stiffest = float(np.max(diagonal / mass))
    floor = (1e-8 * stiffest if stiffest > 0 else 1.0) * mass  # where nothing holds anything, 1 rad/s sets the size
    scale = np.ones(len(at.x))
    scale[position] = np.sqrt(2 * energy / np.maximum(diagonal, floor))
    scale[rate] = speed
    return scale


def fastest(library: Library, at: Equilibrium, p: Vector) -> float:
    """Return the largest eigenvalue's modulus [1/s] of the linearised model."""
    scale = vibration_scale(library, at, p)
    matrix = state_matrix(library, at.x, at.s, pulling(library, p)) * scale[None, :] / scale[:, None]
    return float(np.abs(np.linalg.eigvals(matrix)).max())


class _Run:
    """An integration under way."""

    def __init__(
        self, library: Library, p: Vector, at: Equilibrium, method: str, rtol: float, samples: int, rate: float,
        signals: Signals,
    ) -> None:  # fmt: skip
        self.library, self.p, self.at, self.signals = library, p, at, signals
        self.frame = Frame(at.x, vibration_scale(library, at, p))
        self.nodes, self.longest = self._layout(method, samples, rate)
        self.stepper = make_stepper(library, method, rtol, self.frame, p, self.nodes.points[1:])
        self.phase_kernel, self.energy_kernel = (
            Kernel(library.functions["phases"]),
            Kernel(library.functions["energy"]),
        )
        self.z = np.zeros(len(at.x))
        self.work = self.jump_energy = self.time = 0.0
        names, kinds = [state.name for state in library.manifest.states], library.manifest.signals
        self.speed = next((i for i, signal in enumerate(kinds) if signal.name == "reference.speed"), None)
        self.angle = names.index("reference.angle") if "reference.angle" in names else -1
        start = signals.at(0.0)
        self.cells: Cells = cells_of(self.phases(self.z, start))
        self.last_turn, self.expected, self.reversed = self.cells, 0, False
        self.first_energy = self.energy(self.z, self.cells, start)
        self.extremes = MeshExtremes(library, p, len(self.nodes.points), samples / rate)

    def _layout(self, method: str, samples: int, rate: float) -> tuple[Nodes, float]:
        """Choose nodes and longest segment [s]: blocks of samples where nothing switches or bends, else Chebyshev.

        A segment between switchings is so short that the fastest mode turns by 8 rad between 17 nodes, or
        16 rad between 25, at most; polynomials through them are right to 1e-9 then.
        """
        if not self.library.manifest.levels and not self.library.manifest.signals:
            block = min(256, samples)
            return Uniform(block), block / rate
        count, turn = (24, 16.0) if method in MULTISTEP else (16, 8.0)
        return Chebyshev(count), turn / fastest(self.library, self.at, self.p)

    def phases(self, z: Vector, signals: Vector) -> Phases:
        """Return the mesh phases of a state under some load signals."""
        s = np.concatenate([np.zeros(len(self.library.manifest.levels)), signals])
        tau, rate, share = self.phase_kernel(self.frame.origin + self.frame.scale * z, s, self.p)
        return Phases(tau.copy(), rate.copy(), share.copy())

    def energy(self, z: Vector, cells: Cells, signals: Vector) -> float:
        """Return kinetic and potential energy [J], weight included."""
        s = np.concatenate([levels_of(cells), signals])
        balance = self.energy_kernel(self.frame.origin + self.frame.scale * z, s, self.p)[0]
        return float(balance[0] + balance[1] + balance[2])

    def segment(self, left: float) -> tuple[float, Vector, Vector]:
        """Integrate to the next switching instant or knot, ``left`` seconds at most; return duration, path, levels.

        Where nothing switches or bends, the last block of samples is finished even beyond the end.
        """
        signals, slope = self.signals.at(self.time), self.signals.rate(self.time)
        now, knot = self.phases(self.z, signals), self.signals.next_knot(self.time)
        most = min(self.longest, knot - self.time, left if isinstance(self.nodes, Chebyshev) else self.longest)
        gain = np.zeros_like(now.rate)
        if self.speed is not None:
            gain = (self.phases(self.z, signals + slope * most).rate - now.rate) / most
            self._stand(now, gain, signals)
        levels, duration = levels_of(self.cells), min(time_to_border(self.cells, now, gain), most)
        if duration <= 0:
            raise RuntimeError("two switching instants of one mesh fall together; check its contact ratio")
        s = np.concatenate([levels, signals])
        for _ in range(20):
            path, work = self.stepper.advance(self.z, duration, self.frame.origin, s, slope)
            times = duration * self.nodes.points
            path = self._on_course(np.vstack([self.z, path]), times, signals, slope)
            after = self.phases(path[-1], signals + slope * duration)
            cells, part = crossed(self.cells, now, after)
            if part == 1.0:
                break
            duration *= part  # the rates were not constant: go back to the segment's start with a shorter one
        else:
            raise RuntimeError("a switching instant could not be located in 20 trials")
        self.reversed |= self.speed is None and bool((now.rate * after.rate < 0).any())
        self.extremes.note(
            self.frame.origin + self.frame.scale * path, s + np.outer(times, self._rates(slope)), self.time + times
        )
        self.time = knot if duration == knot - self.time else self.time + duration
        self.work, self.z = self.work + work, path[-1].copy()
        self._switch(cells, signals + slope * duration)
        return duration, path, levels

    def _rates(self, slope: Vector) -> Vector:
        """Return the rates of levels and signals."""
        return np.concatenate([np.zeros(len(self.library.manifest.levels)), slope])

    def _on_course(self, path: Vector, times: Vector, signals: Vector, slope: Vector) -> Vector:
        """Put in the reference angle, which a speed over time makes known: no tolerance then moves a switching."""
        if self.speed is not None:
            angle, speed = self.angle, self.speed
            turned = signals[speed] * times + slope[speed] * times**2 / 2
            path[:, angle] = path[0, angle] + turned / self.frame.scale[angle]
        return path

    def _stand(self, now: Phases, gain: Vector, signals: Vector) -> None:
        """At a standstill, note the cells, and leave those at whose border it stands in the direction ahead."""
        if now.rate.any():
            return
        self.expected += self._passed(now)
        self.last_turn = self._counted(now)
        ahead = Phases(now.tau, gain, now.share)
        cells, _ = crossed(self.cells, ahead, ahead)
        self.expected += int(np.abs(cells - self.cells).sum())
        self.last_turn = self.last_turn + cells - self.cells
        self._switch(cells, signals)

    def _counted(self, now: Phases) -> Cells:
        """Return the cells by kinematics; a standstill on a border belongs to the cell that is being left."""
        beside = np.minimum(
            np.abs(now.tau - lower(self.cells, now.share)), np.abs(now.tau - upper(self.cells, now.share))
        )
        return np.where((now.rate == 0) & (beside <= at_border(now)), self.cells, cells_of(now))

    def _passed(self, now: Phases) -> int:
        """Return the switchings since the last standstill by kinematics."""
        return int(np.abs(self._counted(now) - self.last_turn).sum())

    def expected_events(self) -> int | None:
        """Return the switchings that kinematics calls for; None if that cannot be told from a few phases."""
        now = self.phases(self.z, self.signals.at(self.time))
        return None if self.reversed else self.expected + self._passed(now)

    def _switch(self, cells: Cells, signals: Vector) -> None:
        """Go over to other cells, and book what the stiffness jumps put in."""
        if (cells != self.cells).any():
            before = self.energy(self.z, self.cells, signals)
            self.jump_energy += self.energy(self.z, cells, signals) - before
            self.stepper.counts.events += int(np.abs(cells - self.cells).sum())
            self.cells = cells


def integrate(
    library: Library, p: Vector, at: Equilibrium, *, t_end: float, rate: float, method: str, rtol: float,
    told: Told = lambda t: None, tables: Mapping[str, Pairs] | None = None,
) -> Trajectory:  # fmt: skip
    """Integrate from the equilibrium.

    Parameters
    ----------
    library, p, at
        Model, parameters and initial state.
    t_end
        Time to simulate [s].
    rate
        Samples a second [Hz].
    method, rtol
        See ``stepper``.
    told
        Called with the simulated time now and then.
    tables
        The model's tables over time, by name.

    Returns
    -------
    Trajectory
        A failure is a status in it, and what was computed until then is kept.
    """
    clock = perf_counter()
    count = round(t_end * rate)
    signals = Signals(library.manifest.signals, tables or {})
    try:
        run = _Run(library, p, at, method, rtol, count, rate, signals)
    except RuntimeError as error:
        raise SolverError(f"{method} cannot be set up: {str(error).splitlines()[-1]}") from error
    prepared = perf_counter()
    samples = _Samples(run, np.arange(count + 1) / rate)
    status = _proceed(run, samples, told, f"{method} stopped at t = {{:.6g}} s (rtol {rtol:g})")
    expected = run.expected_events()
    if status == "done" and expected not in (None, run.stepper.counts.events):
        status = f"{run.stepper.counts.events} stiffness switchings, not the {expected} of kinematics: not to be used"
    energy = run.first_energy, run.energy(run.z, run.cells, signals.at(run.time))
    return Trajectory(
        *samples.taken(), run.work, run.jump_energy, energy, run.stepper.counts, expected, run.extremes, status,
        min(run.time, float(samples.time[-1])),
        {"prepare": prepared - clock, "integrate": perf_counter() - prepared},
        signals.over(samples.time[: samples.done]),
    )  # fmt: skip


class _Samples:
    """The uniform samples of a run, filled segment by segment."""

    def __init__(self, run: _Run, time: Vector) -> None:
        self.run, self.time, self.done = run, time, 1
        self.x, self.levels = np.empty((len(time), len(run.z))), np.empty((len(time), len(run.cells)))
        self.x[0], self.levels[0] = run.frame.origin, levels_of(run.cells)

    def take(self, start: float, duration: float, path: Vector, level: Vector) -> None:
        """Read the samples that lie in a segment, its end included."""
        end = start + duration * (1 + 1e-12)
        last = self.done + int(np.searchsorted(self.time[self.done :], end, side="right"))
        if self.done < last:
            inside = self.run.nodes.matrix((self.time[self.done : last] - start) / duration)
            self.x[self.done : last] = self.run.frame.origin + self.run.frame.scale * (inside @ path)
            self.levels[self.done : last] = level
        self.done = last

    def taken(self) -> tuple[Vector, Vector, Vector]:
        """Return times, states and levels so far."""
        return self.time[: self.done], self.x[: self.done], self.levels[: self.done]


def _proceed(run: _Run, samples: _Samples, told: Told, stopped: str) -> str:
    """Integrate segment by segment to the end; return ``done``, or why it stopped and what to try."""
    shown = 0.0
    while samples.done < len(samples.time):
        start = run.time
        try:
            duration, path, level = run.segment(samples.time[-1] - start)
        except RuntimeError as error:
            cause = str(error).strip().splitlines()[-1][:200]
            return f"{stopped.format(start)}: {cause}; {CURE}"
        except KeyboardInterrupt:
            return f"interrupted at t = {start:.6g} s; what was computed until then is kept"
        samples.take(start, duration, path, level)
        if perf_counter() - shown > 0.1:
            shown = perf_counter()
            told(run.time)
    return "done"
