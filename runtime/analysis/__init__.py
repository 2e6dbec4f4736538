"""What a simulation shows: spectra, orders, loads and orbits, each a function of outputs over time to a plain value."""

from importlib import import_module
from typing import Any

_HOME = {
    "analyse": "survey",
    "count_cycles": "cycles",
    "cut": "span",
    "draw_bearings": "load_figures",
    "draw_envelope": "spectrum_figures",
    "draw_forces": "load_figures",
    "draw_load_duration": "load_figures",
    "draw_orbits": "orbit_figures",
    "draw_range_means": "cycle_figures",
    "draw_ranges": "cycle_figures",
    "draw_shares": "load_figures",
    "draw_spectrogram": "spectrum_figures",
    "draw_spectrum": "spectrum_figures",
    "draw_survey": "gallery",
    "draw_transmission_error": "load_figures",
    "draw_waterfall": "spectrum_figures",
    "find_clues": "lines",
    "find_density": "spectrum",
    "find_envelope": "envelope",
    "find_load_duration": "duration",
    "find_load_share": "sharing",
    "find_orbit": "orbits",
    "find_order_spectrum": "orders",
    "find_sidebands": "envelope",
    "find_spectrum": "spectrum",
    "find_transmission_error": "transmission",
    "find_waterfall": "waterfall",
    "list_bearing_loads": "bearings",
    "list_tables": "listing",
    "mesh_courses": "waterfall",
    "name_lines": "lines",
    "select_output": "trace",
    "shaft_angle": "orders",
}
__all__ = list(_HOME)


def __getattr__(name: str) -> Any:  # noqa: ANN401
    """Load a public name from its module."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_HOME[name]}", __name__), name)
