r"""Mesh friction at the pitch point: the paper's force, made dissipative.

The paper's force (eqs 14 and 27) is :math:`(\mu N + c\,\dot\delta_t)\operatorname{sgn}\dot\delta_t`: its viscous part
is positive in either direction, so it supplies energy. Here the force opposes the relative speed :math:`v_t` of the two
bodies at the pitch point, perpendicular to the line of action,

.. math:: F = -(\mu |N| \tanh(v_t/v_0) + c_t v_t), \qquad
          v_t = \dot d\cos\alpha + \sigma s \tan\alpha\,
          [r_1(\omega_1-\dot\gamma) + \sigma r_2(\omega_2-\dot\gamma)],

with the paper's moment arms :math:`r\tan\alpha` (eqs 32, 34). N is the spring's part of the normal force, zero where
teeth have separated.
"""

import sympy as sp

from .base import Element, LogCosh, Output, element_type, load_on, positive
from .contact import HOLD, Switch
from .mesh import ERROR, GAP, ONE, R1, R2, TWO, UNITS, S, deflection, geometry, stiffness

MU, CT, V0 = (positive(n) for n in ("mu", "c_t", "v_0"))


def sliding_speed(kind: str) -> sp.Expr:
    """Return v_t [m/s], body 2 relative to body 1, at the pitch point."""
    g = geometry(kind)
    mx, my = g.along
    turning = g.sigma * S * (g.h / g.c) * (R1 * ONE.omega + g.sigma * R2 * TWO.omega)
    return mx * (TWO.vx - ONE.vx) + my * (TWO.vy - ONE.vy) + turning


def pressed(kind: str, law: str, switched: bool, contact: str, error: bool) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """Return |N| [N] (the spring's part), whether flanks touch, and the event function of contact [N].

    A bilateral mesh is in contact on both sides of the border, a one-flank mesh on its positive side only.
    """
    delta = deflection(kind, law) - (ERROR if error else 0) - (GAP if contact == "gap" else 0)
    normal = stiffness(switched) * delta
    touching = Switch(normal, HOLD)
    if contact == "bilateral":
        return normal * (2 * touching - 1), sp.S.One, normal
    return normal * touching, touching, normal


@element_type
def mesh_friction(kind: str, law: str, switched: bool, contact: str = "bilateral", error: bool = False) -> Element:
    """Write the pitch-point friction of one mesh type (arguments as in ``mesh``)."""
    g = geometry(kind)
    normal, touching, border = pressed(kind, law, switched, contact, error)
    speed = sliding_speed(kind)
    force = -(MU * normal * sp.tanh(speed / V0) + touching * CT * speed)
    mx, my = g.along
    arm = S * (g.h / g.c) * force
    wrench = load_on(ONE, -force * mx, -force * my, g.sigma * R1 * arm) | load_on(TWO, force * mx, force * my, R2 * arm)
    free = set().union(*(e.free_symbols for e in wrench.values()))
    units = UNITS | {MU: "", CT: "N*s/m", V0: "m/s"}
    return Element(
        title="mesh friction",
        joins="mesh",
        ports=(ONE, TWO),
        parameters={symbol: unit for symbol, unit in units.items() if symbol in free},
        dissipation=MU * normal * V0 * LogCosh(speed / V0) + touching * CT * speed**2 / 2,
        wrench=wrench,
        outputs={"friction": Output(force, "N", "mesh_friction"), "border": Output(border, "N")},
        source="Wu et al. 2021 eqs 14, 27, 32, 34, sign made dissipative",
    )
