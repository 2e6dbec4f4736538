"""The stiffness of a mesh in single and in double contact: given, of a torsional measurement, or computed."""

from functools import lru_cache

from . import gears, tooth_stiffness
from .schema import Gear, Mesh, Pair, Planetary
from .tooth_stiffness import Tooth


def levels(stage: Planetary | Pair, mesh: Mesh, one: Gear, two: Gear, sigma: int) -> tuple[float, float | None]:
    """Return the stiffness [N/m] of single contact and of double contact.

    A torsional stiffness K on a reference gear gives k = K / r_b^2. From a face width both follow by the
    potential-energy method for spur gears, each the mean over its part of a pitch. ``double_factor``
    (the paper's xi) comes before a computed second level; without either the stiffness is constant and
    the second value None.
    """
    if mesh.face_width is not None:
        single, double = _computed(
            _tooth(stage, one, sigma < 0), _tooth(stage, two, False), mesh.face_width, gears.stage_distance(stage)
        )
        return single, double if mesh.double_factor is None else single * mesh.double_factor
    single = mesh.stiffness or 0.0
    if mesh.torsional_stiffness is not None and mesh.reference is not None:
        single = mesh.torsional_stiffness / gears.base_radius(stage, getattr(stage, mesh.reference)) ** 2
    return single, None if mesh.double_factor is None else single * mesh.double_factor


def _tooth(stage: Planetary | Pair, gear: Gear, internal: bool) -> Tooth:
    """Return a gear's teeth."""
    module, alpha = gears.transverse(stage)
    return Tooth(gear.teeth or 0, module, alpha, gear.profile_shift, internal=internal)


@lru_cache(maxsize=64)
def _computed(one: Tooth, two: Tooth, width: float, distance: float) -> tuple[float, float]:
    """Return the mean stiffness [N/m] of single and of double contact."""
    phase, k = tooth_stiffness.mesh_stiffness(one, two, width, distance)
    single = phase < 2.0 - tooth_stiffness.path_of_contact(one, two, distance).contact_ratio
    return float(k[single].mean()), float(k[~single].mean())
