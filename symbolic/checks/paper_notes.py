"""Notes on the paper: rows that contradict each other, misprints that cancel, and consequences."""

from collections.abc import Iterator, Mapping
from itertools import combinations

import numpy as np
import sympy as sp

from ..wu2021 import ROWS, Row, evaluate, exchange
from ..wu2021.printed_laws import START
from ..wu2021.printed_letters import d_PR, d_PR0, d_PS, d_PS0
from ..wu2021.slips import STRUCTURAL
from .paper_derived import benches
from .paper_grades import TOLERANCE, bench_for, grade, repair
from .paper_states import KIND, Array, Values

PRINTED: Mapping[tuple[int, str], Row] = {(row.equation, row.label): row for row in ROWS}
REACTIONS = {
    (32, "x_S"): (35, "x_P"), (32, "y_S"): (36, "y_P"), (34, "x_R"): (35, "x_P"), (34, "y_R"): (36, "y_P"),
}  # fmt: skip
"""Row of a force on sun or ring -> row of its reaction on the planet."""
TANGENT = {
    (8, "delta_t_PS"): (15, "beta_SPf"), (24, "delta_t_PR"): (28, "beta_RPf"),
}  # fmt: skip
"""Deflection whose rate friction goes by -> the direction of friction."""
LSP = {"Z_S": 22, "n": 4}
"""Teeth of the sun and planets of the paper's LSP (printed: Table 2)."""
DISTANCE = {"S": (d_PS, d_PS0), "R": (d_PR, d_PR0)}


def list_notes(row: Row, derived: Mapping[str, sp.Expr]) -> list[str]:
    """List notes on a row besides its own misprints.

    Parameters
    ----------
    row
        The row as printed.
    derived
        Its term groups put right.
    """
    return [*_reactions(row), *_arm(row, derived), *_cancelling(row, derived), *_tangents(row), *_starts(row)]


def _name(row: Row) -> str:
    """Name a row."""
    return f"eq {row.equation} {row.label}"


def _differs(one: Array, two: Array) -> bool:
    """Tell whether two values differ by more than rounding."""
    return bool(np.max(np.abs(one - two)) > TOLERANCE * np.max(np.abs(one)))


def _same_distance(expression: sp.Expr) -> sp.Expr:
    """Write the present centre distance wherever the nominal one is printed."""
    return exchange({nominal: present for present, nominal in DISTANCE.values()})(expression)


def _reactions(row: Row) -> Iterator[str]:
    """Tell of forces that do not cancel the reaction printed elsewhere; the distances and the sign are looked at."""
    here, values = (row.equation, row.label), benches(1, 1)[0].values
    pairs = [pair for pair in REACTIONS.items() if here in pair]
    for other in (PRINTED[one if two == here else two] for one, two in pairs):
        for group in (group for group in row.terms if group.partition(" ")[2] and group in other.terms):
            forces = row.terms[group], other.terms[group]
            force, back = (evaluate(part, values) for part in forces)
            if not _differs(force, -back):
                continue
            alike = [evaluate(_same_distance(part), values) for part in forces]
            b = "S" if "S-P" in group else "R"
            lengths = [DISTANCE[b][part.has(DISTANCE[b][1])].name for part in forces]
            found = [f"{lengths[0]} here, {lengths[1]} there"] * (lengths[0] != lengths[1])
            found += ["the same sign here and there"] * (not _differs(*alike))
            yield f"{group}: no reaction to that of {_name(other)}" + (f" ({', '.join(found)})" if found else "")


def _arm(row: Row, derived: Mapping[str, sp.Expr]) -> Iterator[str]:
    """Tell where viscous and Coulomb friction, put right, have arms of two lengths: torque over force along x."""
    body = row.label.removeprefix("theta_")
    if body not in KIND or (row.equation, f"x_{body}") not in REACTIONS:
        return
    along, values = PRINTED[row.equation, f"x_{body}"], benches(1, 1)[0].values
    coulomb, viscous = (f"{kind} friction {body}-P" for kind in ("Coulomb", "viscous"))
    found = repair(along, viscous, bench_for(along))
    if found is None or any(isinstance(derived[group], sp.Symbol) for group in (coulomb, viscous)):
        return  # the one or the other could not be put right
    arm = derived[coulomb] / along.terms[coulomb]
    arms = [np.abs(evaluate(part, values)) for part in (derived[viscous] / found[0], arm)]
    nominal = derived[viscous] / exchange({DISTANCE[body][0]: DISTANCE[body][1]})(found[0])
    if _differs(*arms) and not _differs(np.abs(evaluate(nominal, values)), arms[1]):
        present, zero = (symbol.name for symbol in DISTANCE[body])
        yield f"arm of friction: {zero} with the viscous force of {_name(along)}, {present} with the Coulomb force"


def _cancelling(row: Row, derived: Mapping[str, sp.Expr]) -> Iterator[str]:
    """Tell of pairs of slips that a comparison of values does not see: each alone is one, both together are none."""
    where = bench_for(row)
    for group, right in derived.items():
        usable = [edit for edit in STRUCTURAL if edit.apply(right) != right]
        for one, two in combinations(usable, 2):
            if grade(row, group, right, where) == "misprint":
                continue
            alone = [grade(row, group, edit.apply(right), where) == "misprint" for edit in (one, two)]
            if all(alone) and grade(row, group, two.apply(one.apply(right)), where) != "misprint":
                yield f"{group}: two slips cancel: {one.reads}, {two.reads}"


def _tangents(row: Row) -> Iterator[str]:
    """Tell where friction, along the direction printed and by the rate of the deflection printed, pushes sliding on."""
    here = (row.equation, row.label)
    for deflection, angle in TANGENT.items():
        if here not in (deflection, angle):
            continue
        b, other = deflection[1][-1], PRINTED[angle if here == deflection else deflection]
        one, two = (row, other) if here == deflection else (other, row)
        values = benches(0, 0)[0].values
        along = np.cos(evaluate(two.terms["angle"], values) - values[f"gamma_P{b}"])
        if np.all(np.sign(_rate(one.terms["deflection"], values, b)) * along * values[f"d_P{b}'"] > 0):
            rows = [item for item in ROWS if item.equation > 31 and f"Coulomb friction {b}-P" in item.terms]
            kept = [item for item in rows if _keeps(item, b) and item.label[:1] in "xy"]
            yield f"against eq {other.equation}: with both friction would push the sliding on"
            yield f"{', '.join(map(_name, kept))} go with eq {deflection[0]}"


def _rate(deflection: sp.Expr, v: Values, b: str) -> Array:
    """Return the rate of a printed tangent deflection while the centre distance changes, by a small step."""
    m, (_, sigma), step = f"P{b}", KIND[b], 1e-6
    distance = v[f"d_{m}"] + step * v[f"d_{m}'"]
    later = {**v, f"d_{m}": distance, f"alpha_{m}": np.arccos((v[f"r_{b}b"] + sigma * v["r_Pb"]) / distance)}
    rate: Array = (evaluate(deflection, later) - evaluate(deflection, v)) / step
    return rate


def _keeps(row: Row, b: str) -> bool:
    """Tell whether a row's Coulomb friction of a mesh is right."""
    group = f"Coulomb friction {b}-P"
    return grade(row, group, row.terms[group], bench_for(row)) != "misprint"


def _starts(row: Row) -> Iterator[str]:
    """Tell of the starts of single contact: eq 10 against eq 11, and what eq 11 makes of the paper's own LSP."""
    stiffness = PRINTED[11, "k_PS,i"].terms["stiffness"]
    if row.label == "phi_i" and stiffness.has(START):
        yield f"eq 11 has {sp.sstr(START, order='none')}"
    if row.label != "k_PS,i":
        return
    shift = float(evaluate(PRINTED[10, "phi_S0"].terms["phase"], LSP)) * LSP["Z_S"] / (2 * np.pi)
    theta = (np.arange(1000) + 0.5) / 1000
    number = {"theta": theta, "theta_T": 1.0, "phi_S0": shift, "epsilon": 1.5, "k": 1.0, "xi": 2.0}
    planets = range(1, LSP["n"] + 1)
    alone = [float(np.mean(evaluate(row.terms["stiffness"], number | {"i": i}) == 1.0)) for i in planets]
    starts = ", ".join(f"{(i - 1) * shift:g}" for i in planets)
    never = " and ".join(str(i) for i, share in zip(planets, alone, strict=True) if share == 0)
    if never:
        yield (
            f"with {LSP['Z_S']} teeth and {LSP['n']} planets (the paper's LSP) they start at {starts} pitches, so that "
            f"planets {never} are never in single contact"
        )
