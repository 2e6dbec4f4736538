"""Random states of a planetary set, by the names of the paper's symbols."""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Values = Mapping[str, Array]

STATES = 20
KIND = {"S": ("external", 1), "R": ("internal", -1)}
COMPONENTS = ("x", "y", "theta")


def random_values(size: float, directions: Mapping[str, int]) -> dict[str, Array]:
    """Draw states as name -> values, shape (20,).

    Parameters
    ----------
    size
        Relative size of the centre distance's change and of the tooth deflection.
    directions
        Mesh (S or R) -> +1 if the centres approach, -1 if they separate, 0 for some of each.
    """
    rng = np.random.default_rng(31)

    def draw(low: float = 0.5, high: float = 1.5) -> Array:
        return rng.uniform(low, high, STATES)

    plain = "M_S M_R M_P M_C I_S I_R I_P I_C k_SB k_RB k_CPB c_SB c_RB c_PB R_P mu_CPB d_CPB"
    signed = "F_Sx F_Sy T_S F_Rx F_Ry T_R F_Cx F_Cy T_C G_S G_R G_P G_C gamma_CP0"
    v = {name: draw() for name in plain.split()}
    v |= {name: draw(-2.0, 2.0) for name in signed.split()}
    for rate in ("", "'", "''"):
        v |= {f"{c}_{b}{rate}": draw(-2.0, 2.0) for c in COMPONENTS for b in "SRPC"}
    v |= {"r_Pb": draw(), "r_Sb": draw(0.5, 2.0), "r_Rb": draw(3.0, 5.0)}
    pitch = draw(10.0, 20.0)
    v |= {f"Z_{b}": v[f"r_{b}b"] * pitch for b in "SRP"}
    v["theta_C + gamma_CP0"] = v["theta_C"] + v["gamma_CP0"]
    for b, (_, sigma) in KIND.items():
        place_gear(v, b, sigma, size, directions[b], draw)
        name_components(v, b, sigma)
    name_pin(v)
    return v | phase_values(rng)


def place_gear(
    v: dict[str, Array], b: str, sigma: int, size: float, direction: int, draw: Callable[..., Array]
) -> None:
    """Place sun or ring against the planet: nearly at its centre distance, loaded, rolling."""
    m, base, planet = f"P{b}", v[f"r_{b}b"], v["r_Pb"]
    c = base + sigma * planet
    d0 = c / np.cos(draw(0.3, 0.45))
    d, gamma, turn = d0 * (1 + size * draw(-1.0, 1.0)), draw(-3.0, 3.0), draw(-0.4, 0.4)
    cos, sin, alpha = np.cos(gamma), np.sin(gamma), np.arccos(c / d)
    sign = -float(direction) if direction else np.where(np.arange(STATES) % 2, 1.0, -1.0)
    rate, swing = sign * draw(), draw(-1.0, 1.0)
    v[f"x_{b}"], v[f"y_{b}"] = v["x_P"] - d * cos, v["y_P"] - d * sin
    v[f"x_{b}'"] = v["x_P'"] - rate * cos + swing * d * sin
    v[f"y_{b}'"] = v["y_P'"] - rate * sin - swing * d * cos
    v[f"theta_{b}'"] = swing - sigma * planet * (v["theta_P'"] - swing) / base
    roll = size * planet * draw(5.0, 10.0)
    v[f"theta_{b}"] = turn + (roll - sigma * planet * (v["theta_P"] - turn)) / base
    v |= {f"d_{m}": d, f"d_{m}0": d0, f"d_{m}'": rate, f"alpha_{m}": alpha, f"Delta_gamma_{m}": turn}
    v |= {f"gamma_{m}": gamma, f"mu_{m}": draw(0.05, 0.2), f"c_{m}": draw(), f"k_{m}": draw(50.0, 90.0)}
    v[f"gamma_{b}P - alpha_{b}P"] = gamma - alpha
    v[f"alpha_{b}P - gamma_{b}P"] = alpha - gamma
    v[f"gamma_{b}P + alpha_{b}P"] = gamma + alpha
    v[f"N_{m}"] = -sigma * v[f"k_{m}"] * ((d - d0) * np.sin(alpha) - sigma * planet * np.tan(roll / planet))
    v[f"delta_t_{m}'"] = -d0 * c / d**2 * rate
    v[f"sgn(delta_t_{m}')"] = np.sign(v[f"delta_t_{m}'"])
    v |= {f"Delta_theta_{m}": sigma * roll / planet, f"theta_P,{m}": v["theta_P"] - sigma * roll / planet}
    v |= {f"r_P,{m}": d * planet / c, f"gamma_{b}P": gamma}


def name_components(v: dict[str, Array], b: str, sigma: int) -> None:
    """Resolve what rows 31 and 33 only name: forces on sun or ring along eqs 13, 15, 26, 28.

    Torques are moments of these forces at the pitch point; friction has the size and the direction that
    the derivation gives it, so that these rows are judged by their signs and arms.
    """
    m = f"P{b}"
    along = v[f"gamma_{m}"] - sigma * v[f"alpha_{m}"]
    arm = v[f"d_{m}"] * v[f"r_{b}b"] / (v[f"r_{b}b"] + sigma * v["r_Pb"])
    ax, ay = arm * np.cos(v[f"gamma_{m}"]), arm * np.sin(v[f"gamma_{m}"])
    slide = v[f"d_{m}'"]
    friction = -v[f"mu_{m}"] * v[f"N_{m}"] * np.sign(slide) - v[f"c_{m}"] * slide * np.cos(v[f"alpha_{m}"])
    for name, size, beta in (("N", v[f"N_{m}"], np.pi / 2 + along), ("f", friction, along)):
        fx, fy = -size * np.cos(beta), -size * np.sin(beta)
        v |= {f"{name}_{m}x": fx, f"{name}_{m}y": fy, f"T_{m}{name}": ax * fy - ay * fx}


def name_pin(v: dict[str, Array]) -> None:
    """Name what eq 30 takes from eq 29, there and in rows 37 and 38 by other letters for one damping."""
    angle = v["theta_C + gamma_CP0"]
    for c, turned in (("x", np.cos(angle)), ("y", np.sin(angle))):
        v[f"delta_CP{c}"] = v[f"{c}_P"] - v[f"{c}_C"] - v["R_P"] * turned
        v[f"F_CP{c}"] = -v["k_CPB"] * v[f"delta_CP{c}"]
    v["delta_CPtheta'"] = v["theta_P'"] - v["theta_C'"]
    v |= {"sgn(delta_CPtheta')": np.sign(v["delta_CPtheta'"]), "c_CPB": v["c_PB"]}


def phase_values(rng: np.random.Generator) -> dict[str, Array]:
    """Draw planet counters short of a whole tooth, and the phase that their place round the sun gives.

    Contact ratios lie between one and two, and phases of the mesh within a pitch.
    """
    n = rng.integers(3, 7, STATES)
    rest = rng.integers(1, n)
    teeth = n * rng.integers(5, 20, STATES) + rest
    i = 1 + rng.integers(0, (n - 1) // rest + 1)
    pitch = 2 * np.pi / teeth
    phase = (i - 1) * teeth % n / n * pitch
    values = {"n": n, "i": i, "phi_S0": (teeth / n - teeth // n) * pitch, "phi_i": phase}
    values |= {"theta_T": pitch, "theta": pitch * rng.uniform(0.0, 1.0, STATES), "k": rng.uniform(0.5, 1.5, STATES)}
    values |= {"epsilon": rng.uniform(1.1, 1.9, STATES), "xi": rng.uniform(1.2, 1.8, STATES)}
    return {name: np.asarray(value, dtype=np.float64) for name, value in values.items()}
