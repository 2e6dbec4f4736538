"""Substitution of common parts of an expression by their names.

Only exact parts are replaced (some terms of a sum, some factors of a product, up to the sign), so substituting every
name back gives the same expression; ``unfold`` does it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp


@dataclass(frozen=True)
class NamedStep:
    """A named quantity: its symbol (or an expression of earlier symbols) and its value."""

    symbol: sp.Expr
    value: sp.Expr


@dataclass(frozen=True)
class Folded:
    """Expressions with named parts, and the names used, in order."""

    steps: tuple[NamedStep, ...]
    expressions: tuple[sp.Expr, ...]


def fold(expressions: Sequence[sp.Expr], steps: Sequence[NamedStep]) -> Folded:
    """Substitute names into expressions, and earlier names into later ones.

    Parameters
    ----------
    expressions
        Expressions to shorten.
    steps
        Names and their values, in raw form, simple ones first.

    Returns
    -------
    Folded
        Without unused names, and without names no shorter than their values.
    """
    names: list[NamedStep] = []
    folded: list[NamedStep] = []
    for step in steps:
        short = _replace(step.value, names)
        if not short.is_Symbol:
            names.append(step)
            folded.append(NamedStep(step.symbol, short))
    results = tuple(_replace(sp.sympify(expression), names) for expression in expressions)
    return Folded(_used(folded, results), results)


def unfold(folded: Folded) -> tuple[sp.Expr, ...]:
    """Replace every name by its value."""
    meaning: dict[sp.Basic, sp.Expr] = {}
    for step in folded.steps:
        meaning[step.symbol] = step.value.xreplace(meaning)
    return tuple(expression.xreplace(meaning) for expression in folded.expressions)


def _used(steps: Sequence[NamedStep], expressions: Sequence[sp.Expr]) -> tuple[NamedStep, ...]:
    """Return the steps that expressions, or later steps that are used, name."""
    needed: set[sp.Basic] = set().union(*(e.free_symbols for e in expressions))
    kept = []
    for step in reversed(steps):
        if step.symbol.is_Symbol and step.symbol in needed:
            kept.append(step)
            needed |= step.value.free_symbols
    return tuple(reversed(kept))


def _replace(expression: sp.Expr, steps: Sequence[NamedStep]) -> sp.Expr:
    """Substitute names into an expression, the latest first."""
    memory: dict[sp.Basic, sp.Expr] = {}

    def visit(node: sp.Expr) -> sp.Expr:
        if node.is_Atom:
            return node
        if node not in memory:
            memory[node] = _named(node, steps, visit)
        return memory[node]

    return visit(expression)


def _named(node: sp.Expr, steps: Sequence[NamedStep], visit: object) -> sp.Expr:
    """Replace a node, or the parts of it that have a name, and go on with what is left."""
    assert callable(visit)
    for step in reversed(steps):
        if node == step.value:
            return step.symbol
    kind = node.func if node.is_Add or node.is_Mul else None
    if kind is None:
        return node.func(*(visit(argument) for argument in node.args))
    rest, taken = set(node.args), []
    for step in reversed(steps):
        for sign in (1, -1):
            parts = set((sign * step.value).args) if (sign * step.value).func is kind else set()
            if len(parts) > 1 and parts <= rest:
                rest -= parts
                taken.append(sign * step.symbol)
                break
    return kind(*taken, *(visit(argument) for argument in node.args if argument in rest))
