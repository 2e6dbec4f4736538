"""Figures, tables and pages of what was computed."""

from importlib import import_module
from typing import Any

_HOME = {
    "draw_bearings": "figures.load_figures",
    "draw_envelope": "figures.spectrum_figures",
    "draw_forces": "figures.load_figures",
    "draw_load_duration": "figures.load_figures",
    "draw_orbits": "figures.orbit_figures",
    "draw_range_means": "figures.cycle_figures",
    "draw_ranges": "figures.cycle_figures",
    "draw_shares": "figures.load_figures",
    "draw_spectrogram": "figures.spectrum_figures",
    "draw_spectrum": "figures.spectrum_figures",
    "draw_survey": "figures.gallery",
    "draw_transmission_error": "figures.load_figures",
    "draw_waterfall": "figures.spectrum_figures",
    "list_tables": "tables.analysis_tables",
}
__all__ = list(_HOME)


def __getattr__(name: str) -> Any:  # noqa: ANN401
    """Load a public name from its module."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_HOME[name]}", __name__), name)
