"""Printed equation: one scalar row as term groups, as text, and in numbers."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

import numpy as np
import sympy as sp

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


FUNCTIONS: Mapping[Any, Callable[..., Any]] = {
    sp.sin: np.sin, sp.cos: np.cos, sp.tan: np.tan, sp.acos: np.arccos, sp.atan: np.arctan, sp.atan2: np.arctan2,
    sp.sign: np.sign, sp.log: np.log, sp.floor: np.floor, sp.Mod: np.mod,
    sp.Lt: np.less, sp.Le: np.less_equal, sp.Gt: np.greater, sp.Ge: np.greater_equal,
    sp.And: lambda *parts: np.logical_and.reduce(np.broadcast_arrays(*parts)),
    sp.Or: lambda *parts: np.logical_or.reduce(np.broadcast_arrays(*parts)),
}  # fmt: skip


def evaluate(expression: sp.Basic, values: Mapping[str, Any]) -> Any:  # noqa: ANN401 - an array or a number
    """Evaluate an expression by the names of its symbols; not a number where none of its cases holds."""
    if expression.is_Symbol:
        return values[expression.name]
    if expression.is_number:
        return float(expression)
    if expression == sp.true:
        return True
    if isinstance(expression, sp.Piecewise):
        cases = [np.broadcast_arrays(*(evaluate(part, values) for part in case.args)) for case in expression.args]
        return np.select([condition for _, condition in cases], [value for value, _ in cases], np.nan)
    parts = [evaluate(argument, values) for argument in expression.args]
    if expression.is_Add:
        return sum(parts)
    if expression.is_Mul:
        return np.prod(np.broadcast_arrays(*parts), axis=0)
    return parts[0] ** parts[1] if expression.is_Pow else FUNCTIONS[expression.func](*parts)


def row(equation: int, label: str, terms: Mapping[str, sp.Expr], definition: bool = False) -> Row:
    """Make a row with read-only terms."""
    return Row(equation, label, MappingProxyType(dict(terms)), definition)
