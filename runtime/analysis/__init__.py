"""Analysis of a result: spectra, orders, loads and orbits, as functions of outputs over time."""

from importlib import import_module
from typing import Any

_HOME = {
    "analyse": "survey",
    "count_cycles": "cycles",
    "cut": "span",
    "find_clues": "lines",
    "find_density": "spectrum",
    "find_envelope": "envelope",
    "find_load_duration": "duration",
    "find_load_share": "sharing",
    "find_orbit": "orbits",
    "find_order_spectrum": "order_spectrum",
    "find_sidebands": "envelope",
    "find_spectrum": "spectrum",
    "find_transmission_error": "transmission",
    "find_waterfall": "waterfall",
    "list_bearing_loads": "bearings",
    "mesh_courses": "waterfall",
    "name_lines": "lines",
    "select_output": "trace",
    "shaft_angle": "order_spectrum",
}
__all__ = list(_HOME)


def __getattr__(name: str) -> Any:  # noqa: ANN401
    """Load a public name from its module."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_HOME[name]}", __name__), name)
