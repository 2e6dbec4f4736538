"""Torsional elements: couplings between shafts, supports in the housing, drag, external torque, slip law."""

import sympy as sp

from .axes import THETA
from .base import Element, Output, Port, element_type, positive, real

ONE, TWO = (Port.numbered(number, (THETA,)) for number in (1, 2))
K, C = positive("k_t"), positive("c_t")
T, OMEGA_S = real("T"), real("omega_s")
T_B, OMEGA_B = positive("T_b"), positive("omega_b")


@element_type
def coupling(damped: bool) -> Element:
    """Write a torsional spring-damper between two members (Table 5's connections)."""
    twist, rate = ONE.theta - TWO.theta, ONE.omega - TWO.omega
    c = C if damped else sp.S.Zero
    torque = K * twist + c * rate
    return Element(
        title="shaft coupling",
        joins="coupling",
        ports=(ONE, TWO),
        parameters={K: "N*m/rad"} | ({C: "N*m*s/rad"} if damped else {}),
        potential=K * twist**2 / 2,
        dissipation=c * rate**2 / 2,
        wrench={(ONE, THETA): -torque, (TWO, THETA): torque},
        outputs={"torque": Output(torque, "N*m", "coupling_torque")},
        source="linear torsional spring-damper; stiffnesses: Wu et al. 2021 Table 5",
    )


@element_type
def torsional_support(damped: bool) -> Element:
    """Write a torsional spring-damper to the housing (Lin and Parker 1999, k_ru)."""
    c = C if damped else sp.S.Zero
    torque = -K * ONE.theta - c * ONE.omega
    return Element(
        title="torsional support",
        joins="support",
        ports=(ONE,),
        parameters={K: "N*m/rad"} | ({C: "N*m*s/rad"} if damped else {}),
        potential=K * ONE.theta**2 / 2,
        dissipation=c * ONE.omega**2 / 2,
        wrench={(ONE, THETA): torque},
        outputs={"torque": Output(torque, "N*m", "support_torque")},
        rates="absolute",
        source="Lin and Parker 1999, J. Vib. Acoust. 121:316",
    )


@element_type
def drag() -> Element:
    """Write the rotational viscous damping of a member, the c_B terms of eqs 31-34."""
    torque = -C * ONE.omega
    return Element(
        title="rotor drag",
        joins="",
        ports=(ONE,),
        parameters={C: "N*m*s/rad"},
        dissipation=C * ONE.omega**2 / 2,
        wrench={(ONE, THETA): torque},
        outputs={"torque": Output(torque, "N*m")},
        rates="absolute",
        source="Wu et al. 2021 eqs 31-34",
    )


@element_type
def external_torque() -> Element:
    """Write an external torque, T in eqs 31-38."""
    return Element(
        title="load torque",
        joins="load",
        ports=(ONE,),
        parameters={T: "N*m"},
        potential=-T * ONE.theta,
        wrench={(ONE, THETA): T},
        outputs={"torque": Output(T, "N*m", "load_torque")},
        load=True,
        source="Wu et al. 2021 eqs 31-38",
    )


@element_type
def slip_torque() -> Element:
    r"""Write the torque of an asynchronous machine by Kloss's formula.

    Slip over breakdown slip is :math:`z = (\omega - \omega_s)/\omega_b`, the breakdown slip speed
    :math:`\omega_b` being the share :math:`g_b` of :math:`|\omega_s|`, and

    .. math:: T = -\frac{2 T_b}{z + 1/z} = -2 T_b\,\frac{z}{1 + z^2} ,

    which brakes above the synchronous speed, in either direction. The stator's resistance is neglected, so braking and
    driving breakdown torques are equal. The dissipation function serves for the slope only: the torque is a load, and
    its power may be positive.
    """
    z = (ONE.omega - OMEGA_S) / OMEGA_B
    torque = -2 * T_B * z / (1 + z**2)
    return Element(
        title="slip law",
        joins="load",
        ports=(ONE,),
        parameters={OMEGA_S: "rad/s", OMEGA_B: "rad/s", T_B: "N*m"},
        dissipation=T_B * OMEGA_B * sp.log(1 + z**2),
        wrench={(ONE, THETA): torque},
        outputs={"torque": Output(torque, "N*m", "load_torque")},
        rates="absolute",
        load=True,
        source="Kloss's formula, in textbooks on electrical machines as T / T_b = 2 / (s / s_b + s_b / s)",
    )
