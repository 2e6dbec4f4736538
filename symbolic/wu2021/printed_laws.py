"""Equations 1 to 30 as printed: angles, deflections, stiffness, forces; and the exact law."""
# ruff: noqa: I001 - so many letters on few lines

from collections.abc import Mapping
from types import MappingProxyType

import sympy as sp
from sympy import cos, sin

from .printed_letters import (
    COULOMB_C,
    COULOMB_R,
    COULOMB_S,
    F_CPx,
    F_CPy,
    NORMAL_R,
    NORMAL_S,
    N_PR,
    N_PS,
    R_P,
    VISCOUS_C,
    VISCOUS_R,
    VISCOUS_S,
    Z_P,
    Z_R,
    Z_S,
    a_PR,
    a_PS,
    c_CPB,
    c_PR,
    c_PS,
    counter_i,
    counter_n,
    d_CPB,
    d_PR,
    d_PR0,
    d_PS,
    d_PS0,
    delta_CPx,
    delta_CPy,
    epsilon,
    gamma_PR,
    gamma_SP,
    gma_S,
    gpa_R,
    ideal_PR,
    ideal_PS,
    k,
    k_CPB,
    k_PR,
    k_PS,
    mu_CPB,
    mu_PR,
    mu_PS,
    off_PR,
    off_PS,
    phi_S0,
    pin,
    r_PR,
    r_PS,
    r_Pb,
    r_Rb,
    r_Sb,
    sgn_CP,
    sgn_PR,
    sgn_PS,
    sum_S,
    th_P,
    th_R,
    th_S,
    theta,
    theta_T,
    turn_PR,
    turn_PS,
    u_CP,
    u_PR,
    u_PS,
    x_C,
    x_P,
    x_R,
    x_S,
    xi,
    y_C,
    y_P,
    y_R,
    y_S,
)
from .printed_row import row


TURNING = (
    # Three coordinates of each of R, S and C, and of n planets.
    row(1, "coordinates", {"number": sp.Integer(9) + 3 * counter_n}, definition=True),
    row(2, "rolling_S", {"deflection": (th_P - turn_PS) * Z_P + (th_S - turn_PS) * Z_S}),
    row(2, "gamma_PS", {"angle": sp.atan((y_P - y_S) / (x_P - x_S))}, definition=True),
    row(3, "theta_P,PS", {"ideal": -(th_S - turn_PS) * Z_S / Z_P + turn_PS}, definition=True),
    row(4, "Delta_theta_PS", {"difference": th_P - ideal_PS}, definition=True),
    row(16, "d_PR", {"length": sp.sqrt((x_P - x_R) ** 2 + (y_P - y_R) ** 2)}, definition=True),
    row(17, "gamma_PR", {"angle": sp.atan((y_P - y_R) / (x_P - x_R))}, definition=True),
    row(18, "rolling_R", {"deflection": (th_P - turn_PR) * Z_P - (th_R - turn_PR) * Z_R}),
    row(19, "theta_P,PR", {"ideal": (th_R - turn_PR) * Z_R / Z_P + turn_PR}, definition=True),
    row(20, "Delta_theta_PR", {"difference": th_P - ideal_PR}, definition=True),
)

DEFLECTIONS = (
    row(5, "delta_theta_n,PS", {"deflection": r_PS * sp.tan(off_PS) * cos(a_PS)}, definition=True),
    row(5, "r_P,PS", {"length": d_PS * Z_P / (Z_S + Z_P)}, definition=True),
    row(5, "d_PS", {"length": ((x_P - x_S) ** 2 + (y_P - y_S) ** 2) ** sp.Rational(1, 2)}, definition=True),
    row(5, "alpha_PS", {"pressure": sp.acos(sum_S / d_PS)}, definition=True),
    row(6, "delta_dn,PS", {"deflection": -(d_PS - d_PS0) * sin(a_PS)}, definition=True),
    row(7, "delta_n,PS", {
        "deflection": r_PS * sp.tan(off_PS) * cos(a_PS) - (d_PS - d_PS0) * sin(a_PS),
    }, definition=True),
    row(8, "delta_t_PS", {"deflection": -(d_PS - d_PS0) * cos(a_PS)}, definition=True),
    row(21, "delta_theta_n,PR", {"deflection": -r_PR * sp.tan(off_PR) * cos(a_PR)}, definition=True),
    row(21, "r_P,PR", {"length": d_PR * Z_P / (Z_R - Z_P)}, definition=True),
    row(22, "delta_dn,PR", {"deflection": (d_PR - d_PR0) * sin(a_PR)}, definition=True),
    row(23, "delta_n,PR", {
        "deflection": -r_PR * sp.tan(off_PR) * cos(a_PR) + (d_PR - d_PR0) * sin(a_PR),
    }, definition=True),
    row(24, "delta_t_PR", {"deflection": -(d_PR - d_PR0) * cos(a_PR)}, definition=True),
)  # fmt: skip

START, SINGLE = (counter_i - 1) * phi_S0, (2 - epsilon) * theta_T
STIFFNESS = (
    row(9, "k_PS", {"stiffness": sp.Piecewise(
        (k, sp.And(theta >= 0, theta <= SINGLE)), (xi * k, sp.And(theta > SINGLE, theta <= theta_T)),
    )}, definition=True),
    row(10, "phi_i", {"phase": (counter_n - 1) * phi_S0}, definition=True),
    row(10, "phi_S0", {"phase": (Z_S / counter_n - sp.floor(Z_S / counter_n)) * (2 * sp.pi / Z_S)}, definition=True),
    row(11, "k_PS,i", {"stiffness": sp.Piecewise(
        (k, sp.And(theta >= START, theta <= START + SINGLE)),
        (xi * k, sp.Or(sp.And(theta > 0, theta < START), sp.And(theta > START + SINGLE, theta <= theta_T))),
    )}, definition=True),
)  # fmt: skip

# Eqs 12 and 25: deflection times stiffness; 13 and 26: its direction; 14 and 27: friction along eqs 15, 28.
FORCES = (
    row(12, "N_SP", {"deflection": k_PS * (
        Z_P * sum_S / (Z_S + Z_P)
        * sp.tan(th_P + Z_S / Z_P * th_S - (Z_S + Z_P) / Z_P * turn_PS)
        - (d_PS - d_PS0) * sin(a_PS)
    )}, definition=True),
    row(13, "N_SPx", {NORMAL_S: N_PS * cos(sp.pi / 2 + gma_S)}, definition=True),
    row(13, "N_SPy", {NORMAL_S: N_PS * sin(sp.pi / 2 + gma_S)}, definition=True),
    row(14, "f_SP", {COULOMB_S: mu_PS * N_PS * sgn_PS, VISCOUS_S: c_PS * u_PS * sgn_PS}, definition=True),
    row(15, "beta_SPf", {"angle": gamma_SP - a_PS}, definition=True),
    row(25, "N_RP", {"deflection": k_PR * (
        -Z_P * (r_Rb - r_Pb) / (Z_R - Z_P)
        * sp.tan(th_P - Z_R / Z_P * th_R + (Z_R - Z_P) / Z_P * turn_PR)
        + (d_PR - d_PR0) * sin(a_PR)
    )}, definition=True),
    row(26, "N_RPx", {NORMAL_R: N_PR * cos(sp.pi / 2 + gpa_R)}, definition=True),
    row(26, "N_RPy", {NORMAL_R: N_PR * sin(sp.pi / 2 + gpa_R)}, definition=True),
    row(27, "f_RP", {COULOMB_R: mu_PR * N_PR * sgn_PR, VISCOUS_R: c_PR * u_PR * sgn_PR}, definition=True),
    row(28, "beta_RPf", {"angle": sp.pi + gamma_PR + a_PR}, definition=True),
    row(29, "delta_CPx", {"deflection": x_P - x_C - R_P * cos(pin)}, definition=True),
    row(29, "delta_CPy", {"deflection": y_P - y_C - R_P * cos(pin)}, definition=True),
    row(30, "F_CPx", {"pin": -k_CPB * delta_CPx}, definition=True),
    row(30, "F_CPy", {"pin": -k_CPB * delta_CPy}, definition=True),
    row(30, "T_CPz", {
        COULOMB_C: -mu_CPB * sp.sqrt(F_CPx**2 + F_CPy**2) * d_CPB / 2 * sgn_CP, VISCOUS_C: -c_CPB * u_CP * sgn_CP,
    }, definition=True),
)  # fmt: skip

LAWS = tuple(sorted((*TURNING, *DEFLECTIONS, *STIFFNESS, *FORCES), key=lambda item: item.equation))

SLACK_S = -(r_Sb + r_Pb) * (
    sp.tan(a_PS) - a_PS - sp.tan(sp.acos((r_Sb + r_Pb) / d_PS0)) + sp.acos((r_Sb + r_Pb) / d_PS0)
)
SLACK_R = (r_Rb - r_Pb) * (
    sp.tan(a_PR) - a_PR - sp.tan(sp.acos((r_Rb - r_Pb) / d_PR0)) + sp.acos((r_Rb - r_Pb) / d_PR0)
)
EXACT: Mapping[str, sp.Expr] = MappingProxyType({
    "N_SP": k_PS * (r_Sb * (th_S - turn_PS) + r_Pb * (th_P - turn_PS) + SLACK_S),
    "N_RP": k_PR * (r_Rb * (th_R - turn_PR) - r_Pb * (th_P - turn_PR) + SLACK_R),
    "delta_theta_n,PS": r_Pb * off_PS, "delta_theta_n,PR": -r_Pb * off_PR,
    "delta_dn,PS": SLACK_S, "delta_dn,PR": SLACK_R,
    "delta_n,PS": r_Pb * off_PS + SLACK_S, "delta_n,PR": -r_Pb * off_PR + SLACK_R,
    "delta_t_PS": -(r_Sb + r_Pb) * sp.log(d_PS / d_PS0), "delta_t_PR": -(r_Rb - r_Pb) * sp.log(d_PR / d_PR0),
})  # fmt: skip
"""The exact involute law in the paper's symbols, for the rows that are correct to first order only."""
