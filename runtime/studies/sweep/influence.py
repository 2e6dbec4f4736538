"""Sobol indices: shares of a metric's variance that each varied number brings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from ltcgear.generated.errors import LtcgearError
from numpy.typing import NDArray

from .design import Design, import_salib, make_problem
from .sweep_reading import FloatArray, SweepNumbers, design_of, is_done, is_whole, list_numbers

if TYPE_CHECKING:
    import xarray as xr

FEWEST = 16
"""Whole blocks of Saltelli's scheme below which no indices are given."""
RESAMPLES, SEED = 200, 1
"""Times that blocks are drawn again with replacement for a confidence, and the seed of that."""
LEVEL = 0.95
FLAT = 1e-9
"""Spread over size below which a number does not vary."""


@dataclass(frozen=True)
class SobolIndices:
    """Sobol indices of one number (Saltelli et al. 2010, Comput. Phys. Commun. 181:259).

    Attributes
    ----------
    metric, item
        The number; no item where it is single.
    axes
        Keys that were varied.
    first
        Share of the variance that each brings by itself [1], shape (axes,); NaN where the number does not vary, or
        too few blocks have it.
    total
        Share that it brings alone and with the others [1].
    first_confidence, total_confidence
        Half of the 95 % interval of each, by resampling [1].
    blocks, dropped
        Blocks of the scheme that were used, and left out since a run of theirs failed or has no such number.
    """

    metric: str
    item: str
    axes: tuple[str, ...]
    first: FloatArray
    total: FloatArray
    first_confidence: FloatArray
    total_confidence: FloatArray
    blocks: int
    dropped: int


def find_influences(dataset: xr.Dataset, metrics: list[str] | None = None) -> list[SobolIndices]:
    """Return the Sobol indices of a sweep of the sample ``saltelli``.

    A block of the scheme, d + 2 runs, counts as a whole or not at all: one failed run takes its block along. What is
    left then tells of the part of the ranges in which runs succeed.

    Parameters
    ----------
    dataset
        A sweep.
    metrics
        Variables whose numbers are analysed; all but spectra where left out.

    Raises
    ------
    LtcgearError
        If the sample is another one, fewer than `FEWEST` blocks are whole, or SALib is missing.
    """
    design = design_of(dataset)
    if design.sample != "saltelli":
        raise LtcgearError(f"Sobol indices need a sweep with --sample saltelli; this one is of {design.sample}")
    if not is_whole(dataset):
        raise LtcgearError("Sobol indices need all runs of a sweep; give its command again, which goes on with it")
    width, done = len(design.axes) + 2, is_done(dataset)
    whole = int(done.reshape(-1, width).all(axis=1).sum())
    if whole < FEWEST:
        raise LtcgearError(
            f"Sobol indices: {whole} of {done.size // width} blocks of {width} runs are whole, {FEWEST} at least are "
            "needed; see why runs failed, or ask for more --points with another -o"
        )
    return [_analyse(design, number, done) for number in list_numbers(dataset, metrics)]


def _analyse(design: Design, number: SweepNumbers, done: NDArray[np.bool_]) -> SobolIndices:
    """Return the indices of one number."""
    width = len(design.axes) + 2
    whole = np.asarray((done & np.isfinite(number.values)).reshape(-1, width).all(axis=1))
    kept, dropped = int(whole.sum()), int((~whole).sum())
    first, first_half, total, total_half = _estimate(design, number.values.reshape(-1, width)[whole].ravel())
    keys = tuple(axis.key for axis in design.axes)
    return SobolIndices(number.metric, number.item, keys, first, total, first_half, total_half, kept, dropped)


def _estimate(design: Design, values: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return first-order and total indices, each with its confidence, shape (axes,) each."""
    few = values.size < FEWEST * (len(design.axes) + 2)
    if few or not np.ptp(values) > FLAT * np.abs(values).max():
        none = np.full(len(design.axes), np.nan)
        return none, none, none, none
    analyser = import_salib("analyze")
    found = analyser.analyze(
        make_problem(design.axes), values, calc_second_order=False, num_resamples=RESAMPLES, conf_level=LEVEL, seed=SEED
    )
    first, first_half, total, total_half = (np.asarray(found[key]) for key in ("S1", "S1_conf", "ST", "ST_conf"))
    return first, first_half, total, total_half
