"""Summary of a sweep in numbers: statistics over its points, failures, warnings, Sobol indices."""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np
from ltcgear.generated.errors import LtcgearError
from numpy.typing import NDArray

from ...results.attributes import finite
from .influence import SobolIndices, find_influences
from .sweep_reading import (
    DONE,
    STATUS,
    SweepNumbers,
    design_of,
    is_done,
    is_warned,
    keeps_warnings,
    list_numbers,
    list_warnings,
)

if TYPE_CHECKING:
    import xarray as xr

STATISTICS = ("mean", "std", "min", "p5", "median", "p95", "max")
"""Of a number over the points, in the order of columns."""
DIGITS = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
"""Numbers in a warning."""


def summarise(dataset: xr.Dataset) -> dict[str, Any]:
    """Return a sweep in numbers, as ``ltcgear sweep --json`` prints them.

    Returns
    -------
    dict
        ``points``, ``failed``, ``reasons`` (text -> runs), ``warned`` (runs; None if an older file kept none),
        ``warnings`` (see `gather_warnings`), ``metrics`` (metric -> unit and, by item or for the
        number itself, `STATISTICS` over the points that are done; NaN is null) and, of the sample ``saltelli``,
        ``influences`` (see ``influence.SobolIndices``) or, where too many runs failed for any, ``without_influences``,
        which tells so.
    """
    done = is_done(dataset)
    metrics: dict[str, Any] = {}
    for number in list_numbers(dataset):
        one = metrics.setdefault(number.metric, {"unit": number.unit, "long_name": number.words})
        if number.item:
            one.setdefault("items", {})[number.item] = gather(number, done)
        else:
            one |= gather(number, done)
    found: dict[str, Any] = {"points": int(done.size), "failed": int((~done).sum()), "reasons": list_reasons(dataset)}
    found["warned"] = int(is_warned(dataset).sum()) if keeps_warnings(dataset) else None
    found |= {"warnings": gather_warnings(dataset), "metrics": metrics}
    influences, refused = seek_influences(dataset, None)
    if influences:
        found["influences"] = [_plain(one) for one in influences]
    if refused:
        found["without_influences"] = refused
    plain: dict[str, Any] = finite(found)
    return plain


def seek_influences(dataset: xr.Dataset, metrics: list[str] | None) -> tuple[list[SobolIndices], str]:
    """Return Sobol indices where the sample is made for them; else why there are none of a sample that is."""
    if design_of(dataset).sample != "saltelli":
        return [], ""
    try:
        return find_influences(dataset, metrics), ""
    except LtcgearError as error:
        return [], str(error)


def gather(number: SweepNumbers, done: NDArray[np.bool_]) -> dict[str, float]:
    """Return the `STATISTICS` of a number over the points that are done and have it, and ``count``, how many."""
    values = number.values[done & np.isfinite(number.values)]
    if not values.size:
        return dict.fromkeys(STATISTICS, float("nan")) | {"count": 0}
    low, middle, high = np.quantile(values, [0.05, 0.5, 0.95]).tolist()
    spread = float(values.std(ddof=1)) if values.size > 1 else float("nan")
    row = (float(values.mean()), spread, float(values.min()), low, middle, high, float(values.max()))
    return dict(zip(STATISTICS, row, strict=True)) | {"count": int(values.size)}


def list_reasons(dataset: xr.Dataset) -> dict[str, int]:
    """Return why runs failed, and how many for each reason, the most frequent first."""
    return dict(Counter(str(one) for one in dataset[STATUS].values if str(one) != DONE).most_common())


def gather_warnings(dataset: xr.Dataset) -> dict[str, int]:
    """Return what runs are warned about, and how many for each kind, the most frequent first.

    Warnings that differ in their numbers only are of one kind, and are told by the first of them.
    """
    first: dict[str, str] = {}
    counts: Counter[str] = Counter()
    for lines in list_warnings(dataset):
        kinds = {DIGITS.sub("#", line): line for line in reversed(lines)}
        for kind, line in kinds.items():
            first.setdefault(kind, line)
        counts.update(kinds.keys())
    return {first[kind]: count for kind, count in counts.most_common()}


def _plain(one: SobolIndices) -> dict[str, Any]:
    """Return the indices of a number as JSON has them, by the key varied."""
    columns = zip(one.axes, *(values.tolist() for values in columns_of(one)), strict=True)
    names = ("first", "first_confidence", "total", "total_confidence")
    axes = {key: dict(zip(names, values, strict=True)) for key, *values in columns}
    return {"metric": one.metric, "item": one.item, "axes": axes, "blocks": one.blocks, "dropped": one.dropped}


def columns_of(one: SobolIndices) -> tuple[Any, ...]:
    """Return the indices and their confidences."""
    return one.first, one.first_confidence, one.total, one.total_confidence
