"""Printed rows of the paper: their text is what the page says."""

from ltcgear.symbolic.wu2021 import ROWS

BY_KEY = {(row.equation, row.label): row for row in ROWS}


def test_printed_text_shows_what_was_printed() -> None:
    assert BY_KEY[38, "y_C"].printed == ("M_C*y_C'' - k_CPB*(y_P - y_C - R_P*sin(theta_C + gamma_CP0)) = F_Cy + G_P")
    assert BY_KEY[32, "x_S"].printed.endswith("*cos(gamma_SP - alpha_SP)/d_PS = F_Sx")
