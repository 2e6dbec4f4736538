r"""Tooth pairs in contact: position and load share of each over the mesh phase.

P is the pitch point and :math:`\xi` is measured along the force on body 2. The middle of the path of contact is at
:math:`\xi_m`; pairs follow each other a base pitch :math:`p_b = 2\pi r_1/z_1` apart. With the phase :math:`\tau` in
tooth pitches (single contact for frac :math:`\tau < \varsigma`, eqs 9-11) and :math:`g = \tau - \varsigma/2`, wrapped
into [-1/2, 1/2), the leading pair A and the other pair B are at

.. math:: \xi_A = \xi_m + s\,p_b\,g, \qquad \xi_B = \xi_m + s\,p_b\,(g - \operatorname{sgn} g),

with :math:`z_1` negative if gear 1 turns clockwise. A carries the share w of the load, B the share 1 - w: w is 1 in
single contact and falls linearly to 1/2 in the middle of double contact, where A and B swap. So each pair's load rises
linearly from zero at first contact. This is the load sharing factor of ISO/TR 15144-1 for spur gears with adequate
profile modification.
"""

import sympy as sp

from .base import positive, real
from .mesh import R1, S

PHASE, SHARE, MIDDLE, Z1 = real("tau"), positive("varsigma"), real("xi_m"), real("z_1")
UNITS = {PHASE: "", SHARE: "", MIDDLE: "m", Z1: ""}


class Wrapped(sp.Function):  # type: ignore[misc]  # SymPy is untyped
    """z less the nearest whole number, in [-1/2, 1/2)."""


class Sharing(sp.Function):  # type: ignore[misc]
    """Load share of the leading pair, at g from the middle of single contact of the given share."""


def tooth_pairs() -> tuple[tuple[sp.Expr, sp.Expr], tuple[sp.Expr, sp.Expr]]:
    """Return position xi [m] and load share of the leading pair, and of the other."""
    g = Wrapped(PHASE - SHARE / 2)
    part = Sharing(g, SHARE)
    pitch = S * 2 * sp.pi * R1 / Z1
    return (MIDDLE + pitch * g, part), (MIDDLE + pitch * (g - sp.sign(g)), 1 - part)
