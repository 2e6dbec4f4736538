r"""Lagrange's equations: generalised forces of elements and accelerations of bodies from energies.

.. math:: \frac{d}{dt}\frac{\partial T}{\partial\dot q} - \frac{\partial T}{\partial q}
          = -\frac{\partial V}{\partial q} - \frac{\partial D}{\partial\dot q}

SymPy differentiates each element type and each kind of body once, in its own few coordinates.
"""

from functools import cache

import sympy as sp

from ..elements.base import Element
from .frames import FrameMotion


def forces(element: Element) -> tuple[sp.Expr, ...]:
    """Return -dV/dq - dD/dv of an element, in the order of its loads."""
    return tuple(
        -sp.diff(element.potential, q) - sp.diff(element.dissipation, v)
        for q, v in zip(element.coordinates, element.velocities, strict=True)
    )


def kinetic_energy() -> sp.Expr:
    """Return T = m |v|^2 / 2 + I (rho phi' + u')^2 / 2 of a body in a rotating frame (symbols of ``FrameMotion``).

    v is the velocity relative to the ground, resolved in the frame.
    """
    f = FrameMotion.symbols()
    w = f.frame_ratio * f.phi_d
    vx, vy = f.vx - w * f.y, f.vy + w * f.x
    turning = f.ratio * f.phi_d + sp.Symbol("u_d", real=True)
    return f.m * (vx**2 + vy**2) / 2 + f.inertia * turning**2 / 2


@cache
def frame_accelerations() -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """Derive x'', y'', u'' of a body in a rotating frame from its kinetic energy.

    The reference's acceleration phi'' is given.
    """
    f = FrameMotion.symbols()
    t = sp.Symbol("t")
    x, y, u, phi = (sp.Function(n)(t) for n in ("x", "y", "u", "phi"))
    motion = {f.x: x, f.y: y, f.vx: x.diff(t), f.vy: y.diff(t), f.phi_d: phi.diff(t)}
    kinetic = kinetic_energy().xreplace({**motion, sp.Symbol("u_d", real=True): u.diff(t)})
    named = [
        (phi.diff(t, 2), f.phi_dd), (phi.diff(t), f.phi_d), (x.diff(t), f.vx), (y.diff(t), f.vy),
        (x, f.x), (y, f.y), (u, sp.S.Zero), (phi, sp.S.Zero),
    ]  # fmt: skip
    solved = []
    for q, force in ((x, f.fx), (y, f.fy), (u, f.torque)):
        equation = sp.diff(kinetic.diff(q.diff(t)), t) - kinetic.diff(q) - force
        acceleration = sp.solve(equation, q.diff(t, 2))[0]
        solved.append(sp.expand(acceleration.subs(named)))
    return tuple(solved)
