"""Choice of the integrator: explicit, with steps limited by stability, or implicit, with steps limited by accuracy.

The linearised model gives both limits. Its eigenvalues limit an explicit step; the excitation of its modes by jumps of
stiffness, errors of teeth and loads limits a step for accuracy.
"""

from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from ..model.blas import single_threaded
from ..model.function import Kernel
from ..model.library import Library
from ..model.operating_point import Complex, OperatingPoint
from ..model.state_matrix import settled
from .driver import LONGEST
from .duty import Changes, list_duty
from .methods.registry import ERK, ROSENBROCK
from .run_settings import RunSettings

Vector = NDArray[np.float64]
UNCHANGED = Changes(np.zeros(0), np.zeros(0))
GROWTH = np.polynomial.Polynomial([1, 1, 1 / 2, 1 / 6, 1 / 24, 1 / 120, 0.001432211324807348])
"""Growth of a mode in a step, over h lambda, by the explicit 5(4) pair (Tsitouras 2011)."""
REACH = np.linspace(0.5, 3.7, 321)
"""|h lambda| at which growth is evaluated: it passes 1 between 1.0 without damping and 3.5 without oscillation."""
UNSEEN = 1e-4
"""Growth in a step that the error control corrects long before it matters."""
PER_STEP = 6
"""Right-hand sides per step of the explicit pair."""
STAGES = 8
"""Stages of the Rosenbrock method."""
SPARSE = 1.25
"""Time of an operation of a sparse factorisation over that of one in straight-line code (measured: 1 to 2)."""
SHORTEST = 8.0
"""Angle of the fastest mode in the shortest segment."""
PER_SEGMENT = 4.5
"""Steps of a segment where fast modes are at rest, at least (measured)."""
ERROR = 1e-3
"""Error of a step of both methods: ERROR a (h omega)^5 for a mode of amplitude a (fitted to the rig's steps)."""
REST = 1.2
"""h omega at which a mode with an amplitude within the tolerance counts as at rest: an L-stable step damps it."""
GAIN = 1.2
"""How much cheaper the stiff method must be to be chosen: it takes longer to compile."""
IDLE = 1e9
"""Operations a second of a model at rest, about a second, above which the stiff method is worth its compilation."""
GONE = 1e4
"""Decay exponent of a mode between two excitations above which it is never resolved."""
RIGID = 1e-6
"""Modes below this part of the largest eigenvalue are rigid."""
TIMES = np.linspace(0.0, 1.0, 65) ** 4
"""Times between two switchings at which steps are estimated, denser after the jump."""


@dataclass(frozen=True)
class Choice:
    """A method and why it is taken; None if the user chose."""

    method: str
    why: str | None


@dataclass(frozen=True)
class Pace:
    """Cost rate of a run: steps and segments per second for both kinds of methods, means over the duty cycle.

    ``fastest`` is the largest eigenvalue [1/s] and ``stable`` the explicit steps needed for stability [1/s].
    """

    explicit: float
    stiff: float
    segments: tuple[float, float]
    fastest: float
    stable: float


@single_threaded()
def choose(point: OperatingPoint, settings: RunSettings) -> Choice:
    """Choose between ``erk`` and ``rosenbrock`` by the steps that a run needs of both and what a step costs."""
    pace, (explicit, stiff) = reckon(point, settings), step_operations(point.library)
    if not pace.stiff:
        still, slow = "nothing sets the model going from its equilibrium", pace.stable * explicit > IDLE
        return Choice((ROSENBROCK if slow else ERK).name, still)
    costs = [
        pace.explicit * explicit + pace.segments[0] * ERK.segment_operations,
        pace.stiff * stiff + pace.segments[1] * ROSENBROCK.segment_operations,
    ]
    why = (
        f"the fastest eigenvalue, {pace.fastest:.2g} 1/s, binds explicit steps to {pace.stable:.2g} a second at least; "
        f"accuracy calls for {pace.stiff:.2g}, and a stiff step costs {stiff / explicit:.2g} times as much"
    )
    return Choice((ROSENBROCK if costs[0] > GAIN * costs[1] else ERK).name, why)


def reckon(point: OperatingPoint, settings: RunSettings) -> Pace:
    """Return what a run takes a second, its mean over the duty."""
    parts = list_duty(point, settings)
    paces = [_pace_at(part.point, settings.rtol, part.changes) for part in parts]
    shares = np.array([part.share for part in parts])
    rows = np.array([[pace.explicit, pace.stiff, *pace.segments, pace.stable] for pace in paces])
    explicit, stiff, one, two, stable = (shares @ rows).tolist()
    return Pace(explicit, stiff, (one, two), max(pace.fastest for pace in paces), stable)


def _pace_at(point: OperatingPoint, rtol: float, changes: Changes) -> Pace:
    """Return what a run takes a second while speeds and loads are about those of a point."""
    values, accuracy = excited_rates(point, rtol, changes)
    stable, fastest = stability_rate(values), float(np.abs(values).max(initial=0.0))
    steps = [float(np.trapezoid(rate, TIMES)) for rate in (np.maximum(accuracy, stable), accuracy)]
    bound = float(np.trapezoid(accuracy < stable, TIMES))
    segments = 0.0, 0.0
    manifest = point.library.manifest
    if manifest.levels or manifest.signals or manifest.holds:
        most = fastest / SHORTEST
        resting = max(min(steps[1] / PER_SEGMENT, most), most / LONGEST)
        segments = bound * most + (1 - bound) * resting, resting
    return Pace(steps[0], max(steps[1], segments[1]) if steps[1] else 0.0, segments, fastest, stable)


def stability_rate(values: Complex) -> float:
    """Return the steps a second [1/s] below which the explicit pair lets some mode grow that decays."""
    directions = np.minimum(values.real, 0.0) + 1j * values.imag
    directions = directions / np.maximum(np.abs(directions), 1e-300)
    stable = np.abs(GROWTH(np.outer(directions, REACH))) <= 1.0 + UNSEEN
    reach = REACH[np.where(stable.all(axis=1), -1, np.argmin(stable, axis=1))]
    return float((np.abs(values) / reach).max(initial=0.0))


def step_operations(library: Library) -> tuple[float, float]:
    """Return the operations of an explicit step, and of a Rosenbrock step: stages, Jacobian and sparse QR."""
    rhs, jacobian = (library.manifest.functions[name].operations for name in ("rhs", "jac_rhs"))
    pattern = library.functions["jac_rhs"].sparsity_out(0)
    n = pattern.size1()
    left, right, _, _ = (pattern + ca.Sparsity.diag(n)).qr_sparse()
    columns, rows = np.diff(left.colind()), np.diff(right.T.colind())
    sparse = float(4 * columns @ rows[: len(columns)]) + STAGES * (4 * left.nnz() + 2 * right.nnz())
    stage = rhs + 7.0 * n  # with the sum of the stages before it
    return PER_STEP * stage, STAGES * stage + jacobian + SPARSE * sparse


def excited_rates(point: OperatingPoint, rtol: float, changes: Changes = UNCHANGED) -> tuple[Complex, Vector]:
    """Return the eigenvalues [1/s], and the steps per second needed for accuracy at TIMES between two switchings.

    A jump excites each mode, which then decays until the next one. What varies without jumps excites modes all the
    time.
    """
    values, amplitude, shapes = excited_modes(point, changes)
    decay = _decay(point, values)
    weight = np.maximum(shapes @ amplitude, 1.0)
    size = (shapes / weight[:, None]).max(axis=0) * amplitude
    angles = (ERROR * size[:, None] * np.exp(-np.outer(decay, TIMES)) / rtol) ** 0.2
    rates = np.abs(values)[:, None] * np.where(angles * REST > 1, angles, 0.0)
    # Once set going, the slowest mode is to be followed, unless it is gone at once.
    slow = float(np.abs(values[decay < GONE]).min(initial=np.inf))
    least = slow if amplitude.any() and np.isfinite(slow) else 0.0
    return values, np.maximum(rates.max(axis=0, initial=0.0), least)


def excited_modes(point: OperatingPoint, changes: Changes = UNCHANGED) -> tuple[Complex, Vector, Vector]:
    """Return the amplitudes of modes excited by jumps of stiffness, errors of teeth and loads.

    Parameters
    ----------
    point
        Operating point of the modes.
    changes
        Of load signals over time.

    Returns
    -------
    values, amplitude, shapes
        Eigenvalues of all modes that are not rigid [1/s], shape (m,), their amplitudes in scaled coordinates after many
        excitations, shape (m,), and the magnitudes of their shapes, shape (n, m).
    """
    values, shapes = point.stiffest_spectrum
    jumps, swings = _pushes(point), _swings(point, changes)
    pushes = np.hstack([jumps, swings]) / point.scale[:, None]
    moving = np.abs(values) > RIGID * np.abs(values).max()
    parts = np.linalg.lstsq(shapes, pushes.astype(np.complex128), rcond=None)[0][moving]
    values, sizes = values[moving], np.abs(shapes[:, moving])
    parts[:, jumps.shape[1] :] *= np.minimum(1.0, 2 * np.multiply.outer(1 / np.abs(values), changes.rates))
    staying = 1 / np.sqrt(np.maximum(1 - np.exp(-2 * _decay(point, values)), 1e-3))
    return values, np.abs(parts).max(axis=1, initial=0.0) / np.abs(values) * staying, sizes


def _decay(point: OperatingPoint, values: Complex) -> Vector:
    """Return the exponent by which each mode decays between two switchings [1]."""
    return np.asarray(np.maximum(-values.real, 0.0) * (_between(point) if len(point.at.levels) else 0.0))


def _pushes(point: OperatingPoint) -> Vector:
    """Return the jumps of the accelerations: what is out of balance at the start, and by each mesh's level."""
    library, at, p = point.library, point.at, point.p
    rhs = Kernel(library.functions["rhs"])
    count = len(at.levels)

    def rates(levels: Vector, p: Vector) -> Vector:
        return rhs(at.x, np.concatenate([levels, at.signals]), p)[0].copy()

    ones, means = np.ones(count), settled(library, p)
    pushes = [rates(at.levels, p) - rates(at.levels, means), rates(ones, p) - rates(ones, means)]
    pushes += [rates(level, p) - rates(np.zeros(count), p) for level in np.eye(count)]
    return np.array(pushes).T


def _swings(point: OperatingPoint, changes: Changes) -> Vector:
    """Return by how much accelerations change with each load signal over time, shape (n, signals)."""
    at, p, rhs = point.at, point.p, Kernel(point.library.functions["rhs"])
    first = rhs(at.x, at.s, p)[0].copy()
    found = [rhs(at.x, np.concatenate([at.levels, at.signals + row]), p)[0] - first for row in np.diag(changes.sizes)]
    return np.array(found).reshape(-1, len(at.x)).T


def _between(point: OperatingPoint) -> float:
    """Return the mean time between switchings [s]; a second where nothing switches."""
    tau_rate = Kernel(point.library.functions["phases"])(point.at.x, point.at.s, point.p)[1]
    often = float(2 * np.abs(tau_rate).sum()) if len(tau_rate) else 0.0
    return 1 / often if often > 0 else 1.0
