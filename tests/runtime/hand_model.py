"""A whole scene by hand, in the paper's inertial coordinates: forces of `reference.hand_forces`, Newton's laws.

Bodies, topology and numbers are read from the Scene's own tables. Angles, radii and speed ratios are
extended precision (80 bits on x86): inertial angles of thousands of radians must still give deflections
of micrometres to ten digits.
"""

from dataclasses import dataclass, field

import numpy as np
from ltcgear.symbolic.schema import Planetary

from reference import hand_forces as hand

L = np.longdouble
PI = 4 * np.arctan(L(1))
AUTO = {"lsp": 1.0, "hsp": 1.0, "psh": -1.0, "gear": 1.0}
"""The loaded flank of a ring driven counter-clockwise: as printed in both planetary stages, mirrored in the PSH."""


@dataclass
class Motion:
    """Position, angle and their rates of one body in inertial coordinates, shapes (2,) and ()."""

    O: np.ndarray  # noqa: E741
    th: L
    V: np.ndarray
    w: L


@dataclass
class Result:
    """(quantity, item) -> value; body -> force and torque; power that dampers and friction take [W]."""

    outputs: dict = field(default_factory=dict)
    forces: dict = field(default_factory=dict)

    def add(self, body, force=(0.0, 0.0), torque=0.0):
        self.forces[body] = self.forces.get(body, np.zeros(3, L)) + np.array([*force, torque], L)


def rotation(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def turned(v):
    """A vector turned by +90 degrees."""
    return np.array([-v[1], v[0]])


def on_disc(member):
    """Mass and inertia of a member."""
    if member.disc is None:
        return getattr(member, "mass", None), member.inertia
    R, r = member.disc.outer_diameter / 2, member.disc.inner_diameter / 2
    m = member.disc.density * np.pi * (R**2 - r**2) * member.disc.width
    return m, m * (R**2 + r**2) / 2


class HandMesh:
    """One mesh of a stage in numbers."""

    def __init__(self, stage_name, stage, kind, mesh, one, two, effects):
        self.kind, self.mesh, self.sigma = kind, mesh, hand.SIGMA[kind]
        alpha = 0.0 if stage.module is None else np.arctan(np.tan(stage.pressure_angle) / np.cos(stage.helix_angle))
        m_t = 0.0 if stage.module is None else stage.module / np.cos(stage.helix_angle)
        unit = L(m_t / 2 * np.cos(alpha))
        self.r1, self.r2 = (L(g.base_radius) if g.base_radius else g.teeth * unit for g in (one, two))
        self.teeth = one.teeth
        self.d0 = centre_distance(stage)
        if mesh.stiffness is not None:
            self.k1 = mesh.stiffness
        else:
            self.k1 = mesh.torsional_stiffness / float(getattr(stage, mesh.reference).teeth * unit) ** 2
        self.share = 1.0
        if mesh.double_factor is not None:
            self.share = 2.0 - contact_ratio(stage, self.sigma, one, two, self.d0)
        self.k2 = self.k1 * (mesh.double_factor or 1.0)
        self.mean = self.share * self.k1 + (1 - self.share) * self.k2
        self.switched = mesh.double_factor is not None and effects["mesh_stiffness"] == "two-level"
        self.flank = {"auto": AUTO[stage_name], "printed": 1.0, "opposite": -1.0}[mesh.flank]

    def stiffness(self, level):
        return self.k1 + level * (self.k2 - self.k1) if self.switched else self.mean

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


class HandModel:
    """Forces and accelerations of a scene by hand.

    ``lead`` is the member whose angle is the reference angle phi (None at rest).
    """

    def __init__(self, scene, lead):
        self.scene, self.lead, self.effects = scene, lead, scene.effects
        self.driven = {load.member for load in scene.loads.values() if load.speed is not None}
        self.ratios = speed_ratios(scene, lead)
        self.members, self.frame, self.place, self.direction = {}, {}, {}, {}
        for name, rotor in scene.rotors.items():
            self._member(name, rotor, None)
        for name, stage in scene.stages.items():
            self._stage(name, stage)

    def _stage(self, name, stage):
        d = centre_distance(stage)
        if isinstance(stage, Planetary):
            carrier = f"{name}.carrier"
            for part in ("ring", "sun", "carrier"):
                self._member(f"{name}.{part}", getattr(stage, part), carrier)
            for i, angle in enumerate(self.planet_angles(stage), start=1):
                self._member(f"{name}.planet.{i}", stage.planet, carrier, d, angle)
        else:
            self._member(f"{name}.input", stage.input, None)
            self._member(f"{name}.output", stage.output, None, d, stage.line_of_centres)

    def _member(self, name, member, frame, distance=0.0, angle=0.0):
        self.members[name], self.frame[name], self.direction[name] = member, frame, angle
        self.place[name] = distance * np.array([np.cos(angle), np.sin(angle)])

    @staticmethod
    def planet_angles(stage):
        """Directions from the sun to the planets at the start [rad]."""
        equal = [2 * np.pi * i / stage.planets for i in range(stage.planets)]
        return [stage.line_of_centres + angle for angle in stage.planet_angles or equal]

    def ratio(self, name):
        """A body's speed over the lead's; equal planets share one."""
        return self.ratios.get(name.rsplit(".", 1)[0] if ".planet." in name else name, L(0))

    def frame_ratio(self, name):
        """The speed of the frame a body's deviations are described in, over the lead's."""
        return self.ratio(self.frame[name]) if self.frame[name] else L(0)

    def inertia(self, name):
        """Moment of inertia, None where the angle is held."""
        member = self.members[name]
        held = name in self.driven or getattr(member, "support", "") == "fixed"
        return None if held else on_disc(member)[1]

    # --- from deviations in turning frames to inertial coordinates and back

    def motions(self, states, x):
        """Every body's inertial motion from the generated model's state vector (names ``states``)."""
        value = {name: L(v) for name, v in zip(states, x, strict=True)}
        self.phi = value.get("reference.angle", L(0))
        self.speed = value.get("reference.speed", L(self._held_speed()))
        motions = {}
        for name in self.members:
            dx, dy, u = (value.get(f"{name}.{axis}", L(0)) for axis in ("x", "y", "u"))
            vx, vy, w = (value.get(f"{name}.{axis}.rate", L(0)) for axis in ("x", "y", "u"))
            R = rotation(self.frame_ratio(name) * self.phi)
            r = self.place[name] + np.array([dx, dy])
            V = np.array([vx, vy]) + self.frame_ratio(name) * self.speed * turned(r)
            motions[name] = Motion(
                R @ r, self.ratio(name) * self.phi + u, R @ V, self.ratio(name) * self.speed + w
            )  # fmt: skip
        return motions

    def _held_speed(self):
        return next((load.speed for load in self.scene.loads.values() if load.speed is not None), 0.0)

    def accelerations(self, states, x, xdot):
        """Inertial accelerations (body, axis) -> m/s^2 or rad/s^2 from the generated right-hand side."""
        value, rate = ({n: L(v) for n, v in zip(states, a, strict=True)} for a in (x, xdot))
        phi, w0 = value.get("reference.angle", L(0)), value.get("reference.speed", L(self._held_speed()))
        a0 = rate.get("reference.speed", L(0))
        result = {}
        for name in self.members:
            if f"{name}.x" in value:
                result |= self._lateral(name, value, rate, phi, w0, a0)
            if f"{name}.u" in value:
                result[name, "u"] = self.ratio(name) * a0 + rate[f"{name}.u.rate"]
            elif name == self.lead and name not in self.driven:
                result[name, "u"] = a0
        return result

    def _lateral(self, name, value, rate, phi, w0, a0):
        """R (a + 2 w z x v + w' z x r - w^2 r)."""
        r = self.place[name] + np.array([value[f"{name}.x"], value[f"{name}.y"]])
        v = np.array([value[f"{name}.x.rate"], value[f"{name}.y.rate"]])
        a = np.array([rate[f"{name}.x.rate"], rate[f"{name}.y.rate"]])
        w, wd = self.frame_ratio(name) * w0, self.frame_ratio(name) * a0
        ax, ay = rotation(self.frame_ratio(name) * phi) @ (a + 2 * w * turned(v) + wd * turned(r) - w**2 * r)
        return {(name, "x"): ax, (name, "y"): ay}

    # --- forces

    def evaluate(self, motions, levels):
        """All forces; ``levels`` maps switched meshes to levels in 0..1."""
        out = Result()
        for name, stage in self.scene.stages.items():
            self._stage_forces(name, stage, motions, levels, out)
        for name, coupling in self.scene.couplings.items():
            self._coupling(name, coupling, motions, out)
        for name, member in self.members.items():
            self._housing(name, member, motions[name], out)
        for load in self.scene.loads.values():
            if load.torque is not None:
                out.add(load.member, torque=load.torque)
        return out

    def newton(self, forces):
        """Force over mass, torque over inertia."""
        result = {}
        for name, member in self.members.items():
            mass, inertia = on_disc(member)
            f = forces.get(name, np.zeros(3, L))
            if getattr(member, "support", "rigid") in ("bearing", "floating"):
                result |= {(name, "x"): f[0] / mass, (name, "y"): f[1] / mass}
            if self.inertia(name):
                result[name, "u"] = f[2] / inertia
        return result

    def _stage_forces(self, name, stage, motions, levels, out):
        if not isinstance(stage, Planetary):
            self._mesh(name, "mesh", "", stage, "external", ("input", "output"), motions, levels, out)
            return
        for i in range(1, stage.planets + 1):
            pair = (f"planet.{i}", f".{i}")
            self._mesh(name, "sun_planet", pair[1], stage, "external", ("sun", pair[0]), motions, levels, out)
            self._mesh(name, "ring_planet", pair[1], stage, "internal", ("ring", pair[0]), motions, levels, out)
            self._pin(name, stage, i, motions, out)

    def _mesh(self, name, label, number, stage, kind, bodies, motions, levels, out):
        mesh, item = getattr(stage, label), f"{name}.{label}{number}"
        gears = [getattr(stage, body.split(".")[0]) for body in bodies]
        m = HandMesh(name, stage, kind, mesh, *gears, self.effects)
        one, two = (f"{name}.{body}" for body in bodies)
        a, b = motions[one], motions[two]
        turn = self.frame_ratio(two) * self.phi
        gamma0 = self.direction[two]
        c = m.damping(self.inertia(one), self.inertia(two)) if self.effects["mesh_damping"] == "on" else 0.0
        k = m.stiffness(levels.get(item, 0.0))
        law = self.effects["mesh_law"]
        r = hand.mesh(
            kind, law, m.flank, m.r1, m.r2, m.d0, gamma0, turn, k, c, a.O, a.th, a.V, a.w, b.O, b.th, b.V, b.w
        )
        _, _, _, alpha = hand.line_of_centres(kind, m.r1, m.r2, a.O, b.O)
        out.outputs |= {
            ("mesh_force", item): r["force"],
            ("mesh_deflection", item): r["deflection"],
            ("pressure_angle", item): alpha,
        }
        if m.teeth:
            Dg = hand.direction_change(a.O, b.O, gamma0, turn)
            start = next((x for item in self.scene.loads.values() if (x := item.speed or item.initial_speed)), 1.0)
            sense = -1 if (self.ratio(one) - self.frame_ratio(two)) * start < 0 else 1
            out.outputs["mesh_phase", item] = sense * m.teeth / (2 * PI) * (a.th - gamma0 - Dg) + mesh.phase
        out.add(one, r["F1"], r["T1"])
        out.add(two, r["F2"], r["T2"])
        if self.effects["mesh_friction"] == "pitch-point" and mesh.friction is not None:
            self._mesh_friction(item, m, mesh.friction, k * r["deflection"], (one, two), (a, b), out)

    @staticmethod
    def _mesh_friction(item, m, given, N, bodies, motions, out):
        a, b = motions
        mu, c_t, v0 = given.coefficient, given.damping or 0.0, given.speed
        f = hand.pitch_point_friction(m.kind, m.flank, m.r1, m.r2, N, mu, c_t, v0, a.O, a.V, a.w, b.O, b.V, b.w)
        out.outputs["mesh_friction", item] = -(mu * abs(N) * np.tanh(f["v_t"] / v0) + c_t * f["v_t"])
        out.add(bodies[0], f["F1"], f["T1"])
        out.add(bodies[1], f["F2"], f["T2"])

    def _pin(self, name, stage, i, motions, out):
        planet, carrier, item = f"{name}.planet.{i}", f"{name}.carrier", f"{name}.pin.{i}"
        P, C, pin = motions[planet], motions[carrier], stage.pin
        c, rho0 = self._damping(pin, on_disc(stage.planet)[0]), self.place[planet]
        f = hand.pin(pin.stiffness, c, rho0, C.O, C.th, C.V, C.w, P.O, P.V)
        out.outputs |= {("pin_force_x", item): f["FP"][0], ("pin_force_y", item): f["FP"][1]}
        out.add(planet, f["FP"])
        out.add(carrier, f["FC"], f["TC"])
        if self.effects["bearing_friction"] == "on" and (pin.friction or pin.friction_damping):
            still = np.zeros(2)
            spring = hand.pin(pin.stiffness, 0.0, rho0, C.O, C.th, still, L(0), P.O, still)["FP"]
            load = np.sqrt(spring @ spring + pin.friction_load**2)
            TP, TC = hand.pin_friction(
                pin.friction, pin.diameter or 0.0, pin.friction_damping or 0.0, pin.friction_speed, load, C.w, P.w
            )
            out.outputs["pin_friction_torque", item] = TP
            out.add(planet, torque=TP)
            out.add(carrier, torque=TC)

    def _damping(self, spring, inertia):
        """Given, or 2 zeta sqrt(k m)."""
        if self.effects["damping"] == "off":
            return 0.0
        if spring.damping is None and spring.damping_ratio is not None:
            return 2 * spring.damping_ratio * np.sqrt(spring.stiffness * inertia)
        return spring.damping or 0.0

    def _coupling(self, name, coupling, motions, out):
        one, two = coupling.between
        parts = [1 / i for i in map(self.inertia, (one, two)) if i]
        c = self._damping(coupling, 1 / sum(parts))
        a, b = motions[one], motions[two]
        T1, T2 = hand.coupling(coupling.stiffness, c, a.th, a.w, b.th, b.w)
        out.outputs["coupling_torque", name] = T2
        out.add(one, torque=T1)
        out.add(two, torque=T2)

    def _housing(self, name, member, motion, out):
        """Bearing, torsional support, drag and weight."""
        lateral = getattr(member, "support", "rigid") in ("bearing", "floating")
        mass, inertia = on_disc(member)
        if getattr(member, "bearing", None) is not None:
            c = self._damping(member.bearing, mass)
            F = hand.ground_bearing(member.bearing.stiffness, c, motion.O - self.place[name], motion.V)
            out.outputs |= {("bearing_force_x", name): F[0], ("bearing_force_y", name): F[1]}
            out.add(name, F)
        if member.torsional_support is not None:
            T = hand.support(
                member.torsional_support.stiffness,
                self._damping(member.torsional_support, inertia),
                motion.th,
                motion.w,
            )
            out.outputs["support_torque", name] = T
            out.add(name, torque=T)
        if member.drag is not None:
            out.add(name, torque=-member.drag * motion.w)
        if lateral and self.effects["gravity"] == "on":
            out.add(name, mass * np.array(self.scene.gravity))
