"""Cost of effects: time of variants of a model, and how far their mesh forces are off."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np
from ltcgear.generated.contract import BACK
from ltcgear.generated.errors import SolverError
from numpy.typing import NDArray

from ..model.equilibrium import find_equilibrium
from ..model.function import Kernel
from ..model.library import Library
from ..model.load_tables import Pairs
from ..model.operating_point import LOADED
from ..results.result import Result
from ..results.statistics import group_of, stage_of, statistics, steady_start, window
from ..simulation.simulate import simulate

if TYPE_CHECKING:
    import xarray as xr

Vector = NDArray[np.float64]
Forces = dict[str, Vector]

BATCH = 32
"""Calls of the right-hand side that Python makes at once, so that its own time does not count."""
BLOCKS, ROUNDS = 40, 5
"""Timed batches, and timed runs, of each variant; the least counts."""
QUICK, REPEATS = 0.1, 5
"""Runs of less than 0.1 s are repeated, since other work on the machine would show in them."""
ORDERS = 20
"""Mesh orders that are compared at most."""
STILL = 1e-6
"""Vibration below this share of the mean force is rounding: relative changes of it mean nothing."""
MEASURES = ("force_rms", "force_peak", "load_share", "spectrum")


@dataclass(frozen=True)
class Variant:
    """A model with one effect at another value; ``library`` is None where there is no such model, for ``reason``.

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
    """Tell the time simulated in this run on top of what went before."""
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
            "changes": {name: _worst([stage[name] for stage in stages.values()]) for name in MEASURES},
        }


def _worst(values: Sequence[float | None]) -> float | None:
    """Return the largest change, its sign kept; None where there is none."""
    return max((value for value in values if value is not None), key=abs, default=None)


def compare_forces(full: "xr.Dataset", other: "xr.Dataset") -> dict[str, dict[str, float | None]]:
    """Say by how much the mesh forces of another run differ from those of the full one, stage by stage.

    Parameters
    ----------
    full, other
        Results at the same times; their second halves are compared. A mesh that one of them lacks counts as
        unloaded there.

    Returns
    -------
    dict of dict
        By stage, the worst of its meshes, None where there is nothing to refer to:
        ``force_rms``, change of the root mean square of force less mean, over the full one's;
        ``force_peak``, change of the largest force, over the full one's;
        ``load_share``, change of the most loaded planet's mean force over the planets' mean;
        ``spectrum``, root mean square of the amplitudes' differences at the mesh orders, over the full one's.
    """
    if "mesh_force" not in full:
        return {}
    one, two = _forces(full), _forces(other)
    names = list(dict.fromkeys([*one, *two]))
    zero = np.zeros(len(next(iter(one.values()))))
    one, two = ({name: forces.get(name, zero) for name in names} for forces in (one, two))
    phase = _phases(full)
    peaks = [_peaks(run) for run in (full, other)]
    found = {}
    for stage in dict.fromkeys(map(stage_of, names)):
        meshes = [name for name in names if stage_of(name) == stage]
        found[stage] = {
            "force_rms": _worst([_rms_change(one[m], two[m]) for m in meshes]),
            "force_peak": _worst(
                [_ratio(peaks[1].get(m, 0.0) - peaks[0].get(m, 0.0), peaks[0].get(m, 0.0)) for m in meshes]
            ),
            "load_share": _share_change(one, two, meshes),
            "spectrum": _worst([_spectrum_change(one[m], two[m], phase[m]) for m in meshes if m in phase]),
        }
    return found


def _peaks(dataset: "xr.Dataset") -> dict[str, float]:
    """Return the largest force [N] of the second half in every mesh, on whichever flank."""
    found: dict[str, float] = {}
    for name, force in statistics(dataset, steady_start(dataset)).items():
        mesh = name.removesuffix(BACK)
        found[mesh] = max(found.get(mesh, 0.0), abs(force["min"]), abs(force["max"]))
    return found


def _forces(dataset: "xr.Dataset") -> Forces:
    """Return the mesh forces [N] of the second half, those on the other flank against those on the loaded one."""
    forces = window(dataset)["mesh_force"]
    found = {str(name): forces.sel(mesh=name).values for name in forces["mesh"].values}
    return {name: force - found.get(name + BACK, 0.0) for name, force in found.items() if not name.endswith(BACK)}


def _phases(dataset: "xr.Dataset") -> Forces:
    """Return the mesh phases [cycles] of the second half, where there are teeth."""
    if "mesh_phase" not in dataset:
        return {}
    phases = window(dataset)["mesh_phase"]
    return {str(name): values for name, values in zip(phases[phases.dims[1]].values, phases.values.T, strict=True)}


def _ratio(change: float, reference: float) -> float | None:
    """Return a relative change; None where there is nothing to refer to."""
    return change / reference if reference > 0 else None


def _vibrates(force: Vector) -> bool:
    """Tell whether a force does more than stand still."""
    return float(force.std()) > STILL * abs(float(force.mean()))


def _rms_change(one: Vector, two: Vector) -> float | None:
    """Return the change of the vibration's root mean square."""
    return _ratio(float(two.std() - one.std()), float(one.std())) if _vibrates(one) else None


def _share_change(one: Forces, two: Forces, meshes: list[str]) -> float | None:
    """Return the change of the largest planet's share; the worst group of meshes."""
    groups: dict[str, list[str]] = {}
    for mesh in meshes:
        groups.setdefault(group_of(mesh), []).append(mesh)
    found = []
    for group in groups.values():
        before, after = (_share([float(forces[mesh].mean()) for mesh in group]) for forces in (one, two))
        if len(group) > 1 and before is not None and after is not None:
            found.append(after - before)
    return _worst(found)


def _share(means: list[float]) -> float | None:
    """Return the largest mean force over the mean of all."""
    size = [abs(mean) for mean in means]
    return _ratio(max(size), sum(size) / len(size))


def _spectrum_change(one: Vector, two: Vector, phase: Vector) -> float | None:
    """Return the distance of two amplitude spectra at the mesh orders over the first one's size."""
    before, after = mesh_orders(one, phase), mesh_orders(two, phase)
    if not _vibrates(one) or not len(before):
        return None
    return _ratio(float(np.linalg.norm(after - before)), float(np.linalg.norm(before)))


def mesh_orders(force: Vector, phase: Vector) -> Vector:
    """Return the amplitudes of a force at the orders of its mesh.

    Parameters
    ----------
    force
        Samples, shape (n,) [any unit].
    phase
        Mesh phase at the samples, shape (n,) [cycles]; it may speed up or slow down.

    Returns
    -------
    numpy.ndarray
        Amplitude of order 1, 2, ... under a Hann window, as many as 0.4 of the sampling rate and ``ORDERS``
        allow; none where less than two teeth pass, since their orders cannot be told apart.
    """
    steps = np.abs(np.diff(phase))
    if abs(phase[-1] - phase[0]) < 2 or not steps.max() > 0:
        return np.zeros(0)
    count = min(ORDERS, int(0.4 / steps.max()))
    weight = np.hanning(len(force))
    turns = np.exp(-2j * np.pi * np.outer(np.arange(1, count + 1), phase))
    amplitudes: Vector = np.abs(turns @ (weight * (force - force.mean()))) * (2 / weight.sum())
    return amplitudes
