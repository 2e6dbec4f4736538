"""Contact events: the state of every contact, held within a smooth segment.

A contact opens or closes at a zero of its generated indicator g (teeth touch, a bearing closes its clearance). While a
segment is integrated the signs of all indicators are held, so that the motion in it is smooth; the first zero crossing
ends it (``model/c/regimes.c``).
"""

import numpy as np
from ltcgear.generated.contract import HELD
from numpy.typing import NDArray

from ..model.contact_levels import Cells, lower, upper
from ..model.function import Kernel
from ..model.library import Library
from .smooth_arc import Frame

Vector = NDArray[np.float64]
Sides = NDArray[np.bool_]
SLACK = 0.1
"""Distance beyond an event that still counts as on it, over the error of the indicator that the tolerance allows."""


class Regimes:
    """The states of all contacts of a run.

    Parameters
    ----------
    library, p
        Model and parameters, shape (n_p,).
    frame
        Scaling of the states, which gives indicators their size.
    rtol
        Tolerance of the states.
    s
        Levels and signals at the start.
    known
        Index of a state known without error, or None.

    Attributes
    ----------
    sides
        True where the indicator is held positive, shape (n_g,).
    index
        Where the holds are in p, shape (n_g,).
    error, slack
        Error of each indicator allowed by the tolerance of each state, shape (n, n_g), and the largest, shape (n_g,).
    """

    def __init__(
        self, library: Library, p: Vector, frame: Frame, rtol: float, s: Vector, known: int | None = None
    ) -> None:
        names = [name for name, _ in library.manifest.parameters]
        self.index = np.array([names.index(hold) for hold in library.manifest.holds], dtype=np.int64)
        self.p, self.frame = p, frame
        self.one = Kernel(library.functions["borders"])
        first = self._at(np.zeros(len(frame.scale)), s)
        self.sides: Sides = first > 0
        error = SLACK * rtol * np.array([np.abs(self._at(z, s) - first) for z in np.eye(len(frame.scale))])
        if known is not None:
            error[known] = 0.0
        self.error, self.slack = error, error.max(axis=0, initial=0.0)

    def _at(self, z: Vector, s: Vector) -> Vector:
        """Return the indicators of one state."""
        return np.array(self.one(self.frame.origin + self.frame.scale * z, s, self.p)[0])

    def seen(self, x: Vector, s: Vector) -> Vector:
        """Return the indicators of an unscaled state, positive on the side that holds."""
        return np.asarray(np.where(self.sides, 1.0, -1.0) * self.one(x, s, self.p)[0])

    def hold(self, p: Vector) -> None:
        """Put the sides into parameters."""
        p[self.index] = np.where(self.sides, HELD, -HELD)


class EventFunctions:
    """Event functions of mesh phases and contacts, for integrators with their own root finding.

    Parameters
    ----------
    regimes
        The sides that hold.
    phases
        The function of the mesh phases.
    p
        Parameters; the C changes them in place.
    cells
        The cells of the mesh phases, updated by the C from now on.
    """

    def __init__(self, regimes: Regimes, phases: Kernel, p: Vector, cells: Cells) -> None:
        self.regimes, self.phases, self.p, self.cells = regimes, phases, p, cells
        self.count = 2 * len(cells) + len(regimes.index)

    def distances(self, x: Vector, s: Vector) -> Vector:
        """Return the event functions at a state, positive before an event and zero at it, shape (count,)."""
        tau, _, share = self.phases(x, s, self.p)
        return np.concatenate([upper(self.cells, share) - tau, tau - lower(self.cells, share), self.regimes.seen(x, s)])
