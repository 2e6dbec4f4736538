"""Compiled models at work: equilibrium, integration, linearisation, results."""

from importlib import import_module
from typing import Any

_HOME = {
    "Dynamics": "dynamics",
    "build": "library",
    "describe_modes": "linear.naming",
    "differentiate_modes": "linear.sensitivity",
    "find_equilibrium": "equilibrium",
    "find_modes": "linear.modes",
    "integrate": "integration",
    "linearise": "linear.system",
    "load": "results",
    "load_sweep": "sweeping.store",
    "record": "recording",
    "respond": "linear.response",
    "save": "results",
    "simulate": "simulation",
    "simulate_many": "ensemble",
    "sweep": "sweeping.run",
    "write_fmu": "fmu.package",
    "write_report": "report.page",
}
__all__ = list(_HOME)


def __getattr__(name: str) -> Any:  # noqa: ANN401
    """Load a public name from its module."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_HOME[name]}", __name__), name)
