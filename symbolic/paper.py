r"""Transcription: the printed equations of motion of Wu et al. 2021, misprints included.

One representative planet stands for the sum over i. A prime is a time derivative, so ``d_PS'`` is the
printed :math:`\dot d_{PS}^i`. Every row is kept as term groups whose sum is lhs - rhs = 0; products with a
bracket are written out, nothing else is rearranged. Indices mixed by the paper stay mixed.

The source is a machine-read text of the paper. Two readings are marked here because a reader of the
journal's page may see more: the torque rows 32, 34, 37 have a centre distance where its rate belongs (a
dot may have been lost in reading), and row 32 repeats that factor six times (read once).
"""
# ruff: noqa: N816 - the paper's letters

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

import numpy as np
import sympy as sp
from sympy import cos, sin

RIGHT = ("external", "weight")
"""Term groups that the paper prints right of the equals sign."""


@dataclass(frozen=True)
class Row:
    """One printed scalar equation.

    Attributes
    ----------
    equation
        Number in the paper.
    label
        Coordinate whose balance it is (``x_S``), or the quantity that it defines (``f_SP``).
    terms
        Term group -> expression; their sum is lhs - rhs of a balance, or the right side of a definition.
    definition
        Whether the row defines a quantity rather than balancing forces.
    """

    equation: int
    label: str
    terms: Mapping[str, sp.Expr]
    definition: bool = False

    @property
    def printed(self) -> str:
        """Return the row as text."""
        return text(self.terms, self.label if self.definition else "")

    def with_term(self, group: str, expression: sp.Expr) -> "Row":
        """Return the row with one term group replaced (to corrupt or to repair it)."""
        return replace(self, terms=MappingProxyType({**self.terms, group: expression}))


def text(terms: Mapping[str, sp.Expr], defined: str = "") -> str:
    """Write term groups as one line, in their order; ``defined`` names the left side of a definition."""
    sides: dict[bool, str] = {False: "", True: ""}
    for group, term in terms.items():
        right = group in RIGHT and not defined
        part = sp.sstr(-term if right else term, order="none")
        sides[right] += (" - " + part[1:]) if part.startswith("-") else (" + " + part)
    left, right_side = (side.removeprefix(" + ").lstrip() for side in sides.values())
    return f"{defined} = {left}" if defined else f"{left} = {right_side or '0'}"


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

N_PSx, f_PSx, N_PSy, f_PSy, T_PSN, T_PSf = real("N_PSx f_PSx N_PSy f_PSy T_PSN T_PSf")
N_PRx, f_PRx, N_PRy, f_PRy, T_PRN, T_PRf = real("N_PRx f_PRx N_PRy f_PRy T_PRN T_PRf")

pin = angle("theta_C + gamma_CP0")
u_x, u_y = x_P - x_C - R_P * cos(pin), y_P - y_C - R_P * sin(pin)
sum_S, sum_R = r_Pb + r_Sb, r_Pb + r_Rb
share_S, share_R = Z_S / (Z_S + Z_P), Z_R / (Z_R + Z_P)

NORMAL_S, COULOMB_S, VISCOUS_S = "normal force S-P", "Coulomb friction S-P", "viscous friction S-P"
NORMAL_R, COULOMB_R, VISCOUS_R = "normal force R-P", "Coulomb friction R-P", "viscous friction R-P"
FRICTION_S, FRICTION_R = "friction S-P", "friction R-P"


FUNCTIONS: Mapping[Any, Callable[..., Any]] = {
    sp.sin: np.sin,
    sp.cos: np.cos,
    sp.tan: np.tan,
    sp.sign: np.sign,
    sp.acos: np.arccos,
}


def evaluate(expression: sp.Expr, values: Mapping[str, Any]) -> Any:  # noqa: ANN401 - an array or a number
    """Evaluate an expression by the names of its symbols."""
    if expression.is_Symbol:
        return values[expression.name]
    if expression.is_number:
        return float(expression)
    parts = [evaluate(argument, values) for argument in expression.args]
    if expression.is_Add:
        return sum(parts)
    if expression.is_Mul:
        return np.prod(np.broadcast_arrays(*parts), axis=0)
    return parts[0] ** parts[1] if expression.is_Pow else FUNCTIONS[expression.func](*parts)


def row(equation: int, label: str, terms: Mapping[str, sp.Expr], definition: bool = False) -> Row:
    """Make a row with read-only terms."""
    return Row(equation, label, MappingProxyType(dict(terms)), definition)


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

# Eqs 12 and 25: deflection times stiffness; 13 and 26: its direction; 14 and 27: friction along eqs 15, 28.
LAWS = (
    row(10, "phi_i", {"phase": (counter_n - 1) * phi_S0}, definition=True),
    row(12, "N_SP", {"deflection": k_PS * (
        Z_P * sum_S / (Z_S + Z_P)
        * sp.tan(th_P + Z_S / Z_P * th_S - (Z_S + Z_P) / Z_P * turn_PS)
        - (d_PS - d_PS0) * sin(a_PS)
    )}, definition=True),
    row(13, "N_SPx", {NORMAL_S: N_PS * cos(sp.pi / 2 + gma_S)}, definition=True),
    row(13, "N_SPy", {NORMAL_S: N_PS * sin(sp.pi / 2 + gma_S)}, definition=True),
    row(14, "f_SP", {COULOMB_S: mu_PS * N_PS * sgn_PS, VISCOUS_S: c_PS * u_PS * sgn_PS}, definition=True),
    row(25, "N_RP", {"deflection": k_PR * (
        -Z_P * (r_Rb - r_Pb) / (Z_R - Z_P)
        * sp.tan(th_P - Z_R / Z_P * th_R + (Z_R - Z_P) / Z_P * turn_PR)
        + (d_PR - d_PR0) * sin(a_PR)
    )}, definition=True),
    row(26, "N_RPx", {NORMAL_R: N_PR * cos(sp.pi / 2 + gpa_R)}, definition=True),
    row(26, "N_RPy", {NORMAL_R: N_PR * sin(sp.pi / 2 + gpa_R)}, definition=True),
    row(27, "f_RP", {COULOMB_R: mu_PR * N_PR * sgn_PR, VISCOUS_R: c_PR * u_PR * sgn_PR}, definition=True),
    row(29, "delta_CPx", {"deflection": x_P - x_C - R_P * cos(pin)}, definition=True),
    row(29, "delta_CPy", {"deflection": y_P - y_C - R_P * cos(pin)}, definition=True),
)  # fmt: skip

#: The involute's exact law in the paper's symbols, for the rows that are right to first order only.
EXACT: Mapping[str, sp.Expr] = MappingProxyType({
    "N_SP": k_PS * (
        r_Sb * (th_S - turn_PS) + r_Pb * (th_P - turn_PS)
        - (r_Sb + r_Pb) * (
            sp.tan(a_PS) - a_PS - sp.tan(sp.acos((r_Sb + r_Pb) / d_PS0)) + sp.acos((r_Sb + r_Pb) / d_PS0)
        )
    ),
    "N_RP": k_PR * (
        r_Rb * (th_R - turn_PR) - r_Pb * (th_P - turn_PR)
        + (r_Rb - r_Pb) * (
            sp.tan(a_PR) - a_PR - sp.tan(sp.acos((r_Rb - r_Pb) / d_PR0)) + sp.acos((r_Rb - r_Pb) / d_PR0)
        )
    ),
})  # fmt: skip

ROWS: tuple[Row, ...] = (*LAWS, *SUN, *RING, *PLANET, *CARRIER)

FAMILIES: tuple[tuple[sp.Symbol, ...], ...] = (
    (gma_S, amg_S, gpa_S),
    (gma_R, amg_R, gpa_R),
    (r_Sb, r_Pb, r_Rb),
    (Z_S, Z_P, Z_R),
    (om_S, om_R, om_P, om_C),
    (G_S, G_R, G_P, G_C),
    (c_SB, c_RB, c_PB),
    (k_SB, k_RB, k_CPB),
    (counter_i, counter_n),
    (d_PS, d_PS0, v_PS),
    (d_PR, d_PR0, v_PR),
    (N_PS, N_PR),
    (mu_PS, mu_PR),
    (c_PS, c_PR),
)
"""Symbols that print mistakes exchange for one another."""


@dataclass(frozen=True)
class Edit:
    """One slip of the pen, put right: what it concerns, how it reads, and the expression after it."""

    slot: str
    reads: str
    apply: Callable[[sp.Expr], sp.Expr]


def exchange(rules: Mapping[sp.Expr, sp.Expr]) -> Callable[[sp.Expr], sp.Expr]:
    """Make a simultaneous replacement; sums of radii or teeth stay whole unless they are in the rules."""
    kept = {whole: whole for whole in (sum_S, sum_R, r_Rb - r_Pb, Z_S + Z_P, Z_R + Z_P, Z_R - Z_P)}
    return lambda expression: expression.xreplace({**kept, **rules})


def swap_trig(expression: sp.Expr) -> sp.Expr:
    """Exchange sine and cosine."""
    other = {sin: cos, cos: sin}
    return expression.replace(lambda e: e.func in other, lambda e: other[e.func](*e.args))


def close_bracket(expression: sp.Expr) -> sp.Expr:
    """Turn [u + v*(p - q)] into [u + v]*(p - q), where (p - q) is one of the pin's arms."""
    arms = (x_P - x_C, y_P - y_C)

    def moved(whole: sp.Expr) -> sp.Expr:
        found = [(part, arm) for arm in arms for part in whole.args if part.is_Mul and part.has(arm)]
        return (whole - found[0][0] + found[0][0] / found[0][1]) * found[0][1] if len(found) == 1 else whole

    return expression.replace(lambda e: e.is_Add and len(e.args) == 3, moved)


X_ARM, Y_ARM = x_P - x_C, y_P - y_C
STRUCTURAL: tuple[Edit, ...] = (
    Edit("length", f"{low_PS} for {low_PS}^2 below the bar", exchange({low_PS: low_PS**2})),
    Edit("length", f"{low_PR} for {low_PR}^2 below the bar", exchange({low_PR: low_PR**2})),
    Edit("sum", "r_Pb + r_Rb for r_Rb - r_Pb", exchange({sum_R: r_Rb - r_Pb})),
    Edit("teeth", "Z_R + Z_P for Z_R - Z_P", exchange({Z_R + Z_P: Z_R - Z_P})),
    Edit("bracket", "a bracket that closes after the moment arm", close_bracket),
    Edit("arms", "crossed moment arms", exchange({X_ARM: Y_ARM, Y_ARM: X_ARM})),
    Edit("sgn", "a factor sgn() too many", exchange({sgn_PS: sp.S.One, sgn_PR: sp.S.One})),
)


def edits(expression: sp.Expr) -> tuple[Edit, ...]:
    """List the single edits that change an expression, sign first, then structure, then indices."""
    signs = ("-", "+") if expression.could_extract_minus_sign() else ("+", "-")
    found = [Edit("sign", "{} for {}".format(*signs), lambda e: -e)]
    heads = [head.__name__ for head in (sin, cos) if expression.has(head)]
    if heads:
        reads = "sin and cos exchanged" if len(heads) == 2 else "sin for cos" if heads == ["sin"] else "cos for sin"
        found.append(Edit("trig", reads, swap_trig))
    found += [edit for edit in STRUCTURAL if edit.apply(expression) != expression]
    for family in FAMILIES:
        for old in (symbol for symbol in family if exchange({symbol: sp.S.Zero})(expression) != expression):
            slot = {FAMILIES[2]: "radius", FAMILIES[3]: "share"}.get(family, str(old))
            news = (new for new in family if new != old)
            found += [Edit(slot, f"{old} for {new}", exchange({old: new})) for new in news]
    return tuple(found)


MEANING: Mapping[tuple[str, str], str] = {
    ("normal", "sign"): "the mesh spring would pull here where it must push",
    ("normal", "radius"): "the moment arm is another gear's",
    ("Coulomb", "sign"): "this component would push the sliding on",
    ("viscous", "sign"): "this component feeds energy",
    ("viscous", "sgn"): "it feeds energy in one of the two directions",
    ("viscous", "length"): "one length too many for a force",
    ("viscous", "sum"): "an internal pair has the difference of the radii",
    ("damping", "theta_S'"): "the speed is another body's",
    ("damping", "theta_R'"): "the speed is another body's",
    ("pin", "bracket"): "metres are added to square metres",
    ("pin", "arms"): "a force along x has its arm along y, and the reverse",
    ("weight", "G_P"): "the weight is another body's",
    ("weight", "left out"): "row 31 has it",
    ("bearing", "left out"): "eq 30 has it",
}
"""(First word of a term group, slot of an edit) -> what it does."""
