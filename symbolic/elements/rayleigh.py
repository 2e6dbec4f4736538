r"""Mass-proportional part of Rayleigh damping, on a body's deviation from the rigid motion of its train.

With :math:`\alpha` in 1/s, :math:`D = \alpha (m |\mathbf v|^2 + I\dot u^2)/2`, v and u' being the rates in the rotating
frame, so that the rigid motion itself is not damped. The stiffness-proportional part needs no element: every spring has
a damper :math:`c = \beta k`.
"""

import sympy as sp

from .base import Element, Port, element_type, load_on, positive

ALPHA, M, I = (positive(name) for name in ("alpha", "m", "I"))  # noqa: E741  # the moment of inertia's letter
SHIFTING, TURNING, BOTH = "shifting", "turning", "shifting and turning"


@element_type
def rayleigh(motion: str) -> Element:
    """Write the damping of a body's ``motion``: ``shifting``, ``turning`` or ``shifting and turning``."""
    body, zero = Port.numbered(1), sp.S.Zero
    m, inertia = (M if motion in (SHIFTING, BOTH) else zero), (I if motion in (TURNING, BOTH) else zero)
    return Element(
        title="Rayleigh damping by mass",
        joins="",
        ports=(body,),
        parameters={ALPHA: "1/s"} | ({M: "kg"} if m else {}) | ({I: "kg*m^2"} if inertia else {}),
        dissipation=ALPHA * (m * (body.vx**2 + body.vy**2) + inertia * body.omega**2) / 2,
        wrench=load_on(body, -ALPHA * m * body.vx, -ALPHA * m * body.vy, -ALPHA * inertia * body.omega),
        rates="deviation",
        source="Rayleigh 1877, The Theory of Sound, vol. 1",
    )
