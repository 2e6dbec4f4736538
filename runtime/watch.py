"""Watch: what a motion must not step over, for engines that look for it themselves."""

import numpy as np
from numpy.typing import NDArray

from .kernel import Kernel
from .library import Library
from .switching import Cells, lower, upper

Vector = NDArray[np.float64]


class Watch:
    """The borders of the cells that a motion is in.

    Attributes
    ----------
    cells
        The cells of the mesh phases now, kept by the march.
    """

    def __init__(self, library: Library, p: Vector) -> None:
        self.p, self.phases = p, Kernel(library.functions["phases"])
        self.cells: Cells = np.zeros(len(library.manifest.levels), dtype=np.int64)
        self.count = 2 * len(self.cells)

    def distances(self, x: Vector, s: Vector) -> Vector:
        """Return how far a state is from the borders, positive inside and zero at a border, shape (count,)."""
        tau, _, share = self.phases(x, s, self.p)
        return np.concatenate([upper(self.cells, share) - tau, tau - lower(self.cells, share)])
