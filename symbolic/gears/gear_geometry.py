"""Gear geometry: base radii, centre distances, contact ratios of involute gears (transverse plane).

Sources: DIN 3960 / ISO 21771 for radii, working pressure angle and contact ratio.
"""

from dataclasses import dataclass
from math import acos, atan, cos, pi, sin, sqrt, tan

from ..schema.mesh_schema import Mesh
from ..schema.scene_schema import Gear, Pair, Planetary, Stage


def involute(alpha: float) -> float:
    """Return inv(alpha) = tan(alpha) - alpha [rad]."""
    return tan(alpha) - alpha


def inverse_involute(value: float) -> float:
    """Solve inv(alpha) = value for 0 < alpha < pi/2.

    Both starts lie above the root and inv is convex, so Newton's method comes down without overshoot.

    Raises
    ------
    ValueError
        If ``value`` is not positive.
    """
    if not value > 0:
        raise ValueError(f"inv(alpha) = {value:.4g} has no working pressure angle")
    alpha: float = min((3 * value) ** (1 / 3), atan(value + pi / 2))
    for _ in range(50):
        step = (involute(alpha) - value) / tan(alpha) ** 2
        alpha = alpha - step
        if abs(step) < 1e-15:
            break
    return alpha


def transverse(stage: Stage) -> tuple[float, float]:
    """Return transverse module [m] and transverse pressure angle [rad]."""
    assert stage.module is not None  # validate() has refused a stage without tooth system
    assert stage.pressure_angle is not None
    beta = stage.helix_angle
    return stage.module / cos(beta), atan(tan(stage.pressure_angle) / cos(beta))


def base_radius(stage: Stage, gear: Gear) -> float:
    """Return r_b [m]: given, or z m_t cos(alpha_t) / 2."""
    if gear.base_radius is not None:
        return gear.base_radius
    module, alpha = transverse(stage)
    assert gear.teeth is not None
    return gear.teeth * module / 2 * cos(alpha)


def working_involute(stage: Stage, one: Gear, two: Gear, sigma: int) -> float:
    """Return inv of the working pressure angle without backlash for the profile shifts."""
    assert one.teeth is not None
    assert two.teeth is not None
    _, alpha = transverse(stage)
    shifts = one.profile_shift + sigma * two.profile_shift
    # x is in normal modules: x_t m_t = x m_n, so the same formula holds with tan(alpha_n).
    return involute(alpha) + 2 * shifts / (one.teeth + sigma * two.teeth) * tan(stage.pressure_angle or alpha)


def standard_centre_distance(stage: Stage, one: Gear, two: Gear, sigma: int) -> float:
    """Return the centre distance [m] without backlash for the profile shifts."""
    assert one.teeth is not None
    assert two.teeth is not None
    module, alpha = transverse(stage)
    working = inverse_involute(working_involute(stage, one, two, sigma))
    return (one.teeth + sigma * two.teeth) * module / 2 * cos(alpha) / cos(working)


def contact_ratio(stage: Stage, one: Gear, two: Gear, sigma: int, distance: float) -> float:
    """Return the transverse contact ratio of full-depth teeth (addendum one normal module)."""
    module, alpha = transverse(stage)
    working = acos((base_radius(stage, one) + sigma * base_radius(stage, two)) / distance)
    outer = _flank_length(stage, two, 1)
    inner = _flank_length(stage, one, sigma)
    path = outer + sigma * inner - sigma * distance * sin(working)
    return path / (pi * module * cos(alpha))


def single_share(stage: Planetary | Pair, mesh: Mesh, one: Gear, two: Gear, sigma: int) -> float:
    """Return the share of a tooth pitch in single contact, 2 - contact ratio (eq 9)."""
    return 2.0 - (mesh.contact_ratio or contact_ratio(stage, one, two, sigma, stage_distance(stage)))


def path_of_contact(stage: Planetary | Pair, one: Gear, two: Gear, sigma: int) -> tuple[float, float]:
    """Return start and end of the path of contact of full-depth teeth [m].

    They are measured from the pitch point along the force on gear 2: from the tip circle of gear 2, at
    r_2 tan(alpha) - L_2, to that of gear 1, at sigma (L_1 - r_1 tan(alpha)).
    """
    at = mesh_geometry(stage, one, two, sigma)
    own, other = _flank_length(stage, one, sigma), _flank_length(stage, two, 1)
    return at.r2 * tan(at.alpha) - other, sigma * (own - at.r1 * tan(at.alpha))


def backlash(stage: Stage, mesh: Mesh, one: Gear, two: Gear) -> float:
    """Return the gap along the line of action [m]: given, plus that of thinner teeth, s_n cos(alpha_t) / cos(beta)."""
    thinning = one.tooth_thinning + two.tooth_thinning
    if not thinning:
        return mesh.backlash
    return mesh.backlash + thinning / cos(stage.helix_angle) * cos(transverse(stage)[1])


def interference(stage: Stage, one: Gear, two: Gear, sigma: int, distance: float) -> bool:
    """Tell whether full-depth tips extend beyond the end of the line of action, where involutes cannot touch."""
    line = distance * sin(acos((base_radius(stage, one) + sigma * base_radius(stage, two)) / distance))
    if sigma < 0:
        return _flank_length(stage, one, -1) < line
    return max(_flank_length(stage, one, 1), _flank_length(stage, two, 1)) > line


def _flank_length(stage: Stage, gear: Gear, sign: int) -> float:
    """Return the length [m] from the base circle's tangent point to the tip circle."""
    module, _ = transverse(stage)
    assert gear.teeth is not None
    assert stage.module is not None
    tip = gear.teeth * module / 2 + sign * stage.module * (1 + sign * gear.profile_shift)
    return sqrt(max(tip**2 - base_radius(stage, gear) ** 2, 0.0))


@dataclass(frozen=True)
class MeshGeometry:
    """Geometry of one mesh: base radii, centre distance [m], pressure angle [rad], sign of the pair."""

    sigma: int
    r1: float
    r2: float
    distance: float
    alpha: float


def stage_distance(stage: Planetary | Pair) -> float:
    """Return the stage's centre distance [m]: given, or from teeth and profile shifts."""
    if stage.center_distance is not None:
        return stage.center_distance
    if isinstance(stage, Pair):
        return standard_centre_distance(stage, stage.input, stage.output, 1)
    return standard_centre_distance(stage, stage.sun, stage.planet, 1)


def mesh_geometry(stage: Planetary | Pair, one: Gear, two: Gear, sigma: int) -> MeshGeometry:
    """Return the geometry of the mesh of two gears of a stage."""
    r1, r2, distance = base_radius(stage, one), base_radius(stage, two), stage_distance(stage)
    return MeshGeometry(sigma, r1, r2, distance, acos((r1 + sigma * r2) / distance))
