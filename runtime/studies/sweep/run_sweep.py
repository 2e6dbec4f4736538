"""Sweep: from its axes to its file."""

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from importlib.metadata import version
from pathlib import Path
from time import perf_counter
from typing import Any

from ltcgear.generated.errors import LtcgearError, MachineError

from ...model.members import train_of, unite_trains
from ...results.attributes import to_attributes
from ...results.row_file import part_of
from ...results.train_record import TRAIN, write_train
from ...simulation.low_pass import BAND
from ...simulation.run_settings import DEFAULT_METHOD, DEFAULT_RTOL, RunSettings, check_options
from .design import Design, draw_design
from .execution import KILLED, Pool, Processes, check_joblib, compute_points
from .faults import is_machines, stopped_by_machine
from .metrics import find_metric
from .planning import Told, check_points, choose_common_rate, make_plan, prepare
from .summary import summarise
from .sweep_axes import read_axes
from .sweep_file import GO_ON, Store, check_store, load_sweep
from .sweep_reading import design_of
from .task import UNBUILT, Maker, Plan, PointOutcome, find_places

MOST_WORKERS = 1024
SKIPPED = "left out by --skip"
"""Status of a point that was not to be computed."""
MOST_KILLED = 8
"""Points whose processes are killed from outside after which a sweep stops."""


def sweep(
    maker: Maker,
    vary: Sequence[str],
    target: str | Path,
    *,
    sample: str = "grid",
    points: int | None = None,
    seed: int = 0,
    metrics: Sequence[str] | None = None,
    t_end: float | None = None,
    rate: float | None = None,
    method: str = DEFAULT_METHOD,
    rtol: float = DEFAULT_RTOL,
    raw: bool = False,
    workers: int | None = None,
    scheduler: str | None = None,
    retry: bool = False,
    skip: Sequence[int] = (),
    long: bool = False,
    told: Told = lambda stage, done, total, failed: None,
) -> dict[str, Any]:
    """Simulate a scene at many points and keep metrics of each, one row a point, in a NetCDF4 file.

    Rows go to ``NAME.part.nc`` as they come. If the sweep was stopped or killed, the same call resumes it and
    computes what is missing; the file is the same to the last bit. A point that fails is a row with its reason; where
    the machine fails the sweep stops.

    Parameters
    ----------
    maker
        The scene, read once: ``ltcgear.symbolic.Template("lsp")``.
    vary
        Axes as after ``--vary``: ``KEY=a:b:n``, ``KEY=a:b`` or ``KEY=v1,v2,v3``.
    target
        The file, ``NAME.nc``.
    sample, points, seed
        How points are drawn: grid, lhs, sobol, normal or saltelli; how many; seed of the random numbers.
    metrics
        What is kept of each run; forces, and load shares where meshes share a load, where left out.
    t_end, rate
        Time to simulate [s] and samples a second [Hz]; those of the scene where left out.
    method, rtol, raw
        As for ``simulate``; raw spectra of what jumps have high harmonics folded into them.
    workers
        Processes, as many as there are cores where left out; with 1 this process computes.
    scheduler
        Address of a Dask scheduler whose workers compute, in place of processes; it and its network are trusted.
    retry
        Whether points that failed before are computed again.
    skip
        Numbers of points that are left out: rows that say so, as of those that failed.
    long
        Allow runs estimated to take more than an hour; otherwise such points fail.
    told
        Called with a stage (``build`` or ``simulate``), how much of it is done, its total, and failed points so far.

    Returns
    -------
    dict
        The summary: counts of points, reasons of those that failed, seconds.

    Raises
    ------
    LtcgearError
        If anything is wrong, before anything is computed: a key, a range, a metric, the scheduler, or a file there
        that is of another sweep.
    MachineError
        If the machine fails: no compiler, store, disk or memory, or processes that are killed; what was computed is
        kept.
    KeyboardInterrupt
        At Ctrl-C; what was computed is kept.
    """
    clock, target = perf_counter(), Path(target)
    check_joblib()
    check_options(method, rtol, t_end, rate)
    check_store(target)
    for name in metrics or ():
        find_metric(name)
    design = draw_design(read_axes(vary), sample, points, seed)
    _check_skip(skip, design)
    taken = check_points(maker, design)
    ends = [dict(changes) for changes in taken]
    end, samples = maker.times(ends[0])
    given = samples if rate is None else rate
    common = choose_common_rate(maker, ends) if given is None else given
    settings = RunSettings(end if t_end is None else t_end, common, method, rtol, raw, long=long).checked()
    with _open_pool(workers, scheduler, design.size) as pool:
        plan = make_plan(maker, design, taken, metrics, settings, told)
        seconds = {"prepare": perf_counter() - clock}
        clock = perf_counter()
        with Store(target, design, plan.form, describe_sweep(plan), _attributes(plan), retry) as store:
            kept, left_out = len(store.done), set(skip) - store.done
            for point in sorted(left_out):
                store.add(PointOutcome(point, SKIPPED))
            fill(plan, store, pool, told)
            seconds["simulate"] = perf_counter() - clock
            store.seal()
    counts = {"computed": design.size - kept - len(left_out), "kept": kept, "workers": pool.workers}
    return tell_sweep(target, maker, counts, seconds)


def _check_skip(skip: Sequence[int], design: Design) -> None:
    """Refuse points to be left out that there are not."""
    for point in skip:
        if not 0 <= point < design.size:
            raise LtcgearError(f"--skip {point}: no such point; they are numbered from 0 to {design.size - 1}")


def describe_sweep(plan: Plan) -> dict[str, Any]:
    """Return what makes a sweep what it is; two whose descriptions are equal are equal to the last bit."""
    drawn = plan.design.to_json()
    axes = {f"axis {axis.key}": _write_axis(axis.to_json()) for axis in plan.design.axes}
    return {
        **axes,
        **{name: drawn[name] for name in ("sample", "points", "seed")},
        "metrics": ", ".join(plan.metrics),
        **plan.settings.identity(),
        **plan.maker.entries(),
        **{f"version of {name}": version(name) for name in _list_packages(plan.design)},
        "equations": sorted(plan.models),
        "points as drawn": drawn["digest"],
    }


def _list_packages(design: Design) -> list[str]:
    """Return the packages on which a sweep's numbers depend."""
    return ["ltcgear", "casadi", "numpy", "scipy", *(["SALib"] if design.sample == "saltelli" else [])]


def _write_axis(axis: Mapping[str, Any]) -> str:
    """Return an axis as one writes it."""
    if axis["items"]:
        return ",".join(axis["items"])
    count = "" if axis["count"] is None else f":{axis['count']}"
    return f"{axis['low']:g}:{axis['high']:g}{count} {axis['unit']}".strip()


def _attributes(plan: Plan) -> dict[str, Any]:
    """Return the file's attributes on scene and settings."""
    told = {name: value for name, value in plan.settings.identity().items() if name != "raw"}
    band = {} if plan.settings.raw else {"band_hz": BAND * plan.settings.sampling_rate}
    train = write_train(unite_trains(train_of(model.manifest) for model in plan.models.values()))
    return to_attributes(plan.maker.about(), {**told, **band, "metrics": list(plan.metrics), TRAIN: train})


@contextmanager
def _open_pool(workers: int | None, scheduler: str | None, points: int) -> Iterator[Pool]:
    """Give the pool that computes some points.

    Raises
    ------
    LtcgearError
        If there is no such pool.
    """
    if workers is not None and scheduler is not None:
        raise LtcgearError(f"--workers {workers}: a cluster has its own; leave it out")
    if workers is not None and not 1 <= workers <= MOST_WORKERS:
        raise LtcgearError(f"--workers {workers}: must be 1 at least, and {MOST_WORKERS} at most")
    if scheduler is None:
        yield Processes(min(workers or len(os.sched_getaffinity(0)), points))
        return
    try:
        from .cluster import connect
    except ModuleNotFoundError as error:
        raise LtcgearError("--scheduler needs Dask: pip install 'ltcgear[cluster]'") from error
    with connect(scheduler) as cluster:
        yield cluster


def tell_sweep(target: Path, maker: Maker, counts: Mapping[str, int], seconds: Mapping[str, float]) -> dict[str, Any]:
    """Return how a sweep went, and what it says in numbers."""
    found = load_sweep(target)
    told = {"scene": maker.name, "file": str(target), **summarise(found), **counts}
    return told | {"notes": list(design_of(found).notes), "seconds": dict(seconds)}


def tell_kept(target: Path) -> str:
    """Say what a sweep that was stopped has left, and what the same command then does."""
    part = part_of(target)
    if target.exists():
        return f"{target} has all rows"
    with suppress(LtcgearError):  # of a damaged one the same command tells
        if part.exists() and load_sweep(part).sizes["point"]:
            return f"rows are kept in {part}, the same command goes on"
    return "no row was there yet; the same command begins anew"


# --- missing points


def fill(plan: Plan, store: Store, pool: Pool, told: Told) -> None:
    """Compute the missing points and add their rows.

    Raises
    ------
    MachineError
        If the machine fails, at once, or if processes were killed from outside, once all other points are done.
    """
    missing, killed = store.missing(), list[int]()
    while missing:
        unbuilt: list[int] = []
        for outcome in _outcomes(plan, missing, pool, store):
            if outcome.status == UNBUILT:
                unbuilt.append(outcome.point)
                continue
            if outcome.status == KILLED:
                killed.append(outcome.point)
                if len(killed) == MOST_KILLED:
                    raise _told_killed(killed, store)
                continue
            store.add(outcome)
            told("simulate", len(store.done), plan.design.size, store.failed)
        with stopped_by_machine(partial(_advise, store)):
            missing = [point for point in unbuilt if not _build_late(plan, store, point)]
        if unbuilt:
            told("simulate", len(store.done), plan.design.size, store.failed)
    if killed:
        raise _told_killed(killed, store)


def _outcomes(plan: Plan, points: Sequence[int], pool: Pool, store: Store) -> Iterator[PointOutcome]:
    """Compute points; where the machine fails, say what is kept."""
    with stopped_by_machine(partial(_advise, store)):
        yield from compute_points(plan, points, pool)


def _advise(store: Store) -> str:
    """Say what to do where the machine failed."""
    return f"no fault of the model: mend it and {GO_ON}, or leave a point out with --skip; {_kept(store)}"


def _kept(store: Store) -> str:
    """Say how many rows are kept."""
    return f"{len(store.done)} of {store.design.size} rows are kept"


def _told_killed(killed: Sequence[int], store: Store) -> MachineError:
    """Say which points' processes were killed."""
    points = ", ".join(store.design.tell(point) for point in killed)
    skip = " ".join(f"--skip {point}" for point in killed)
    return MachineError(
        f"{points}: the process was killed from outside, twice, as where memory runs out; see that there is memory or "
        f"give fewer --workers, and {GO_ON}, or leave out what cannot be computed with {skip}; {_kept(store)}"
    )


def _build_late(plan: Plan, store: Store, point: int) -> bool:
    """Build the variant of a point whose structure neither lists nor ends of axes show; say whether that failed."""
    changes = plan.design.changes(point)
    key = plan.maker.make(changes)[0]
    if key in plan.models:
        return False
    try:
        artifact, row, _ = prepare(plan.maker, changes, plan.metrics, plan.settings)
        find_places(row, plan.form)
    except LtcgearError as error:
        if is_machines(error):
            raise
        store.add(PointOutcome(point, str(error)))
        return True
    plan.models[key], plan.rows[key] = artifact, row
    return False
