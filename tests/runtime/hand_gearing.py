"""Numbers of a train by hand: inertias, speed ratios, and everything about a mesh that its bodies do not decide."""

import numpy as np
from ltcgear.symbolic.schema.scene_schema import Planetary

from reference import hand_forces as hand
from reference import hand_profiles as profiles

L = np.longdouble
PI = 4 * np.arctan(L(1))
AUTO = {"lsp": 1.0, "hsp": 1.0, "psh": -1.0, "gear": 1.0}
"""The loaded flank of a ring driven counter-clockwise: as printed in both planetary stages, mirrored in the PSH."""


def on_disc(member):
    """Mass and inertia of a member."""
    if member.disc is None:
        return getattr(member, "mass", None), member.inertia
    R, r = member.disc.outer_diameter / 2, member.disc.inner_diameter / 2
    m = member.disc.density * np.pi * (R**2 - r**2) * member.disc.width
    return m, m * (R**2 + r**2) / 2


class HandMesh:
    """One mesh of a stage in numbers; ``planet`` tells whose (0 for a pair)."""

    def __init__(self, stage_name, stage, kind, mesh, one, two, effects, planet=0):
        self.kind, self.mesh, self.sigma, self.effects = kind, mesh, hand.SIGMA[kind], effects
        alpha = 0.0 if stage.module is None else np.arctan(np.tan(stage.pressure_angle) / np.cos(stage.helix_angle))
        m_t = 0.0 if stage.module is None else stage.module / np.cos(stage.helix_angle)
        unit = L(m_t / 2 * np.cos(alpha))
        self.r1, self.r2 = (L(g.base_radius) if g.base_radius else g.teeth * unit for g in (one, two))
        self.teeth = one.teeth
        self.d0 = centre_distance(stage)
        if mesh.stiffness is not None:
            self.k1 = mesh.stiffness
        elif mesh.torsional_stiffness is not None:
            self.k1 = mesh.torsional_stiffness / float(getattr(stage, mesh.reference).teeth * unit) ** 2
        else:
            self.k1 = profiles.polygon_terms(mesh.stiffness_table, 0)[0]
        self.single = self.share = 1.0
        if mesh.double_factor is not None or mesh.tooth_errors:
            ratio = mesh.contact_ratio or contact_ratio(stage, self.sigma, one, two, self.d0)
            self.single = 2.0 - ratio
        if mesh.double_factor is not None:
            self.share = self.single
        self.k2 = self.k1 * (mesh.double_factor or 1.0)
        self.mean = self.share * self.k1 + (1 - self.share) * self.k2
        self.switched = mesh.double_factor is not None and effects["mesh_stiffness"] == "two-level"
        self.terms = self._terms(effects["mesh_stiffness"])
        self.mean = self.terms[0] if self.terms else self.mean
        self.flank = {"auto": AUTO[stage_name], "printed": 1.0, "opposite": -1.0}[mesh.flank]
        self.wrong = self._wrong_teeth(stage, planet)
        self.error_terms = self._error_terms() if effects["transmission_error"] == "on" else None

    def _terms(self, law):
        """The Fourier series of the stiffness, where it has one."""
        if law == "fourier" and self.mesh.double_factor is not None:
            return profiles.square_terms(self.k1, self.k2, self.share, self.mesh.harmonics)
        if law == "table" and self.mesh.stiffness_table is not None:
            return profiles.polygon_terms(self.mesh.stiffness_table, self.mesh.harmonics)
        return None

    def _wrong_teeth(self, stage, planet):
        """(error, tooth, teeth of its gear) of each tooth out of place."""
        if self.effects["tooth_errors"] == "off":
            return []
        listed = [t for t in self.mesh.tooth_errors if t.planet in (None, planet)]
        return [(t.error, t.tooth, getattr(stage, t.gear).teeth) for t in listed]

    def _error_terms(self):
        """The Fourier series of the transmission error: A cos(2 pi n tau + f), or that of a table."""
        given = self.mesh.transmission_error
        if given is None or given.table is not None:
            return given and profiles.polygon_terms(given.table, self.mesh.harmonics)
        a, f = np.array(given.amplitudes), np.array(given.phases or [0.0] * len(given.amplitudes))
        return 0.0, a * np.cos(f), -a * np.sin(f)

    @property
    def varying(self):
        """Whether the stiffness follows the phase smoothly."""
        smooth = self.mesh.double_factor is not None and self.effects["mesh_stiffness"] == "smooth"
        return smooth or self.terms is not None

    def stiffness(self, level, tau=0.0):
        """Stiffness [N/m] at a level (where it is switched) or phase."""
        if self.switched:
            return self.k1 + level * (self.k2 - self.k1)
        return self.profile(tau)[0] if self.varying else self.mean

    def profile(self, tau):
        """Stiffness [N/m] at a phase and its slope over the phase."""
        if self.terms is not None:
            return profiles.wave(tau, *self.terms)
        width = min(self.mesh.transition or 0.1, self.share, 1 - self.share)  # no wider than the shorter contact
        return profiles.smooth_levels(tau, self.k1, self.k2, self.share, width)

    def error(self, tau):
        """Transmission error e [m] at a phase and its slope: harmonics or table, and teeth out of place."""
        e = np.zeros(2, L)
        if self.error_terms is not None:
            e += profiles.wave(tau, *self.error_terms)
        for size, tooth, teeth in self.wrong:
            e += size * np.array(profiles.tooth_window(tau, tooth, teeth, self.single))
        return e

    def damping(self, I1, I2):
        """2 zeta sqrt(k m) on the equivalent mass along the line of action; None is an infinite inertia."""
        if self.mesh.damping is not None or self.mesh.damping_ratio is None:
            return self.mesh.damping or 0.0
        mobility = (float(self.r1) ** 2 / I1 if I1 else 0.0) + (float(self.r2) ** 2 / I2 if I2 else 0.0)
        return 2 * self.mesh.damping_ratio * np.sqrt(self.mean / mobility)


def centre_distance(stage):
    """Given, or that of unshifted teeth [m]."""
    if stage.center_distance is not None:
        return stage.center_distance
    gears = (stage.sun, stage.planet) if isinstance(stage, Planetary) else (stage.input, stage.output)
    assert all(g.profile_shift == 0 for g in gears)
    return sum(g.teeth for g in gears) * stage.module / np.cos(stage.helix_angle) / 2


def contact_ratio(stage, sigma, one, two, distance):
    """Transverse contact ratio, ISO 21771: the line of action between the tip circles over the base pitch."""
    m_t = stage.module / np.cos(stage.helix_angle)
    alpha = np.arctan(np.tan(stage.pressure_angle) / np.cos(stage.helix_angle))
    r1, r2 = (g.teeth * m_t / 2 * np.cos(alpha) for g in (one, two))
    # An internal gear's teeth point inwards; its shift moves them outwards.
    tip1 = one.teeth * m_t / 2 + stage.module * (sigma + one.profile_shift)
    tip2 = two.teeth * m_t / 2 + stage.module * (1 + two.profile_shift)
    working = np.arccos((r1 + sigma * r2) / distance)
    path = sigma * np.sqrt(tip1**2 - r1**2) + np.sqrt(tip2**2 - r2**2) - sigma * distance * np.sin(working)
    return path / (np.pi * m_t * np.cos(alpha))


def speed_ratios(scene, lead):
    """Every member's speed over the lead's, by Willis' equation walked through the train."""
    known = {lead: L(1)} if lead else {}
    for name, stage in scene.stages.items():
        parts = ("sun", "ring", "carrier") if isinstance(stage, Planetary) else ()
        known |= {f"{name}.{part}": L(0) for part in parts if getattr(stage, part).support == "fixed"}
    for _ in range(len(scene.stages) + len(scene.couplings)):
        for coupling in scene.couplings.values():
            one, two = coupling.between
            for a, b in ((one, two), (two, one)):
                if a in known:
                    known.setdefault(b, known[a])
        for name, stage in scene.stages.items():
            (_planetary_ratios if isinstance(stage, Planetary) else _pair_ratios)(name, stage, known)
    return known


def _pair_ratios(name, stage, known):
    one, two = f"{name}.input", f"{name}.output"
    if one in known:
        known.setdefault(two, -known[one] * stage.input.teeth / stage.output.teeth)


def _planetary_ratios(name, stage, known):
    """z_S (w_S - w_C) = -z_R (w_R - w_C) = -z_P (w_P - w_C)."""
    s, r, c = (f"{name}.{part}" for part in ("sun", "ring", "carrier"))
    if stage.sun.teeth is None or sum(part in known for part in (s, r, c)) < 2:
        return
    zs, zr, zp = L(stage.sun.teeth), L(stage.ring.teeth), L(stage.planet.teeth)
    if c not in known:
        known[c] = (zs * known[s] + zr * known[r]) / (zs + zr)
    elif s not in known:
        known[s] = known[c] - zr / zs * (known[r] - known[c])
    elif r not in known:
        known[r] = known[c] - zs / zr * (known[s] - known[c])
    known[f"{name}.planet"] = known[c] - zs / zp * (known[s] - known[c])
