"""Duty cycle of a run: time at each speed and changes of load, before it is integrated.

Friction is steepest at rest and switching is proportional to speed, so the number of steps is a mean over the speeds.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..model.function import Kernel
from ..model.load_tables import Pairs, Signals
from ..model.operating_point import OperatingPoint
from ..model.parameter_values import name_values
from .run_settings import RunSettings

Vector = NDArray[np.float64]
INSTANTS = 512
"""Instants of a run at which its speed is sampled, denser where it passes through rest."""
HALVINGS = 40
"""Halvings of the time from a knot for these instants: down to 1e-12 of the run."""
EDGES = np.array([1e-8, 1e-6, 1e-4, 1e-3, 1e-2, 0.1, 0.3, 0.6])
"""Ranges of speed, over the highest, that count as one speed."""


@dataclass(frozen=True)
class Changes:
    """By how much load signals change within a run, and how fast: largest rate over size [1/s]; inf where they jump."""

    sizes: Vector
    rates: Vector


@dataclass(frozen=True)
class DutyPart:
    """A share of a run's time at about one speed: its operating point, and the changes of its loads."""

    share: float
    point: OperatingPoint
    changes: Changes


def list_duty(point: OperatingPoint, settings: RunSettings) -> list[DutyPart]:
    """Return the parts of a run; the operating point alone where speed and loads stay."""
    library, at, p = point.library, point.at, point.p
    kinds, names = library.manifest.signals, [state.name for state in library.manifest.states]
    free = names.index("reference.speed") if "reference.speed" in names else None
    if (kinds and not settings.tables) or not (kinds or free is not None):
        return [DutyPart(1.0, point, Changes(np.zeros(0), np.zeros(0)))]
    signals = Signals(kinds, settings.tables or {})
    time, weight = _instants(signals, settings.t_end)
    values, changes = signals.over(time), _changes(signals, time)
    speed = np.zeros(len(time))
    if free is not None:
        speed = at.x[free] + float(Kernel(library.functions["rhs"])(at.x, at.s, p)[0][free]) * time
    for i, kind in enumerate(kinds):
        if kind.name == "reference.speed":
            speed = values[:, i]
    parts, place = [], np.digitize(np.abs(speed), EDGES * max(np.abs(speed).max(), 1e-300))
    for each in np.unique(place):
        chosen = np.flatnonzero(place == each)
        middle = chosen[np.argsort(np.abs(speed[chosen]))[len(chosen) // 2]]
        x = at.x.copy()
        if free is not None:
            x[free] = speed[middle]
        there = replace(point, at=replace(at, x=x, signals=values[middle]))
        parts.append(DutyPart(float(weight[chosen].sum()), there, changes))
    return parts


def _instants(signals: Signals, t_end: float) -> tuple[Vector, Vector]:
    """Return instants of a run [s], dense at knots and zeros of tables, and their shares of its time."""
    near = t_end * 0.5 ** np.arange(1, HALVINGS + 1)
    inner = [0.0, *(knot for knot in signals.knots[:INSTANTS] if 0 < knot < t_end)]
    beside = np.concatenate([np.add.outer(inner, near).ravel(), np.subtract.outer(inner, near).ravel()])
    every = np.concatenate([np.linspace(0.0, t_end, INSTANTS), beside[(beside > 0) & (beside < t_end)]])
    edges = np.unique(every)
    return (edges[1:] + edges[:-1]) / 2, np.diff(edges) / t_end


def _changes(signals: Signals, time: Vector) -> Changes:
    """Return the changes of all signals."""
    values = signals.over(time)
    sizes = np.ptp(values, axis=0) if len(values) else np.zeros(0)
    rates = np.full(len(sizes), np.inf)
    for i, (table, sloping) in enumerate(zip(signals.tables, signals.sloping, strict=True)):
        steepest = np.abs(np.diff(table[1]) / np.diff(table[0])).max(initial=0.0)
        if not sloping:
            rates[i] = steepest / max(sizes[i], 1e-300)
    return Changes(sizes, np.maximum(rates, 1e-300))


def reference_speed(point: OperatingPoint, tables: Mapping[str, Pairs] | None = None) -> float:
    """Return the highest speed of the reference that is given, held, over time or at the start [rad/s]."""
    manifest = point.library.manifest
    names = [state.name for state in manifest.states]
    number = name_values(manifest, point.p)
    speeds = [number[name] for name in ("reference.speed",) if manifest.reference == "speed" and name in number]
    speeds += [float(point.at.x[names.index(name)]) for name in ("reference.speed",) if name in names]
    given = [signal.table for signal in manifest.signals if signal.name == "reference.speed"]
    speeds += [value for table in given for _, value in (tables or {})[table]]
    return max(map(abs, speeds), default=0.0)
