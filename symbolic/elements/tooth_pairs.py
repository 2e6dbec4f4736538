r"""Tooth pairs in contact: where they touch and which part of the load each carries, by the mesh phase.

P is the pitch point and :math:`\xi` counts along the force on body 2. The path of contact has its middle at
:math:`\xi_m`; on it pairs follow each other a base pitch :math:`p_b = 2\pi r_1/z_1` apart. With the phase
:math:`\tau` in tooth pitches (single contact for frac :math:`\tau < \varsigma`, eqs 9-11) and
:math:`g = \tau - \varsigma/2`, wrapped into [-1/2, 1/2), the leading pair A and the other pair B are at

.. math:: \xi_A = \xi_m + s\,p_b\,g, \qquad \xi_B = \xi_m + s\,p_b\,(g - \operatorname{sgn} g),

:math:`z_1` being negative where gear 1 turns clockwise. A carries the part w of the load, B the part 1 - w:
w is 1 in single contact and falls linearly to 1/2 in the middle of double contact, where A and B change
names; so each pair's load rises linearly from nothing when it comes into contact. That is the load sharing
factor of ISO/TR 15144-1 for spur gears with adequate profile modification.
"""

import sympy as sp

from .base import positive, real
from .mesh import R1, S

PHASE, SHARE, MIDDLE, Z1 = real("tau"), positive("varsigma"), real("xi_m"), real("z_1")
UNITS = {PHASE: "", SHARE: "", MIDDLE: "m", Z1: ""}


class Wrapped(sp.Function):  # type: ignore[misc]  # SymPy is untyped
    """z less the nearest whole number, in [-1/2, 1/2)."""


class Sharing(sp.Function):  # type: ignore[misc]
    """The leading pair's part of the load, at g from the middle of single contact of the given share."""


def tooth_pairs() -> tuple[tuple[sp.Expr, sp.Expr], tuple[sp.Expr, sp.Expr]]:
    """Return place xi [m] and part of the load of the leading pair, and of the other."""
    g = Wrapped(PHASE - SHARE / 2)
    part = Sharing(g, SHARE)
    pitch = S * 2 * sp.pi * R1 / Z1
    return (MIDDLE + pitch * g, part), (MIDDLE + pitch * (g - sp.sign(g)), 1 - part)
