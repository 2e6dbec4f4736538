"""Evaluate the book: its printed equations one after the other, in plain floating-point numbers."""

import math

import sympy as sp
from numpy.polynomial import Polynomial

RISE = (Polynomial([1, 0, -1]) ** 6).integ()


def rise(z):
    """The integral that is printed as R(z)."""
    return 3003 / 2048 * (RISE(min(max(2 * z - 1, -1), 1)) - RISE(-1))


def wrap(z):
    """A number less the nearest whole one."""
    return z - math.floor(z + 0.5)


FUNCTIONS = {
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
    "tanh": math.tanh,
    "atan": math.atan,
    "atan2": math.atan2,
    "log": math.log,
    "Abs": abs,
    "Min": min,
    "Max": max,
    "LogCosh": lambda z: math.log(math.cosh(z)),
    "Step": lambda z: float(z > 0),
    "Switch": lambda g, hold: float(g + hold > 0),
    "Rest": lambda g, hold, z: float(z > 0 and g + hold <= 0),
    "Lesser": min,
    "Given": lambda z, value, slope: value,
    "Wrapped": wrap,
    "Wrap": wrap,
    "Sharing": lambda g, share: 1 - max(abs(g) - share / 2, 0) / (1 - share),
    "Rise": rise,
    "sign": lambda z: float((z > 0) - (z < 0)),
}


def value(expression, known):
    """Evaluate one printed expression; the memory is that of its common parts."""
    plain = sp.sympify(expression)
    return _value(plain.doit() if plain.has(sp.Sum, sp.Integral) else plain, dict(known))


def _value(node, memory):
    """Evaluate one node, once."""
    if node not in memory:
        memory[node] = float(node) if node.is_number else _apply(node, [_value(part, memory) for part in node.args])
    return memory[node]


def _apply(node, parts):
    """Apply one operation."""
    if node.is_Add:
        return math.fsum(parts)
    if node.is_Mul:
        return math.prod(parts)
    return parts[0] ** parts[1] if node.is_Pow else FUNCTIONS[node.func.__name__](*parts)


def evaluate(assembly, vectors):
    """Return all that an assembly names, and the rates of its states.

    ``vectors`` maps x, s and p to their values by name.
    """
    known = {symbol: vectors[leaf.vector][leaf.name] for symbol, leaf in assembly.leaves.items()}
    for item in assembly.assignments:
        known[item.symbol] = value(item.value, known)
    return known, {state: value(rate, known) for state, rate in assembly.rates.items()}
