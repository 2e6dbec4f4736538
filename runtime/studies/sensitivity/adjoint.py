"""Adjoint of a run: derivatives of a mean, RMS or extreme to all parameters, through jumps and regimes.

One run forwards, one backwards: with the adjoint of Cao, Li, Petzold and Serban (2003) the cost does not grow with
the number of parameters.
"""

from dataclasses import dataclass

import numpy as np
from ltcgear.generated.errors import SolverError
from numpy.typing import NDArray

from ...linear.balance import Balance
from ...linear.gradients import Gradients
from ...model.function import Kernel
from ...model.operating_point import OperatingPoint
from ...simulation.run_settings import RunSettings
from .backward import Backward, report_gradient, vibrating
from .course import Course, Piece, follow_course
from .extreme import Instant
from .jumps import Jumps
from .worth import Worth, find_worth

Vector = NDArray[np.float64]
GROWTH = 1e2
"""By how much the adjoint may exceed what has gone into it, beyond what a train that rolls freely makes of it."""

INSTANT, EDGE = 1e-12, 1e-9
"""Part of a piece that is nothing but rounding; part of a run by which a jump may miss an end of the window."""


@dataclass(frozen=True)
class OutputDerivative:
    """A measure of an output and its derivatives.

    Attributes
    ----------
    value
        The measure, in the unit of the output.
    gradient
        Its derivative with respect to all parameters, shape (n_p,).
    pieces, steps
        Smooth pieces of the run, and steps back.
    one_sided
        Parameters with a one-sided derivative: they move a mesh phase off the switching point where it starts.
    edges
        Ends of the window [s] on which a jump falls: there all derivatives hold to one side only.
    """

    value: float
    gradient: Vector
    pieces: int
    steps: int
    one_sided: list[str]
    edges: list[float]


def differentiate_output(
    point: OperatingPoint, output: int, settings: RunSettings, *, measure: str, start: float
) -> OutputDerivative:  # fmt: skip
    """Differentiate a measure of an output of a run from the equilibrium.

    Parameters
    ----------
    point
        The model where the run begins; its equilibrium moves with the parameters.
    output, measure, start
        Place of the output among the reports; see ``worth.MEASURES``; first instant that counts [s].
    settings
        Time, method, tolerance and tables of the run; the adjoint has the same tolerance.

    Raises
    ------
    SolverError
        If the run or its adjoint cannot be followed: where motion grows so that derivatives say nothing.
    """
    course = follow_course(point, settings)
    return differentiate_course(course, output, measure=measure, start=start, rtol=settings.rtol)


def differentiate_course(course: Course, output: int, *, measure: str, start: float, rtol: float) -> OutputDerivative:
    """Differentiate a measure of an output of a run that is known; see ``differentiate_output``."""
    worth = find_worth(course, output, measure, start)
    backward = Backward(course, output, rtol)
    jumps = Jumps(course, output)
    if worth.instant is None:
        _go_back(course, worth, backward, jumps, output)
    else:
        _go_back_from(course, worth.instant, backward, jumps)
    gradient = backward.gradient + Balance(Gradients(course.library), course.point.p, course.point.at).pull_back(
        backward.adjoint
    )
    sided = jumps.one_sided(course.pieces[0])
    return OutputDerivative(
        worth.value, gradient, len(course.pieces), int(backward.state.steps), sided, _edges(course, worth)
    )


def _edges(course: Course, worth: Worth) -> list[float]:
    """Return the ends of the window on which a jump falls, of an extreme only where it lies on one."""
    jumps = [piece.start + piece.duration for piece in course.pieces if piece.crossed.any()]
    ends = [worth.start, worth.end] if worth.start > 0 else [worth.end]
    if worth.instant is not None:
        at = course.pieces[worth.instant.piece].start + worth.instant.time
        ends = [end for end in ends if abs(end - at) < EDGE * worth.end]
    return [end for end in ends if any(abs(end - jump) < EDGE * worth.end for jump in jumps)]


def _go_back(course: Course, worth: Worth, backward: Backward, jumps: Jumps, output: int) -> None:
    """Go back over all pieces and what lies between them."""
    watch = _Watch(course, worth, output)
    after = None
    for piece in reversed(course.pieces):
        end = piece.start + piece.duration
        a, b = (worth.a, worth.b) if end > worth.start else (0.0, 0.0)
        if after is not None:
            jumps.go_back(backward, piece, after, a, b)
        within, least = min(max(worth.start - piece.start, 0.0), piece.duration), INSTANT * piece.duration
        if within < piece.duration - least:
            backward.go_back(piece, within, piece.duration, worth.a, worth.b)
        if within > least:
            backward.go_back(piece, 0.0, within, 0.0, 0.0)
        watch.look(backward, piece)
        after = piece


def _go_back_from(course: Course, instant: Instant, backward: Backward, jumps: Jumps) -> None:
    """Go back from the instant of an extreme to the start of the run."""
    pieces = course.pieces[: instant.piece + 1]
    last = pieces[-1]
    rate = jumps.begin(backward, last, instant.time)
    watch = _Growth(course, last.start + instant.time, float(np.linalg.norm(vibrating(course) * backward.adjoint)))
    if instant.side == "end":
        jumps.follow_end(backward, last, course.pieces[instant.piece + 1], rate)
    if instant.time > INSTANT * last.duration:
        backward.go_back(last, 0.0, instant.time, 0.0, 0.0)
    after, shifted = last, rate if instant.side == "start" else 0.0
    for piece in reversed(pieces[:-1]):
        jumps.go_back(backward, piece, after, 0.0, 0.0, shifted)
        backward.go_back(piece, 0.0, piece.duration, 0.0, 0.0)
        watch.look(backward, piece)
        after, shifted = piece, 0.0


class _Watch:
    """Sees to it that the adjoint does not outgrow what has gone into it."""

    def __init__(self, course: Course, worth: Worth, output: int) -> None:
        self.course, self.worth, self.growth = course, worth, _Growth(course, worth.end, 0.0)
        self.source = Kernel(report_gradient(course.library, output))

    def look(self, backward: Backward, piece: Piece) -> None:
        """Refuse an adjoint that has outgrown its sources: whatever moves a little moves everything then."""
        if piece.start + piece.duration > self.worth.start:
            given = max(self._given(piece, place) for place in (0, len(piece.x) // 2, -1))
            self.growth.given += piece.duration * given
        self.growth.look(backward, piece)

    def _given(self, piece: Piece, place: int) -> float:
        """Return the size of the adjoint's source at a node."""
        s = piece.s_at(float(self.course.nodes.points[place]) * piece.duration)
        of_x = self.source(piece.x[place], s, piece.p, (self.worth.a, self.worth.b))[0]
        return float(np.linalg.norm(self.growth.size * of_x))


class _Growth:
    """What has gone into an adjoint, and whether it has outgrown that.

    Parameters
    ----------
    course, end, given
        The run, the last instant that counts [s], and the size of what the adjoint begins with.
    """

    def __init__(self, course: Course, end: float, given: float) -> None:
        self.end, self.given, self.size = end, given, vibrating(course)
        self.speed = course.point.fastest

    def look(self, backward: Backward, piece: Piece) -> None:
        """Refuse an adjoint that has outgrown its sources: whatever moves a little moves everything then."""
        past = self.end - piece.start
        reached = float(np.linalg.norm(self.size * backward.adjoint))
        growth = reached / max(self.given * (1 + self.speed * past), 1e-300)
        if growth > GROWTH:
            raise SolverError(
                f"from t = {piece.start:.6g} s to the end of the run what is moved a little grows {growth:.1e}-fold "
                "beyond what a regular motion makes of it: it grows or is chaotic, and derivatives of it say nothing; "
                "simulate less time (--t-end), or take a load or speed at which the motion is regular"
            )
