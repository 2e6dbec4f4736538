"""Tables of a sweep: statistics, values over an axis, Sobol indices."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...results.table import Cell, Table
from ...results.train_record import read_train
from ...studies.sweep.influence import LEVEL, SobolIndices
from ...studies.sweep.summary import STATISTICS, columns_of, gather, seek_influences
from ...studies.sweep.sweep_reading import (
    SweepNumbers,
    choose_shown,
    design_of,
    is_done,
    is_warned,
    list_numbers,
    shorten,
    tell_warned,
)
from ..figures.drawing import scale_of

if TYPE_CHECKING:
    import xarray as xr

HEADINGS = ("mean", "deviation", "min", "5 %", "median", "95 %", "max")
MARK = "!"
"""What a table puts after the row of a run that is warned about."""
ROWS = 32
"""Rows that a table over an axis has at most."""


def list_tables(dataset: xr.Dataset, metrics: list[str] | None = None) -> list[Table]:
    """Return a sweep as tables: over the axis if there is one with its own points, else over all points.

    Parameters
    ----------
    dataset
        A sweep.
    metrics
        Variables that are shown; those that ``reading.choose_shown`` chooses where left out.
    """
    design = design_of(dataset)
    along = len(design.varied) == 1 and design.varied[0].crossed
    metrics = choose_shown(dataset) if metrics is None else metrics
    numbers, train = list_numbers(dataset, metrics), read_train(dataset)
    groups: dict[tuple[str, str], list[SweepNumbers]] = {}
    for number in numbers:
        groups.setdefault((number.metric, train.group(number.item) if along else ""), []).append(number)
    tables = [_over_axis(dataset, own) if along else _over_points(dataset, own) for own in groups.values()]
    return tables + _influences(dataset, metrics)


def _head(own: list[SweepNumbers]) -> tuple[str, float]:
    """Return the title of a metric's table, and the unit's size [SI] in which numbers are handy."""
    largest = max((float(np.abs(one.values[np.isfinite(one.values)]).max(initial=0.0)) for one in own), default=0.0)
    size, unit = scale_of(own[0].unit, largest)
    return f"{own[0].metric}: {own[0].words} [{unit}]", size


def _over_points(dataset: xr.Dataset, own: list[SweepNumbers]) -> Table:
    """List a metric's statistics over the points, a row for each item."""
    done = is_done(dataset)
    title, size = _head(own)
    rows: list[tuple[Cell, ...]] = []
    for number in own:
        found = gather(number, done)
        rows.append((number.item or "all", *(_round(found[name] / size) for name in STATISTICS)))
    crossed = [axis.key for axis in design_of(dataset).varied if axis.crossed]
    pooled = (f"over all values of {', '.join(crossed)}",) if crossed else ()
    return Table(title, ("", *HEADINGS), tuple(rows), (*pooled, *_tell_doubts(dataset)))


def _over_axis(dataset: xr.Dataset, own: list[SweepNumbers]) -> Table:
    """List a metric over the one axis, a column for each item of a group."""
    axis = design_of(dataset).varied[0]
    title, size = _head(own)
    coordinate = dataset[axis.key]
    unit = coordinate.attrs.get("units", "")
    stride, warned = max(-(-coordinate.size // ROWS), 1), is_warned(dataset)
    marks = [(MARK if one else "",) for one in warned] if warned.any() else [()] * coordinate.size
    rows = tuple(
        (_cell(coordinate.values[at]), *(_round(float(number.values[at]) / size) for number in own), *marks[at])
        for at in range(0, coordinate.size, stride)
    )
    shown = (f"one point of {stride}; the file has all",) if stride > 1 else ()
    heading = f"{axis.key} [{unit}]" if unit else axis.key
    group = read_train(dataset).group(own[0].item)
    numbered = all(one.item.startswith(f"{group}.") for one in own)  # planets, told by their numbers below the group
    names = [one.item.removeprefix(f"{group}.") if numbered else one.item or one.metric for one in own]
    title = f"{title}, {group}" if numbered else title
    columns = (heading, *names, *([""] if warned.any() else []))
    return Table(title, columns, rows, (*shown, *_tell_doubts(dataset)))


def _round(value: float) -> float:
    """Return a number with the digits that a table has room for; files and --json have all."""
    return float(f"{value:.4g}")


def _cell(value: Any) -> Cell:  # noqa: ANN401
    """Return a coordinate as a table shows it."""
    if not isinstance(value, float | np.floating):
        return str(value)
    return int(value) if value.is_integer() else float(value)


def _tell_doubts(dataset: xr.Dataset) -> tuple[str, ...]:
    """Say how many runs failed, and how many are warned about."""
    done = is_done(dataset)
    failed = (f"{(~done).sum()} of {done.size} runs failed and are left out",) if not done.all() else ()
    return failed + tell_warned(dataset)


def _influences(dataset: xr.Dataset, metrics: list[str]) -> list[Table]:
    """List Sobol indices, a table for each metric, a row for each item and key."""
    found, refused = seek_influences(dataset, metrics)
    tables = [Table("Sobol indices", (), (), (refused,))] if refused else []
    for metric in dict.fromkeys(one.metric for one in found):
        own = [one for one in found if one.metric == metric]
        rows: list[tuple[Cell, ...]] = []
        for one in own:
            prefix, keys = shorten(one.axes)
            lines = zip(keys, *(values.tolist() for values in columns_of(one)), strict=True)
            rows += [
                (one.item if k == 0 else "", key, *(round(value, 3) for value in line))
                for k, (key, *line) in enumerate(lines)
            ]
        title = f"{metric}: Sobol indices" + (f" of keys of {prefix.removesuffix('.')}" if prefix else "")
        tables.append(Table(title, ("", "varied", "first", "+-", "total", "+-"), tuple(rows), _said(own)))
    return tables


def _said(own: list[SobolIndices]) -> tuple[str, ...]:
    """Say with what indices were estimated, and what was left out."""
    blocks, dropped = own[0].blocks, max(one.dropped for one in own)
    notes = [f"{blocks} blocks; +- is half of the {100 * LEVEL:.0f} % interval, by resampling blocks"]
    if dropped:
        notes.append(f"left out for failed runs: {dropped} blocks; the indices are of the rest of the ranges")
    return tuple(notes)
