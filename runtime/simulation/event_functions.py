"""Event functions for integrators with their own root finding."""

import numpy as np
from numpy.typing import NDArray

from ..model.contact_levels import Cells, lower, upper
from ..model.function import Kernel
from .contact_events import Regimes

Vector = NDArray[np.float64]


class Watch:
    """Event functions of the mesh phases and contacts in their present state.

    Parameters
    ----------
    regimes
        The states of the contacts.
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
