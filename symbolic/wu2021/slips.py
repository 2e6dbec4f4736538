"""Misprints: the edits that correct a printed expression, and the effect of each misprint."""
# ruff: noqa: I001 - so many letters on few lines

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import sympy as sp
from sympy import cos, sin

from .printed_letters import (
    G_C,
    G_P,
    G_R,
    G_S,
    N_PR,
    N_PS,
    Z_P,
    Z_R,
    Z_S,
    amg_R,
    amg_S,
    c_PB,
    c_PR,
    c_PS,
    c_RB,
    c_SB,
    counter_i,
    counter_n,
    d_PR,
    d_PR0,
    d_PS,
    d_PS0,
    gma_R,
    gma_S,
    gpa_R,
    gpa_S,
    k_CPB,
    k_RB,
    k_SB,
    low_PR,
    low_PS,
    mu_PR,
    mu_PS,
    om_C,
    om_P,
    om_R,
    om_S,
    r_Pb,
    r_Rb,
    r_Sb,
    sgn_CP,
    sgn_PR,
    sgn_PS,
    sum_R,
    sum_S,
    theta,
    theta_T,
    v_PR,
    v_PS,
    x_C,
    x_P,
    y_C,
    y_P,
)
from .printed_laws import SINGLE, START


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
"""Symbols that misprints exchange."""


@dataclass(frozen=True)
class Edit:
    """One corrected misprint: its subject, its text, and the corrected expression."""

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


def part_quotient(expression: sp.Expr) -> sp.Expr:
    """Turn atan(y/x) into atan2(y, x)."""
    return expression.replace(sp.atan, lambda quotient: sp.atan2(*sp.fraction(quotient)))


def wrap_start(expression: sp.Expr) -> sp.Expr:
    """Count a phase of single contact from its start, whole pitches taken off."""
    single = sp.Mod(theta - START, theta_T) <= SINGLE
    return (
        expression.replace(sp.Piecewise, lambda *cases: sp.Piecewise((cases[0][0], single), (cases[1][0], True)))
        if expression.has(START)
        else expression
    )


X_ARM, Y_ARM = x_P - x_C, y_P - y_C
STRUCTURAL: tuple[Edit, ...] = (
    Edit("length", f"{low_PS} for {low_PS}^2 below the bar", exchange({low_PS: low_PS**2})),
    Edit("length", f"{low_PR} for {low_PR}^2 below the bar", exchange({low_PR: low_PR**2})),
    Edit("sum", "r_Pb + r_Rb for r_Rb - r_Pb", exchange({sum_R: r_Rb - r_Pb})),
    Edit("teeth", "Z_R + Z_P for Z_R - Z_P", exchange({Z_R + Z_P: Z_R - Z_P})),
    Edit("bracket", "a bracket that closes after the moment arm", close_bracket),
    Edit("arms", "crossed moment arms", exchange({X_ARM: Y_ARM, Y_ARM: X_ARM})),
    Edit("sgn", "a factor sgn() too many", exchange(dict.fromkeys((sgn_PS, sgn_PR, sgn_CP), sp.S.One))),
    Edit("turn", "pi too many", exchange({sp.pi: sp.S.Zero})),
    Edit("quadrant", "the arctangent of a quotient for the angle of its two parts", part_quotient),
    Edit("pitch", "theta for theta - (i - 1)*phi_S0 less whole pitches", wrap_start),
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
    ("angle", "quadrant"): "half a turn off wherever the planet lies left of the gear",
}
"""(First word of a term group, slot of an edit) -> effect of the misprint."""
