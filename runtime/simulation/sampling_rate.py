"""Choice of the sampling rate, by modes and mesh frequencies."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil, log2, pi

import numpy as np

from ..model.blas import single_threaded
from ..model.equilibrium import find_equilibrium
from ..model.library import Library
from ..model.load_tables import Pairs
from ..model.operating_point import OperatingPoint
from ..model.phase_wrapping import Clocks
from .choose_method import excited_modes
from .duty import reference_speed
from .low_pass import BAND

HARMONICS = 5
"""Harmonics of the fastest mesh that the band shall hold."""
ROOM = 1.2
"""Band over the highest mode that the band shall hold."""
FAINT = 0.01
"""Amplitude of a mode over that of the strongest below which it may lie outside of the band."""
STILL = 1e-6
"""Amplitude, over that to which tolerances refer, below which a mode counts as not excited."""
LEAST, MOST = 2**10, 2**18
"""Bounds of rates that are chosen [Hz]; a rate is a power of two."""


@dataclass(frozen=True)
class Rate:
    """A sampling rate [Hz] and why it is taken; None if the scene or the user gives it."""

    rate: float
    why: str | None


@single_threaded()
def choose_rate(point: OperatingPoint, tables: Mapping[str, Pairs] | None = None) -> Rate:
    """Choose a sampling rate whose band holds the modes that are excited and the first harmonics of all meshes.

    Parameters
    ----------
    point
        The model at its loaded equilibrium.
    tables
        The model's tables over time, by name.
    """
    modes, mesh = _fastest_mode(point), mesh_frequency(point, tables)
    wanted = max(ROOM * modes, HARMONICS * mesh) / BAND
    power = ceil(log2(max(wanted, 1.0)) - 1e-6)  # a rounding does not double a rate
    rate = float(min(max(2**power, LEAST), MOST))
    told = f"modes reach {modes:.4g} Hz, mesh frequencies {mesh:.4g} Hz"
    return Rate(rate, told if wanted <= rate * 1.001 else f"{told}, which no rate up to {MOST} Hz holds")


def find_rate(
    library: Library, values: Mapping[str, float], tables: Mapping[str, Pairs] | None, rate: float | None
) -> Rate:
    """Return the sampling rate of a scene: the one that it gives, or the one that is chosen.

    Parameters
    ----------
    library, values, tables
        Model, parameter name -> value in SI, the model's tables over time by name.
    rate
        What the scene gives [Hz].

    Raises
    ------
    SolverError
        If there is no equilibrium to choose by.
    """
    if rate is not None:
        return Rate(rate, None)
    p = library.parameters(values)
    return choose_rate(OperatingPoint(library, p, find_equilibrium(library, p, tables=tables)), tables)


def _fastest_mode(point: OperatingPoint) -> float:
    """Return the highest frequency [Hz] of the excited modes, of all oscillating modes if none is; 0 without any."""
    values, amplitude = excited_modes(point)[:2]
    most = float(amplitude.max(initial=0.0))
    swings = (np.abs(values.imag) > np.abs(values.real)) & (amplitude >= (FAINT * most if most > STILL else 0.0))
    return float(np.abs(values.imag[swings]).max(initial=0.0)) / (2 * pi)


def mesh_frequency(point: OperatingPoint, tables: Mapping[str, Pairs] | None = None) -> float:
    """Return the highest mesh frequency [Hz] at the speeds that are given; 0 where nothing turns.

    Parameters are those of ``choose_rate``.
    """
    advance = [abs(float(course.advance)) for course in Clocks(point.library.manifest, point.p).by_mesh.values()]
    return reference_speed(point, tables) * max(advance, default=0.0) / (2 * pi)
