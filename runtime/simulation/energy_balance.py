"""Energy balance of a run."""

from ..model.energy_levels import UNLOADED
from ..model.operating_point import OperatingPoint
from .trajectory import Outcome


def energy_residual(point: OperatingPoint, path: Outcome) -> float:
    """Return the error of the energy balance, over the strain energy at the start.

    Energy at the end less energy at the start, less work of loads, drives and dampers, less the energy
    added by stiffness jumps; zero for an exact solution. With less strain energy than `UNLOADED` per degree of freedom
    (to which tolerances then refer), it is relative to that, or to all work.
    """
    missing = path.energy[1] - path.energy[0] - path.work - path.jump_energy
    freedoms = len(point.library.index(""))
    return missing / max(point.strain, abs(path.work) + abs(path.jump_energy), UNLOADED * freedoms)
