"""Torsional elements: couplings between shafts, supports in the housing, drag, external torque, slip law."""

import sympy as sp

from .base import Element, Output, Port, positive, real

K, C = positive("k_t"), positive("c_t")
T, OMEGA_S = real("T"), real("omega_s")
T_B, OMEGA_B = positive("T_b"), positive("omega_b")


def coupling(damped: bool) -> Element:
    """Write a torsional spring-damper between two members (Table 5's connections)."""
    one, two = Port.numbered(1), Port.numbered(2)
    twist, rate = one.theta - two.theta, one.omega - two.omega
    c = C if damped else sp.S.Zero
    torque = K * twist + c * rate
    zero = sp.S.Zero
    return Element(
        name="coupling" + "_damped" * damped,
        ports=(one, two),
        parameters={K: "N*m/rad"} | ({C: "N*m*s/rad"} if damped else {}),
        potential=K * twist**2 / 2,
        dissipation=c * rate**2 / 2,
        wrench=(zero, zero, -torque, zero, zero, torque),
        outputs={"torque": Output(torque, "N*m")},
        source="linear torsional spring-damper; stiffnesses: Wu et al. 2021 Table 5",
    )


def torsional_support(damped: bool) -> Element:
    """Write a torsional spring-damper to the housing (Lin and Parker 1999, k_ru)."""
    body = Port.numbered(1)
    c = C if damped else sp.S.Zero
    torque = -K * body.theta - c * body.omega
    return Element(
        name="torsional_support" + "_damped" * damped,
        ports=(body,),
        parameters={K: "N*m/rad"} | ({C: "N*m*s/rad"} if damped else {}),
        potential=K * body.theta**2 / 2,
        dissipation=c * body.omega**2 / 2,
        wrench=(sp.S.Zero, sp.S.Zero, torque),
        outputs={"torque": Output(torque, "N*m")},
        rates="absolute",
        source="Lin and Parker 1999, J. Vib. Acoust. 121:316",
    )


def drag() -> Element:
    """Write the rotational viscous damping of a member, the c_B terms of eqs 31-34."""
    body = Port.numbered(1)
    torque = -C * body.omega
    return Element(
        name="drag",
        ports=(body,),
        parameters={C: "N*m*s/rad"},
        dissipation=C * body.omega**2 / 2,
        wrench=(sp.S.Zero, sp.S.Zero, torque),
        outputs={"torque": Output(torque, "N*m")},
        rates="absolute",
        source="Wu et al. 2021 eqs 31-34",
    )


def external_torque() -> Element:
    """Write a torque given from outside, T in eqs 31-38."""
    body = Port.numbered(1)
    return Element(
        name="external_torque",
        ports=(body,),
        parameters={T: "N*m"},
        potential=-T * body.theta,
        wrench=(sp.S.Zero, sp.S.Zero, T),
        outputs={"torque": Output(T, "N*m")},
        load=True,
        source="Wu et al. 2021 eqs 31-38",
    )


def slip_torque() -> Element:
    r"""Write the torque of an asynchronous machine by Kloss's formula.

    Slip over breakdown slip is :math:`z = (\omega - \omega_s)/\omega_b`, the breakdown slip speed
    :math:`\omega_b` being the share :math:`g_b` of :math:`|\omega_s|`, and

    .. math:: T = -\frac{2 T_b}{z + 1/z} = -2 T_b\,\frac{z}{1 + z^2} ,

    which brakes above the synchronous speed, whichever way that is. The stator's resistance is left out, so
    braking and driving breakdown torques are alike. The dissipation function is one for the law's slope only:
    the torque is a load, and its power may be positive.
    """
    body = Port.numbered(1)
    z = (body.omega - OMEGA_S) / OMEGA_B
    torque = -2 * T_B * z / (1 + z**2)
    return Element(
        name="slip_torque",
        ports=(body,),
        parameters={OMEGA_S: "rad/s", OMEGA_B: "rad/s", T_B: "N*m"},
        dissipation=T_B * OMEGA_B * sp.log(1 + z**2),
        wrench=(sp.S.Zero, sp.S.Zero, torque),
        outputs={"torque": Output(torque, "N*m")},
        rates="absolute",
        load=True,
        source="Kloss's formula, in textbooks on electrical machines as T / T_b = 2 / (s / s_b + s_b / s)",
    )
