"""One planetary stage by PyDy: Kane's method in SymPy, C by its code generator, called from Python.

Run as ``python -m benchmarks.peers.pydy_stage`` it derives, generates, compiles, checks and times, and prints JSON, so
that a caller can stop it when it takes too long. Absolute coordinates of every body, forces as loads on points and
frames; the driven ring's angle and speed are specified.
"""

import json
from time import perf_counter
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray
from sympy.physics import mechanics as me

from .floor import python_time
from .rig import Rig, disagreement
from .stage import PLANETS, open_stage

Vector = NDArray[np.float64]
NUMBERS = {
    "m_R": "lsp.ring.mass", "m_S": "lsp.sun.mass", "I_S": "lsp.sun.inertia", "m_P": "lsp.planet.mass",
    "I_P": "lsp.planet.inertia", "k_R": "lsp.ring.bearing.stiffness", "c_R": "lsp.ring.bearing.damping",
    "k_P": "lsp.pin.stiffness", "c_P": "lsp.pin.damping", "T": "loads.sun.torque",
    "r_S": "lsp.sun_planet.base_radius_1", "r_P": "lsp.sun_planet.base_radius_2",
    "r_R": "lsp.ring_planet.base_radius_1", "s_S": "lsp.sun_planet.flank", "s_R": "lsp.ring_planet.flank",
    "i_S": "lsp.sun_planet.inv_alpha_0", "i_R": "lsp.ring_planet.inv_alpha_0",
    "k_SP": "lsp.sun_planet.stiffness", "c_SP": "lsp.sun_planet.damping",
    "k_RP": "lsp.ring_planet.stiffness", "c_RP": "lsp.ring_planet.damping",
    **{f"{a}_{i}": f"lsp.planet.{i}.{a}_0" for i in range(1, PLANETS + 1) for a in "xy"},
}  # fmt: skip
"""Our names of PyDy's constants."""
C = {name: sp.Symbol(name) for name in NUMBERS}


class Gear:
    """A body that shifts and turns: point, frame, coordinates, speeds."""

    def __init__(self, ground: me.ReferenceFrame, origin: me.Point, name: str, turning: tuple[Any, Any] | None) -> None:
        self.place, self.rate = (me.dynamicsymbols(f"{a}x_{name} {a}y_{name}") for a in "qu")
        self.point = origin.locatenew(name, self.place[0] * ground.x + self.place[1] * ground.y)
        self.point.set_vel(ground, self.rate[0] * ground.x + self.rate[1] * ground.y)
        self.q, self.u = list(self.place), list(self.rate)
        self.given = turning is not None
        self.angle, self.speed = turning or me.dynamicsymbols(f"qt_{name} ut_{name}")
        self.frame = ground.orientnew(name, "Axis", (self.angle, ground.z))
        self.frame.set_ang_vel(ground, self.speed * ground.z)
        if not self.given:
            self.q, self.u = [*self.q, self.angle], [*self.u, self.speed]

    def body(self, mass: Any, inertia: Any) -> Any:  # noqa: ANN401
        """Return it as a body of SymPy; a driven one only shifts."""
        if self.given:
            return me.Particle(self.frame.name, self.point, mass)
        dyad = me.inertia(self.frame, 0, 0, inertia)
        return me.RigidBody(self.frame.name, self.point, self.frame, mass, (dyad, self.point))


def mesh(n: me.ReferenceFrame, one: Gear, two: Gear, sigma: int, key: str, number: int) -> list[tuple[Any, Any]]:
    """Write the loads of a mesh (involute law of docs/method.md) on two gears."""
    r1, r2, s = C[f"r_{key}"], C["r_P"], C[f"s_{key}"]
    c, (dx, dy) = r1 + sigma * r2, (two.place[i] - one.place[i] for i in (0, 1))
    ex, ey = C[f"x_{number}"], C[f"y_{number}"]
    d2 = dx**2 + dy**2
    h, turned = sp.sqrt(d2 - c**2), sp.atan2(ex * dy - ey * dx, ex * dx + ey * dy)
    w = r1 * (one.angle - turned) + sigma * r2 * (two.angle - turned)
    delta = s * w - sigma * c * (h / c - sp.atan(h / c) - C[f"i_{key}"])
    nx, ny = (sigma * h * dx - s * c * dy) / d2, (sigma * h * dy + s * c * dx) / d2
    slip = nx * (two.rate[0] - one.rate[0]) + ny * (two.rate[1] - one.rate[1])
    rate = s * (r1 * one.speed + sigma * r2 * two.speed) - slip
    force = C[f"k_{key}P"] * delta + C[f"c_{key}P"] * rate
    push = force * (nx * n.x + ny * n.y)
    loads = [(one.point, -push), (two.point, push), (two.frame, -sigma * s * r2 * force * n.z)]
    return loads if one.given else [*loads, (one.frame, -s * r1 * force * n.z)]


def held(n: me.ReferenceFrame, gear: Gear, key: str, number: int = 0) -> tuple[Any, Any]:
    """Write the load of a bearing or a pin on a gear."""
    force = [C[f"k_{key}"] * q + C[f"c_{key}"] * u for q, u in zip(gear.place, gear.rate, strict=True)]
    if number:
        force = [f - C[f"k_{key}"] * C[f"{a}_{number}"] for f, a in zip(force, "xy", strict=True)]
    return gear.point, -force[0] * n.x - force[1] * n.y


def derive() -> tuple[me.KanesMethod, list[Any]]:
    """Derive the equations of motion by Kane's method; also return what is specified."""
    n, origin = me.ReferenceFrame("N"), me.Point("O")
    origin.set_vel(n, 0)
    given = me.dynamicsymbols("theta_R omega_R")
    ring, sun = Gear(n, origin, "R", tuple(given)), Gear(n, origin, "S", None)
    planets = [Gear(n, origin, f"P{i}", None) for i in range(1, PLANETS + 1)]
    loads = [held(n, ring, "R"), (sun.frame, C["T"] * n.z)]
    for i, planet in enumerate(planets, start=1):
        loads += [held(n, planet, "P", i), *mesh(n, sun, planet, 1, "S", i), *mesh(n, ring, planet, -1, "R", i)]
    gears = [ring, sun, *planets]
    bodies = [ring.body(C["m_R"], None), sun.body(C["m_S"], C["I_S"])]
    bodies += [planet.body(C["m_P"], C["I_P"]) for planet in planets]
    q, u = ([x for gear in gears for x in getattr(gear, name)] for name in "qu")
    kinematic = [ud - qd.diff(me.dynamicsymbols._t) for qd, ud in zip(q, u, strict=True)]
    kane = me.KanesMethod(n, q, u, kinematic)
    kane.kanes_equations(bodies, loads)
    return kane, list(given)


def generate(kane: me.KanesMethod, given: list[Any]) -> Any:  # noqa: ANN401
    """Generate and compile PyDy's right-hand side, C behind Cython."""
    from pydy.codegen.ode_function_generators import generate_ode_function

    return generate_ode_function(
        kane.forcing, list(kane.q), list(kane.u), list(C.values()), mass_matrix=kane.mass_matrix,
        coordinate_derivatives=sp.Matrix(list(kane.u)), specifieds=given, generator="cython",
    )  # fmt: skip


class PydyRate:
    """PyDy's right-hand side in our coordinates."""

    def __init__(self, rig: Rig, function: Any) -> None:  # noqa: ANN401
        v, names = rig.values, [state.name for state in rig.library.manifest.states]
        self.function, half = function, len(names) // 2 + 1
        self.constants = np.array([v[name] for name in NUMBERS.values()])
        self.speed = v["reference.speed"]
        # Ours begin with the reference angle, which PyDy is given; deviations come before their rates.
        self.place, self.ratio = np.zeros(half - 1), np.zeros(half - 1)
        for i, name in enumerate(names[1:half]):
            body, axis = name.rsplit(".", 1)
            self.place[i] = v.get(f"{body}.{axis}_0", 0.0)
            self.ratio[i] = v[f"{body.rstrip('.1234')}.speed_ratio"] if axis == "u" else 0.0

    def state(self, x: Vector) -> tuple[Vector, Vector]:
        """Return PyDy's state and what is specified."""
        q, u = np.split(x[1:], 2)
        turned, turning = self.ratio * x[0], self.ratio * self.speed
        return np.concatenate([q + self.place + turned, u + turning]), np.array([x[0], self.speed])

    def __call__(self, x: Vector, levels: Vector) -> Vector:
        """Return our x'."""
        state, given = self.state(x)
        rates = self.function(state, 0.0, given, self.constants)
        moved = rates[: len(self.ratio)] - self.ratio * self.speed
        return np.concatenate([[self.speed], moved, rates[len(self.ratio) :]])


def main() -> None:
    """Derive, generate, check, time, print."""
    clock = perf_counter()
    kane, given = derive()
    derived = perf_counter()
    function = generate(kane, given)
    generated = perf_counter()
    stage = open_stage()
    rate = PydyRate(stage, function)
    state, forced = rate.state(stage.at.x)
    call = python_time(lambda: function(state, 0.0, forced, rate.constants))
    found = {
        "derive": derived - clock, "generate_and_compile": generated - derived,
        "disagreement": disagreement(stage, rate), "call": call,
    }  # fmt: skip
    print(json.dumps(found))


if __name__ == "__main__":
    main()
