"""Weight of a member in a basis that may turn."""

import sympy as sp

from .base import Element, Port, positive, real

M = positive("m")
GX, GY, BASIS = real("g_x"), real("g_y"), real("beta")


def gravity() -> Element:
    """Write the weight; ``beta`` is the angle by which the basis has turned (zero in the paper's)."""
    body = Port.numbered(1)
    cos, sin = sp.cos(BASIS), sp.sin(BASIS)
    gx, gy = GX * cos + GY * sin, GY * cos - GX * sin
    return Element(
        name="gravity",
        ports=(body,),
        parameters={M: "kg", GX: "m/s^2", GY: "m/s^2", BASIS: "rad"},
        potential=-M * (gx * body.x + gy * body.y),
        wrench=(M * gx, M * gy, sp.S.Zero),
        source="weight G of eqs 31-38",
    )
