"""Forward run of the adjoint, stored segment by segment."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from ltcgear.generated.contract import HELD
from ltcgear.generated.errors import SolverError
from numpy.typing import NDArray

from ...model.library import Library
from ...model.load_tables import Signals
from ...model.operating_point import OperatingPoint
from ...simulation.dense_output import Chebyshev
from ...simulation.driver import March
from ...simulation.method_limits import check_explicit
from ...simulation.run_settings import RunSettings

Vector = NDArray[np.float64]
Cells = NDArray[np.int64]
Sides = NDArray[np.bool_]


@dataclass(frozen=True)
class Piece:
    """A smooth piece of a run.

    Attributes
    ----------
    start, duration
        Its first instant and how long it is [s].
    x
        States at the nodes, shape (nodes, n); whole turns are taken off the reference angle.
    s, slope
        Levels and load signals at its start; rates of the signals [1/s].
    p
        Parameters: those of the run with the turns that were taken off and the sides that are held.
    cells, sides
        Cells of the mesh phases, and states of the contacts.
    crossed
        Per mesh the cell that is entered at its end less that which is left: 0, 1 or -1.
    """

    start: float
    duration: float
    x: Vector
    s: Vector
    slope: Vector
    p: Vector
    cells: Cells
    sides: Sides
    crossed: Cells

    def s_at(self, time: float) -> Vector:
        """Return levels and signals at a time [s] after its start."""
        s = self.s.copy()
        if len(self.slope):
            s[-len(self.slope) :] += self.slope * time
        return s


@dataclass(frozen=True)
class Course:
    """A run as pieces of smooth motion.

    Attributes
    ----------
    point
        The model where the run begins.
    nodes
        The nodes of every piece, in its own time 0..1.
    scale
        Sizes of vibrations of the states.
    pieces
        The pieces, in order.
    """

    point: OperatingPoint
    nodes: Chebyshev
    scale: Vector
    pieces: list[Piece]

    @property
    def library(self) -> Library:
        """Return the model."""
        return self.point.library


def follow_course(point: OperatingPoint, settings: RunSettings) -> Course:
    """Integrate from the equilibrium and store every segment.

    Parameters
    ----------
    point, settings
        Where the run begins and how it goes; no sampling rate is needed.

    Raises
    ------
    SolverError
        If the run does not reach its end.
    """
    if settings.integrator.explicit:
        check_explicit(point, settings)
    signals = Signals(point.library.manifest.signals, settings.tables or {})
    march = March(point, replace(settings, rate=1 / settings.t_end), signals, dense=True)
    assert isinstance(march.nodes, Chebyshev)
    pieces: list[Piece] = []
    while march.state.done <= march.state.last:
        start, segments = march.time, march.state.segments
        try:
            march.proceed(segments=1)
        except RuntimeError as error:
            reason = march.explain_failure() or str(error).strip().splitlines()[-1]
            stopped = f"{settings.method} stopped at t = {march.time:.6g} s (rtol {settings.rtol:g})"
            raise SolverError(f"{stopped}: {reason}") from error
        march.state.filled = 0
        if march.state.segments > segments:
            pieces.append(_piece(march, start))
    return Course(point, march.nodes, march.frame.scale, pieces)


def _piece(march: March, start: float) -> Piece:
    """Store the segment just integrated."""
    arrays: dict[str, Any] = march.native.arrays
    sides, cells = arrays["arc_sides"].copy(), arrays["arc_cells"].copy()
    p = march.p.copy()
    p[march.regimes.index] = np.where(sides, HELD, -HELD)
    x = march.frame.origin + march.frame.scale * arrays["path"]
    return Piece(
        start, float(march.state.reached), x, arrays["s"].copy(), arrays["slope"].copy(), p, cells, sides,
        march.cells - cells,
    )  # fmt: skip
