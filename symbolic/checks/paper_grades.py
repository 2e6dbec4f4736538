"""Grades of printed equations: term groups against derived ones, and the fewest edits between them."""

from collections.abc import Sequence
from functools import lru_cache
from itertools import combinations

import numpy as np
import sympy as sp

from ..wu2021 import MEANING, ROWS, Edit, Row, edits, evaluate
from .paper_derived import SIZES, DerivedRows, benches
from .paper_states import KIND, STATES, Array

TOLERANCE = 1e-9
MAX_EDITS = 5
BOTH_WAYS = (14, 15, 27, 28)
"""Equations that carry their own sgn(), or go with it."""


# --- comparison


def target(row: Row, group: str, bench: DerivedRows) -> Array:
    """Return the derived term group; rows 31 and 33 name both kinds of friction as one force."""
    groups = bench.rows[row.label]
    if group.startswith("friction"):
        return groups[f"Coulomb {group}"] + groups[f"viscous {group}"]
    return groups.get(group, np.zeros(STATES))


def grade(row: Row, group: str, expression: sp.Expr, where: Sequence[DerivedRows]) -> str:
    """Compare one group: agrees, first-order or misprint."""
    errors = []
    for bench in where:
        right = target(row, group, bench)
        difference = evaluate(expression, bench.values) - right
        if group == "angle":  # whole turns do not count
            difference = np.mod(difference + np.pi, 2 * np.pi) - np.pi
        wrong = np.max(np.abs(difference))
        errors.append(float(wrong / np.max(np.abs(right))) if np.any(right) else float(wrong > 0) * np.inf)
    if max(errors) < TOLERANCE:
        return "agrees"
    shrinks = errors[-1] < 3 * errors[0] * SIZES[-1] / SIZES[0]
    return "first-order" if shrinks and errors[0] < 1 else "misprint"


def bench_for(row: Row) -> tuple[DerivedRows, ...]:
    """Choose the states of a row: both directions at once where the row carries its own sgn()."""
    return benches(0, 0) if row.equation in BOTH_WAYS else benches(direction("S"), direction("R"))


@lru_cache
def direction(b: str) -> int:
    """Deduce the direction of sliding that the explicit rows print: +1 where the centres approach."""
    group = f"Coulomb friction {b}-P"
    rows = [row for row in ROWS if group in row.terms and not row.definition]
    score = {
        way: sum(grade(row, group, row.terms[group], benches(way, way)) != "misprint" for row in rows)
        for way in (1, -1)
    }
    return max(score, key=lambda way: score[way])


# --- explanation


def repair(row: Row, group: str, where: Sequence[DerivedRows]) -> tuple[sp.Expr, tuple[Edit, ...]] | None:
    """Find the fewest edits that make a printed group the derived one, if there are any."""
    printed = row.terms[group]
    single = edits(printed)
    for count in range(1, MAX_EDITS + 1):
        for chosen in combinations(single, count):
            if len({edit.slot for edit in chosen}) < count:
                continue
            expression = printed
            for edit in chosen:
                expression = edit.apply(expression)
            if grade(row, group, expression, where) != "misprint":
                return expression, chosen
    return None


def ratio(row: Row, group: str, bench: DerivedRows) -> str:
    """Say by what factor a group without a known repair differs."""
    factors = evaluate(row.terms[group], bench.values) / target(row, group, bench)
    return f"{group}: no simple repair; printed / derived lies between {min(factors):.3g} and {max(factors):.3g}"


def explain(row: Row, group: str, where: Sequence[DerivedRows]) -> tuple[sp.Expr, str]:
    """Return the derived form of a group that differs, and the reason in words."""
    if not np.any(target(row, group, where[0])):
        return sp.S.Zero, f"{group}: printed, but the derivation has none"
    if (found := repair(row, group, where)) is None:
        return sp.Symbol(f"<{group}>"), ratio(row, group, where[0])
    expression, chosen = found
    meanings = [MEANING.get((group.split()[0], edit.slot), "") for edit in chosen]
    why = f"{group}: prints " + ", ".join(edit.reads for edit in chosen)
    return expression, why + "".join(f"; {meaning}" for meaning in dict.fromkeys(meanings) if meaning)


def left_out(row: Row, where: Sequence[DerivedRows]) -> dict[str, sp.Expr]:
    """Return the derived groups that a row does not print, as a symbol where one names them."""
    named = {f"friction {b}-P" for b in KIND} & set(row.terms)
    missing = [g for g in where[0].rows[row.label] if g not in row.terms and not any(n in g for n in named)]
    found = {}
    for group in missing:
        right = where[0].rows[row.label][group]
        same = (name for name, value in where[0].values.items() if np.allclose(-value, right, rtol=TOLERANCE))
        found[group] = -sp.Symbol(next(same, f"<{group}>"))
    return found
