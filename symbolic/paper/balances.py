"""Equations 31 to 38 as printed: the balances of sun, ring, planet and carrier."""
# ruff: noqa: I001 - so many letters on few lines

from sympy import cos, sin

from .letters import (
    COULOMB_R, COULOMB_S, FRICTION_R, FRICTION_S, F_Cx, F_Cy, F_Rx, F_Ry, F_Sx, F_Sy, G_P, G_R, G_S, I_C, I_P, I_R,
    I_S, M_C, M_P, M_R, M_S, NORMAL_R, NORMAL_S, N_PR, N_PRx, N_PRy, N_PS, N_PSx, N_PSy, R_P, T_C, T_PRN, T_PRf,
    T_PSN, T_PSf, T_R, T_S, VISCOUS_R, VISCOUS_S, a_PR, a_PS, al_C, al_P, al_R, al_S, amg_R, amg_S, ax_C, ax_P, ax_R,
    ax_S, ay_C, ay_P, ay_R, ay_S, c_PB, c_PR, c_PS, c_RB, c_SB, d_PR, d_PR0, d_PS, d_PS0, f_PRx, f_PRy, f_PSx, f_PSy,
    gma_S, gpa_R, k_CPB, k_RB, k_SB, low_PR, low_PS, mu_PR, mu_PS, om_P, om_R, om_S, pin, r_Rb, r_Sb, share_R,
    share_S, sum_R, sum_S, u_x, u_y, v_PR, v_PS, x_C, x_P, x_R, x_S, y_C, y_P, y_R, y_S,
)  # fmt: skip
from .row import row


SUN = (
    row(31, "x_S", {
        "inertia": M_S * ax_S, "bearing": k_SB * x_S,
        NORMAL_S: -N_PSx, FRICTION_S: -f_PSx, "external": -F_Sx,
    }),
    row(31, "y_S", {
        "inertia": M_S * ay_S, "bearing": k_SB * y_S,
        NORMAL_S: -N_PSy, FRICTION_S: -f_PSy, "external": -F_Sy, "weight": -G_S,
    }),
    row(31, "theta_S", {
        "inertia": I_S * al_S, "damping": c_SB * om_S,
        NORMAL_S: -T_PSN, FRICTION_S: -T_PSf, "external": -T_S,
    }),
    row(32, "x_S", {
        "inertia": M_S * ax_S, "bearing": k_SB * x_S,
        NORMAL_S: N_PS * sin(gma_S), COULOMB_S: N_PS * mu_PS * cos(gma_S),
        VISCOUS_S: c_PS * d_PS * sum_S / low_PS * v_PS * cos(gma_S),
        "external": -F_Sx,
    }),
    row(32, "y_S", {
        "inertia": M_S * ay_S, "bearing": k_SB * y_S,
        NORMAL_S: N_PS * cos(gma_S), COULOMB_S: N_PS * mu_PS * sin(amg_S),
        VISCOUS_S: c_PS * d_PS0 * sum_S / low_PS * v_PS * cos(amg_S),
        "external": -F_Sy,
    }),
    row(32, "theta_S", {
        "inertia": I_S * al_S, "damping": c_SB * om_S,
        NORMAL_S: N_PS * r_Sb, COULOMB_S: -N_PS * mu_PS * share_S * d_PS * sin(a_PS),
        VISCOUS_S: -c_PS * share_S * d_PS0 * sum_S / low_PS * sin(a_PS) * d_PS,
        "external": -T_S,
    }),
)  # fmt: skip

RING = (
    row(33, "x_R", {
        "inertia": M_R * ax_R, "bearing": k_RB * x_R,
        NORMAL_R: -N_PRx, FRICTION_R: -f_PRx, "external": -F_Rx,
    }),
    row(33, "y_R", {
        "inertia": M_R * ay_R, "bearing": k_RB * y_R,
        NORMAL_R: -N_PRy, FRICTION_R: -f_PRy, "external": -F_Ry, "weight": -G_R,
    }),
    row(33, "theta_R", {
        "inertia": I_R * al_R, "damping": c_RB * om_R,
        NORMAL_R: -T_PRN, FRICTION_R: -T_PRf, "external": -T_R,
    }),
    row(34, "x_R", {
        "inertia": M_R * ax_R, "bearing": k_RB * x_R,
        NORMAL_R: N_PR * sin(gpa_R), COULOMB_R: N_PR * mu_PR * cos(gpa_R),
        VISCOUS_R: c_PR * d_PR * sum_R / low_PR * v_PR * cos(gpa_R),
        "external": -F_Rx,
    }),
    row(34, "y_R", {
        "inertia": M_R * ay_R, "bearing": k_RB * y_R,
        NORMAL_R: N_PR * cos(gpa_R), COULOMB_R: N_PR * mu_PR * sin(gpa_R),
        VISCOUS_R: c_PR * d_PR * sum_R / low_PR * v_PR * cos(amg_R),
        "external": -F_Ry, "weight": -G_R,
    }),
    row(34, "theta_R", {
        "inertia": I_R * al_R, "damping": c_SB * om_S,
        NORMAL_R: N_PR * r_Rb, COULOMB_R: N_PR * mu_PR * share_R * d_PR * sin(a_PR),
        VISCOUS_R: -c_PR * share_R * d_PR0 * sum_R / low_PR * sin(a_PR) * d_PR,
        "external": -T_R,
    }),
)  # fmt: skip

PLANET = (
    row(35, "x_P", {
        "inertia": M_P * ax_P, "pin": k_CPB * u_x,
        NORMAL_S: -N_PS * sin(gma_S), COULOMB_S: -N_PS * mu_PS * cos(gma_S),
        VISCOUS_S: -c_PS * d_PS0 * sum_S / low_PS * v_PS * cos(gma_S),
        NORMAL_R: -N_PR * sin(gpa_R), COULOMB_R: -N_PR * mu_PR * cos(gpa_R),
        VISCOUS_R: -c_PR * d_PR0 * sum_R / low_PR * v_PR * cos(gpa_R),
    }),
    row(36, "y_P", {
        "inertia": M_P * ay_P, "pin": k_CPB * u_y,
        NORMAL_S: -N_PS * cos(gma_S), COULOMB_S: -N_PS * mu_PS * sin(amg_S),
        VISCOUS_S: -c_PS * d_PS0 * sum_S / low_PS * v_PS * cos(amg_S),
        NORMAL_R: -N_PR * cos(gpa_R), COULOMB_R: -N_PR * mu_PR * sin(gpa_R),
        VISCOUS_R: c_PR * d_PR0 * sum_R / low_PR * v_PR * cos(amg_R),
        "weight": -G_P,
    }),
    row(37, "theta_P", {
        "inertia": I_P * al_P, "damping": c_PB * (om_P - om_R),
        NORMAL_S: -N_PS * r_Sb, COULOMB_S: N_PS * mu_PS * share_S * d_PS * sin(a_PS),
        VISCOUS_S: c_PS * share_S * d_PS0 * sum_S / low_PS * sin(a_PS) * d_PS,
        NORMAL_R: -N_PR * r_Rb, COULOMB_R: -N_PR * mu_PR * share_R * d_PR * sin(a_PR),
        VISCOUS_R: c_PR * share_R * d_PR0 * sum_R / low_PR * sin(a_PR) * d_PR,
    }),
)  # fmt: skip

CARRIER = (
    row(38, "x_C", {"inertia": M_C * ax_C, "pin": -k_CPB * u_x, "external": -F_Cx}),
    row(38, "y_C", {"inertia": M_C * ay_C, "pin": -k_CPB * u_y, "external": -F_Cy, "weight": -G_P}),
    row(38, "theta_C", {
        "inertia": I_C * al_C, "damping": c_PB * (om_R - om_P),
        "pin": k_CPB * (x_P - x_C - R_P * cos(pin) * (x_P - x_C))
        - k_CPB * (y_P - y_C - R_P * sin(pin) * (y_P - y_C)),
        "external": -T_C,
    }),
)  # fmt: skip

BALANCES = (*SUN, *RING, *PLANET, *CARRIER)
