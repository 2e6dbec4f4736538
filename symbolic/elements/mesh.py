r"""Gear mesh: a spring-damper along the line of action.

External and internal meshes are one law with a sign, :math:`\sigma = +1` (sun-planet, parallel pair)
or :math:`\sigma = -1` (ring-planet); the two flanks are one law with a sign :math:`s`, +1 for the
flank the paper prints. Body 1 is the sun or ring, body 2 the planet. With
:math:`c = r_1 + \sigma r_2`, centre distance :math:`d`, :math:`\cos\alpha = c/d`,
:math:`\mathbf e` from 1 to 2, :math:`\mathbf t` perpendicular to it and the rolling deflection
:math:`w = r_1(\theta_1-\Delta\gamma) + \sigma r_2(\theta_2-\Delta\gamma)`:

involute (the exact involute, whose gradient is the unit line of action)
    :math:`\delta = s w - \sigma c (\operatorname{inv}\alpha - \operatorname{inv}\alpha_0)`
paper (Wu et al. 2021, eqs 7 and 23)
    :math:`\delta = s r_2\tan(w/r_2) - \sigma (d - d_0)\sin\alpha`

and in both the force on body 2 is :math:`N(\sigma\sin\alpha\,\mathbf e + s\cos\alpha\,\mathbf t)`,
the torques are :math:`-s r_1 N` and :math:`-\sigma s r_2 N` (eqs 12, 13, 25, 26).

A bilateral mesh (the paper's) may pull. A one-flank mesh has :math:`N = k\langle\delta\rangle`, and its damper acts in
contact only: teeth push where both :math:`k\delta` and :math:`k\delta + c\dot\delta` are positive. Where the damper
would pull harder than the spring pushes, it just cancels the spring, so N is never negative (``pull``, 0 in every run,
lets it pull during the search for the loaded equilibrium). Tooth errors subtract :math:`e` from the deflection and
:math:`\dot e` from its rate. Backlash is two one-flank meshes, on s and -s; the gap :math:`j` (along the line of
action) is subtracted from the deflection of the second.
"""

from dataclasses import dataclass

import sympy as sp

from .axes import THETA
from .base import Element, Output, Port, Wrench, element_type, load_on, positive, real
from .contact import HOLD, Given, Lesser, Rest, Step, Switch

SIGN = {"external": 1, "internal": -1}


@dataclass(frozen=True)
class Geometry:
    """Mesh triangle: the geometry common to all mesh laws (units [m], [rad])."""

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
        """Return the unit direction perpendicular to the line of action (eqs 15 and 28, one flank)."""
        return (
            (self.c * self.dx + self.sigma * S * self.h * self.dy) / self.d**2,
            (self.c * self.dy - self.sigma * S * self.h * self.dx) / self.d**2,
        )


ONE, TWO, THREE = Port.numbered(1), Port.numbered(2), Port.numbered(3)
R1, R2, D0, K, K1, K2, C = (positive(n) for n in ("r_1", "r_2", "d_0", "k", "k_1", "k_2", "c"))
S, EX, EY, TURN, INV0, LEVEL, GAP, PULL, ERROR, ERROR_RATE, SLOPE, TEETH = (
    real(n) for n in ("s", "e_x", "e_y", "Delta_gamma_0", "inv_0", "level", "gap", "pull", "e", "e_d", "k_d", "z_1")
)

UNITS = {
    R1: "m", R2: "m", D0: "m", K: "N/m", K1: "N/m", K2: "N/m", C: "N*s/m",
    S: "", EX: "", EY: "", TURN: "rad", INV0: "rad", GAP: "m", ERROR: "m", ERROR_RATE: "m/s",
    SLOPE: "N/m", TEETH: "", PULL: "", LEVEL: "", HOLD: "N",
}  # fmt: skip


def geometry(kind: str) -> Geometry:
    """Construct the mesh triangle; the position angle is measured from (e_x, e_y) and never wraps."""
    sigma = SIGN[kind]
    c = R1 + sigma * R2
    dx, dy = TWO.x - ONE.x, TWO.y - ONE.y
    d = sp.sqrt(dx**2 + dy**2)
    turned = TURN + sp.atan2(EX * dy - EY * dx, EX * dx + EY * dy)
    w = R1 * (ONE.theta - turned) + sigma * R2 * (TWO.theta - turned)
    return Geometry(sigma, c, dx, dy, d, sp.sqrt(d**2 - c**2), turned, w)


def deflection(kind: str, law: str) -> sp.Expr:
    """Return the normal composite deflection [m] of one law (see the module docstring)."""
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
    """Return the mesh parameters in the expressions, in the order of ``UNITS``."""
    free = set().union(*(sp.sympify(e).free_symbols for e in expressions))
    return {symbol: unit for symbol, unit in UNITS.items() if symbol in free}


@dataclass(frozen=True)
class MeshLaw:
    """Mesh law: deflection [m] and its rate from the motion, and loads on the ports.

    ``pressed`` is the wrench of a unit normal force [1 N], ``rolled`` that of 1 N m on the rolling angle of gear 1,
    measured from the line of centres.
    """

    ports: tuple[Port, ...]
    deflection: sp.Expr
    rate: sp.Expr
    pressed: Wrench
    rolling: sp.Expr
    rolled: Wrench
    outputs: dict[str, Output]


def plane_law(kind: str, law: str) -> MeshLaw:
    """Write the law of a mesh whose gears move in the plane."""
    g = geometry(kind)
    nx, ny = g.normal
    pressed = load_on(ONE, -nx, -ny, -S * R1) | load_on(TWO, nx, ny, -g.sigma * S * R2)
    ax, ay = g.dy / g.d**2, -g.dx / g.d**2
    rolled = load_on(ONE, ax, ay, -sp.S.One) | load_on(TWO, -ax, -ay)
    seen = {"pressure_angle": Output(g.alpha, "rad", "pressure_angle")}
    return MeshLaw((ONE, TWO), deflection(kind, law), approach(kind), pressed, ONE.theta - g.turned, rolled, seen)


def torsional_law(kind: str, orbiting: bool) -> MeshLaw:
    r"""Write the law of a mesh whose gears only rotate.

    :math:`\delta = s\,[r_1(\theta_1-\theta_3)+\sigma r_2(\theta_2-\theta_3)]`: the line of
    centres rotates with body 3, the carrier, if body 2 is a planet (``orbiting``), else it is fixed.
    """
    sigma, zero = SIGN[kind], sp.S.Zero
    ports = tuple(Port.numbered(number, (THETA,)) for number in ((1, 2, 3) if orbiting else (1, 2)))
    turn, speed = (THREE.theta, THREE.omega) if orbiting else (zero, zero)
    delta, rate = (
        S * (R1 * (one - line) + sigma * R2 * (two - line))
        for one, two, line in ((ONE.theta, TWO.theta, turn), (ONE.omega, TWO.omega, speed))
    )
    torques = (-S * R1, -sigma * S * R2, S * (R1 + sigma * R2))
    pressed, rolled = (
        {(port, THETA): torque for port, torque in zip(ports, each, strict=False)}
        for each in (torques, (-sp.S.One, zero, sp.S.One))
    )
    return MeshLaw(ports, delta, rate, pressed, ONE.theta - turn, rolled, {})


@element_type
def mesh(
    kind: str, law: str, switched: bool, damped: bool, contact: str = "bilateral", error: bool = False,
    followed: bool = False,
) -> Element:  # fmt: skip
    """Write one mesh type.

    Parameters
    ----------
    kind
        ``external`` or ``internal``.
    law
        ``involute`` or ``paper``; ``torsional`` or ``orbiting`` for gears that only rotate, see `torsional_law`.
    switched
        Whether the stiffness follows a level.
    damped
        Whether a damper c acts along the line of action.
    contact
        ``bilateral``, ``one-flank``, or ``gap`` (one flank behind a gap).
    error
        Whether tooth errors subtract ``e`` from the deflection.
    followed
        Whether the stiffness depends on gear 1's own rolling angle, so that its slope gives a torque on the gear.
    """
    written = torsional_law(kind, law == "orbiting") if law in ("torsional", "orbiting") else plane_law(kind, law)
    delta, rate = written.deflection, written.rate
    if contact == "gap":
        delta -= GAP
    if error:
        delta, rate = delta - ERROR, rate - ERROR_RATE
    k = Given(TEETH * written.rolling / (2 * sp.pi), K, SLOPE) if followed else stiffness(switched)
    acting = normal_force(delta, rate, k, damped, contact)
    turn = acting.stored * SLOPE * TEETH / (2 * sp.pi) if followed else sp.S.Zero
    wrench = {at: acting.force * pressed + turn * written.rolled[at] for at, pressed in written.pressed.items()}
    return Element(
        title="mesh",
        joins="mesh",
        ports=written.ports,
        parameters=used(*wrench.values()),
        potential=k * acting.stored,
        dissipation=acting.loss,
        wrench=wrench,
        outputs={
            "force": Output(acting.force, "N", "mesh_force"),
            "damper": Output(acting.damper, "N"),
            "deflection": Output(delta, "m", "mesh_deflection"),
        }
        | written.outputs
        | {"rolling": Output(written.rolling, "rad")}
        | border_outputs(delta, acting.border),
        source="Wu et al. 2021 eqs 2-13 and 16-26; damper along the line of action: assumed form; torque of a "
        "stiffness that follows the gear: Oh, Grosh and Barber 2005, J. Vib. Acoust. 127:208",
        gradient=law != "paper",
        closed=law != "torsional",
    )


def border_outputs(delta: sp.Expr, border: sp.Expr | None) -> dict[str, Output]:
    """Return the contact outputs of a mesh whose teeth can separate."""
    if border is None:
        return {}
    return {"contact": Output(Step(delta), "", "mesh_contact"), "border": Output(border, "N")}


@dataclass(frozen=True)
class NormalForce:
    """Normal force [N], the damper's part of it, its potential over the stiffness [m^2], its dissipation [W].

    ``border`` is the event function [N], positive where the teeth push; a bilateral mesh has none.
    """

    force: sp.Expr
    damper: sp.Expr
    stored: sp.Expr
    loss: sp.Expr
    border: sp.Expr | None = None


def normal_force(delta: sp.Expr, rate: sp.Expr, k: sp.Expr, damped: bool, contact: str) -> NormalForce:
    """Write the normal force of a deflection [m] and its rate."""
    damping = C if damped else sp.S.Zero
    if contact == "bilateral":
        return NormalForce(k * delta + damping * rate, damping * rate, delta**2 / 2, damping * rate**2 / 2)
    border = Lesser(k * delta, k * delta + damping * rate) if damped else k * delta
    pushing = Switch(border, HOLD)
    resting = Rest(border, HOLD, delta) if damped else sp.S.Zero
    pull = (1 - pushing - resting) * (sp.S.Zero if contact == "gap" else PULL)
    return NormalForce(
        force=pushing * (k * delta + damping * rate) + pull * k * delta,
        damper=pushing * damping * rate - resting * k * delta,
        stored=(pushing + resting + pull) * delta**2 / 2,
        loss=pushing * damping * rate**2 / 2 - resting * k * delta * rate,
        border=border,
    )
