"""A geared train whose equations are linear between switchings, and its exact solution by matrix exponentials.

Motor at a held speed, coupling, gear pair on rigid shafts, coupling, generator under a torque. Nothing here
moves sideways, so the mesh deflection is s (r1 u1 + r2 u2) whatever the size of the deviations u.
"""

import numpy as np
from scipy.linalg import expm

from .hand_gearing import HandMesh, on_disc

SETTINGS = (
    *(f'stages.psh.{part}.support = "rigid"' for part in ("input", "output")),
    *(f"-stages.psh.{part}.bearing" for part in ("input", "output")),
    'rotors.motor.inertia = "3 kg*m^2"',
    'rotors.generator.inertia = "6 kg*m^2"',
    'couplings.one.between = ["motor", "psh.input"]',
    'couplings.one.stiffness = "6e6 N*m/rad"',
    "couplings.one.damping_ratio = 0.02",
    'couplings.two.between = ["psh.output", "generator"]',
    'couplings.two.stiffness = "4e6 N*m/rad"',
    "couplings.two.damping_ratio = 0.02",
    'loads.input.member = "motor"',
    'loads.output.member = "generator"',
    "stages.psh.mesh.double_factor = 1.5",
)
FREE = ("psh.input.u", "psh.output.u", "generator.u")


class Train:
    """The train of a scene with ``SETTINGS`` by hand; deviations of gear 1, gear 2, generator from rolling."""

    def __init__(self, scene):
        stage, one, two = scene.stages["psh"], scene.couplings["one"], scene.couplings["two"]
        self.mesh = HandMesh("psh", stage, "external", stage.mesh, stage.input, stage.output, scene.effects)
        self.pull = self.mesh.flank * np.array([float(self.mesh.r1), float(self.mesh.r2), 0.0])
        bodies = (stage.input, stage.output, scene.rotors["generator"])
        self.inertia = np.array([on_disc(body)[1] for body in bodies])
        first, second = np.array([1.0, 0, 0]), np.array([0, 1.0, -1.0])
        self.springs = [(first, *self._spring(one, self.inertia[0]))]
        self.springs += [(second, *self._spring(two, 1 / (1 / self.inertia[1:]).sum()))]
        self.c = self.mesh.damping(*self.inertia[:2])
        self.torque = np.array([0, 0, scene.loads["output"].torque])
        self.rate = stage.input.teeth * scene.loads["input"].speed / (2 * np.pi)
        self.share = self.mesh.share
        self.solved = {}

    @staticmethod
    def _spring(coupling, inertia):
        return coupling.stiffness, 2 * coupling.damping_ratio * np.sqrt(coupling.stiffness * inertia)

    def stiffness(self, k):
        return sum((s * np.outer(d, d) for d, s, _ in self.springs), k * np.outer(self.pull, self.pull))

    def equilibrium(self):
        """Deviations at rest under the mean mesh stiffness."""
        return np.linalg.solve(self.stiffness(self.mesh.mean), self.torque)

    def generator(self, k):
        """Matrix G of y' = G y, y = deviations, rates, 1."""
        C = sum((c * np.outer(d, d) for d, _, c in self.springs), self.c * np.outer(self.pull, self.pull))
        G = np.zeros((7, 7))
        G[:3, 3:6] = np.eye(3)
        G[3:6, :3] = -self.stiffness(k) / self.inertia[:, None]
        G[3:6, 3:6] = -C / self.inertia[:, None]
        G[3:6, 6] = self.torque / self.inertia
        return G

    def switchings(self, end):
        """Instants of switching up to ``end`` and the levels between them, the first from zero on."""
        w = abs(self.rate)
        pitches = np.arange(np.ceil(end * w) + 1)
        # Eq 9: a pitch begins with single contact, whichever way the gears turn.
        times = np.sort(np.concatenate([pitches, pitches + self.share])) / w
        return times, np.arange(len(times)) % 2

    def solve(self, times):
        """Exact deviations and rates, shape (times, 6), from the equilibrium on."""
        key = (len(times), times[-1])
        if key not in self.solved:
            self.solved[key] = self._solve(times)
        return self.solved[key]

    def _solve(self, times):
        starts, levels = self.switchings(times[-1])
        y, out = np.array([*self.equilibrium(), 0, 0, 0, 1.0]), np.empty((len(times), 6))
        for start, end, level in zip(starts, [*starts[1:], np.inf], levels, strict=False):
            G = self.generator(self.mesh.stiffness(float(level)))
            for i in np.flatnonzero((times >= start) & (times < end)):
                out[i] = (expm(G * (times[i] - start)) @ y)[:6]
            if end > times[-1]:
                break
            y = expm(G * (end - start)) @ y
        return out
