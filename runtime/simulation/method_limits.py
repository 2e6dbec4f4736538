"""Limits of methods: runs that a method cannot finish, or not within the hour, are refused."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from ltcgear.generated.errors import LtcgearError

from ..model.blas import single_threaded
from ..model.library import Library
from ..model.load_tables import Pairs
from ..model.operating_point import OperatingPoint
from ..model.phase_wrapping import TURN, Clocks
from .choose_method import SHORTEST, reckon, step_operations
from .driver import LONGEST as LONGEST_ARC
from .duty import reference_speed
from .run_settings import RunSettings

REACH = 3.5
"""Step times |eigenvalue| up to which the explicit Runge-Kutta pair 5(4) of Tsitouras is stable."""
MOST_STEPS = 1e9
"""Steps above which a run is refused: minutes for the smallest scenes, hours for large ones."""
SPEED = 1e9
"""Operations per second assumed in estimates (measured on the rig and its stages: 1.0e9 to 1.8e9)."""
LONGEST = 3600.0
"""Estimated seconds above which a run needs ``--long``."""
DENSEST = 10.0
"""Upper bound of steps per radian of the fastest motion: if even these are quick, no closer estimate is made."""
POINTS = 4
"""Points at which outputs are read, to a sample (measured on the rig: three)."""
LEG = 3e5
"""Operations in the time between two legs: a knot of a table, a whole turn of the reference (measured: 0.3 ms)."""
BOUND = 3.0
"""Steps over those for accuracy or the longest segments, above which another cause is reported."""
ASKED = "--long, or long=True in Python, begins it all the same"


@dataclass(frozen=True)
class Work:
    """One part of what a run takes: operations, what they come from, and what makes fewer of them."""

    operations: float
    cause: str
    cure: str


@single_threaded()
def check_run(point: OperatingPoint, settings: RunSettings) -> None:
    """Refuse a run that would take more than about an hour, unless it is asked for (``long``).

    The estimate counts operations, so it is the same on every machine. It bounds what is foreseen only: steps of BDF,
    which undamped fast motions may hold at much shorter ones, and contacts that chatter are not.

    Raises
    ------
    LtcgearError
        It names what takes so long (body, mesh, samples, table) and the cure.
    """
    if settings.integrator.explicit:
        _check_steps(point, settings, np.inf if settings.long else MOST_STEPS, f"; {ASKED}")
    if settings.long:
        return
    parts = [
        *_teeth_work(point, settings), _sample_work(point.library, settings), *_table_work(settings.tables),
        *_step_work(point, settings),
    ]  # fmt: skip
    hours = sum(part.operations for part in parts) / SPEED / 3600
    if hours * 3600 > LONGEST:
        worst = max(parts, key=lambda part: part.operations)
        raise LtcgearError(
            f"the run would take about {hours:.2g} hours, most of them for {worst.cause}; {worst.cure}; {ASKED}"
        )


def check_explicit(point: OperatingPoint, settings: RunSettings) -> None:
    """Refuse a run that one fast motion takes from an explicit method: too many steps, or too many for Adams.

    Raises
    ------
    LtcgearError
        It names the body and the cure.
    """
    _check_steps(point, settings, MOST_STEPS, "")


def _check_steps(point: OperatingPoint, settings: RunSettings, most: float, asked: str) -> None:
    """Refuse more steps than ``most``, and how they may be asked for."""
    method, speed = settings.method, point.fastest
    stiffest = settings.integrator.stiffest
    slowest = _slowest(point) if np.isfinite(stiffest) else np.inf
    if speed / slowest > stiffest:
        raise LtcgearError(
            f"{method} is not for stiff models: {point.fastest_body} swings at {speed:.1e} rad/s, "
            f"{speed / slowest:.0e} times as fast as the slowest motion; use --method rosenbrock or cvodes"
        )
    steps = settings.t_end * speed / REACH
    if steps > most:
        body = point.fastest_body
        raise LtcgearError(
            f"{method} would need about {steps:.0e} steps: {body} swings at {speed:.1e} rad/s; "
            f"use --method rosenbrock, give {body.split()[0]} more inertia or softer springs, or simulate less time"
            f"{asked}"
        )


def _teeth_work(point: OperatingPoint, settings: RunSettings) -> list[Work]:
    """Return the work of switchings, and of subtracting whole turns from the reference angle."""
    manifest, t_end = point.library.manifest, settings.t_end
    levels, speed = manifest.levels, reference_speed(point, settings.tables)
    turns = t_end * speed / TURN
    found = [Work(LEG * turns, f"{turns:.1e} turns of the reference", "lower its speed or simulate less time")]
    rates = {name: abs(float(course.advance)) for name, course in Clocks(manifest, point.p).by_mesh.items()}
    if levels and rates:
        fastest = max(rates, key=lambda mesh: rates[mesh])
        frequency = speed * rates[fastest] / TURN
        switchings = 2 * len(levels) * frequency * t_end
        cause = f"{switchings:.1e} switchings of stiffness: the teeth of {fastest} mesh {frequency:.3g} times a second"
        each = settings.integrator.segment_operations
        found.append(Work(switchings * each, cause, "lower the speed or simulate less time"))
    return found


def _sample_work(library: Library, settings: RunSettings) -> Work:
    """Return the work of reading outputs."""
    samples, manifest = settings.t_end * settings.sampling_rate, library.manifest
    each = manifest.functions["outputs"].operations + 20 * len(manifest.reports)  # with filter and statistics
    return Work(POINTS * samples * each, f"{samples:.1e} samples", "lower the rate or simulate less time")


def _table_work(tables: Mapping[str, Pairs] | None) -> list[Work]:
    """Return the work of stops at the rows of tables."""
    rows = {name: len(table) for name, table in (tables or {}).items()}
    return [Work(LEG * count, f"{count:.1e} rows of {name}", "give fewer rows") for name, count in rows.items()]


def _step_work(point: OperatingPoint, settings: RunSettings) -> list[Work]:
    """Return the work of steps for stability and accuracy, and of the segments that they lie in."""
    method, t_end, speed = settings.integrator, settings.t_end, point.fastest
    explicit, beside = method.explicit, method.segment_operations
    each = step_operations(point.library)[not explicit]
    if DENSEST * speed * t_end * (each + beside) < SPEED * LONGEST / 4:
        return []
    pace, body = reckon(point, settings), point.fastest_body
    steps, segments = t_end * (pace.explicit if explicit else pace.stiff), t_end * pace.segments[not explicit]
    operations = steps * each + segments * beside
    # What is above these is held short by the fastest motion, by stability or since segments are.
    if steps < BOUND * t_end * pace.stiff and steps > BOUND * t_end * speed / (SHORTEST * LONGEST_ARC):
        return [Work(operations, f"{steps:.1e} steps for accuracy", "take a larger --rtol, or simulate less time")]
    cure = f"give {body.split()[0]} more inertia or softer springs, or simulate less time"
    cure = f"use --method rosenbrock, {cure}" if explicit else cure
    return [Work(operations, f"{steps:.1e} steps: {body} swings at {speed:.1e} rad/s", cure)]


def _slowest(point: OperatingPoint) -> float:
    """Return the smallest natural frequency [rad/s] that is not rigid."""
    from ..linear.modes import find_modes
    from ..linear.system import linearise

    modes = find_modes(linearise(point))
    found = (mode.frequency_hz for mode in modes if mode.kind != "rigid")
    return 2 * np.pi * min((hertz for hertz in found if hertz > 0), default=float("inf"))
