"""Runtime: compiled models at work, from the equilibrium to results and reports."""

from importlib import import_module
from typing import Any

_HOME = {
    "Dynamics": "export.solver.dynamics",
    "OperatingPoint": "model.operating_point",
    "RunSettings": "simulation.run_settings",
    "build": "model.building",
    "describe_modes": "linear.naming",
    "differentiate_modes": "linear.sensitivity",
    "find_equilibrium": "model.equilibrium",
    "find_modes": "linear.modes",
    "integrate": "simulation.integrate",
    "linearise": "linear.system",
    "load": "results.result",
    "load_sweep": "studies.sweep.sweep_file",
    "record": "simulation.recording",
    "respond": "linear.response",
    "save": "results.result",
    "simulate": "simulation.simulate",
    "simulate_many": "simulation.ensemble",
    "sweep": "studies.sweep.run_sweep",
    "write_fmu": "export.fmu.package",
    "write_report": "view.report.page",
}
__all__ = list(_HOME)


def __getattr__(name: str) -> Any:  # noqa: ANN401
    """Load a public name from its module."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_HOME[name]}", __name__), name)
