"""Objective of the adjoint: a mean, RMS or extreme of an output over a window."""

from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache

import numpy as np
from ltcgear.generated.contract import Manifest
from ltcgear.generated.errors import LtcgearError
from numpy.typing import NDArray

from ...model.quantity_names import PHASES
from ...model.rows import Batch
from ...results.select import split_output
from ...simulation.dense_output import Chebyshev
from .course import Course, Piece
from .extreme import SIGNS, Instant, find_extreme

Vector = NDArray[np.float64]
MEASURES = ("mean", "rms", "vibration", *SIGNS)
"""Mean; root mean square about zero; root mean square about the mean; largest and smallest value."""
COUNTS = (16, 32, 64, 128, 256, 512, 1024)
"""Intervals between the points of a piece at which an output is evaluated."""
EXACT, STILL = 1e-11, 1e-12
"""Change of the mean square that ends that; RMS over mean from which an output counts as varying."""


@dataclass(frozen=True)
class Worth:
    """Measure of an output y and its derivative, dJ = integral of (a + b y) dy dt over the window or dy at one instant.

    Attributes
    ----------
    value
        J.
    a, b
        Weights [1/s over the unit of y] where J is linear in y, and what adds to them.
    start, end
        The window [s].
    instant
        Instant of the extreme; None for an integral.
    """

    value: float
    a: float
    b: float
    start: float
    end: float
    instant: Instant | None = None


def find_output(manifest: Manifest, wanted: str) -> int:
    """Return the place among the outputs of QUANTITY:ITEM.

    Raises
    ------
    LtcgearError
        If there is no such output, or its mean says nothing.
    """
    quantity, item = split_output(wanted)
    reports = [f"{report.quantity}:{report.item}" for report in manifest.reports]
    if quantity in PHASES:
        raise LtcgearError(f"--output {wanted}: {quantity} grows with time, so it has no mean; give another output")
    if f"{quantity}:{item}" in reports:
        return reports.index(f"{quantity}:{item}")
    known = list(dict.fromkeys(report.quantity for report in manifest.reports if report.quantity not in PHASES))
    of_it = [report.item for report in manifest.reports if report.quantity == quantity]
    if of_it:
        near = get_close_matches(item, of_it, 1, 0.0) or of_it
        raise LtcgearError(f"--output {wanted}: no such item; {quantity} has {', '.join(of_it)}; nearest: {near[0]}")
    raise LtcgearError(f"--output {wanted}: no such quantity; write QUANTITY:ITEM with one of {', '.join(known)}")


def check_measure(measure: str, start: float, end: float) -> None:
    """Refuse a measure that is not known, or a window without length."""
    if measure not in MEASURES:
        raise LtcgearError(f"--measure {measure}: must be one of {', '.join(MEASURES)}")
    if not 0 <= start < end:
        raise LtcgearError(f"--from {start:g}: must be a time between 0 and the end of the run, {end:g} s")


def find_worth(course: Course, output: int, measure: str, start: float) -> Worth:
    """Measure an output over the window from ``start`` to the end of a course.

    Raises
    ------
    LtcgearError
        If the output does not vary, where its vibration is asked for: that has no derivative there.
    """
    end = course.pieces[-1].start + course.pieces[-1].duration
    if measure in SIGNS:
        extreme, instant = find_extreme(course, output, measure, start)
        return Worth(extreme, 0.0, 0.0, start, end, instant)
    rows = [_values(course, Batch(course.library, "outputs"), piece, output, start) for piece in course.pieces]
    y, weights = (np.concatenate(parts) for parts in zip(*rows, strict=True))
    share = 1 / (end - start)
    mean = share * float(weights @ y)
    if measure == "mean":
        return Worth(mean, share, 0.0, start, end)
    about = mean if measure == "vibration" else 0.0
    value = float(np.sqrt(share * (weights @ (y - about) ** 2)))
    if not value > STILL * abs(mean):
        raise LtcgearError(f"the output stays as it is ({mean:.6g}): its {measure} has no derivative; ask for mean")
    return Worth(value, -about * share / value, share / value, start, end)


def _values(course: Course, batch: Batch, piece: Piece, output: int, start: float) -> tuple[Vector, Vector]:
    """Return an output at points of a piece, or of what lies of it in the window, and quadrature weights [s].

    An output may vary faster than the motion, as stiffness and errors over the mesh phase do: points are added until
    the mean square is constant.
    """
    first = min(max((start - piece.start) / piece.duration, 0.0), 1.0)
    if first >= 1.0:
        return np.zeros(0), np.zeros(0)
    before = np.inf
    for count in COUNTS:
        times = first + (1 - first) * Chebyshev(count).points
        x = course.nodes.matrix(times) @ piece.x
        s = np.array([piece.s_at(part * piece.duration) for part in times])
        y, weights = batch(x, s, piece.p)[:, output], quadrature(count)
        square = float(weights @ y**2)
        if abs(square - before) <= EXACT * float(np.max(y**2)):
            break
        before = square
    return y, (1 - first) * piece.duration * weights


@cache
def quadrature(count: int) -> Vector:
    """Return the weights of Clenshaw and Curtis over 0..1 for ``count + 1`` Chebyshev points (Waldvogel 2006)."""
    k = np.arange(count + 1)
    moments = np.where(k % 2 == 0, 1.0 / (1.0 - np.where(k % 2 == 0, k, 0.0) ** 2), 0.0)
    terms = np.cos(np.pi * np.outer(k, k) / count) * 2.0 / count
    terms[[0, -1]] /= 2
    terms[:, [0, -1]] /= 2
    return np.asarray(moments @ terms)
