"""Integration from the equilibrium in one call, all samples kept."""

from collections.abc import Mapping

from ..model.library import Library
from ..model.load_tables import Pairs
from ..model.operating_point import OperatingPoint
from ..model.state_matrix import Equilibrium, Vector
from .integration import Integration
from .method_limits import check_run
from .run_settings import RunSettings
from .trajectory import Block, Told, Trajectory, join


def integrate(
    library: Library, p: Vector, at: Equilibrium, *, t_end: float, rate: float, method: str, rtol: float,
    told: Told = lambda t: None, tables: Mapping[str, Pairs] | None = None,
) -> Trajectory:  # fmt: skip
    """Integrate from the equilibrium, and keep all samples.

    Parameters
    ----------
    library, p, at
        Model, parameters and initial state.
    t_end, rate, method, rtol, tables
        See ``RunSettings``.
    told
        Called with the simulated time now and then.

    Returns
    -------
    Trajectory
        A failure is a status in it, and what was computed until then is kept.
    """
    kept: list[Block] = []
    settings = RunSettings(t_end, rate, method, rtol, tables=tables)
    point = OperatingPoint(library, p, at)
    check_run(point, settings)
    outcome = Integration(point, settings).proceed(lambda block, points: kept.append(block), told)
    return Trajectory(**vars(outcome), **vars(join(kept)))
