"""Energy balance of a run."""

import numpy as np
from numpy.typing import NDArray

from ..model.energy_levels import UNLOADED
from ..model.equilibrium import Equilibrium
from ..model.function import Kernel
from ..model.library import Library
from .integration import Outcome

Vector = NDArray[np.float64]


def energy_residual(library: Library, p: Vector, at: Equilibrium, path: Outcome) -> float:
    """Return what is missing in the energy balance, over the strain energy of the start.

    Energy at the end less energy at the start, less work of loads, drives and dampers, less what the
    stiffness jumps put in; zero for an exact solution. Where there is less strain energy than `UNLOADED` a freedom
    (the size of vibrations that tolerances then refer to), it is taken over that, or over all work.
    """
    missing = path.energy[1] - path.energy[0] - path.work - path.jump_energy
    strain = float(Kernel(library.functions["energy"])(at.x, at.s, p)[0][1])
    freedoms = len(library.index(""))
    return missing / max(strain, abs(path.work) + abs(path.jump_energy), UNLOADED * freedoms)
