"""Plan of a sweep: sampling rate, models and form of a row, settled before any worker starts."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from ltcgear.generated.contract import Artifact
from ltcgear.generated.errors import LtcgearError, SceneError

from ...model.building import build
from ...results.dataset import make_dataset
from ...results.samples import no_rows
from ...simulation.room import check_size
from ...simulation.run_settings import RunSettings
from ...simulation.sampling_rate import find_rate
from ...simulation.simulate import Run
from .design import Design
from .faults import own_reason
from .metrics import choose_metrics, lay_out, unite
from .task import Maker, Plan

if TYPE_CHECKING:
    import xarray as xr

Keys = dict[tuple[tuple[str, str], ...], str]
"""Changes of a point -> key of its model."""
Told = Callable[[str, int, int, int], None]
MOST_TRIED = 8
"""Points by which a sampling rate is chosen."""
MOST_COMBINED = 1000
"""Combinations of lists whose structures are sought before the first run; those of others as they come."""
FIXED = ("simulation",)
"""Tables of the scene that are the same for all points."""


def choose_common_rate(maker: Maker, points: Sequence[Mapping[str, str]]) -> float:
    """Choose one sampling rate for all points [Hz]: the highest needed by a selection that includes the ends."""
    found, reasons = list[float](), list[str]()
    for changes in [*points[: MOST_TRIED - 1], *points[MOST_TRIED - 1 :][-1:]]:
        with own_reason(reasons.append):
            _, values, tables = maker.make(changes)
            found.append(find_rate(build(maker.obtain(changes)), values, tables, None).rate)
    if not found:
        raise LtcgearError(
            f"no end of the axes can begin ({reasons[0]}), so no sampling rate follows; "
            "give --set simulation.rate='8192 Hz', or other values"
        )
    return max(found)


def check_points(maker: Maker, design: Design) -> Keys:
    """Refuse keys and values that the scene does not take; return the points that it takes and their models' keys.

    What is refused is wrong alone and with the other values of its point; else it is that point's own reason.
    """
    for axis in design.axes:
        if axis.key.split(".")[0] in FIXED:
            raise LtcgearError(f"--vary {axis.key}: is the same for all points; give --t-end, or --set {axis.key}=...")
    taken: Keys = {}
    for changes in _list_checked(design):
        try:
            taken[tuple(changes.items())] = maker.make(changes)[0]
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
    """Return the changes of representative points: the ends of axes, or the mean of draws without ends."""
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
    maker: Maker, design: Design, taken: Keys, metrics: Sequence[str] | None, settings: RunSettings, told: Told
) -> Plan:
    """Derive and compile all variants, and lay out the rows, before any worker starts."""
    plan: Plan | None = None
    listed = _list_variants(maker, design, taken)
    for k, (key, changes) in enumerate(listed.items()):
        told("build", k, len(listed), 0)
        artifact, row, metrics = prepare(maker, changes, metrics, settings)
        if plan is None:
            plan = Plan(maker, design, metrics, row, settings, {}, {})
        plan.models[key], plan.rows[key] = artifact, row
    if plan is None:
        raise LtcgearError("no point of the sweep gives a scene without defects; see `ltcgear info SCENE`")
    plan.form = unite(list(plan.rows.values()))
    return plan


def _list_variants(maker: Maker, design: Design, taken: Keys) -> dict[str, dict[str, str]]:
    """Return the structures needed by lists and ends of axes: the key of each and the changes of a point."""
    lists = [k for k, axis in enumerate(design.axes) if axis.items]
    found = np.unique(design.values[:, lists], axis=0, return_index=True)[1] if lists else [0]
    variants: dict[str, dict[str, str]] = {}
    for point in sorted(found)[:MOST_COMBINED]:
        changes = design.changes(int(point))
        with suppress(SceneError):  # this combination's own reason
            variants.setdefault(taken.get(tuple(changes.items())) or maker.make(changes)[0], changes)
    for ends, key in taken.items():
        variants.setdefault(key, dict(ends))
    return variants


def prepare(
    maker: Maker, changes: Mapping[str, str], metrics: Sequence[str] | None, settings: RunSettings
) -> tuple[Artifact, "xr.Dataset", Sequence[str]]:
    """Obtain and compile a variant, with what its integrator compiles; return it, its row, and the metrics."""
    artifact = maker.obtain(changes)
    library, (_, values, tables) = build(artifact), maker.make(changes)
    check_size(library, settings.t_end * settings.sampling_rate)
    p = library.parameters(values)
    with own_reason():
        Run(library, p, replace(settings, tables=tables))
    empty = make_dataset(library, p, no_rows(library))
    metrics = metrics or choose_metrics(empty)
    return artifact, lay_out(empty, metrics, settings.t_end, settings.sampling_rate, settings.raw), metrics
