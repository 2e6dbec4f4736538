"""Reading of sweeps: design, finished points, and numbers one by one."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .design import Design

if TYPE_CHECKING:
    import xarray as xr

FloatArray = NDArray[np.float64]
POINT, STATUS, DONE, WARNINGS = "point", "status", "done", "warnings"
UNKNOWN = "the file is of an older version, which kept no warnings of its runs"
TEXTS = (STATUS, WARNINGS)
"""Variables that hold what is told of a run, one warning a line; the others are metrics."""

QUIET = ("mesh_force_mean", "mesh_force_min", "mesh_force_rms", "mesh_force_amplitude", "mesh_frequency", "counts")
"""Metrics that tables and figures leave out where there are others; files and --json have them."""


@dataclass(frozen=True)
class SweepNumbers:
    """One number over the points of a sweep.

    Attributes
    ----------
    metric, item
        Of the number; no item where it is single.
    unit, words
        Unit, and the metric in words.
    values
        Shape (points,).
    """

    metric: str
    item: str
    unit: str
    words: str
    values: FloatArray

    @property
    def name(self) -> str:
        """Return the number's name, ``load_share:lsp.sun_planet.1``."""
        return f"{self.metric}:{self.item}" if self.item else self.metric


def design_of(dataset: xr.Dataset) -> Design:
    """Return the design of a sweep."""
    return Design.from_json(json.loads(dataset.attrs["design"]))


def is_done(dataset: xr.Dataset) -> NDArray[np.bool_]:
    """Say of each point whether its run came to its end, shape (points,)."""
    return np.array([str(status) == DONE for status in dataset[STATUS].values], dtype=bool)


def list_warnings(dataset: xr.Dataset) -> list[tuple[str, ...]]:
    """Return the warnings of each run; none if an older file kept none (see `keeps_warnings`)."""
    if not keeps_warnings(dataset):
        return [()] * dataset.sizes[POINT]
    return [tuple(str(lines).splitlines()) for lines in dataset[WARNINGS].values]


def keeps_warnings(dataset: xr.Dataset) -> bool:
    """Say whether a sweep's file has warnings; those of form 1 have not, which does not mean that there were none."""
    return WARNINGS in dataset


def is_warned(dataset: xr.Dataset) -> NDArray[np.bool_]:
    """Say of each point whether its run is warned about, shape (points,)."""
    return np.array([bool(lines) for lines in list_warnings(dataset)], dtype=bool)


def tell_warned(dataset: xr.Dataset) -> tuple[str, ...]:
    """Say how many runs are warned about, or that it is not known; nothing where none is."""
    warned = is_warned(dataset)
    marked = (f"{warned.sum()} of {warned.size} runs are warned about: see `{WARNINGS}`",) if warned.any() else ()
    return marked if keeps_warnings(dataset) else (UNKNOWN,)


def is_whole(dataset: xr.Dataset) -> bool:
    """Say whether a sweep has a row for every point; one under way has not."""
    return dataset.sizes[POINT] == design_of(dataset).size


def list_metrics(dataset: xr.Dataset) -> list[str]:
    """List the variables that hold metrics, spectra included."""
    return [str(name) for name, variable in dataset.data_vars.items() if POINT in variable.dims and name not in TEXTS]


def list_spectra(dataset: xr.Dataset) -> list[str]:
    """List the variables that hold spectra."""
    return [name for name in list_metrics(dataset) if "frequency" in dataset[name].dims]


def choose_shown(dataset: xr.Dataset) -> list[str]:
    """Return the metrics that tables and figures show where nobody says which, spectra left out."""
    spectra = list_spectra(dataset)
    metrics = [name for name in list_metrics(dataset) if name not in spectra]
    return [name for name in metrics if name not in QUIET] or metrics


def list_numbers(dataset: xr.Dataset, metrics: list[str] | None = None) -> list[SweepNumbers]:
    """List all numbers of a sweep, spectra left out; those of some metrics only where these are given."""
    spectra = list_spectra(dataset)
    wanted = list_metrics(dataset) if metrics is None else metrics
    return [number for name in wanted if name not in spectra for number in _split(dataset[name])]


def _split(variable: xr.DataArray) -> Iterator[SweepNumbers]:
    """Yield the numbers of a metric."""
    words, unit = str(variable.attrs.get("long_name", variable.name)), str(variable.attrs.get("units", "1"))
    values = variable.transpose(POINT, ...).values.astype(np.float64)
    if values.ndim == 1:
        yield SweepNumbers(str(variable.name), "", unit, words, values)
        return
    items = variable[next(name for name in variable.dims if name != POINT)].values
    for item, column in zip(items, values.T, strict=True):
        yield SweepNumbers(str(variable.name), str(item), unit, words, column)


def shorten(keys: tuple[str, ...]) -> tuple[str, tuple[str, ...]]:
    """Return the tables that all keys begin with, ``stages.lsp.``, and the keys without; "" where they share none."""
    parts = [key.split(".")[:-1] for key in keys]
    common = 0
    while all(len(part) > common and part[common] == parts[0][common] for part in parts):
        common += 1
    prefix = "".join(f"{name}." for name in parts[0][:common])
    return prefix, tuple(key.removeprefix(prefix) for key in keys)
