"""Extreme of an output in a window, and its derivative to state and parameters.

At an instant t* inside a smooth piece where y is largest, its rate is zero, so that t* may move without moving the
largest value: the derivative is that of y at t* held (the envelope theorem; Milgrom and Segal 2002). Where y is
largest on a jump, it is the jump's instant that t* follows.
"""

from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from ...model.function import Kernel
from ...model.rows import Batch
from ...model.ties import order_by_size
from ...simulation.dense_output import Chebyshev
from .course import Course, Piece

Vector = NDArray[np.float64]
SIGNS = {"max": 1.0, "min": -1.0}
"""The measures that are extremes, and what turns each into a maximum."""
COUNT = 32
"""Intervals between the points of a piece at which an output is evaluated."""
RIVALS = 8
"""Number of pieces with the highest points that are refined."""
SHARP = 1e-13
"""How well the place of an extreme is found, over the length of its piece."""


@dataclass(frozen=True)
class Instant:
    """The instant of an extreme.

    Attributes
    ----------
    piece
        Number of the piece it lies in.
    time
        Time after that piece's start [s].
    side
        ``start`` or ``end`` where it is an end of the piece that is no end of the window, else ``inside``.
    """

    piece: int
    time: float
    side: str


def find_extreme(course: Course, output: int, measure: str, start: float) -> tuple[float, Instant]:
    """Find the largest or smallest value of an output, jumps from both sides, from ``start`` to the end of a course.

    Parameters
    ----------
    course, output, start
        The run, place of the output among the reports, first instant that counts [s].
    measure
        ``max`` or ``min``.

    Returns
    -------
    value, instant
        The extreme in the unit of the output, and where it lies.
    """
    sign, look = SIGNS[measure], _Look(course, output)
    spans = [_span(piece, start) for piece in course.pieces]
    tops = [
        -np.inf if first >= 1.0 else float((sign * look.values(piece, _points(first))).max())
        for piece, first in zip(course.pieces, spans, strict=True)
    ]
    best, chosen = -np.inf, Instant(0, 0.0, "inside")
    for k in order_by_size(tops)[:RIVALS]:
        if spans[k] >= 1.0:
            break
        piece = course.pieces[int(k)]
        part = look.refine(piece, _points(spans[k]), sign)
        top = float(sign * look.values(piece, np.array([part]))[0])
        if top > best:
            best, chosen = top, Instant(int(k), part * piece.duration, _side(course, int(k), part, spans[k]))
    return sign * best, chosen


class _Look:
    """An output and its rate at any place of a course."""

    def __init__(self, course: Course, output: int) -> None:
        self.course, self.output, library = course, output, course.library
        self.batch = Batch(library, "outputs")
        graph = library.graphs["outputs"]
        point = [ca.SX.sym(graph.name_in(i), graph.sparsity_in(i)) for i in range(graph.n_in())]
        slope, y = ca.SX.sym("slope", point[1].numel()), graph.call(point)[0][output]
        rate = ca.jtimes(y, point[0], library.graphs["rhs"].call(point)[0]) + ca.jtimes(y, point[1], slope)
        self.rate = Kernel(ca.Function("rate", [*point, slope], [ca.densify(rate)]))

    def values(self, piece: Piece, parts: Vector) -> Vector:
        """Return the output at parts 0..1 of a piece."""
        x = self.course.nodes.matrix(parts) @ piece.x
        s = np.array([piece.s_at(part * piece.duration) for part in parts])
        return np.asarray(self.batch(x, s, piece.p)[:, self.output])

    def rate_at(self, piece: Piece, part: float) -> float:
        """Return the output's rate at a part of a piece [1/s]."""
        x, s = (self.course.nodes.matrix(np.array([part])) @ piece.x)[0], piece.s_at(part * piece.duration)
        drift = np.zeros(len(s))
        drift[len(s) - len(piece.slope) :] = piece.slope
        return float(self.rate(x, s, piece.p, drift)[0][0])

    def refine(self, piece: Piece, points: Vector, sign: float) -> float:
        """Return the part of a piece where an output is largest, between the neighbours of its highest point.

        Where the rate goes through zero is known far better than where a flat top is highest.
        """
        here = int((sign * self.values(piece, points)).argmax())
        for left, right in ((here, here + 1), (here - 1, here)):
            if left < 0 or right >= len(points):
                continue
            ends = [sign * self.rate_at(piece, float(points[i])) for i in (left, right)]
            if ends[0] > 0 > ends[1]:
                return float(brentq(lambda part: self.rate_at(piece, part), points[left], points[right], xtol=SHARP))
        return float(points[here])


def _span(piece: Piece, start: float) -> float:
    """Return the part of a piece at which the window begins, 1 or more where it lies before the window."""
    return max((start - piece.start) / piece.duration, 0.0)


def _points(first: float) -> Vector:
    return np.asarray(first + (1 - first) * Chebyshev(COUNT).points)


def _side(course: Course, piece: int, part: float, first: float) -> str:
    """Return whether an instant is an end of its piece but not of the window."""
    if part == 0.0 and first == 0.0 and piece > 0:
        return "start"
    return "end" if part == 1.0 and piece < len(course.pieces) - 1 else "inside"
