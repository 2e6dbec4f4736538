"""Printed force laws: an element's energies and its hand-written wrench."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import sympy as sp

from ..checks.check import title
from ..elements.base import Element
from ..elements.element_types import make
from ..elements.key import ElementKey
from ..mechanics.lagrange import forces
from .abbreviations import list_steps
from .folding import Folded, NamedStep, fold
from .letters import ABSOLUTE, LETTERS, PECULIAR, Letter

SHORT = 24
"""Largest number of operations for which a derivative of the energies is printed beside the wrench."""


@dataclass(frozen=True)
class Law:
    """An element type in the book.

    Attributes
    ----------
    key, title, element
        Element type, its plain name, and the element itself.
    folded
        Named quantities, and in their terms V, D, the wrench and the outputs, in this order.
    gradient
        -dV/dq - dD/dv as differentiated, one for each component of the wrench; None where it is too long to read.
    """

    key: ElementKey
    title: str
    element: Element
    folded: Folded
    gradient: tuple[sp.Expr | None, ...]

    @property
    def steps(self) -> tuple[NamedStep, ...]:
        """Return the named quantities."""
        return self.folded.steps

    @property
    def potential(self) -> sp.Expr:
        """Return V."""
        return self.folded.expressions[0]

    @property
    def dissipation(self) -> sp.Expr:
        """Return D."""
        return self.folded.expressions[1]

    @property
    def wrench(self) -> tuple[sp.Expr, ...]:
        """Return force and torque on each port, flat."""
        return self.folded.expressions[2 : 2 + len(self.element.loads)]

    @property
    def outputs(self) -> dict[str, sp.Expr]:
        """Return what the element reports."""
        return dict(zip(self.element.outputs, self.folded.expressions[2 + len(self.element.loads) :], strict=True))

    @property
    def letters(self) -> Mapping[str, Letter]:
        """Return the table of letters of this law."""
        own = {name: letter for (group, name), letter in PECULIAR.items() if group == self.key.type}
        return {**LETTERS, **(ABSOLUTE if self.element.rates == "absolute" else {}), **own}

    @property
    def symbols(self) -> tuple[sp.Symbol, ...]:
        """Return all symbols that the law is printed with: coordinates, rates, parameters, named quantities."""
        free = set().union(*(e.free_symbols for e in (*self.folded.expressions, *(s.value for s in self.steps))))
        order = [*self.element.arguments, *(step.symbol for step in self.steps)]
        return tuple(symbol for symbol in order if symbol in free)


@cache
def write_law(key: ElementKey) -> Law:
    """Bring an element type into the form in which it is printed.

    Parameters
    ----------
    key
        The element type, as in ``Instance.element``.
    """
    element = make(key)
    steps = list_steps(key, element)
    reports = [output.expression for output in element.outputs.values()]
    folded = fold([element.potential, element.dissipation, *element.loads, *reports], steps)
    gradient = _gradient(element, steps, folded) if element.gradient else (None,) * len(element.loads)
    return Law(key, title(key), element, folded, gradient)


def _gradient(element: Element, steps: list[NamedStep], folded: Folded) -> tuple[sp.Expr | None, ...]:
    """Return the derivatives of the energies, in the names of the law; None if too long to read."""
    raw = forces(element)
    known = {*element.arguments, *(step.symbol for step in folded.steps)}
    short = (
        named if named.free_symbols <= known else plain
        for plain, named in zip(raw, fold(raw, steps).expressions, strict=True)
    )
    return tuple(expression if sp.count_ops(expression) <= SHORT else None for expression in short)
