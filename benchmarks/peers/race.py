"""Races: runners take turns at several settings, and the time that each needs for one error is read off."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import exp, log
from statistics import median
from typing import Any

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
TARGET = 1e-4
"""Error of mesh forces, over their vibration, at which times are compared."""


@dataclass(frozen=True)
class Runner:
    """A tool at work.

    Attributes
    ----------
    tool, solver
        What it is called.
    run
        Takes a setting; returns the states at all samples and the seconds that the run took.
    settings
        Tolerances, or numbers of steps.
    rounds
        How often each setting is run.
    """

    tool: str
    solver: str
    run: Callable[[float], tuple[Vector, float]]
    settings: tuple[float, ...]
    rounds: int


def race(
    runners: Sequence[Runner], error: Callable[[Vector], float], told: Callable[[str], None] = lambda text: None
) -> list[dict[str, Any]]:
    """Let runners run by turns.

    Parameters
    ----------
    runners
        Who runs.
    error
        Error of the states at all samples.
    told
        Called with a line of text now and then.

    Returns
    -------
    list of dict
        Per runner ``tool``, ``solver``, ``points`` (``setting``, ``error``, ``min``, ``median``, ``runs``),
        ``reason`` (of settings that failed) and ``at_target`` (see ``time_at``; least times and medians).
    """
    seconds: dict[tuple[int, float], list[float]] = {}
    errors: dict[tuple[int, float], float] = {}
    reasons: dict[int, str] = {}
    for turn in range(max((runner.rounds for runner in runners), default=0)):
        for k, runner in enumerate(runners):
            for setting in runner.settings if turn < runner.rounds else ():
                if turn > 0 and (k, setting) not in errors:
                    continue  # it has failed
                try:
                    states, spent = runner.run(setting)
                except (RuntimeError, ValueError) as failure:
                    reasons[k] = f"{setting:g}: {(str(failure).splitlines() or ['failed'])[-1]}"
                    continue
                if turn == 0:
                    errors[k, setting] = error(states)
                seconds.setdefault((k, setting), []).append(spent)
        told(f"round {turn + 1} done")
    return [_row(k, runner, seconds, errors, reasons.get(k, "")) for k, runner in enumerate(runners)]


def _row(
    k: int, runner: Runner, seconds: dict[tuple[int, float], list[float]], errors: dict[tuple[int, float], float],
    reason: str,
) -> dict[str, Any]:  # fmt: skip
    """Put together what is known of a runner."""
    points = [
        {"setting": s, "error": errors[k, s], "min": min(t), "median": median(t), "runs": len(t)}
        for (i, s), t in seconds.items()
        if i == k
    ]
    at_target = {key: time_at([(p["error"], p[key]) for p in points]) for key in ("min", "median")}
    return {"tool": runner.tool, "solver": runner.solver, "points": points, "reason": reason, "at_target": at_target}


def time_at(points: Sequence[tuple[float, float]], target: float = TARGET) -> float | None:
    """Return the time at an error.

    Parameters
    ----------
    points
        (error, seconds) of several settings.
    target
        The error.

    Returns
    -------
    float or None
        Between the two nearest errors, linear in logarithms; that of the quickest point that is more accurate, where
        none is less so; None where none is as accurate. Never more than that of a more accurate point.
    """
    usable = sorted((e, t) for e, t in points if np.isfinite(e) and e > 0)
    better, worse = [p for p in usable if p[0] <= target], [p for p in usable if p[0] > target]
    if not better:
        return None
    quickest = min(t for _, t in better)
    if not worse:
        return quickest
    (e1, t1), (e2, t2) = better[-1], worse[0]
    part = log(target / e1) / log(e2 / e1)
    return min(exp(log(t1) + part * log(t2 / t1)), quickest)


def best(rows: Sequence[dict[str, Any]], tool: str, key: str = "min") -> dict[str, Any] | None:
    """Return the row of a tool that needs least time for the target, None where none gets there."""
    there = [row for row in rows if row["tool"] == tool and row["at_target"][key] is not None]
    return min(there, key=lambda row: float(row["at_target"][key]), default=None)
