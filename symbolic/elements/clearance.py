r"""Bearings with radial clearance: no force until the displacement exceeds the clearance.

With the displacement :math:`\mathbf u`, :math:`r = \sqrt{u^2 + \epsilon^2}` and the clearance c,

.. math:: V = k\langle r - c\rangle^2/2, \qquad \mathbf F = -k\langle r - c\rangle\,\mathbf u/r ;

the damper acts in contact only. The small length :math:`\epsilon` keeps the force's slope finite at the centre; for any
:math:`\epsilon`, zero clearance gives a linear bearing. ``closing`` (0 in every run) reduces the clearance during the
search for the loaded equilibrium.
"""

from dataclasses import dataclass

import sympy as sp

from .axes import X, Y
from .base import Element, Output, Port, element_type, load_on, positive, real
from .bearing import CARRIER, PLANET, X0, Y0, C, K, pin_deflection, pin_place, pin_speed, rubbing_pin
from .contact import HOLD, Switch

CLEARANCE, CLOSING, ROUNDING = positive("clearance"), real("closing"), positive("epsilon")


@dataclass(frozen=True)
class Race:
    """Contact of a bearing at the displacement (u_x, u_y) [m]: penetration beyond the clearance, and direction."""

    ux: sp.Expr
    uy: sp.Expr

    @property
    def radius(self) -> sp.Expr:
        """Return r [m]."""
        return sp.sqrt(self.ux**2 + self.uy**2 + ROUNDING**2)

    @property
    def reach(self) -> sp.Expr:
        """Return r - c [m], positive in contact."""
        return self.radius - CLEARANCE * (1 - CLOSING)

    @property
    def touching(self) -> sp.Expr:
        """Return whether the bearing is in contact."""
        return Switch(self.reach, HOLD)

    @property
    def secant(self) -> sp.Expr:
        """Return the force over the displacement [N/m]."""
        return K * self.reach * self.touching / self.radius

    @property
    def potential(self) -> sp.Expr:
        """Return the strain energy [J]."""
        return K * self.reach**2 / 2 * self.touching

    def damping(self, damped: bool) -> sp.Expr:
        """Return the active damping [N s/m]."""
        return C * self.touching if damped else sp.S.Zero


def parameters(damped: bool) -> dict[sp.Symbol, str]:
    """Return the parameters of a bearing with clearance."""
    own = {K: "N/m"} | ({C: "N*s/m"} if damped else {})
    return own | {X0: "m", Y0: "m", CLEARANCE: "m", CLOSING: "", ROUNDING: "m", HOLD: "m"}


@element_type
def ground_clearance(damped: bool) -> Element:
    """Write the bearing of a member in the housing, with clearance."""
    body = Port.numbered(1)
    race = Race(body.x - X0, body.y - Y0)
    k, c = race.secant, race.damping(damped)
    fx, fy = -k * race.ux - c * body.vx, -k * race.uy - c * body.vy
    return Element(
        title="housing bearing with clearance",
        joins="bearing",
        ports=(body,),
        parameters=parameters(damped),
        potential=race.potential,
        dissipation=c * (body.vx**2 + body.vy**2) / 2,
        wrench=load_on(body, fx, fy),
        outputs={
            "force_x": Output(fx, "N", "bearing_force_x", X),
            "force_y": Output(fy, "N", "bearing_force_y", Y),
            "border": Output(race.reach, "m"),
        },
        rates="absolute",
        source="radial clearance with a linear race: Kahraman and Singh 1991, J. Sound Vib. 144:469",
    )


@element_type
def pin_clearance(damped: bool) -> Element:
    """Write the planet bearing with clearance; its damper acts on the motion relative to the rotating carrier."""
    race = Race(*pin_deflection())
    k, c = race.secant, race.damping(damped)
    ax, ay = pin_place()
    rx, ry = PLANET.x - CARRIER.x, PLANET.y - CARRIER.y
    vx, vy = pin_speed()
    fx, fy = k * race.ux + c * vx, k * race.uy + c * vy
    torque = ax * k * race.uy - ay * k * race.ux + c * (rx * vy - ry * vx)
    return Element(
        title="planet bearing with clearance",
        joins="pin",
        ports=(CARRIER, PLANET),
        parameters=parameters(damped),
        potential=race.potential,
        dissipation=c * (vx**2 + vy**2) / 2,
        wrench=load_on(CARRIER, fx, fy, torque) | load_on(PLANET, -fx, -fy),
        outputs={
            "force_x": Output(-fx, "N", "pin_force_x", X),
            "force_y": Output(-fy, "N", "pin_force_y", Y),
            "border": Output(race.reach, "m"),
        },
        source="Wu et al. 2021 eqs 29-30 with radial clearance",
    )


@element_type
def pin_clearance_friction() -> Element:
    """Write the friction torque of the planet bearing with clearance, from its load."""
    title = "friction of the planet bearing with clearance"
    return rubbing_pin(title, Race(*pin_deflection()).secant, parameters(False))
