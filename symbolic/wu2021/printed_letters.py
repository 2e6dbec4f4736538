"""Symbols of the paper, by their printed names."""
# ruff: noqa: N816 - the paper's letters

import sympy as sp
from sympy import cos, sin


def real(names: str) -> tuple[sp.Symbol, ...]:
    """Make the real symbols of a blank-separated list of names."""
    return tuple(sp.Symbol(name, real=True) for name in names.split())


def lower(name: str) -> sp.Symbol:
    """Make the symbol of a centre distance below a fraction bar, kept apart so that d/d stays as printed."""
    return sp.Symbol(name, positive=True)


def angle(name: str) -> sp.Symbol:
    """Make one symbol of a sum of angles, so that SymPy does not turn its sign round."""
    return sp.Symbol(name, real=True)


x_S, y_S, x_R, y_R, x_P, y_P, x_C, y_C = real("x_S y_S x_R y_R x_P y_P x_C y_C")
th_S, th_R, th_P, th_C = real("theta_S theta_R theta_P theta_C")
om_S, om_R, om_P, om_C = real("theta_S' theta_R' theta_P' theta_C'")
ax_S, ay_S, al_S, ax_R, ay_R, al_R = real("x_S'' y_S'' theta_S'' x_R'' y_R'' theta_R''")
ax_P, ay_P, al_P, ax_C, ay_C, al_C = real("x_P'' y_P'' theta_P'' x_C'' y_C'' theta_C''")
M_S, M_R, M_P, M_C, I_S, I_R, I_P, I_C = real("M_S M_R M_P M_C I_S I_R I_P I_C")
F_Sx, F_Sy, T_S, F_Rx, F_Ry, T_R, F_Cx, F_Cy, T_C = real("F_Sx F_Sy T_S F_Rx F_Ry T_R F_Cx F_Cy T_C")
G_S, G_R, G_P, G_C = real("G_S G_R G_P G_C")
k_SB, k_RB, k_CPB, c_SB, c_RB, c_PB = real("k_SB k_RB k_CPB c_SB c_RB c_PB")
R_P, gamma_CP0, Z_S, Z_R, Z_P = real("R_P gamma_CP0 Z_S Z_R Z_P")
r_Sb, r_Rb, r_Pb = real("r_Sb r_Rb r_Pb")

N_PS, k_PS, mu_PS, c_PS, d_PS, d_PS0, v_PS = real("N_PS k_PS mu_PS c_PS d_PS d_PS0 d_PS'")
N_PR, k_PR, mu_PR, c_PR, d_PR, d_PR0, v_PR = real("N_PR k_PR mu_PR c_PR d_PR d_PR0 d_PR'")
a_PS, a_PR, turn_PS, turn_PR = real("alpha_PS alpha_PR Delta_gamma_PS Delta_gamma_PR")
u_PS, sgn_PS, u_PR, sgn_PR = real("delta_t_PS' sgn(delta_t_PS') delta_t_PR' sgn(delta_t_PR')")
low_PS, low_PR = lower("d_PS"), lower("d_PR")
gma_S, amg_S, gpa_S = map(angle, ("gamma_SP - alpha_SP", "alpha_SP - gamma_SP", "gamma_SP + alpha_SP"))
gma_R, amg_R, gpa_R = map(angle, ("gamma_RP - alpha_RP", "alpha_RP - gamma_RP", "gamma_RP + alpha_RP"))
phi_S0, counter_i, counter_n = real("phi_S0 i n")
gamma_PS, gamma_PR, gamma_SP = real("gamma_PS gamma_PR gamma_SP")
ideal_PS, ideal_PR = real("theta_P,PS theta_P,PR")
off_PS, off_PR, r_PS, r_PR = real("Delta_theta_PS Delta_theta_PR r_P,PS r_P,PR")
theta, theta_T, epsilon, xi, k = real("theta theta_T epsilon xi k")
c_CPB, mu_CPB, d_CPB, u_CP, sgn_CP = real("c_CPB mu_CPB d_CPB delta_CPtheta' sgn(delta_CPtheta')")
delta_CPx, delta_CPy, F_CPx, F_CPy = real("delta_CPx delta_CPy F_CPx F_CPy")

N_PSx, f_PSx, N_PSy, f_PSy, T_PSN, T_PSf = real("N_PSx f_PSx N_PSy f_PSy T_PSN T_PSf")
N_PRx, f_PRx, N_PRy, f_PRy, T_PRN, T_PRf = real("N_PRx f_PRx N_PRy f_PRy T_PRN T_PRf")

pin = angle("theta_C + gamma_CP0")
u_x, u_y = x_P - x_C - R_P * cos(pin), y_P - y_C - R_P * sin(pin)
sum_S, sum_R = r_Pb + r_Sb, r_Pb + r_Rb
share_S, share_R = Z_S / (Z_S + Z_P), Z_R / (Z_R + Z_P)

NORMAL_S, COULOMB_S, VISCOUS_S = "normal force S-P", "Coulomb friction S-P", "viscous friction S-P"
NORMAL_R, COULOMB_R, VISCOUS_R = "normal force R-P", "Coulomb friction R-P", "viscous friction R-P"
FRICTION_S, FRICTION_R = "friction S-P", "friction R-P"
COULOMB_C, VISCOUS_C = "Coulomb friction C-P", "viscous friction C-P"
