"""Mesh stiffness in single and double contact: given, from a torsional measurement, or computed."""

from collections.abc import Sequence
from functools import lru_cache
from math import cos, pi, sin

import numpy as np
from numpy.typing import NDArray

from ..schema.mesh_schema import Mesh
from ..schema.scene_schema import Gear, Pair, Planetary
from ..schema.series import Pairs
from . import gear_geometry, tooth_stiffness
from .tooth_stiffness import Tooth

SAMPLES = 2000  # of a computed curve over a pitch


def levels(stage: Planetary | Pair, mesh: Mesh, one: Gear, two: Gear, sigma: int) -> tuple[float, float | None]:
    """Return the stiffness [N/m] of single contact and of double contact.

    A torsional stiffness K on a reference gear gives k = K / r_b^2. From a face width both are computed by the
    potential-energy method for spur gears, each the mean over its part of a pitch. ``double_factor`` (the paper's xi)
    takes precedence over a computed second level. Without either, or with a given contact ratio of 1 or 2, the
    stiffness is constant and the second value None. A mesh with only a table has its mean.
    """
    if mesh.stiffness_table is not None and not (mesh.stiffness or mesh.torsional_stiffness or mesh.face_width):
        return table_series(mesh.stiffness_table, 0)[0], None
    if mesh.face_width is not None:
        single, double = _computed(
            _tooth(stage, one, sigma < 0),
            _tooth(stage, two, False),
            mesh.face_width,
            gear_geometry.stage_distance(stage),
        )
        return single, double if mesh.double_factor is None else single * mesh.double_factor
    single = mesh.stiffness or 0.0
    if mesh.torsional_stiffness is not None and mesh.reference is not None:
        single = mesh.torsional_stiffness / gear_geometry.base_radius(stage, getattr(stage, mesh.reference)) ** 2
    if mesh.double_factor is None or mesh.contact_ratio == 1.0:
        return single, None
    double = single * mesh.double_factor
    return (double, None) if mesh.contact_ratio == 2.0 else (single, double)


def is_computed(mesh: Mesh) -> bool:
    """Tell whether a mesh's stiffness is computed over the whole pitch."""
    return mesh.face_width is not None and mesh.double_factor is None


def arcs(
    stage: Planetary | Pair, mesh: Mesh, one: Gear, two: Gear, sigma: int, *, backwards: bool = False
) -> list[float]:
    """Return the computed stiffness as a parabola over single and one over double contact [N/m], least squares.

    Each is c_0 + c_1 y + c_2 y^2 with y [pitches] from the middle of its contact. ``backwards`` means that the contact
    moves away from the tip of gear 1, which is then driven.
    """
    phase, k = _curve(stage, mesh, one, two, sigma, backwards)
    share = gear_geometry.single_share(stage, mesh, one, two, sigma)
    found: list[float] = []
    for part, middle in ((phase < share, share / 2), (phase >= share, (1 + share) / 2)):
        found += np.polynomial.polynomial.polyfit(phase[part] - middle, k[part], 2).tolist()
    return found


def two_level_series(single: float, double: float, share: float, count: int) -> list[float]:
    """Return mean and amplitudes a_1, b_1, a_2, ... of eq 9's two levels, their Fourier integrals in closed form."""
    step, found = double - single, [single * share + double * (1 - share)]
    for n in range(1, count + 1):
        found += [-step * sin(2 * pi * n * share) / (pi * n), step * (cos(2 * pi * n * share) - 1) / (pi * n)]
    return found


def computed_series(
    stage: Planetary | Pair, mesh: Mesh, one: Gear, two: Gear, sigma: int, *, backwards: bool = False
) -> list[float]:
    """Return mean and amplitudes of the computed stiffness [N/m]."""
    return fourier_series(*_curve(stage, mesh, one, two, sigma, backwards), mesh.harmonics)


def table_series(table: Pairs, count: int) -> list[float]:
    """Return mean and amplitudes of the periodic linear interpolant of a table over one tooth pitch."""
    phase = (np.arange(SAMPLES) + 0.5) / SAMPLES
    places, values = np.array(table).T
    return fourier_series(phase, np.interp(phase, places, values, period=1.0), count)


def fourier_series(phase: NDArray[np.float64], values: NDArray[np.float64], count: int) -> list[float]:
    """Return mean and amplitudes a_1, b_1, a_2, ... of values at phases that divide a pitch evenly."""
    found = [float(values.mean())]
    for n in range(1, count + 1):
        found += [2 * float(np.mean(values * wave(2 * pi * n * phase))) for wave in (np.cos, np.sin)]
    return found


def series_values(series: Sequence[float], phase: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the values of a series at phases [pitches]."""
    total = np.full_like(phase, series[0])
    for n, (a, b) in enumerate(zip(series[1::2], series[2::2], strict=True), start=1):
        total += a * np.cos(2 * pi * n * phase) + b * np.sin(2 * pi * n * phase)
    return total


@lru_cache(maxsize=256)
def least_value(series: tuple[float, ...]) -> float:
    """Return the least value of a series over the pitch; cached, since variants of a scene share most series."""
    return float(series_values(series, np.linspace(0.0, 1.0, 2000)).min())


def lawful_counts(series: Sequence[float]) -> list[int]:
    """Return the numbers of harmonics, from 1 to all, with which the series stays positive."""
    return [n for n in range(1, len(series) // 2 + 1) if least_value(tuple(series[: 1 + 2 * n])) > 0]


def _curve(
    stage: Planetary | Pair, mesh: Mesh, one: Gear, two: Gear, sigma: int, backwards: bool
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return phases [pitches] that divide a pitch evenly, and the stiffness computed there [N/m]."""
    teeth = _tooth(stage, one, sigma < 0), _tooth(stage, two, False)
    phase, k = _computed_curve(*teeth, mesh.face_width or 0.0, gear_geometry.stage_distance(stage))
    return ((gear_geometry.single_share(stage, mesh, one, two, sigma) - phase) % 1.0, k) if backwards else (phase, k)


def _tooth(stage: Planetary | Pair, gear: Gear, internal: bool) -> Tooth:
    """Return a gear's teeth."""
    module, alpha = gear_geometry.transverse(stage)
    return Tooth(gear.teeth or 0, module, alpha, gear.profile_shift, internal=internal)


@lru_cache(maxsize=64)
def _computed_curve(
    one: Tooth, two: Tooth, width: float, distance: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return phases and stiffness of a pair."""
    return tooth_stiffness.mesh_stiffness(one, two, width, distance, samples=SAMPLES)


def _computed(one: Tooth, two: Tooth, width: float, distance: float) -> tuple[float, float]:
    """Return the mean stiffness [N/m] of single and of double contact."""
    phase, k = _computed_curve(one, two, width, distance)
    single = phase < 2.0 - tooth_stiffness.path_of_contact(one, two, distance).contact_ratio
    return float(k[single].mean()), float(k[~single].mean())
