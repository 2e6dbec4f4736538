"""Integrate: segments of smooth motion between switching instants, sampled on a uniform grid."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from time import perf_counter

import numpy as np
from ltcgear.generated.errors import SolverError
from numpy.typing import NDArray

from .equilibrium import Equilibrium
from .extremes import MeshExtremes
from .library import Library
from .march import March
from .sampling import Samples
from .signals import Pairs, Signals
from .stepper import Counts

Vector = NDArray[np.float64]
Told = Callable[[float], None]
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
    phi, turns
        Reference angle [rad] less the whole turns that were taken off it, and these, shapes (m,).
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
    phi: Vector
    turns: NDArray[np.int64]

    @property
    def s(self) -> Vector:
        """Return levels and signals, the functions' second argument, shape (m, l + k)."""
        return np.hstack([self.levels, self.signals])


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
        march = March(library, p, at, method, rtol, count, rate, signals)
    except RuntimeError as error:
        raise SolverError(f"{method} cannot be set up: {str(error).splitlines()[-1]}") from error
    prepared = perf_counter()
    samples = Samples(march, np.arange(count + 1) / rate)
    status = _proceed(march, samples, told, f"{method} stopped at t = {{:.6g}} s (rtol {rtol:g})")
    expected = march.expected_events()
    if status == "done" and expected not in (None, march.stepper.counts.events):
        status = f"{march.stepper.counts.events} stiffness switchings, not the {expected} of kinematics: not to be used"
    energy = march.first_energy, march.energy(march.z, march.cells, signals.at(march.time))
    return Trajectory(
        *samples.taken(), march.work, march.jump_energy, energy, march.stepper.counts, expected, march.extremes, status,
        min(march.time, float(samples.time[-1])),
        {"prepare": prepared - clock, "integrate": perf_counter() - prepared},
        signals.over(samples.time[: samples.done]), samples.phi[: samples.done], samples.turns[: samples.done],
    )  # fmt: skip


def _proceed(march: March, samples: Samples, told: Told, stopped: str) -> str:
    """Integrate segment by segment to the end; return ``done``, or why it stopped and what to try."""
    shown = 0.0
    while samples.done < len(samples.time):
        start = march.time
        try:
            duration, path, level = march.segment(samples.time[-1] - start)
        except RuntimeError as error:
            cause = str(error).strip().splitlines()[-1][:200]
            return f"{stopped.format(start)}: {cause}; {CURE}"
        except KeyboardInterrupt:
            return f"interrupted at t = {start:.6g} s; what was computed until then is kept"
        samples.take(start, duration, path, level)
        if perf_counter() - shown > 0.1:
            shown = perf_counter()
            told(march.time)
    return "done"
