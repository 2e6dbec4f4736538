"""Energy balance of a run."""

from ..model.energy_levels import UNLOADED
from ..model.operating_point import OperatingPoint
from .trajectory import Outcome


def energy_residual(point: OperatingPoint, path: Outcome) -> float:
    """Return what is missing in the energy balance, over the strain energy of the start.

    Energy at the end less energy at the start, less work of loads, drives and dampers, less what the
    stiffness jumps put in; zero for an exact solution. Where there is less strain energy than `UNLOADED` a freedom
    (the size of vibrations that tolerances then refer to), it is taken over that, or over all work.
    """
    missing = path.energy[1] - path.energy[0] - path.work - path.jump_energy
    freedoms = len(point.library.index(""))
    return missing / max(point.strain, abs(path.work) + abs(path.jump_energy), UNLOADED * freedoms)
