"""Printed equations of the whole model, from states to accelerations, in computing order.

The mechanics of the model, with symbols instead of graphs. For small scenes the book prints all equations; for large
ones it prints each law once and which element acts on which body.
"""

from dataclasses import dataclass
from typing import Any

import sympy as sp

from ..elements.base import real
from ..mechanics.body_balances import Balances
from ..mechanics.frames import FrameMotion
from ..mechanics.model import SLOPE, Instance, Model, Profile
from . import waves
from .laws import write_law


@dataclass(frozen=True)
class Assignment:
    """One printed equation: symbol, value, and its body or element (by number)."""

    symbol: sp.Expr
    value: sp.Expr
    owner: str


@dataclass(frozen=True)
class Leaf:
    """Meaning of a free symbol: a state (x), a level or signal (s) or a parameter (p) of the C, by name."""

    vector: str
    name: str


@dataclass(frozen=True)
class PrintedEquations:
    """Equations of motion of a model.

    Attributes
    ----------
    assignments
        Named quantities, each a function of states, numbers and earlier ones.
    rates
        State -> its rate.
    leaves
        Free symbol -> state, signal, level or parameter of the C.
    terms
        Body -> (number of the element, port) of all loads on it.
    """

    assignments: tuple[Assignment, ...]
    rates: dict[str, sp.Expr]
    leaves: dict[sp.Expr, Leaf]
    terms: dict[str, tuple[tuple[int, int], ...]]


def list_terms(model: Model) -> dict[str, tuple[tuple[int, int], ...]]:
    """Return body -> (number of the element, from 1, and its port, from 1) of all elements at it."""
    found: dict[str, list[tuple[int, int]]] = {body.name: [] for body in model.bodies}
    for number, instance in enumerate(model.instances, start=1):
        for port, body in enumerate(instance.bodies, start=1):
            found[body].append((number, port))
    return {body: tuple(items) for body, items in found.items()}


def assemble(model: Model) -> PrintedEquations:
    """Write the equations of motion of a model.

    Parameters
    ----------
    model
        The model.
    """
    made = _Symbols(model)
    instances = enumerate(model.instances, start=1)
    made.sum_up([(instance, made.call(instance, f"#{number}")) for number, instance in instances])
    rates = made.rates()
    return PrintedEquations(tuple(made.assigned.values()), rates, made.leaves, list_terms(model))


class _Symbols(Balances):
    """The mechanics of a model in SymPy symbols: leaves, and the quantities named so far."""

    functions, zero = sp, sp.S.Zero

    def __init__(self, model: Model) -> None:
        super().__init__(model)
        self.leaves: dict[sp.Expr, Leaf] = {}
        self.assigned: dict[str, Assignment] = {}

    def leaf(self, letter: str, leaf: Leaf) -> sp.Symbol:
        """Make a symbol that stands for a state, a signal or a number."""
        symbol = real(letter)
        self.leaves[symbol] = leaf
        return symbol

    def state(self, name: str, letter: str) -> sp.Symbol:
        """Make the symbol of a state."""
        return self.leaf(letter, Leaf("x", name))

    def number(self, name: str, letter: str) -> sp.Symbol:
        """Make the symbol of a parameter, or of a load signal."""
        return self.leaf(letter, Leaf("s" if name in self.signals else "p", name))

    def level(self, mesh: str) -> sp.Symbol:
        """Make the symbol of the level of a mesh."""
        return self.leaf(f"level@{mesh}", Leaf("s", mesh))

    def keep(self, letter: str, owner: str, value: sp.Expr) -> sp.Symbol:
        """Give a value a symbol of its own, once."""
        symbol = real(letter)
        self.assigned.setdefault(letter, Assignment(symbol, sp.sympify(value), owner))
        return symbol

    def body_law(self, given: dict[str, Any]) -> dict[str, sp.Expr]:
        """Return the accelerations of a body by degree of freedom."""
        symbols = FrameMotion.symbols()
        known = {getattr(symbols, name): value for name, value in given.items()}
        return {axis: row.xreplace(known) for axis, row in zip("xyu", symbols.newton(), strict=True)}

    def call(self, instance: Instance, tag: str) -> list[list[sp.Expr]]:
        """Write one element in the coordinates of its bodies, and return force and torque on each port."""
        law, owner = write_law(instance.element), tag.removeprefix("#")
        bound = self.bound(instance, law.element, tag)
        rename = self.seen(law.element, instance)
        rename |= {symbol: bound.get(symbol.name, real(symbol.name + tag)) for symbol in law.element.parameters}
        rename |= {step.symbol: real(f"{step.symbol.name}{tag}") for step in law.steps}
        follows = SLOPE in instance.bind.values()
        names = [step.symbol.name for step in law.steps]
        wait = names.index("psi") + 1 if follows and "psi" in names else 0
        for place, step in enumerate(law.steps):
            if follows and place == wait:
                self.followed(instance, tag, law.outputs["rolling"].xreplace(rename))
            self.keep(rename[step.symbol].name, owner, step.value.xreplace(rename))
        return self.on_ports(law.element, [load.xreplace(rename) for load in law.wrench])

    def one_profile(self, item: Profile, place: int, tau: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
        """Return a profile in symbols of its own, and its slope."""
        wave, tag = waves.WAVES[item.kind], f"@{item.mesh}" + f", {item.quantity} {place + 1}" * (place > 0)
        told = tag + f" {item.quantity}" * (item.quantity != "stiffness")
        rename: dict[sp.Basic, sp.Expr] = {waves.TAU: tau, waves.COUNT: sp.Integer((len(item.numbers) - 1) // 2)}
        if waves.LEVEL in wave.formula.free_symbols:
            rename[waves.LEVEL] = self.level(item.mesh)
        for base in (waves.COS, waves.SIN):
            own = sp.IndexedBase(f"{base}{told}")
            rename |= {base: own, base.label: own.label}
        for symbol, number in zip(wave.numbers(len(item.numbers)), item.numbers, strict=True):
            if isinstance(symbol, sp.Indexed):
                self.leaves[symbol.xreplace(rename)] = Leaf("p", number)
            else:
                rename[symbol] = self.leaf(symbol.name + told, Leaf("p", number))
        value = wave.formula.xreplace(rename)
        return value, sp.diff(value, tau) if tau.is_Symbol else sp.S.Zero
