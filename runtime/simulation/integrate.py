"""Integration from the equilibrium in one call, all samples kept."""

from ..model.operating_point import OperatingPoint
from .integration import Integration
from .method_limits import check_run
from .run_settings import RunSettings
from .trajectory import Block, Told, Trajectory, join


def integrate(point: OperatingPoint, settings: RunSettings, told: Told = lambda t: None) -> Trajectory:
    """Integrate from the equilibrium, and keep all samples.

    Parameters
    ----------
    point
        Model, parameters and initial state.
    settings
        Settings, method and sampling rate chosen.
    told
        Called with the simulated time now and then.

    Returns
    -------
    Trajectory
        A failure is a status in it, and what was computed until then is kept.
    """
    kept: list[Block] = []
    check_run(point, settings)
    outcome = Integration(point, settings).proceed(lambda block, points: kept.append(block), told)
    return Trajectory(**vars(outcome), **vars(join(kept)))
