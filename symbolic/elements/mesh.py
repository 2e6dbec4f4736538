r"""Gear mesh: a spring-damper on the line of action, fixed in space, floating over the turning teeth.

External and internal meshes are one law with a sign, :math:`\sigma = +1` (sun-planet, parallel pair)
or :math:`\sigma = -1` (ring-planet); the two flanks are one law with a sign :math:`s`, +1 for the
flank the paper prints. Body 1 is the sun or ring, body 2 the planet. With
:math:`c = r_1 + \sigma r_2`, centre distance :math:`d`, :math:`\cos\alpha = c/d`,
:math:`\mathbf e` from 1 to 2, :math:`\mathbf t` at a right angle to it and the rolling deflection
:math:`w = r_1(\theta_1-\Delta\gamma) + \sigma r_2(\theta_2-\Delta\gamma)`:

involute (the exact involute, whose gradient is the unit line of action)
    :math:`\delta = s w - \sigma c (\operatorname{inv}\alpha - \operatorname{inv}\alpha_0)`
paper (Wu et al. 2021, eqs 7 and 23)
    :math:`\delta = s r_2\tan(w/r_2) - \sigma (d - d_0)\sin\alpha`

and in both the force on body 2 is :math:`N(\sigma\sin\alpha\,\mathbf e + s\cos\alpha\,\mathbf t)`,
the torques are :math:`-s r_1 N` and :math:`-\sigma s r_2 N` (eqs 12, 13, 25, 26).

A bilateral mesh (the paper's) may pull; a one-flank mesh has :math:`N = k\langle\delta\rangle` and a damper
that acts in contact only and never makes N negative (``pull``, 0 in every run, lets it pull while the
loaded equilibrium is sought). Backlash is two one-flank meshes, on s and -s, whose
gap :math:`j` (along the line of action) is taken from the deflection of the second.
"""

from dataclasses import dataclass

import sympy as sp

from .base import Element, Output, Port, positive, real
from .contact import HalfSquare, NotBelow, NotBelowLoss, Ramp, Step

SIGN = {"external": 1, "internal": -1}


@dataclass(frozen=True)
class Geometry:
    """The triangle of a mesh: everything its laws share (units [m], [rad])."""

    sigma: int
    c: sp.Expr
    dx: sp.Expr
    dy: sp.Expr
    d: sp.Expr
    h: sp.Expr
    turned: sp.Expr
    w: sp.Expr

    @property
    def alpha(self) -> sp.Expr:
        """Return the operating pressure angle."""
        return sp.atan(self.h / self.c)

    @property
    def normal(self) -> tuple[sp.Expr, sp.Expr]:
        """Return the unit force direction on body 2, with h = d sin(alpha), c = d cos(alpha)."""
        return (
            (self.sigma * self.h * self.dx - S * self.c * self.dy) / self.d**2,
            (self.sigma * self.h * self.dy + S * self.c * self.dx) / self.d**2,
        )

    @property
    def along(self) -> tuple[sp.Expr, sp.Expr]:
        """Return the unit direction at a right angle to the line of action (eqs 15 and 28, one flank)."""
        return (
            (self.c * self.dx + self.sigma * S * self.h * self.dy) / self.d**2,
            (self.c * self.dy - self.sigma * S * self.h * self.dx) / self.d**2,
        )


ONE, TWO = Port.numbered(1), Port.numbered(2)
R1, R2, D0, K, K1, K2, C = (positive(n) for n in ("r_1", "r_2", "d_0", "k", "k_1", "k_2", "c"))
S, EX, EY, TURN, INV0, LEVEL, GAP, PULL = (
    real(n) for n in ("s", "e_x", "e_y", "Delta_gamma_0", "inv_0", "level", "gap", "pull")
)

UNITS = {
    R1: "m", R2: "m", D0: "m", K: "N/m", K1: "N/m", K2: "N/m", C: "N*s/m",
    S: "", EX: "", EY: "", TURN: "rad", INV0: "rad", GAP: "m", PULL: "", LEVEL: "",
}  # fmt: skip


def geometry(kind: str) -> Geometry:
    """Lay out the mesh triangle; the position angle is measured from (e_x, e_y) and never wraps."""
    sigma = SIGN[kind]
    c = R1 + sigma * R2
    dx, dy = TWO.x - ONE.x, TWO.y - ONE.y
    d = sp.sqrt(dx**2 + dy**2)
    turned = TURN + sp.atan2(EX * dy - EY * dx, EX * dx + EY * dy)
    w = R1 * (ONE.theta - turned) + sigma * R2 * (TWO.theta - turned)
    return Geometry(sigma, c, dx, dy, d, sp.sqrt(d**2 - c**2), turned, w)


def deflection(kind: str, law: str) -> sp.Expr:
    """Return the normal composite deflection [m] of one law (see the module's head)."""
    g = geometry(kind)
    if law == "involute":
        return S * g.w - g.sigma * g.c * (g.h / g.c - g.alpha - INV0)
    return S * R2 * sp.tan(g.w / R2) - g.sigma * (g.d - D0) * g.h / g.d


def approach(kind: str) -> sp.Expr:
    """Return the speed [m/s] at which the flanks approach along the line of action."""
    g = geometry(kind)
    nx, ny = g.normal
    rolling = S * (R1 * ONE.omega + g.sigma * R2 * TWO.omega)
    return rolling - nx * (TWO.vx - ONE.vx) - ny * (TWO.vy - ONE.vy)


def stiffness(switched: bool) -> sp.Expr:
    """Return k [N/m]; switched, it lies between single (level 0) and double contact (level 1), eq 9."""
    return K1 + (K2 - K1) * LEVEL if switched else K


def used(*expressions: sp.Expr) -> dict[sp.Symbol, str]:
    """Return the mesh parameters that occur in the expressions, in the order of ``UNITS``."""
    free = set().union(*(sp.sympify(e).free_symbols for e in expressions))
    return {symbol: unit for symbol, unit in UNITS.items() if symbol in free}


def mesh(kind: str, law: str, switched: bool, damped: bool, contact: str = "bilateral") -> Element:
    """Write one mesh type.

    Parameters
    ----------
    kind
        ``external`` or ``internal``.
    law
        ``involute`` or ``paper``.
    switched
        Whether the stiffness follows a level.
    damped
        Whether a damper c acts along the line of action.
    contact
        ``bilateral``, ``one-flank``, or ``gap`` (one flank behind a gap).
    """
    g = geometry(kind)
    delta = deflection(kind, law) - (GAP if contact == "gap" else 0)
    rate, k = approach(kind), stiffness(switched)
    damping = C if damped else sp.S.Zero
    if contact == "bilateral":
        potential, loss = k * delta**2 / 2, damping * rate**2 / 2
        force = k * delta + damping * rate
    else:
        pull = sp.S.Zero if contact == "gap" else PULL
        potential, loss = k * (HalfSquare(delta) + pull * HalfSquare(-delta)), sp.S.Zero
        force = k * (Ramp(delta) - pull * Ramp(-delta))
        if damped:
            force += Step(delta) * NotBelow(C * rate, -k * delta)
            loss = Step(delta) * NotBelowLoss(rate, C, -k * delta)
    nx, ny = g.normal
    wrench = (
        -force * nx, -force * ny, -S * R1 * force,
        force * nx, force * ny, -g.sigma * S * R2 * force,
    )  # fmt: skip
    suffix = {"bilateral": "", "one-flank": "_one_flank", "gap": "_gap"}[contact]
    return Element(
        name=f"mesh_{kind}_{law}" + "_switched" * switched + "_damped" * damped + suffix,
        ports=(ONE, TWO),
        parameters=used(*wrench),
        potential=potential,
        dissipation=loss,
        wrench=wrench,
        outputs={
            "force": Output(force, "N"),
            "deflection": Output(delta, "m"),
            "pressure_angle": Output(g.alpha, "rad"),
            "rolling": Output(ONE.theta - g.turned, "rad"),
        }
        | ({} if contact == "bilateral" else {"contact": Output(Step(delta), "")}),
        source="Wu et al. 2021 eqs 2-13 and 16-26; damper along the line of action: assumed form",
        gradient=law == "involute",
    )
