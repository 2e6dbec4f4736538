"""Mesh stiffness of a spur involute pair over the mesh phase, by the potential-energy method.

A tooth is a cantilever of varying section. The compliances of bending, shear and axial compression
(Yang & Lin 1987, J. Mech. Trans. Autom. Des. 109:189; Tian 2004, thesis, Univ. of Alberta), of the body under
the tooth (`foundation_compliance`) and of the Hertzian contact (Yang & Sun 1985, J. Mech. Trans.
Autom. Des. 107:529) add up to that of a pair; the pairs in contact act in parallel.

Neglected: root fillets, which stiffen; the coupling of neighbouring teeth through their common body and the bending of
rims, which soften, double contact more than single. Profiles are exact and without relief; the load is uniform over the
width, in plane stress. For common pairs without bores the highest stiffness of one pair comes out 20 to 28 % above c'
of ISO 6336-1, which rests on measurements.
"""

from dataclasses import dataclass
from math import acos, asin, cos, degrees, pi, sqrt, tan

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
NODES = 32  # Gauss points of each integral; 10 agree with them to 3e-6
SHEAR = 1.2  # shear factor of a rectangular section
# Sainsot, Velex & Duverger 2004 (J. Mech. Des. 126:748), Table 1; columns: 1/theta^2, h^2, h/theta, 1/theta, h, 1.
SAINSOT = np.array(
    [
        [-5.574e-5, -1.9986e-3, -2.3015e-4, 4.7702e-3, 0.0271, 6.8045],  # L*
        [60.111e-5, 28.100e-3, -83.431e-4, -9.9256e-3, 0.1624, 0.9086],  # M*
        [-50.952e-5, 185.50e-3, 0.0538e-4, 53.300e-3, 0.2895, 0.9236],  # P*
        [-6.2042e-5, 9.0889e-3, -4.0964e-4, 7.8297e-3, -0.1472, 0.6904],  # Q*
    ]
)
SAINSOT_RANGE = (1.4, 7.0)  # of h, root radius over bore radius
# ISO 6336-1:2006, 9.3.1, q' [mm um/N]; terms: 1, 1/z1, 1/z2, x1, x1/z1, x2, x2/z2, x1^2, x2^2.
ISO_SERIES = (0.04723, 0.15551, 0.25791, -0.00635, -0.11654, -0.00193, -0.24188, 0.00529, 0.00182)
ISO_MODULUS = 2.06e11  # [Pa]


@dataclass(frozen=True)
class Material:
    """Young's modulus [Pa] and Poisson's ratio of both gears."""

    E: float = 2.06e11
    nu: float = 0.3

    @property
    def contact_modulus(self) -> float:
        """Contact stiffness by width, pi E / (4 (1 - nu^2)) [Pa] (Yang & Sun 1985)."""
        return pi * self.E / (4 * (1 - self.nu**2))


@dataclass(frozen=True)
class Tooth:
    """The teeth of a spur gear, transverse section (DIN 3960 / ISO 21771).

    Parameters
    ----------
    teeth
        Number of teeth, positive for rings too.
    module, pressure_angle
        Module [m] and pressure angle [rad] of the basic rack.
    profile_shift
        In modules, positive away from the gear's centre: it thickens external teeth, thins a ring's.
    addendum, dedendum
        Of the basic rack, in modules.
    bore_radius
        Radius [m] where the body of an external gear is held; None for a deep body.
    internal
        True for a ring.

    Raises
    ------
    ValueError
        If these numbers give no valid tooth.
    """

    teeth: int
    module: float
    pressure_angle: float
    profile_shift: float = 0.0
    addendum: float = 1.0
    dedendum: float = 1.25
    bore_radius: float | None = None
    internal: bool = False

    def __post_init__(self) -> None:
        if self.teeth < 3 or not self.module > 0 or not 0 < self.pressure_angle < pi / 4:
            raise ValueError("a gear needs 3 teeth, a positive module, a pressure angle between 0 and 45 deg")
        if not self.root_radius > 0 or self.thickness(self.tip_roll) <= 0:
            raise ValueError(f"a gear of {self.teeth} teeth with this profile shift has no root, or pointed tips")
        if self.internal and self.tip_radius <= self.base_radius:
            raise ValueError("the ring's tips lie inside its base circle; shorten the addendum")
        if self.bore_radius is None:
            return
        if self.internal:
            raise ValueError("a ring has no bore; leave bore_radius out")
        low, high = SAINSOT_RANGE
        if not low <= self.root_radius / self.bore_radius <= high:
            raise ValueError(f"root radius / bore_radius must lie in {low} to {high}; leave bore_radius out otherwise")

    @property
    def sign(self) -> int:
        """1 for a ring, -1 for an external gear."""
        return 1 if self.internal else -1

    @property
    def pitch_radius(self) -> float:
        """Reference radius [m]."""
        return self.module * self.teeth / 2

    @property
    def base_radius(self) -> float:
        """Base radius [m]."""
        return self.pitch_radius * cos(self.pressure_angle)

    @property
    def tip_radius(self) -> float:
        """Tip radius [m]; no tip shortening."""
        return self.pitch_radius + (self.profile_shift - self.sign * self.addendum) * self.module

    @property
    def root_radius(self) -> float:
        """Root radius [m]."""
        return self.pitch_radius + (self.profile_shift + self.sign * self.dedendum) * self.module

    @property
    def tip_roll(self) -> float:
        """Roll angle of the tip [rad], the tangent of its pressure angle."""
        return sqrt(max((self.tip_radius / self.base_radius) ** 2 - 1, 0.0))

    @property
    def root_roll(self) -> float:
        """Roll angle [rad] where the involute ends: at the root, or at the base circle if that is higher."""
        return sqrt(max((self.root_radius / self.base_radius) ** 2 - 1, 0.0))

    @property
    def load_offset(self) -> float:
        """Load angle less roll angle [rad]; its magnitude is half the tooth's angle at the base circle."""
        half = pi / 2 - self.sign * 2 * self.profile_shift * tan(self.pressure_angle)
        return self.sign * half / self.teeth - _involute(self.pressure_angle)

    def thickness(self, roll: float) -> float:
        """Return half the chordal thickness [m] at a roll angle [rad]."""
        return float(_profile(self, np.asarray(roll))[1])

    def root_section(self) -> tuple[float, float]:
        """Return distance from the centre [m] and half thickness [m] of the section at the root circle."""
        half = self.thickness(self.root_roll)
        if half >= self.root_radius:
            raise ValueError(f"the tooth of {self.teeth} teeth is wider than its root circle")
        return sqrt(self.root_radius**2 - half**2), half


def _involute(angle: float) -> float:
    return tan(angle) - angle


def _profile(tooth: Tooth, roll: Array) -> tuple[Array, Array]:
    """Return distance from the centre and half thickness [m] along the tooth's axis, at roll angles [rad]."""
    load = roll + tooth.load_offset
    along = tooth.base_radius * (np.cos(load) + roll * np.sin(load))
    across = tooth.sign * tooth.base_radius * (np.sin(load) - roll * np.cos(load))
    return along, across


def cantilever_compliance(arm: Array, half: Array, weight: Array, load: Array, offset: Array, nu: float) -> Array:
    """Return E b times the compliance of a cantilever of rectangular sections along its load.

    Parameters
    ----------
    arm, half, weight
        Distance from the load [m], half thickness [m] and length [m] of each piece; the last axis is summed.
    load
        Angle [rad] of the load to the normal of the axis; without that last axis.
    offset
        Distance [m] of the load's point from the axis; without that last axis.
    nu
        Poisson's ratio.

    Notes
    -----
    Strain energy of bending (I = 2/3 b half^3), shear (E/G = 2 (1 + nu)) and compression (A = 2 b half).
    """
    normal, axial = np.cos(load)[..., None], np.sin(load)[..., None]
    bending = 1.5 * (normal * arm - axial * offset[..., None]) ** 2 / half**3
    direct = (SHEAR * 2 * (1 + nu) * normal**2 + axial**2) / (2 * half)
    total: Array = np.sum((bending + direct) * weight, axis=-1)
    return total


def foundation_compliance(tooth: Tooth, load: Array, nu: float) -> Array:
    """Return E b times the compliance of the body under the tooth, at load angles [rad].

    Notes
    -----
    cos^2(load) (L (u/s)^2 + M u/s + P (1 + Q tan^2(load))), with u from the root circle to where the
    load's line crosses the tooth's axis and s the root's thickness. With a bore: Sainsot, Velex &
    Duverger 2004, a disc held there, whose twist P contains. Without one, and for rings: the half-plane
    of Weber & Banaschek 1953 in the plane-stress form of Cornell 1981 (J. Mech. Des. 103:447). For a
    ring that means a rim many modules deep that is held evenly; a thin rim bends and is softer.
    """
    _, half = tooth.root_section()
    theta = asin(half / tooth.root_radius)
    ratio = abs(tooth.root_radius - tooth.base_radius / np.cos(load)) / (2 * tooth.root_radius * theta)
    if tooth.bore_radius is None:
        big_l, big_m, big_p, big_q = 5.306, 2 * (1 - nu), 1.534, 1 / (2.4 * (1 + nu))
    else:
        h = tooth.root_radius / tooth.bore_radius
        big_l, big_m, big_p, big_q = SAINSOT @ np.array([theta**-2, h**2, h / theta, 1 / theta, h, 1.0])
    body: Array = np.cos(load) ** 2 * (big_l * ratio**2 + big_m * ratio + big_p * (1 + big_q * np.tan(load) ** 2))
    return body


def tooth_compliance(tooth: Tooth, roll: Array, nu: float = 0.3, nodes: int = NODES) -> Array:
    """Return E b times the compliance of a tooth and its body, loaded at roll angles [rad].

    Below the base circle the tooth keeps its thickness down to the root (Tian 2004).
    """
    load = roll + tooth.load_offset
    tip, offset = _profile(tooth, roll)
    points, weights = np.polynomial.legendre.leggauss(nodes)
    span = ((roll - tooth.root_roll) / 2)[..., None]
    t = tooth.root_roll + span * (1 + points)
    along, half = _profile(tooth, t)
    piece = np.abs(span * weights * tooth.base_radius * t * np.cos(t + tooth.load_offset))
    involute = cantilever_compliance(np.abs(tip[..., None] - along), half, piece, load, offset, nu)
    root, width = tooth.root_section()
    end = float(_profile(tooth, np.asarray(tooth.root_roll))[0])
    stem = root + (end - root) * (1 + points) / 2
    piece = np.abs(weights * (end - root) / 2)
    straight = cantilever_compliance(np.abs(tip[..., None] - stem), np.full_like(stem, width), piece, load, offset, nu)
    total: Array = involute + straight + foundation_compliance(tooth, load, nu)
    return total


@dataclass(frozen=True)
class Path:
    """The path of contact; positions [m] count from the pitch point towards the tip of the first gear."""

    start: float
    end: float
    base_pitch: float
    pressure_angle: float

    @property
    def contact_ratio(self) -> float:
        """Transverse contact ratio."""
        return (self.end - self.start) / self.base_pitch


def working_distance(one: Tooth, two: Tooth) -> float:
    """Return the centre distance [m] without play that the profile shifts call for (DIN 3960).

    Raises
    ------
    ValueError
        If the gears do not fit each other.
    """
    _check(one, two)
    sigma = one.sign * two.sign
    alpha = one.pressure_angle
    if one.teeth + sigma * two.teeth == 0:
        raise ValueError("a ring needs more teeth than the gear inside")
    shifts = (one.profile_shift + sigma * two.profile_shift) / (one.teeth + sigma * two.teeth)
    wanted = _involute(alpha) + 2 * shifts * tan(alpha)
    if not 0 < wanted < 1:
        raise ValueError("no working pressure angle fits these profile shifts")
    working = (3 * wanted) ** (1 / 3)
    for _ in range(30):
        working -= (_involute(working) - wanted) / tan(working) ** 2
    return abs(one.base_radius + sigma * two.base_radius) / cos(working)


def path_of_contact(one: Tooth, two: Tooth, center_distance: float) -> Path:
    """Return the path of contact at a centre distance [m]; one of the gears may be a ring.

    Raises
    ------
    ValueError
        If the gears do not fit, do not always touch, or touch beyond the involute.
    """
    _check(one, two)
    cosine = abs(one.base_radius + one.sign * two.sign * two.base_radius) / center_distance
    if not 0 < cosine < 1:
        raise ValueError(f"center_distance = {center_distance:.6g} m leaves no working pressure angle")
    alpha = acos(cosine)
    end = -one.sign * one.base_radius * (one.tip_roll - tan(alpha))
    start = two.sign * two.base_radius * (two.tip_roll - tan(alpha))
    path = Path(start, end, pi * one.module * cos(one.pressure_angle), alpha)
    if path.contact_ratio < 1:
        raise ValueError(f"the contact ratio {path.contact_ratio:.3f} is below 1")
    for tooth, roll in zip((one, two), _rolls(one, two, path, np.array([start, end])), strict=True):
        if np.min(roll) < 0 or (tooth.root_roll > np.min(roll) and not tooth.internal):
            raise ValueError(f"the mate's tips touch the gear of {tooth.teeth} teeth below its involute")
    return path


def _check(one: Tooth, two: Tooth) -> None:
    """Refuse gears of different tooth systems, and two rings."""
    if not np.allclose([one.module, one.pressure_angle], [two.module, two.pressure_angle], rtol=1e-9, atol=0):
        raise ValueError("the gears differ in module or pressure angle")
    small, large = (one, two) if two.internal else (two, one)
    if small.internal or (large.internal and small.teeth >= large.teeth):
        raise ValueError("a ring meshes with a smaller external gear")


def _rolls(one: Tooth, two: Tooth, path: Path, position: Array) -> tuple[Array, Array]:
    """Return the roll angles [rad] of both gears at positions [m]."""
    pitch = tan(path.pressure_angle)
    return pitch - one.sign * position / one.base_radius, pitch + two.sign * position / two.base_radius


def _pair(one: Tooth, two: Tooth, width: float, path: Path, position: Array, material: Material) -> Array:
    """Return the stiffness [N/m] of one tooth pair at positions [m]."""
    roll, mate = _rolls(one, two, path, position)
    teeth = tooth_compliance(one, roll, material.nu) + tooth_compliance(two, mate, material.nu)
    return width / (teeth / material.E + 1 / material.contact_modulus)


def single_pair_stiffness(
    one: Tooth, two: Tooth, width: float, center_distance: float, position: float, material: Material | None = None
) -> float:
    """Return the stiffness [N/m] of one tooth pair along the line of action.

    Parameters
    ----------
    one, two
        The gears; one of them may be a ring.
    width
        Common face width [m].
    center_distance
        Centre distance [m].
    position
        Place of contact [m] on the line of action, from the pitch point towards the tip of ``one``.
    material
        Of both gears; default steel.

    Raises
    ------
    ValueError
        If the gears do not mesh, or not at this position.
    """
    path = path_of_contact(one, two, center_distance)
    slack = 1e-9 * path.base_pitch
    if not path.start - slack <= position <= path.end + slack:
        raise ValueError(f"position must lie in {path.start:.6g} to {path.end:.6g} m, the path of contact")
    return float(_pair(one, two, width, path, np.asarray(position), material or Material()))


def mesh_stiffness(
    one: Tooth, two: Tooth, width: float, center_distance: float, material: Material | None = None, samples: int = 200
) -> tuple[Array, Array]:
    """Return mesh phases [cycles], the middles of equal parts, and the stiffness [N/m] of all pairs in contact.

    Single contact begins at phase 0 and lasts 2 - contact ratio, as in Wu et al. 2021, eqs 9-11; the
    contact moves towards the tip of ``one``, the driving gear. Parameters as in `single_pair_stiffness`.
    """
    path = path_of_contact(one, two, center_distance)
    phase = (np.arange(samples) + 0.5) / samples
    total = np.zeros(samples)
    for behind in range(1, 1 + int(np.ceil(path.contact_ratio))):
        position = path.end + (phase - behind) * path.base_pitch
        touching = position >= path.start
        total[touching] += _pair(one, two, width, path, position[touching], material or Material())
    return phase, total


def iso_theoretical_stiffness(z1: float, z2: float, x1: float, x2: float) -> float:
    """Return c'_th [N/(mm um)] of virtual tooth numbers and profile shifts, pinion first (ISO 6336-1:2006, 9.3.1)."""
    terms = (1.0, 1 / z1, 1 / z2, x1, x1 / z1, x2, x2 / z2, x1**2, x2**2)
    return 1 / sum(factor * term for factor, term in zip(ISO_SERIES, terms, strict=True))


def iso_6336_stiffness(
    one: Tooth, two: Tooth, width: float, center_distance: float | None = None, material: Material | None = None
) -> tuple[float, float]:
    """Return single stiffness c' and mean mesh stiffness c_gamma_alpha [N/m] by ISO 6336-1:2006, method B.

    For solid discs (C_R = 1) and loads above 100 N/mm; C_M = 0.8. A ring counts as a rack. Without a
    ``center_distance`` [m] the gears mesh without play. Face width in m.
    """
    path = path_of_contact(one, two, center_distance or working_distance(one, two))
    pinion, wheel = sorted((one, two), key=lambda tooth: tooth.teeth)
    z2, x2 = (float("inf"), -wheel.profile_shift) if wheel.internal else (wheel.teeth, wheel.profile_shift)
    dedendum = (pinion.dedendum + wheel.dedendum) / 2
    rack = (1 + 0.5 * (1.2 - dedendum)) * (1 - 0.02 * (20 - degrees(pinion.pressure_angle)))
    modulus = (material or Material()).E / ISO_MODULUS
    theory = iso_theoretical_stiffness(pinion.teeth, z2, pinion.profile_shift, x2)
    single = theory * 0.8 * rack * modulus * width * 1e9
    return single, single * (0.75 * path.contact_ratio + 0.25)
