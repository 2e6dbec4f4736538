"""A whole scene by hand, in the paper's inertial coordinates: forces of `reference.hand_forces`, Newton's laws.

Bodies, topology and numbers are read from the Scene's own tables. Angles, radii and speed ratios are
extended precision (80 bits on x86): inertial angles of thousands of radians must still give deflections
of micrometres to ten digits.
"""

from dataclasses import dataclass, field

import numpy as np
from ltcgear.symbolic.schema.scene_schema import Planetary

from reference import hand_forces as hand

from .hand_gearing import PI, HandMesh, L, centre_distance, on_disc, speed_ratios


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


class HandModel:
    """Forces and accelerations of a scene by hand.

    ``lead`` is the member whose angle is the reference angle phi (None at rest).
    """

    def __init__(self, scene, lead):
        self.scene, self.lead, self.effects = scene, lead, scene.effects
        self.driven = {load.member for load in scene.loads.values() if load.speed is not None}
        self.ratios = speed_ratios(scene, lead)
        self.members, self.frame, self.place, self.direction = {}, {}, {}, {}
        self.pin, self.eccentric, self.meshes = {}, {}, {}
        for name, rotor in scene.rotors.items():
            self._member(name, rotor, None)
        for name, stage in scene.stages.items():
            self._stage(name, stage)
        self.leader = self._leaders()
        self.held = {self.leader[n] for n, m in self.members.items() if n in self.driven or self.fixed(m)}

    def _stage(self, name, stage):
        d = centre_distance(stage)
        if isinstance(stage, Planetary):
            carrier = f"{name}.carrier"
            for part in ("ring", "sun", "carrier"):
                self._member(f"{name}.{part}", getattr(stage, part), carrier)
            for i, angle in enumerate(self.planet_angles(stage), start=1):
                self._member(f"{name}.planet.{i}", stage.planet, carrier, d, angle)
                self._wrong_planet(f"{name}.planet.{i}", stage, i, angle)
        else:
            self._member(f"{name}.input", stage.input, None)
            self._member(f"{name}.output", stage.output, None, d, stage.line_of_centres)

    def _member(self, name, member, frame, distance=0.0, angle=0.0):
        self.members[name], self.frame[name], self.direction[name] = member, frame, angle
        self.place[name] = self.pin[name] = distance * np.array([np.cos(angle), np.sin(angle)])
        self.eccentric[name] = getattr(member, "eccentricity", None)

    def _wrong_planet(self, planet, stage, number, angle):
        """A planet's pin out of place, outwards and counter-clockwise, and its eccentric teeth."""
        for error in stage.position_errors:
            if error.planet == number and self.effects["planet_position_error"] == "on":
                self.pin[planet] = self.place[planet] + rotation(angle) @ [error.radial, error.tangential]
        for error in stage.eccentricities:
            if error.planet == number:
                self.eccentric[planet] = error

    def _leaders(self):
        """Member -> the first of those that turn with it as one, by rigid shafts."""
        group = {name: [name] for name in self.members}
        if self.effects["torsional_shafts"] == "rigid":
            for coupling in self.scene.couplings.values():
                one, two = (group[end] for end in coupling.between)
                if one is not two:
                    one += two
                    group |= dict.fromkeys(two, one)
        order = list(self.members)
        return {name: min(group[name], key=order.index) for name in order}

    @staticmethod
    def fixed(member):
        return getattr(member, "support", "") == "fixed"

    @staticmethod
    def planet_angles(stage):
        """Directions from the sun to the planets at the start [rad]."""
        equal = [2 * np.pi * i / stage.planets for i in range(stage.planets)]
        return [stage.line_of_centres + angle for angle in stage.planet_angles or equal]

    def seated(self, name):
        """Whether it is a planet that its carrier takes along."""
        return ".planet." in name and (self.effects["pins"] == "rigid" or self.effects["lateral"] == "off")

    def lateral(self, name):
        """Whether a body moves sideways by itself."""
        free = getattr(self.members[name], "support", "rigid") in ("bearing", "floating")
        return free and self.effects["lateral"] == "on" and not self.seated(name)

    def ratio(self, name):
        """A body's speed over the lead's; equal planets share one."""
        return self.ratios.get(name.rsplit(".", 1)[0] if ".planet." in name else name, L(0))

    def frame_ratio(self, name):
        """The speed of the frame a body's deviations are described in, over the lead's."""
        return self.ratio(self.frame[name]) if self.frame[name] else L(0)

    def inertia(self, name):
        """Moment of inertia, None where the angle is held."""
        return None if self.leader[name] in self.held else on_disc(self.members[name])[1]

    # --- from deviations in turning frames to inertial coordinates and back

    def motions(self, states, x):
        """Every body's inertial motion from the generated model's state vector (names ``states``)."""
        value = {name: L(v) for name, v in zip(states, x, strict=True)}
        self.phi = value.get("reference.angle", L(0))
        self.speed = value.get("reference.speed", L(self._held_speed()))
        twist = {self.leader[n]: (value[f"{n}.u"], value[f"{n}.u.rate"]) for n in self.members if f"{n}.u" in value}
        motions = {}
        for name in self.members:
            (dx, dy), (vx, vy) = ([value.get(f"{name}.{a}{r}", L(0)) for a in "xy"] for r in ("", ".rate"))
            u, w = twist.get(self.leader[name], (L(0), L(0)))
            R = rotation(self.frame_ratio(name) * self.phi)
            r = self.place[name] + np.array([dx, dy])
            V = np.array([vx, vy]) + self.frame_ratio(name) * self.speed * turned(r)
            motions[name] = Motion(R @ r, self.ratio(name) * self.phi + u, R @ V, self.ratio(name) * self.speed + w)
        for name in filter(self.seated, self.members):
            self._seat(motions[name], motions[self.frame[name]], self.pin[name])
        return motions

    @staticmethod
    def _seat(planet, carrier, place):
        """Put a planet on its carrier's pin."""
        arm = rotation(carrier.th) @ place
        planet.O, planet.V = carrier.O + arm, carrier.V + carrier.w * turned(arm)

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
                result[self.leader[name], "u"] = self.ratio(name) * a0 + rate[f"{name}.u.rate"]
            elif name == self.lead and self.leader[name] not in self.held:
                result[self.leader[name], "u"] = a0
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
        if self.effects["torsional_shafts"] == "flexible":
            for name, coupling in self.scene.couplings.items():
                self._coupling(name, coupling, motions, out)
        for name, member in self.members.items():
            self._housing(name, member, motions[name], out)
        for load in self.scene.loads.values():
            if load.torque is not None:
                out.add(load.member, torque=load.torque)
        return out

    def _stage_forces(self, name, stage, motions, levels, out):
        if not isinstance(stage, Planetary):
            self._mesh(name, "mesh", "", stage, "external", ("input", "output"), motions, levels, out)
            return
        for i in range(1, stage.planets + 1):
            pair = (f"planet.{i}", f".{i}")
            self._mesh(name, "sun_planet", pair[1], stage, "external", ("sun", pair[0]), motions, levels, out)
            self._mesh(name, "ring_planet", pair[1], stage, "internal", ("ring", pair[0]), motions, levels, out)
            if not self.seated(f"{name}.{pair[0]}"):
                self._pin(name, stage, i, motions, out)

    def _teeth(self, name, motion):
        """Motion of the centre of a gear's teeth, and its arm from the axis."""
        given = self.eccentric[name]
        if given is None or self.effects["eccentricity"] == "off":
            return motion, np.zeros(2, L)
        O, V, arm = hand.offset_point(motion.O, motion.th, motion.V, motion.w, given.radius, given.angle)  # noqa: E741
        return Motion(O, motion.th, V, motion.w), arm

    def _mesh(self, name, label, number, stage, kind, bodies, motions, levels, out):
        mesh, item = getattr(stage, label), f"{name}.{label}{number}"
        if item not in self.meshes:
            gears = [getattr(stage, body.split(".")[0]) for body in bodies]
            self.meshes[item] = HandMesh(name, stage, kind, mesh, *gears, self.effects, int(number[1:] or 0))
        m = self.meshes[item]
        one, two = (f"{name}.{body}" for body in bodies)
        (a, arm1), (b, arm2) = (self._teeth(n, motions[n]) for n in (one, two))
        nominal, rate, actual, sense = self._phases(m, one, two, a, b)
        c = m.damping(self.inertia(one), self.inertia(two)) if self.effects["mesh_damping"] == "on" else 0.0
        by_gear = m.varying and self.effects["stiffness_torque"] == "on"
        followed = actual if by_gear else nominal
        if m.teeth:
            out.outputs |= {("mesh_phase", item): followed, ("gear_phase", item): actual}
        k = m.stiffness(levels.get(item, 0.0), followed)
        slope = L(0)
        if by_gear:
            slope = m.profile(actual)[1] * sense * m.teeth / (2 * PI)
        e = m.error(nominal) * np.array([1, rate])
        self._flank(item, m, m.flank, (one, two), (a, b), (arm1, arm2), out, k=k, c=c, slope=slope, error=e)
        flanks = [(item, m.flank)]
        if self.effects["contact"] == "backlash":
            back = {"k": k, "c": c, "slope": slope, "error": -e, "gap": mesh.backlash}
            self._flank(f"{item}.back", m, -m.flank, (one, two), (a, b), (arm1, arm2), out, **back)
            flanks.append((f"{item}.back", -m.flank))
        if self.effects["mesh_friction"] == "pitch-point" and mesh.friction is not None:
            k = m.stiffness(levels.get(item, 0.0), nominal)
            for flank in flanks:
                self._mesh_friction(*flank, m, mesh.friction, k, (one, two), (a, b), (arm1, arm2), out)

    def _phases(self, m, one, two, a, b):
        """Mesh phase of the rigid motion and its rate, that of the actual one, and the sense of both."""
        if not m.teeth:
            return L(0), L(0), L(0), 1
        start = next((x for item in self.scene.loads.values() if (x := item.speed or item.initial_speed)), 1.0)
        ratio, gamma0 = self.ratio(one) - self.frame_ratio(two), self.direction[two]
        sense = -1 if ratio * start < 0 else 1
        per_angle = sense * m.teeth / (2 * PI)
        Dg = hand.direction_change(a.O, b.O, gamma0, self.frame_ratio(two) * self.phi)
        first = f"{two.rsplit('.', 1)[0]}.1" if ".planet." in two else two
        ahead = gamma0 - self.direction[first]  # phases count from planet 1, wherever it stands
        nominal = m.mesh.phase + per_angle * (ratio * self.phi - ahead)
        return nominal, per_angle * ratio * self.speed, m.mesh.phase + per_angle * (a.th - ahead - Dg), sense

    def _flank(self, item, m, s, names, teeth, arms, out, **laws):
        """Normal force of one flank."""
        (one, two), (a, b) = names, teeth
        place = {"gamma0": self.direction[two], "turn": self.frame_ratio(two) * self.phi}
        moved = {f"{key}{i}": getattr(x, key) for i, x in ((1, a), (2, b)) for key in ("O", "th", "V", "w")}
        pushes = self.effects["contact"] != "bilateral"
        r = hand.mesh(
            m.kind, self.effects["mesh_law"], s, m.r1, m.r2, m.d0, **place, **moved, **laws, pushes_only=pushes
        )
        out.outputs |= {("mesh_force", item): r["force"], ("mesh_deflection", item): r["deflection"]}
        if self.effects["lateral"] == "on" or np.any(arms):
            out.outputs["pressure_angle", item] = hand.line_of_centres(m.kind, m.r1, m.r2, a.O, b.O)[3]
        if pushes:
            out.outputs["mesh_contact", item] = float(r["deflection"] > 0)
        out.add(one, r["F1"], r["T1"] + hand.cross(arms[0], r["F1"]))
        out.add(two, r["F2"], r["T2"] + hand.cross(arms[1], r["F2"]))

    def _mesh_friction(self, item, s, m, given, k, bodies, motions, arms, out):
        """Friction of one flank; flanks that have parted do not rub."""
        (a, b), delta = motions, out.outputs["mesh_deflection", item]
        apart = self.effects["contact"] != "bilateral" and delta <= 0
        mu, c_t, v0 = (0.0, 0.0, given.speed) if apart else (given.coefficient, given.damping or 0.0, given.speed)
        f = hand.pitch_point_friction(m.kind, s, m.r1, m.r2, k * delta, mu, c_t, v0, a.O, a.V, a.w, b.O, b.V, b.w)
        out.outputs["mesh_friction", item] = -(mu * abs(k * delta) * np.tanh(f["v_t"] / v0) + c_t * f["v_t"])
        out.add(bodies[0], f["F1"], f["T1"] + hand.cross(arms[0], f["F1"]))
        out.add(bodies[1], f["F2"], f["T2"] + hand.cross(arms[1], f["F2"]))

    def _pin(self, name, stage, i, motions, out):
        planet, carrier, item = f"{name}.planet.{i}", f"{name}.carrier", f"{name}.pin.{i}"
        P, C, pin = motions[planet], motions[carrier], stage.pin
        c, rho0 = self._damping(pin, on_disc(stage.planet)[0]), self.pin[planet]
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
        mass, inertia = on_disc(member)
        lateral = self.effects["lateral"] == "on"
        if getattr(member, "bearing", None) is not None and lateral:
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
        heavy = self.lateral(name) or self.seated(name)
        if heavy and self.effects["gravity"] == "on":
            out.add(name, mass * np.array(self.scene.gravity))
