"""Lowering of SymPy expressions to CasADi graphs; unknown functions are refused."""

from collections.abc import Callable, Sequence
from functools import cache
from math import log
from typing import Any

import casadi as ca
import sympy as sp

from ..elements.base import LogCosh
from ..elements.contact import Given, Lesser, Rest, Step, Switch
from ..elements.element_types import make
from ..elements.key import ElementKey
from ..elements.tooth_pairs import Sharing, Wrapped
from . import lagrange

UNARY: dict[Any, Callable[[Any], Any]] = {
    sp.sin: ca.sin, sp.cos: ca.cos, sp.tan: ca.tan, sp.atan: ca.atan, sp.tanh: ca.tanh, sp.cosh: ca.cosh,
    sp.sinh: ca.sinh, sp.log: ca.log, sp.exp: ca.exp, sp.Abs: ca.fabs,
    LogCosh: lambda z: ca.fabs(z) + ca.log1p(ca.exp(-2 * ca.fabs(z))) - log(2), sp.sign: ca.sign,
    Step: lambda z: z > 0,
    Wrapped: lambda z: z - ca.floor(z + 0.5),
}  # fmt: skip


def _sharing(g: Any, share: Any) -> Any:  # noqa: ANN401
    """Evaluate the leading pair's load share: 1 in single contact, then falling to 1/2."""
    return 1 - ca.fmax(ca.fabs(g) - share / 2, 0) / (1 - share)


SEVERAL: dict[Any, Callable[..., Any]] = {
    sp.atan2: ca.atan2, Sharing: _sharing, Given: lambda z, value, slope: value,
    Switch: lambda g, hold: g + hold > 0, Lesser: ca.fmin,
    Rest: lambda g, hold, z: (z > 0) * (1 - (g + hold > 0)),
}  # fmt: skip


def lower(expressions: Sequence[sp.Expr], leaves: dict[sp.Symbol, Any]) -> list[Any]:
    """Rebuild SymPy expressions in CasADi.

    Parameters
    ----------
    expressions
        Expressions to lower; common subexpressions are found first (``sympy.cse``).
    leaves
        Symbol -> CasADi expression.

    Raises
    ------
    TypeError
        If an expression contains a function without a CasADi counterpart here.
    """
    plain, memory = [sp.sympify(e) for e in expressions], dict[sp.Basic, Any](leaves)
    named = _angles(plain, memory)
    shared, reduced = sp.cse([e.xreplace(named) for e in plain], order="none")
    for symbol, expression in shared:
        memory[symbol] = _walk(expression, memory)
    return [_walk(e, memory) for e in reduced]


def _angles(expressions: Sequence[sp.Expr], memory: dict[sp.Basic, Any]) -> dict[sp.Basic, sp.Dummy]:
    """Rebuild the arc tangents separately, and return a symbol for each of them and for the sums within.

    All elements of a mesh need the same angle. How ``sympy.cse`` writes it depends on the other expressions, and
    differently written graphs are not merged between elements.
    """
    angles: set[sp.Basic] = set().union(*(e.atoms(sp.atan, sp.atan2) for e in expressions))
    for angle in sorted(angles, key=sp.default_sort_key):
        _walk(angle, memory)
    named = {node: sp.Dummy() for node in memory if node.is_Add or node.is_Pow or node in angles}
    memory.update([(symbol, memory[node]) for node, symbol in named.items()])
    return named


def _walk(node: sp.Basic, memory: dict[sp.Basic, Any]) -> Any:  # noqa: ANN401
    """Rebuild one expression; every node once."""
    if node in memory:
        return memory[node]
    if node.is_Number or node.is_NumberSymbol:
        return ca.SX(float(node))
    arguments = [_walk(argument, memory) for argument in node.args]
    memory[node] = _apply(node, arguments)
    return memory[node]


def _apply(node: sp.Basic, arguments: list[Any]) -> Any:  # noqa: ANN401
    """Apply one operation."""
    if node.is_Add:
        return sum(arguments[1:], arguments[0])
    if node.is_Mul:
        product = arguments[0]
        for factor in arguments[1:]:
            product = product * factor
        return product
    if node.is_Pow:
        return _power(arguments[0], node.args[1], arguments[1])
    if node.func in UNARY:
        return UNARY[node.func](arguments[0])
    if node.func in SEVERAL:
        return SEVERAL[node.func](*arguments)
    raise TypeError(f"no CasADi counterpart for {node.func}")


def _power(base: Any, exponent: sp.Expr, lowered: Any) -> Any:  # noqa: ANN401
    """Write small powers as products and roots, which are cheaper and exact."""
    if exponent == -1:
        return 1 / base
    if exponent == sp.Rational(1, 2):
        return ca.sqrt(base)
    if exponent == -sp.Rational(1, 2):
        return 1 / ca.sqrt(base)
    if exponent.is_Rational and (2 * exponent).is_integer and abs(exponent) <= 4:
        whole = base ** int(abs(exponent))
        power = whole if exponent.is_integer else whole * ca.sqrt(base)
        return power if exponent > 0 else 1 / power
    return base**lowered


@cache
def element_function(key: ElementKey, derivation: str) -> ca.Function:
    """Lower one element type.

    Parameters
    ----------
    key
        The element type, as in ``Instance.element``.
    derivation
        ``newton`` (the hand-written wrench) or ``lagrange`` (from the energies).

    Returns
    -------
    casadi.Function
        Named inputs (the element's arguments); outputs ``force`` (in the order of ``Element.freedoms``),
        ``potential``, ``loss`` (dissipated power, W) and the element's own outputs as ``out_<name>``.
    """
    written = make(key)
    leaves = {symbol: ca.SX.sym(symbol.name) for symbol in written.arguments}
    force = written.loads if derivation == "newton" else lagrange.forces(written)
    loss = sum(
        (sp.diff(written.dissipation, v) * v for v in written.velocities if written.dissipation.has(v)),
        sp.S.Zero,
    )
    reports = [output.expression for output in written.outputs.values()]
    force_, (potential, lost, *rest) = _split(lower([*force, written.potential, loss, *reports], leaves), len(force))
    names = [f"out_{name}" for name in written.outputs]
    return ca.Function(
        f"{key.name}_{derivation}", list(leaves.values()), [ca.vertcat(*force_), potential, lost, *rest],
        [symbol.name for symbol in leaves], ["force", "potential", "loss", *names],
    )  # fmt: skip


def _split(values: list[Any], count: int) -> tuple[list[Any], list[Any]]:
    """Cut a list in two."""
    return values[:count], values[count:]


@cache
def body_function(derivation: str) -> ca.Function:
    """Lower the accelerations of a body in its frame (inputs: the symbols of ``FrameMotion``)."""
    from .frames import FrameMotion

    motion = FrameMotion.symbols()
    leaves = {symbol: ca.SX.sym(symbol.name) for symbol in motion.arguments}
    rows = motion.newton() if derivation == "newton" else lagrange.frame_accelerations()
    names = list(vars(motion))
    return ca.Function("body", list(leaves.values()), lower(rows, leaves), names, ["ax", "ay", "au"])
