"""Letters of the equations: how each symbol is written in TeX, and what it means."""

from collections.abc import Mapping
from types import MappingProxyType

Letter = tuple[str, str]

_PORTS: dict[str, Letter] = {
    name.format(i): (tex.replace("#", str(i)), f"{meaning} {i}")
    for i in (1, 2, 3)
    for name, tex, meaning in (
        ("x_{}", "x_{#}", "place along x of body"),
        ("y_{}", "y_{#}", "place along y of body"),
        ("theta_{}", r"\theta_{#}", "angle of body"),
        ("vx_{}", r"\dot{x}_{#}", "rate of the place along x of body"),
        ("vy_{}", r"\dot{y}_{#}", "rate of the place along y of body"),
        ("omega_{}", r"\dot{\theta}_{#}", "rate of the angle of body"),
    )
}

_PARAMETERS: dict[str, Letter] = {
    "k": ("k", "stiffness"),
    "k_1": ("k_{1}", "stiffness with one pair of teeth in contact"),
    "k_2": ("k_{2}", "stiffness with two pairs of teeth in contact"),
    "k_d": ("k'", "slope of the stiffness over the mesh phase"),
    "c": ("c", "damping"),
    "k_t": ("k_{t}", "torsional stiffness"),
    "c_t": ("c_{t}", "torsional damping"),
    "x_0": ("x_{0}", "nominal place along x"),
    "y_0": ("y_{0}", "nominal place along y"),
    "r_1": ("r_{1}", "base radius of gear 1, which is r_Sb or r_Rb in the paper"),
    "r_2": ("r_{2}", "base radius of gear 2, which is r_Pb in the paper"),
    "s": ("s", "flank in contact: 1 the printed one, -1 the other"),
    "e_x": ("e_{x}", "x of the nominal line of centres"),
    "e_y": ("e_{y}", "y of the nominal line of centres"),
    "d_0": ("d_{0}", "nominal centre distance"),
    "inv_0": (r"\operatorname{inv}\alpha_{0}", "involute of the nominal operating pressure angle"),
    "Delta_gamma_0": (r"\Delta\gamma_{0}", "angle by which the basis has turned"),
    "level": (r"\lambda", "0 with one pair of teeth in contact, 1 with two"),
    "gap": ("j", "backlash along the line of action"),
    "pull": ("p", "0 in every run; parted teeth pull while the equilibrium is sought"),
    "hold": (r"\eta", "0, or beyond all others while a side of a border is held"),
    "e": ("e", "error of the teeth"),
    "e_d": (r"\dot{e}", "rate of the error"),
    "z_1": ("z_{1}", "teeth of gear 1, negative where it turns clockwise"),
    "tau": (r"\tau", "mesh phase in tooth pitches"),
    "varsigma": (r"\varsigma", "part of a pitch with one pair in contact"),
    "xi_m": (r"\xi_{m}", "middle of the path of contact, from the pitch point"),
    "mu": (r"\mu", "coefficient of friction"),
    "v_0": ("v_{0}", "sliding speed at which friction has nearly its full size"),
    "d_b": ("d_{b}", "diameter of the pin"),
    "c_r": ("c_{r}", "damping of the rotation"),
    "omega_0": (r"\omega_{0}", "speed at which friction has nearly its full size"),
    "F_0": ("F_{0}", "small force that keeps the root off zero"),
    "clearance": ("c_{0}", "radial clearance"),
    "closing": (r"\kappa", "0 in every run; closes the clearance while the equilibrium is sought"),
    "epsilon": (r"\epsilon", "small length that keeps the root off zero"),
    "m": ("m", "mass"),
    "I": ("I", "moment of inertia"),
    "alpha": (r"\alpha", "Rayleigh factor of mass"),
    "g_x": ("g_{x}", "gravity along x"),
    "g_y": ("g_{y}", "gravity along y"),
    "beta": (r"\beta", "angle of the basis"),
    "T": ("T", "torque"),
    "T_b": ("T_{b}", "breakdown torque"),
    "omega_s": (r"\omega_{s}", "synchronous speed"),
    "omega_b": (r"\omega_{b}", "breakdown slip speed"),
}

_STEPS: dict[str, Letter] = {
    "Delta_x": (r"\Delta x", "body 2 from body 1, along x"),
    "Delta_y": (r"\Delta y", "body 2 from body 1, along y"),
    "d": ("d", "centre distance"),
    "r_sum": (r"r_{\Sigma}", "d cos of the pressure angle"),
    "h": ("h", "d sin of the pressure angle"),
    "alpha_w": (r"\alpha", "operating pressure angle"),
    "Delta_gamma": (r"\Delta\gamma", "turn of the line of centres"),
    "w": ("w", "rolling deflection"),
    "psi": (r"\psi", "angle of gear 1 from the line of centres"),
    "n_x": ("n_{x}", "x of the line of action, towards body 2"),
    "n_y": ("n_{y}", "y of the line of action, towards body 2"),
    "m_x": ("m_{x}", "x of the sliding direction"),
    "m_y": ("m_{y}", "y of the sliding direction"),
    "delta": (r"\delta", "deflection along the line of action"),
    "delta_d": (r"\dot{\delta}", "rate of the deflection"),
    "g_b": ("g", "border: teeth push, or a race is reached, where it is positive"),
    "chi": (r"\chi", "1 in contact, else 0"),
    "chi_0": (r"\chi_{0}", "1 where teeth touch without a push, else 0"),
    "N": ("N", "normal force"),
    "v_t": ("v_{t}", "sliding speed at the pitch point"),
    "F": ("F", "friction force"),
    "g": ("q", "phase from the middle of single contact, wrapped"),
    "w_A": ("w_{A}", "load of the leading pair over that of the mesh"),
    "xi_A": (r"\xi_{A}", "place of the leading pair"),
    "xi_B": (r"\xi_{B}", "place of the other pair"),
    "v_A": ("v_{A}", "sliding speed of the leading pair"),
    "v_B": ("v_{B}", "sliding speed of the other pair"),
    "a_x": ("a_{x}", "arm from the carrier to the pin, along x"),
    "a_y": ("a_{y}", "arm from the carrier to the pin, along y"),
    "u_x": ("u_{x}", "displacement along x"),
    "u_y": ("u_{y}", "displacement along y"),
    "w_x": ("w_{x}", "speed against the turning carrier, along x"),
    "w_y": ("w_{y}", "speed against the turning carrier, along y"),
    "r_u": ("r", "length of the displacement"),
    "omega_r": (r"\omega_{r}", "speed of the planet against the carrier"),
    "F_n": ("F_{n}", "load of the bearing"),
    "z": ("z", "slip over breakdown slip"),
}

_MOTION: dict[str, Letter] = {
    "x": ("x", "displacement along x in the frame"),
    "y": ("y", "displacement along y in the frame"),
    "u": ("u", "deviation of the angle from the rigid motion"),
    "v_x": (r"\dot{x}", "its rate"),
    "v_y": (r"\dot{y}", "its rate"),
    "u_d": (r"\dot{u}", "its rate"),
    "x_dd": (r"\ddot{x}", "acceleration in the frame, along x"),
    "y_dd": (r"\ddot{y}", "acceleration in the frame, along y"),
    "u_dd": (r"\ddot{u}", "acceleration of the deviation"),
    "phi": (r"\varphi", "reference angle of the rigid motion"),
    "phi_d": (r"\dot{\varphi}", "reference speed"),
    "phi_dd": (r"\ddot{\varphi}", "acceleration of the reference"),
    "rho": (r"\rho", "speed of a member over the reference speed"),
    "rho_C": (r"\rho_{C}", "speed of the frame over the reference speed"),
    "beta_0": (r"\beta_{0}", "angle at the start"),
    "psi_b": (r"\psi", "angle by which a member has turned in its frame"),
    "psi_d": (r"\dot{\psi}", "its rate"),
    "X": ("X", "place in the frame, along x"),
    "Y": ("Y", "place in the frame, along y"),
    "V_x": (r"\dot{X}", "its rate"),
    "V_y": (r"\dot{Y}", "its rate"),
    "F_x": ("F_{x}", "force along x"),
    "F_y": ("F_{y}", "force along y"),
    "S_x": ("S_{x}", "mass times offset, along x, at angle zero"),
    "S_y": ("S_{y}", "mass times offset, along y, at angle zero"),
    "s_x": ("s_{x}", "mass times offset, along x, in the frame"),
    "s_y": ("s_{y}", "mass times offset, along y, in the frame"),
    "Omega": (r"\Omega", "speed against the ground"),
    "Omega_d": (r"\dot{\Omega}", "its rate"),
    "nu": (r"\nu", "tooth pitches a radian of the reference angle"),
    "tau_0": (r"\tau_{0}", "phase at the start"),
    "a": ("a", "amplitude of a cosine"),
    "b": ("b", "amplitude of a sine"),
    "n": ("n", "order"),
    "H": ("H", "number of orders"),
    "k_mean": (r"\bar{k}", "mean"),
    "width": ("b", "length of the transition in pitches"),
    "size": ("e_{0}", "error of the tooth"),
    "tooth": ("i", "number of the tooth"),
    "teeth": ("Z", "teeth of the gear"),
    "value": ("e_{c}", "constant part"),
    "W": (r"\mathbf{W}", "wrench: force and torque"),
    "zeta": (r"\zeta", "variable of integration"),
    "q_1": ("q_{1}", "phase from the middle of single contact, wrapped"),
    "q_2": ("q_{2}", "phase from the middle of double contact, wrapped"),
    **{f"c_{i}": (f"c_{{{i}}}", f"coefficient {i} of the parabola of single contact") for i in range(3)},
    **{f"c_{i}'": (f"c'_{{{i}}}", f"coefficient {i} of the parabola of double contact") for i in range(3)},
}

LETTERS: Mapping[str, Letter] = MappingProxyType({**_PORTS, **_PARAMETERS, **_STEPS, **_MOTION})
"""Name of a symbol -> how it is written, and its meaning. A tag after ``@`` or ``#`` tells body or element."""

ORDER: tuple[frozenset[str], ...] = (
    frozenset({"N", "F", "c", "k", "k_t", "c_t", "m", "I", "mu", "rho", "rho_C", "r_1", "r_2", "alpha", "nu"}),
    frozenset(_PARAMETERS),
    frozenset({"beta_0", "tau_0", "size", "width", "S_x", "S_y", "s_x", "s_y", "F_x", "F_y", "a_x", "a_y"}),
    frozenset(_STEPS),
)
"""Order of factors in a product: forces and numbers first, coordinates last."""

ABSOLUTE: Mapping[str, Letter] = MappingProxyType({
    name.format(i): (tex.replace("#", str(i)), f"{meaning} {i}")
    for i in (1, 2, 3)
    for name, tex, meaning in (
        ("vx_{}", "v_{x#}", "velocity against the ground, along x of the basis, of body"),
        ("vy_{}", "v_{y#}", "velocity against the ground, along y of the basis, of body"),
        ("omega_{}", r"\omega_{#}", "speed against the ground of body"),
    )
})  # fmt: skip
"""Letters of the rates in elements with velocities relative to the ground."""

PECULIAR: Mapping[tuple[str, str], Letter] = MappingProxyType({
    ("mesh_friction", "c_t"): ("c_{t}", "damping of the sliding"),
    ("pin_clearance", "c"): ("c", "damping in contact"),
    ("ground_clearance", "c"): ("c", "damping in contact"),
    ("external_torque", "T"): ("T", "torque given from outside, a number or a table over time"),
})  # fmt: skip
"""(Element, name) -> letter, where an element gives a name a meaning of its own."""
