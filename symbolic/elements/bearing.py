"""Bearings: of a planet on its carrier (pin), and of a member in the housing."""

from collections.abc import Mapping

import sympy as sp

from .axes import THETA, X, Y
from .base import Element, LogCosh, Output, Port, element_type, load_on, positive, real

CARRIER, PLANET = Port.numbered(1), Port.numbered(2)
K, C = positive("k"), positive("c")
X0, Y0 = real("x_0"), real("y_0")
MU, DB, CR, OMEGA0, EPS = (positive(n) for n in ("mu", "d_b", "c_r", "omega_0", "F_0"))


def pin_place() -> tuple[sp.Expr, sp.Expr]:
    """Return the arm from the carrier's centre to the pin's nominal position [m], rotated with the carrier."""
    cos, sin = sp.cos(CARRIER.theta), sp.sin(CARRIER.theta)
    return X0 * cos - Y0 * sin, X0 * sin + Y0 * cos


def pin_deflection() -> tuple[sp.Expr, sp.Expr]:
    """Return the planet's displacement from its pin, eq 29 (whose y row prints a cosine for the sine)."""
    ax, ay = pin_place()
    return PLANET.x - CARRIER.x - ax, PLANET.y - CARRIER.y - ay


def pin_speed() -> tuple[sp.Expr, sp.Expr]:
    """Return the planet's velocity relative to the rotating carrier."""
    rx, ry = PLANET.x - CARRIER.x, PLANET.y - CARRIER.y
    return PLANET.vx - CARRIER.vx + CARRIER.omega * ry, PLANET.vy - CARRIER.vy - CARRIER.omega * rx


@element_type
def pin(damped: bool) -> Element:
    """Write the planet bearing, eqs 29-30; its damper acts on the motion relative to the rotating carrier."""
    ux, uy = pin_deflection()
    ax, ay = pin_place()
    rx, ry = PLANET.x - CARRIER.x, PLANET.y - CARRIER.y
    vx, vy = pin_speed()
    c = C if damped else sp.S.Zero
    fx, fy = K * ux + c * vx, K * uy + c * vy
    torque = ax * K * uy - ay * K * ux + c * (rx * vy - ry * vx)
    return Element(
        title="planet bearing",
        joins="pin",
        ports=(CARRIER, PLANET),
        parameters={K: "N/m"} | ({C: "N*s/m"} if damped else {}) | {X0: "m", Y0: "m"},
        potential=K * (ux**2 + uy**2) / 2,
        dissipation=c * (vx**2 + vy**2) / 2,
        wrench=load_on(CARRIER, fx, fy, torque) | load_on(PLANET, -fx, -fy),
        outputs={"force_x": Output(-fx, "N", "pin_force_x", X), "force_y": Output(-fy, "N", "pin_force_y", Y)},
        source="Wu et al. 2021 eqs 29-30",
    )


@element_type
def pin_friction() -> Element:
    """Write the friction torque of the planet bearing, eq 30 with the sign of the speed corrected to be dissipative."""
    return rubbing_pin("planet bearing friction", K, {K: "N/m", X0: "m", Y0: "m"})


def rubbing_pin(title: str, k: sp.Expr, parameters: Mapping[sp.Symbol, str]) -> Element:
    """Write the friction torque of a planet bearing whose force is k times its displacement."""
    ux, uy = pin_deflection()
    load = sp.sqrt((k * ux) ** 2 + (k * uy) ** 2 + EPS**2)
    speed = PLANET.omega - CARRIER.omega
    torque = -(MU * load * DB / 2 * sp.tanh(speed / OMEGA0) + CR * speed)
    return Element(
        title=title,
        joins="pin",
        ports=(CARRIER, PLANET),
        parameters={**parameters, MU: "", DB: "m", CR: "N*m*s/rad", OMEGA0: "rad/s", EPS: "N"},
        dissipation=MU * load * DB / 2 * OMEGA0 * LogCosh(speed / OMEGA0) + CR * speed**2 / 2,
        wrench={(CARRIER, THETA): -torque, (PLANET, THETA): torque},
        outputs={"friction_torque": Output(torque, "N*m", "pin_friction_torque")},
        rates="absolute",
        source="Wu et al. 2021 eq 30, sign made dissipative and the load's root kept off zero by F_0",
    )


@element_type
def ground_bearing(damped: bool) -> Element:
    """Write the isotropic bearing of a member in the housing, the k_B terms of eqs 31-34."""
    body = Port.numbered(1)
    ux, uy = body.x - X0, body.y - Y0
    c = C if damped else sp.S.Zero
    fx, fy = -K * ux - c * body.vx, -K * uy - c * body.vy
    return Element(
        title="housing bearing",
        joins="bearing",
        ports=(body,),
        parameters={K: "N/m"} | ({C: "N*s/m"} if damped else {}) | {X0: "m", Y0: "m"},
        potential=K * (ux**2 + uy**2) / 2,
        dissipation=c * (body.vx**2 + body.vy**2) / 2,
        wrench=load_on(body, fx, fy),
        outputs={"force_x": Output(fx, "N", "bearing_force_x", X), "force_y": Output(fy, "N", "bearing_force_y", Y)},
        rates="absolute",
        source="Wu et al. 2021 eqs 31-34; its damper: assumed form",
    )
