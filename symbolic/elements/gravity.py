"""Weight of a member in a basis that may rotate."""

import sympy as sp

from .axes import SIDEWAYS, X, Y
from .base import Element, Port, element_type, positive, real

M = positive("m")
GX, GY, BASIS = real("g_x"), real("g_y"), real("beta")


@element_type
def gravity() -> Element:
    """Write the weight; ``beta`` is the rotation angle of the basis (zero in the paper's)."""
    body = Port.numbered(1, SIDEWAYS)
    cos, sin = sp.cos(BASIS), sp.sin(BASIS)
    gx, gy = GX * cos + GY * sin, GY * cos - GX * sin
    return Element(
        title="weight",
        joins="",
        ports=(body,),
        parameters={M: "kg", GX: "m/s^2", GY: "m/s^2", BASIS: "rad"},
        potential=-M * (gx * body.x + gy * body.y),
        wrench={(body, X): M * gx, (body, Y): M * gy},
        source="weight G of eqs 31-38",
    )
