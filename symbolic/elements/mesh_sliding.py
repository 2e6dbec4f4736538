r"""Sliding friction of a mesh: Coulomb's law at each tooth pair in contact.

With n the unit force on body 2, m perpendicular to it (``Geometry.along``) and a contact at
:math:`P + \xi n` (see ``tooth_pairs``), body 2 slides on body 1 along m at

.. math:: v = v_P - s\,\xi\,(\omega_2 - \omega_1),

:math:`v_P` being the speed at the pitch point. The friction on body 2 is F m with

.. math:: F = -\mu\,w\,|N|\tanh(v/v_0), \qquad
          T_1 = s F (\sigma r_1\tan\alpha + \xi), \qquad T_2 = s F (r_2\tan\alpha - \xi),

where w is the pair's share of the load and N the spring's part of the normal force. It reverses where a contact passes
the pitch point. Speeds are relative to the ground, since the sliding comes from the rigid rotation.
"""

import sympy as sp

from .base import Element, LogCosh, Output, element_type, load_on
from .mesh import ONE, R1, R2, TWO, UNITS, S, geometry
from .mesh_friction import MU, V0, pressed, sliding_speed
from .tooth_pairs import UNITS as PAIR_UNITS
from .tooth_pairs import tooth_pairs


@element_type
def mesh_sliding(kind: str, law: str, switched: bool, contact: str = "bilateral", error: bool = False) -> Element:
    """Write the sliding friction of one mesh type (arguments as in ``mesh``)."""
    g = geometry(kind)
    (normal, _, border), tangent = pressed(kind, law, switched, contact, error), g.h / g.c
    force = torque_1 = torque_2 = loss = sp.S.Zero
    for place, part in tooth_pairs():
        speed = sliding_speed(kind) - S * place * (TWO.omega - ONE.omega)
        friction = -MU * part * normal * sp.tanh(speed / V0)
        force += friction
        torque_1 += S * friction * (g.sigma * R1 * tangent + place)
        torque_2 += S * friction * (R2 * tangent - place)
        loss += MU * part * normal * V0 * LogCosh(speed / V0)
    mx, my = g.along
    wrench = load_on(ONE, -force * mx, -force * my, torque_1) | load_on(TWO, force * mx, force * my, torque_2)
    free = set().union(*(e.free_symbols for e in wrench.values()))
    units = UNITS | {MU: "", V0: "m/s"} | PAIR_UNITS
    return Element(
        title="mesh sliding friction",
        joins="mesh",
        ports=(ONE, TWO),
        parameters={symbol: unit for symbol, unit in units.items() if symbol in free},
        dissipation=loss,
        wrench=wrench,
        outputs={"friction": Output(force, "N", "mesh_friction"), "border": Output(border, "N")},
        rates="absolute",
        source="Coulomb's law at the contacts of involute teeth; load sharing: ISO/TR 15144-1 (assumed)",
    )
