"""Cost of effects: time of variants of a model, and how far their mesh forces are off."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from time import perf_counter
from typing import Any

import numpy as np
from ltcgear.generated.errors import SolverError

from ..model.energy_levels import LOADED
from ..model.equilibrium import find_equilibrium
from ..model.function import Kernel
from ..model.library import Library
from ..model.load_tables import Pairs
from ..results.result import Result
from ..simulation.simulate import simulate
from .force_comparison import MEASURES, compare_forces, find_worst

BATCH = 32
"""Right-hand sides per timed call from Python, so that the interpreter's time does not count."""
BLOCKS, ROUNDS = 40, 5
"""Timed batches, and timed runs, of each variant; the least counts."""
QUICK, REPEATS = 0.1, 5
"""Runs of less than 0.1 s are repeated, since other work on the machine would show in them."""


@dataclass(frozen=True)
class Variant:
    """A model with one effect at another value; ``library`` is None if there is no such model, for ``reason``.

    ``values`` and ``tables`` are the model's numbers and its loads over time.
    """

    effect: str
    value: str
    without: str
    library: Library | None
    values: Mapping[str, float]
    reason: str = ""
    tables: Mapping[str, Pairs] = field(default_factory=dict)


@dataclass(frozen=True)
class _Run:
    """A variant at work: right-hand sides ready to be called, its first result, and the least times [s] found."""

    library: Library
    values: Mapping[str, float]
    tables: Mapping[str, Pairs]
    batch: Kernel
    result: Result | None = None
    seconds: float = np.inf
    call: float = np.inf


def measure_costs(
    variants: Sequence[Variant],
    *,
    t_end: float,
    rate: float,
    rtol: float,
    method: str = "erk",
    told: Callable[[float], None] = lambda t: None,
) -> list[dict[str, Any]]:
    """Run variants of a model in turn and compare them with the first.

    Parameters
    ----------
    variants
        The full model first; those without a library become rows that hold their reason.
    t_end, rate
        Time to simulate [s] and samples a second [Hz]; the second half is compared.
    rtol, method
        As for ``simulate``.
    told
        Called with the time simulated so far, of all runs together [s].

    Returns
    -------
    list of dict
        Per variant: ``effect``, ``value``, ``without``, ``reason`` (empty where it ran), ``states``, ``ops``,
        ``ns_call`` (least time of one right-hand side [ns]), ``seconds_per_simulated_second``, ``counts``,
        ``changes`` against the first (see ``compare_forces``; the worst stage) and ``stages`` (the same by stage).

    Raises
    ------
    SolverError
        If the first one cannot be run.
    """
    rows = [_row(variant) for variant in variants]
    runs: dict[int, _Run] = {}
    for k, variant in enumerate(variants):
        try:
            runs |= {k: _start(variant)} if variant.library is not None else {}
        except SolverError as error:
            rows[k]["reason"] = str(error)
    _time_calls(runs)
    options = {"t_end": t_end, "rate": rate, "rtol": rtol, "method": method}
    for turn in range(ROUNDS):
        for place, k in enumerate(list(runs)):
            before = (turn * len(runs) + place) * t_end
            try:
                runs[k] = _timed(runs[k], partial(_later, told, before), options)
            except SolverError as error:
                rows[k]["reason"] = str(error)
                del runs[k]
    _compare(rows, runs)
    return rows


def _later(told: Callable[[float], None], before: float, now: float) -> None:
    """Report the simulated time of this run plus that of earlier ones."""
    told(before + now)


def _row(variant: Variant) -> dict[str, Any]:
    """Return what is known of a variant before it runs."""
    row: dict[str, Any] = {
        "effect": variant.effect, "value": variant.value, "without": variant.without, "reason": variant.reason,
        "states": None, "ops": {"rhs": None, "jacobian": None}, "ns_call": None, "seconds_per_simulated_second": None,
        "counts": {}, "changes": dict.fromkeys(MEASURES), "stages": {},
    }  # fmt: skip
    if variant.library is not None:
        manifest = variant.library.manifest
        row["states"] = len(manifest.states)
        row["ops"] = {
            name: manifest.functions[key].operations for name, key in (("rhs", "rhs"), ("jacobian", "jac_rhs"))
        }
    return row


def _start(variant: Variant) -> _Run:
    """Find a variant's equilibrium and prepare a batch of right-hand sides there."""
    library = variant.library
    if library is None:
        raise SolverError(variant.reason)
    p = library.parameters(variant.values)
    at = find_equilibrium(library, p, tables=variant.tables)
    batch = Kernel(library.functions["rhs"].map(BATCH))
    for array, value in zip(batch.arguments, (at.x, at.s, p), strict=True):
        array[:] = np.tile(value, BATCH)
    return _Run(library, variant.values, variant.tables, batch)


def _time_calls(runs: dict[int, _Run]) -> None:
    """Time right-hand sides, the variants in turn, so that a slow moment of the machine meets all."""
    for _ in range(BLOCKS):
        for k, run in runs.items():
            run.batch.evaluate()  # warm: the others have used the caches
            clock = perf_counter()
            run.batch.evaluate()
            runs[k] = replace(run, call=min(run.call, (perf_counter() - clock) / BATCH))


def _timed(run: _Run, told: Callable[[float], None], options: Mapping[str, Any]) -> _Run:
    """Simulate once more, quick runs several times; the first result and the least time stay.

    Raises
    ------
    SolverError
        If it does not reach its end.
    """
    for _ in range(REPEATS):
        result = simulate(run.library, run.values, told=told, tables=run.tables, **options)
        status = result.summary["status"]
        if status.startswith("interrupted"):
            raise KeyboardInterrupt
        if status != "done":
            raise SolverError(status)
        seconds = result.summary["seconds"]["integrate"]
        least = min(run.seconds, seconds / result.summary["simulated_s"])
        run = replace(run, result=run.result or result, seconds=least)
        if seconds > QUICK:
            break
    return run


def _compare(rows: list[dict[str, Any]], runs: dict[int, _Run]) -> None:
    """Write times, counts and changes of what ran into its rows."""
    if 0 not in runs:
        raise SolverError(rows[0]["reason"])
    results = {k: run.result for k, run in runs.items() if run.result is not None}
    for k, result in results.items():
        # Without load there is nothing but rounding to compare.
        run, loaded = runs[k], results[0].summary["static_strain_j"] > LOADED or bool(runs[0].tables)
        stages = compare_forces(results[0].dataset, result.dataset) if loaded else {}
        rows[k] |= {
            "ns_call": run.call * 1e9,
            "seconds_per_simulated_second": run.seconds,
            "counts": result.summary["counts"],
            "stages": stages,
            "changes": {name: find_worst([stage[name] for stage in stages.values()]) for name in MEASURES},
        }
