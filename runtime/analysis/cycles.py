"""Rainflow cycles of an output, for fatigue."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from ltcgear.generated.errors import LtcgearError

from .trace import FloatArray, read_trace

if TYPE_CHECKING:
    import xarray as xr

BINS = 32


@dataclass(frozen=True)
class Cycles:
    """Rainflow cycles of an output.

    Attributes
    ----------
    name, title, unit
        Of the output.
    span, mean
        Range and mean of each cycle [unit], shape (m,).
    count
        1 of a whole cycle, 0.5 of a half one, shape (m,).
    seconds
        Length of the record [s].
    """

    name: str
    title: str
    unit: str
    span: FloatArray
    mean: FloatArray
    count: FloatArray
    seconds: float

    @property
    def total(self) -> float:
        """Return the number of cycles."""
        return float(self.count.sum())

    @property
    def largest(self) -> float:
        """Return the largest range [unit]; 0 of a constant output."""
        return float(self.span.max()) if self.span.size else 0.0

    def by_range(self, bins: int = BINS) -> tuple[FloatArray, FloatArray]:
        """Return edges of equal bins of the range [unit], shape (bins + 1,), and cycles in each, shape (bins,)."""
        count, edges = np.histogram(self.span, bins, (0.0, self.largest or 1.0), weights=self.count)
        return edges, count

    def by_range_and_mean(self, bins: int = BINS) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return edges of range and of mean [unit], and cycles in each bin, shape (range bins, mean bins)."""
        count, spans, means = np.histogram2d(self.span, self.mean, bins, weights=self.count)
        return spans, means, count

    def equivalent(self, exponent: float, reference: float) -> float:
        """Return the range [unit] that does the same damage in a stated number of cycles: (sum n r^m / n_ref)^(1/m).

        Parameters
        ----------
        exponent
            Slope m of the S-N curve, with Miner's rule.
        reference
            Number of cycles n_ref that it is to act; small cycles add damage then, and never dilute it.

        Raises
        ------
        LtcgearError
            If either is not above zero.
        """
        if not (exponent > 0.0 and reference > 0.0):
            raise LtcgearError(
                f"equivalent range: slope {exponent:g} and {reference:g} cycles; both must be above zero"
            )
        if not self.span.size:
            return 0.0
        part = float((self.count * (self.span / self.largest) ** exponent).sum()) / reference
        return float(self.largest * part ** (1.0 / exponent))


def count_cycles(signal: xr.DataArray) -> Cycles:
    """Count the rainflow cycles of an output (ASTM E1049-85, 5.4.4), by the library ``rainflow``.

    Raises
    ------
    LtcgearError
        If the signal cannot be analysed, or the library is missing.
    """
    try:
        import rainflow
    except ImportError as error:
        raise LtcgearError("rainflow counts: need a further package; run: pip install 'ltcgear[report]'") from error

    one = read_trace(signal)
    cycles = [cycle[:3] for cycle in rainflow.extract_cycles(one.values) if cycle[0] > 0.0]
    found = np.array(cycles, dtype=np.float64).reshape(-1, 3)
    seconds = float(one.time[-1] - one.time[0])
    return Cycles(one.name, one.title, one.unit, found[:, 0], found[:, 1], found[:, 2], seconds)
