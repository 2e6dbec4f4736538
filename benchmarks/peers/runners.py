"""Who runs: ltcgear itself, SciPy and scikit-sundae on our C, SciPy on NumPy, Exudyn on the stage."""

from collections.abc import Callable
from dataclasses import replace
from time import perf_counter
from typing import Any

import numpy as np
from ltcgear.runtime.model.operating_point import OperatingPoint
from ltcgear.runtime.simulation import integrate as whole
from ltcgear.runtime.simulation.run_settings import RunSettings
from ltcgear.runtime.simulation.trajectory import Trajectory
from numpy.typing import NDArray
from scipy import integrate

from . import stage
from .race import Runner
from .rig import RATE, T_END, Rate, Rig
from .solvers import Jacobian, Odeint, Restarted, Stepwise, Sundae, our_rate

Vector = NDArray[np.float64]
OURS, SCIPY, NUMPY, SUNDAE, EXUDYN = "ltcgear", "SciPy on our C", "SciPy on NumPy", "scikit-sundae on our C", "Exudyn"
METHODS = ("erk", "cvodes")
TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6)
ROUNDS, SLOW_ROUNDS = 11, 3
TIGHT = 1e-11


def timed(solver: Restarted) -> Callable[[float], tuple[Vector, float]]:
    """Return a run of a solver that tells its time."""

    def run(rtol: float) -> tuple[Vector, float]:
        clock = perf_counter()
        states = solver.run(rtol)
        return states, perf_counter() - clock

    return run


def _integrate(rig: Rig, method: str, rtol: float) -> Trajectory:
    """Return a motion of ltcgear's."""
    return whole.integrate(OperatingPoint(rig.library, rig.p, rig.at), RunSettings(T_END, RATE, method, rtol))


def ours(rig: Rig, method: str) -> Callable[[float], tuple[Vector, float]]:
    """Return a run of ltcgear; its time is that of integration, without the set-up that each run has once."""

    def run(rtol: float) -> tuple[Vector, float]:
        found = _integrate(rig, method, rtol)
        if found.status != "done":
            raise RuntimeError(found.status)
        return found.x, found.seconds["integrate"] + found.seconds["outputs"]

    return run


def set_up_time(rig: Rig, method: str) -> float:
    """Return the least time [s] that ltcgear takes to set a run up, the integrator being compiled."""
    found = [_integrate(rig, method, 1e-4).seconds["prepare"] for _ in range(3)]
    return min(found)


def our_runners(rig: Rig) -> list[Runner]:
    """Return ltcgear's own."""
    return [Runner(OURS, method, ours(rig, method), TOLERANCES, ROUNDS) for method in METHODS]


def scipy_runners(rig: Rig) -> list[Runner]:
    """Return SciPy's solvers on our C."""
    rate, jacobian = our_rate(rig), Jacobian(rig)
    solvers = {
        "LSODA": Odeint(rig, rate, jacobian), "DOP853": Stepwise(integrate.DOP853, rig, rate),
        "Radau": Stepwise(integrate.Radau, rig, rate, jacobian),
        "LSODA, no restarts": Odeint(rig, rate, jacobian, restarts=False),
    }  # fmt: skip
    slow = {"Radau": TOLERANCES[:2]}
    return [
        Runner(SCIPY, name, timed(solver), slow.get(name, TOLERANCES), ROUNDS - 2 * (name in slow))
        for name, solver in solvers.items()
    ]


def numpy_runners(rig: Rig, rate: Rate) -> list[Runner]:
    """Return SciPy's solvers on NumPy; implicit ones find the Jacobian by differences."""
    solvers = {
        "LSODA": Odeint(rig, rate), "DOP853": Stepwise(integrate.DOP853, rig, rate),
        "Radau": Stepwise(integrate.Radau, rig, rate), "LSODA, no restarts": Odeint(rig, rate, restarts=False),
    }  # fmt: skip
    few = {"DOP853": TOLERANCES[:3], "Radau": TOLERANCES[:2]}
    return [
        Runner(NUMPY, name, timed(solver), few.get(name, TOLERANCES), SLOW_ROUNDS) for name, solver in solvers.items()
    ]


def sundae_runners(rig: Rig) -> list[Runner]:
    """Return CVODE by scikit-sundae on our C."""
    rate, jacobian = our_rate(rig), Jacobian(rig)
    return [
        Runner(SUNDAE, f"CVODE {name}", timed(Sundae(name, rig, rate, jacobian)), TOLERANCES, ROUNDS)
        for name in ("BDF", "Adams")
    ]


def exudyn_runners(peer: Any, torque: float) -> list[Runner]:  # noqa: ANN401
    """Return Exudyn's solvers on the stage; a setting is the number of steps between two samples."""
    from .exudyn_stage import SOLVERS

    def runner(solver: str) -> Callable[[float], tuple[Vector, float]]:
        return lambda steps: peer.run(solver, int(steps), torque)

    return [
        Runner(EXUDYN, solver, runner(solver), steps, ROUNDS if solver.startswith("RK") else SLOW_ROUNDS)
        for solver, steps in SOLVERS.items()
    ]


def struck(rig: Rig) -> tuple[Rig, float]:
    """Return the stage under a step of its torque, from the equilibrium before it, and the torque [N m]."""
    names = [name for name, _ in rig.library.manifest.parameters]
    p = rig.p.copy()
    p[names.index("loads.sun.torque")] *= stage.STEP
    return replace(rig, p=p), float(p[names.index("loads.sun.torque")])


def references(rig: Rig) -> tuple[Vector, Vector]:
    """Return the states by DOP853, and by erk as a second opinion, both at tight tolerances."""
    return Stepwise(integrate.DOP853, rig, our_rate(rig)).run(TIGHT), ours(rig, "erk")(10 * TIGHT)[0]
