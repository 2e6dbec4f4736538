"""The rig's right-hand side in NumPy, as an engineer would write it: all meshes at once, and all bodies at once.

The laws of docs/method.md in deviations from the rigid motion. Meshes, pins, bearings and couplings are rows of arrays;
forces are handed to the bodies by constant matrices of 1 and -1. What does not change is worked out once.
"""

import numpy as np
from numpy.typing import NDArray

from .floor import BODIES, COUPLINGS
from .rig import Rig

Vector = NDArray[np.float64]
HOUSING = len(BODIES)
"""The body that does not move, after the others."""
SHAFT, GENERATOR = HOUSING + 1, HOUSING + 2
LSP = [(gear, f"lsp.planet.{i}", f"lsp.{mesh}") for i in range(1, 5) for gear, mesh in
       (("lsp.sun", "sun_planet"), ("lsp.ring", "ring_planet"))]  # fmt: skip
HSP_SUN = [("hsp.sun", f"hsp.planet.{i}", "hsp.sun_planet") for i in range(1, 4)]
HSP_RING = [("housing", f"hsp.planet.{i}", "hsp.ring_planet") for i in range(1, 4)]
PAIR = [("psh.input", "psh.output", "psh.mesh")]
MESHES = LSP + HSP_SUN + PAIR + HSP_RING
"""Gear 1, gear 2 and law of every mesh: those of two levels first, in the order of the levels."""
BEARINGS = ("lsp.ring", "hsp.sun", "psh.input", "psh.output")
ENDS = (("housing", "lsp.ring"), ("lsp.sun", "hsp.carrier"), ("hsp.sun", "psh.input"), ("psh.output", "shaft"),
        ("shaft", "generator"))  # fmt: skip
PLACE = {name: i for i, name in enumerate((*BODIES, "housing", "shaft", "generator"))}


def between(one: list[int], two: list[int]) -> Vector:
    """Return the matrix that takes from body 1 and gives to body 2, shape (bodies, pairs)."""
    found = np.zeros((len(PLACE), len(one)))
    found[one, range(len(one))] -= 1.0
    found[two, range(len(two))] += 1.0
    return found


class NumpyRig:
    """The right-hand side x'(x, levels)."""

    def __init__(self, rig: Rig) -> None:
        v, n = rig.values, len(PLACE)
        self.position = np.zeros((3, n))
        self.rate = np.zeros((3, n))
        self.place = np.array([[v.get(f"{name}.{axis}_0", 0.0) for name in PLACE] for axis in "xy"])
        self._lay_meshes(rig)
        self._lay_springs(rig)
        kinds = [name.rstrip(".1234567890") for name in BODIES]
        self.mass = np.array([v[f"{kind}.mass"] for kind in kinds])
        turning = [*kinds, "shaft", "generator"]
        self.inertia = np.array([v[f"{kind}.inertia"] for kind in turning])
        self.turning = np.delete(np.arange(n), HOUSING)
        self.torque, self.speed = v["loads.generator.torque"], v["reference.speed"]
        frame = v["hsp.carrier.speed_ratio"] * self.speed
        self.turn = np.array([frame if name.startswith("hsp") else 0.0 for name in BODIES])
        self.square = self.turn**2

    def _lay_meshes(self, rig: Rig) -> None:
        """Lay the numbers of the meshes in rows."""
        v, laws = rig.values, [law for _, _, law in MESHES]
        self.one, self.two = ([PLACE[mesh[i]] for mesh in MESHES] for i in (0, 1))
        self.r1, self.r2, self.s, inv0, self.damping = (
            np.array([v[f"{law}.{key}"] for law in laws])
            for key in ("base_radius_1", "base_radius_2", "flank", "inv_alpha_0", "damping")
        )
        self.sigma = np.array([-1.0 if "ring" in law else 1.0 for law in laws])
        self.c = self.r1 + self.sigma * self.r2
        self.c2, self.rest = self.c**2, self.sigma * self.c * inv0
        self.k = np.array([v.get(f"{law}.stiffness_single", v.get(f"{law}.stiffness", 0.0)) for law in laws])
        double = np.array([v.get(f"{law}.stiffness_double", k) for law, k in zip(laws, self.k, strict=True)])
        self.switched = len(rig.library.manifest.levels)
        self.single, self.more = self.k[: self.switched].copy(), (double - self.k)[: self.switched]
        self.ex, self.ey = self.place[:, self.two] / np.hypot(*self.place[:, self.two])
        self.pushed = between(self.one, self.two)
        self.turned = np.zeros_like(self.pushed)
        self.turned[self.one, range(len(self.one))] = -self.s * self.r1
        self.turned[self.two, range(len(self.two))] = -self.sigma * self.s * self.r2

    def _lay_springs(self, rig: Rig) -> None:
        """Lay the numbers of pins, bearings and couplings in rows."""
        v = rig.values
        planets = [name for name in BODIES if ".planet." in name]
        stages = [name.split(".")[0] for name in planets]
        self.planet = [PLACE[name] for name in planets]
        self.carrier = [PLACE["housing" if stage == "lsp" else "hsp.carrier"] for stage in stages]
        self.pin_k, self.pin_c = (np.array([v[f"{s}.pin.{key}"] for s in stages]) for key in ("stiffness", "damping"))
        self.pinned = between(self.carrier, self.planet)
        self.bearing = [PLACE[name] for name in BEARINGS]
        self.bearing_k, self.bearing_c = (
            np.array([v[f"{name}.bearing.{key}"] for name in BEARINGS]) for key in ("stiffness", "damping")
        )
        self.coupled = between(*([PLACE[pair[i]] for pair in ENDS] for i in (0, 1)))
        self.coupling_k, self.coupling_c = (
            np.array([v[f"couplings.{name}.{key}"] for name in COUPLINGS]) for key in ("stiffness", "damping")
        )

    def __call__(self, x: Vector, levels: Vector) -> Vector:
        """Return x'."""
        q, v, bodies = self.position, self.rate, len(BODIES)
        q[:, :bodies], v[:, :bodies] = x[3:42].reshape(-1, 3).T, x[44:].reshape(-1, 3).T
        q[2, SHAFT:], v[2, SHAFT:] = x[1:3], x[42:44]
        fx, fy, torque = self._meshes(levels)
        self._pins(fx, fy, torque)
        self._bearings(fx, fy)
        torque -= self.coupled @ (self.coupling_k * (q[2] @ self.coupled) + self.coupling_c * (v[2] @ self.coupled))
        torque[GENERATOR] += self.torque
        rates = np.empty_like(x)
        rates[0], rates[1:42], turn = self.speed, x[42:], self.turn
        turning = torque[self.turning] / self.inertia
        rates[42:44] = turning[bodies:]
        moved = rates[44:].reshape(-1, 3)
        at = q[:2, :bodies] + self.place[:, :bodies]
        moved[:, 0] = fx[:bodies] / self.mass + 2 * turn * v[1, :bodies] + self.square * at[0]
        moved[:, 1] = fy[:bodies] / self.mass - 2 * turn * v[0, :bodies] + self.square * at[1]
        moved[:, 2] = turning[:bodies]
        return rates

    def _meshes(self, levels: Vector) -> tuple[Vector, Vector, Vector]:
        """Return forces and torques of the meshes on all bodies."""
        s, sigma, c = self.s, self.sigma, self.c
        self.k[: self.switched] = self.single + self.more * levels
        place = self.place + self.position[:2]
        dx, dy = place[:, self.two] - place[:, self.one]
        (vx, vy), (a, b) = (self.rate[:2] @ self.pushed), self.position[2, [self.one, self.two]]
        square = dx * dx + dy * dy
        h = np.sqrt(square - self.c2)
        turned = np.arctan2(self.ex * dy - self.ey * dx, self.ex * dx + self.ey * dy)
        w = self.r1 * (a - turned) + sigma * self.r2 * (b - turned)
        delta = s * w - sigma * (h - c * np.arctan(h / c)) + self.rest
        nx, ny = (sigma * h * dx - s * c * dy) / square, (sigma * h * dy + s * c * dx) / square
        approach = -(self.rate[2] @ self.turned) - nx * vx - ny * vy
        force = self.k * delta + self.damping * approach
        return self.pushed @ (force * nx), self.pushed @ (force * ny), self.turned @ force

    def _pins(self, fx: Vector, fy: Vector, torque: Vector) -> None:
        """Add what the pins do."""
        q, v, planet, carrier = self.position, self.rate, self.planet, self.carrier
        px, py = self.place[:, planet]
        cos, sin = np.cos(q[2, carrier]), np.sin(q[2, carrier])
        ax, ay = px * cos - py * sin, px * sin + py * cos
        (ux, uy), (vx, vy), w = q[:2] @ self.pinned, v[:2] @ self.pinned, v[2, carrier]
        rx, ry = px + ux, py + uy
        kx, ky = self.pin_k * (rx - ax), self.pin_k * (ry - ay)
        cx, cy = self.pin_c * (vx + w * ry), self.pin_c * (vy - w * rx)
        fx -= self.pinned @ (kx + cx)
        fy -= self.pinned @ (ky + cy)
        held = ax * ky - ay * kx + rx * cy - ry * cx
        np.add.at(torque, carrier, held)

    def _bearings(self, fx: Vector, fy: Vector) -> None:
        """Add what the bearings in the housing do, seen from the frames."""
        at, q, v, turn = self.bearing, self.position, self.rate, self.turn[self.bearing]
        fx[at] -= self.bearing_k * q[0, at] + self.bearing_c * (v[0, at] - turn * q[1, at])
        fy[at] -= self.bearing_k * q[1, at] + self.bearing_c * (v[1, at] + turn * q[0, at])
