"""Evaluate the book: its printed equations one after the other, in plain floating-point numbers."""

import math
from functools import cache

import sympy as sp
from numpy.polynomial import Polynomial

RISE = (Polynomial([1, 0, -1]) ** 6).integ()


def rise(z):
    """The integral that is printed as R(z)."""
    return 3003 / 2048 * (RISE(min(max(2 * z - 1, -1), 1)) - RISE(-1))


FUNCTIONS = {
    "LogCosh": lambda z: math.log(math.cosh(z)),
    "Step": lambda z: float(z > 0),
    "Switch": lambda g, hold: float(g + hold > 0),
    "Rest": lambda g, hold, z: float(z > 0 and g + hold <= 0),
    "Lesser": min,
    "Given": lambda z, value, slope: value,
    "Wrapped": lambda z: z - math.floor(z + 0.5),
    "Wrap": lambda z: z - math.floor(z + 0.5),
    "Sharing": lambda g, share: 1 - max(abs(g) - share / 2, 0) / (1 - share),
    "Rise": rise,
    "sign": lambda z: (z > 0) - (z < 0),
    "Heaviside": lambda z: float(z > 0),
}


@cache
def function(expression):
    """Compile a printed expression over all that stands free in it."""
    plain = expression.doit() if expression.has(sp.Sum, sp.Integral) else expression
    leaves = sorted(plain.free_symbols - {i.base.label for i in plain.atoms(sp.Indexed)} | plain.atoms(sp.Indexed), key=str)
    names = {leaf: sp.Dummy() for leaf in leaves}
    call = sp.lambdify(list(names.values()), plain.xreplace(names), modules=[FUNCTIONS, "math"])
    return leaves, call


def value(expression, known):
    """Evaluate one printed expression."""
    leaves, call = function(sp.sympify(expression))
    return call(*(known[leaf] for leaf in leaves))


def evaluate(assembly, vectors):
    """Return all that an assembly names, and the rates of its states.

    ``vectors`` maps x, s and p to their values by name.
    """
    known = {symbol: vectors[leaf.vector][leaf.name] for symbol, leaf in assembly.leaves.items()}
    for item in assembly.assignments:
        known[item.symbol] = value(item.value, known)
    return known, {state: value(rate, known) for state, rate in assembly.rates.items()}
