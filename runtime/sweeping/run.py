"""Run: a sweep from its axes to its file, stage by stage: axes -> design -> models -> store -> rows -> file."""

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from importlib.metadata import version
from math import isfinite
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np
from ltcgear.generated.contract import Artifact
from ltcgear.generated.errors import LtcgearError, SceneError

from ..attributes import to_attributes
from ..band import BAND
from ..dataset import make_dataset
from ..integration import check_length
from ..library import build
from ..rates import find_rate
from ..reading import no_rows
from ..room import check_size
from ..simulation import DEFAULT_METHOD, DEFAULT_RTOL, Run, check_options
from .axes import read_axes
from .design import Design, draw_design
from .execution import Pool, Processes, check_joblib, compute_points
from .listing import summarise
from .metrics import choose_metrics, find_metric, lay_out, unite
from .reading import design_of
from .store import Store, check_store, load_sweep
from .task import UNBUILT, Maker, Outcome, Plan, find_places

if TYPE_CHECKING:
    import xarray as xr

Told = Callable[[str, int, int, int], None]
MOST_WORKERS = 1024
MOST_TRIED = 8
"""Points by which a sampling rate is chosen."""
FIXED = ("simulation",)
"""Tables of the scene that are the same for all points."""


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
    told: Told = lambda stage, done, total, failed: None,
) -> dict[str, Any]:
    """Simulate a scene at many points and keep metrics of each, one row a point, in a NetCDF4 file.

    Rows go to ``NAME.part.nc`` as they come. Where the sweep was stopped or killed, the same call goes on and
    computes what is missing; the file is the same to the last bit. A point that fails is a row with its reason.

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
        Address of a Dask scheduler whose workers compute, in place of processes.
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
    KeyboardInterrupt
        At Ctrl-C; what was computed is kept.
    """
    clock, target = perf_counter(), Path(target)
    check_joblib()
    check_options(method, rtol, t_end)
    check_store(target)
    for name in metrics or ():
        find_metric(name)
    design = draw_design(read_axes(vary), sample, points, seed)
    ends = check_points(maker, design)
    end, samples = maker.times(ends[0])
    settings: dict[str, Any] = {"t_end": end if t_end is None else t_end, "method": method, "rtol": rtol, "raw": raw}
    given = samples if rate is None else rate
    settings["rate"] = choose_common_rate(maker, ends) if given is None else given
    _check_rate(settings["rate"])
    check_length(settings["t_end"] * settings["rate"])
    with _open_pool(workers, scheduler, design.size) as pool:
        plan = make_plan(maker, design, metrics, settings, told)
        seconds = {"prepare": perf_counter() - clock}
        clock = perf_counter()
        with Store(target, design, plan.form, describe_sweep(plan), _attributes(plan)) as store:
            kept = len(store.done)
            _fill(plan, store, pool, told)
            seconds["simulate"] = perf_counter() - clock
            store.seal()
    return tell_sweep(target, maker, kept, pool.workers, seconds)


def _check_rate(rate: float) -> None:
    """Refuse a rate of samples that is none."""
    if not (isfinite(rate) and rate > 0):
        raise LtcgearError(f"rate {rate:g}: must be samples a second [Hz], greater than zero")


def choose_common_rate(maker: Maker, points: Sequence[Mapping[str, str]]) -> float:
    """Choose one sampling rate for all points [Hz]: the highest that some of them, their ends among them, call for."""
    found = []
    for changes in [*points[: MOST_TRIED - 1], *points[MOST_TRIED - 1 :][-1:]]:
        with suppress(LtcgearError):  # a point's own reason
            _, values, tables = maker.make(changes)
            found.append(find_rate(build(maker.obtain(changes)), values, tables, None).rate)
    if not found:
        raise LtcgearError("no end of the axes can begin, so no sampling rate follows; give simulation.rate")
    return max(found)


def check_points(maker: Maker, design: Design) -> list[dict[str, str]]:
    """Refuse keys and values that the scene does not take; return the changes of the points that it takes.

    What is refused is wrong alone and with the other values of its point; else it is that point's own reason.
    """
    for axis in design.axes:
        if axis.key.split(".")[0] in FIXED:
            raise LtcgearError(f"--vary {axis.key}: is the same for all points; give --t-end, or --set {axis.key}=...")
    taken: list[dict[str, str]] = []
    for changes in _list_checked(design):
        try:
            maker.make(changes)
            taken.append(changes)
        except SceneError as error:
            own = _find_fault(maker, {})
            for key, value in changes.items():
                alone = _find_fault(maker, {key: value})
                if alone and alone == own:  # the scene's, whatever is varied
                    raise
                if alone:
                    raise SceneError(f"--vary {key}: {error}") from error
    if not taken:
        raise LtcgearError("no end of the axes gives a scene without defects; see `ltcgear info SCENE --set KEY=VALUE`")
    return taken


def _list_checked(design: Design) -> list[dict[str, str]]:
    """Return the changes of points that stand for all: the axes' ends, or, where draws have no ends, the middle."""
    if design.sample != "normal":
        return design.ends()
    spread = np.array([0.0 if axis.crossed else 1 / (axis.high or 1.0) for axis in design.axes])
    centre = np.array([0.0 if axis.crossed else axis.low for axis in design.axes])
    middle = design.changes(int(np.argmin((((design.values - centre) * spread) ** 2).sum(axis=1))))
    return [middle, *(middle | {axis.key: item} for axis in design.axes for item in axis.items)]


def _find_fault(maker: Maker, changes: Mapping[str, str]) -> str:
    """Say why the scene does not take some changes; "" where it does."""
    try:
        maker.make(changes)
    except SceneError as error:
        return str(error)
    return ""


def make_plan(
    maker: Maker, design: Design, metrics: Sequence[str] | None, settings: Mapping[str, Any], told: Told
) -> Plan:
    """Derive and compile all variants, and lay out the rows, before any worker starts."""
    plan: Plan | None = None
    listed = _list_variants(maker, design)
    for k, (key, changes) in enumerate(listed.items()):
        told("build", k, len(listed), 0)
        artifact, row, metrics = _prepare(maker, changes, metrics, settings)
        if plan is None:
            plan = Plan(maker, design, metrics, row, settings, {}, {})
        plan.models[key], plan.rows[key] = artifact, row
    if plan is None:
        raise LtcgearError("no point of the sweep gives a scene without defects; see `ltcgear info SCENE`")
    plan.form = unite(list(plan.rows.values()))
    return plan


def _list_variants(maker: Maker, design: Design) -> dict[str, dict[str, str]]:
    """Return the structures that lists and ends of axes call for: the key of each and the changes of a point."""
    lists = [k for k, axis in enumerate(design.axes) if axis.items]
    found = np.unique(design.values[:, lists], axis=0, return_index=True)[1] if lists else [0]
    variants: dict[str, dict[str, str]] = {}
    for changes in [*(design.changes(int(point)) for point in sorted(found)), *_list_checked(design)]:
        with suppress(SceneError):  # this combination's own reason
            variants.setdefault(maker.make(changes)[0], changes)
    return variants


def _prepare(
    maker: Maker, changes: Mapping[str, str], metrics: Sequence[str] | None, settings: Mapping[str, Any]
) -> tuple[Artifact, "xr.Dataset", Sequence[str]]:
    """Obtain and compile a variant, with what its integrator compiles; return it, its row, and the metrics."""
    artifact = maker.obtain(changes)
    library, (_, values, tables) = build(artifact), maker.make(changes)
    check_size(library, settings["t_end"] * settings["rate"])
    p = library.parameters(values)
    with suppress(LtcgearError):  # a point's own reason
        Run(library, p, tables=tables, **settings)
    empty = make_dataset(library, p, no_rows(library))
    metrics = metrics or choose_metrics(empty)
    return artifact, lay_out(empty, metrics, settings["t_end"], settings["rate"], settings["raw"]), metrics


def describe_sweep(plan: Plan) -> dict[str, Any]:
    """Return what makes a sweep what it is; two whose descriptions are equal are equal to the last bit."""
    drawn = plan.design.to_json()
    axes = {f"axis {axis.key}": _write_axis(axis.to_json()) for axis in plan.design.axes}
    return {
        **axes,
        **{name: drawn[name] for name in ("sample", "points", "seed")},
        "metrics": ", ".join(plan.metrics),
        **plan.settings,
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
    """Return what the file tells of scene and settings."""
    told = {name: value for name, value in plan.settings.items() if name != "raw"}
    band = {} if plan.settings["raw"] else {"band_hz": BAND * plan.settings["rate"]}
    return to_attributes(plan.maker.about(), {**told, **band, "metrics": list(plan.metrics)})


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


def _fill(plan: Plan, store: Store, pool: Pool, told: Told) -> None:
    """Compute the missing points and add their rows."""
    missing = store.missing()
    while missing:
        unbuilt: list[int] = []
        for outcome in compute_points(plan, missing, pool):
            if outcome.status == UNBUILT:
                unbuilt.append(outcome.point)
                continue
            store.add(outcome)
            told("simulate", len(store.done), plan.design.size, store.failed)
        missing = [point for point in unbuilt if not _build_late(plan, store, point)]
        if unbuilt:
            told("simulate", len(store.done), plan.design.size, store.failed)


def _build_late(plan: Plan, store: Store, point: int) -> bool:
    """Build the variant of a point whose structure neither lists nor ends of axes show; say whether that failed."""
    changes = plan.design.changes(point)
    key = plan.maker.make(changes)[0]
    if key in plan.models:
        return False
    try:
        artifact, row, _ = _prepare(plan.maker, changes, plan.metrics, plan.settings)
        find_places(row, plan.form)
    except LtcgearError as error:
        store.add(Outcome(point, str(error)))
        return True
    plan.models[key], plan.rows[key] = artifact, row
    return False


def tell_sweep(target: Path, maker: Maker, kept: int, workers: int, seconds: Mapping[str, float]) -> dict[str, Any]:
    """Return how a sweep went, and what it says in numbers."""
    found = load_sweep(target)
    told = {"scene": maker.name, "file": str(target), **summarise(found)}
    counts = {"computed": found.sizes["point"] - kept, "kept": kept, "workers": workers}
    return told | counts | {"notes": list(design_of(found).notes), "seconds": dict(seconds)}
