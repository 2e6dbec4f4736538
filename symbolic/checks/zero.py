r"""Exact zero test for the elements' expressions, much faster than ``sympy.simplify``.

An expression is read as a fraction over a polynomial ring whose generators are its symbols, its square roots
(:math:`R^2` is the radicand) and its other functions, which stay opaque. Known squares (:math:`e_x^2 + e_y^2 = 1`,
:math:`s^2 = 1`, :math:`\sin^2 + \cos^2 = 1`) keep every even power of such a generator out. Denominators are kept as
products of factors, so a common denominator is their least common multiple, not the product of all. The expression
vanishes if its reduced numerator has no terms. The test is sound: it uses only valid rules, and an unknown relation
makes it answer no.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from math import isqrt, lcm
from typing import Any

import sympy as sp
from sympy.polys.domains import ZZ
from sympy.polys.rings import ring

Poly = Any  # SymPy's PolyElement, which carries no types
PAIRS = {sp.sin: (sp.cos, 1, -1), sp.sinh: (sp.cosh, -1, 1)}  # f^2 = a + b g^2


@dataclass(frozen=True)
class Fraction:
    """numerator / (scale * product of factors to their powers), with integer coefficients."""

    numerator: Poly
    scale: int = 1
    factors: Mapping[Poly, int] = field(default_factory=dict)


def vanishing(
    expressions: Sequence[sp.Expr],
    squares: Mapping[sp.Symbol, sp.Expr] | None = None,
    shifts: Mapping[sp.Symbol, sp.Symbol] | None = None,
) -> list[bool]:
    """Tell which expressions are identically zero.

    Parameters
    ----------
    expressions
        Expressions to test; common parts are processed once.
    squares
        Symbol -> expression of its square, if known.
    shifts
        Symbol -> origin from which it is measured instead (a change of variables that keeps
        differences of positions short).

    Returns
    -------
    list of bool
        True where the expression is proven to vanish wherever it is defined.
    """
    quotient = Quotient([sp.sympify(e) for e in expressions], squares or {}, shifts or {})
    return [quotient.is_zero(sp.sympify(expression)) for expression in expressions]


def generators(expressions: Iterable[sp.Expr]) -> list[sp.Expr]:
    """List the generators of expressions; radicands come before their roots."""
    found: dict[sp.Expr, None] = {}
    seen: set[sp.Basic] = set()

    def visit(node: sp.Expr) -> None:
        if node in seen or node.is_Rational or node.is_Float:
            return
        seen.add(node)
        if node.is_Pow and (2 * node.exp).is_Integer:
            visit(node.base)
            if not node.exp.is_Integer:
                found.setdefault(sp.sqrt(node.base))
        elif node.is_Add or node.is_Mul:
            for argument in node.args:
                visit(argument)
        elif node.func is sp.tanh or node.func in PAIRS:
            sine, cosine = (sp.sinh, sp.cosh) if node.func is sp.tanh else (node.func, PAIRS[node.func][0])
            found.setdefault(cosine(node.args[0]))
            found.setdefault(sine(node.args[0]))
        else:
            found.setdefault(node)

    for expression in expressions:
        visit(expression)
    return list(found)


class Quotient:
    """Fractions over the polynomials in some generators, modulo the known squares."""

    def __init__(
        self,
        expressions: Sequence[sp.Expr],
        squares: Mapping[sp.Symbol, sp.Expr],
        shifts: Mapping[sp.Symbol, sp.Symbol],
    ) -> None:
        names = generators([*expressions, *squares.values(), *shifts, *shifts.values()])
        names += [symbol for symbol in squares if symbol not in names]
        self.ring, *gens = ring([f"g{i}" for i in range(len(names))], ZZ)
        self.names = names
        self.place = {name: i for i, name in enumerate(names)}
        self.gens = gens
        self.squares: dict[int, Poly] = {}
        self.memory: dict[sp.Basic, Fraction] = {name: Fraction(gen) for name, gen in zip(names, gens, strict=True)}
        for symbol, origin in shifts.items():
            self.memory[symbol] = Fraction(self.gens[self.place[symbol]] + self.gens[self.place[origin]])
        for symbol, square in squares.items():
            self.squares[self.place[symbol]] = self.fraction(square).numerator
        for name in names:
            self._relate(name)

    def _relate(self, name: sp.Expr) -> None:
        """Note the square of a root or of a sine."""
        i = self.place[name]
        if name.func in PAIRS:
            other, constant, factor = PAIRS[name.func]
            self.squares[i] = constant + factor * self.gens[self.place[other(name.args[0])]] ** 2
        elif name.is_Pow:
            radicand = self.fraction(name.base)
            if radicand.scale == 1 and not radicand.factors:
                self.squares[i] = radicand.numerator
                root = self._monomial_root(radicand.numerator)
                self.memory[name] = Fraction(self.gens[i] if root is None else root)

    def _monomial_root(self, radicand: Poly) -> Poly | None:
        """Return the root of a square of positive symbols, else None."""
        terms = list(radicand.terms())
        if len(terms) != 1:
            return None
        powers, coefficient = terms[0]
        number = isqrt(max(int(coefficient), 0))
        even = all(p % 2 == 0 and (p == 0 or self.names[i].is_positive) for i, p in enumerate(powers))
        if not even or number**2 != coefficient:
            return None
        return self.ring.from_dict({tuple(p // 2 for p in powers): ZZ(number)})

    def is_zero(self, expression: sp.Expr) -> bool:
        """Tell whether an expression vanishes; no if it divides by zero."""
        try:
            return not self.fraction(expression).numerator
        except ZeroDivisionError:
            return False

    def fraction(self, node: sp.Expr) -> Fraction:
        """Read an expression as a fraction; every node once."""
        if node not in self.memory:
            self.memory[node] = self._read(node)
        return self.memory[node]

    def _read(self, node: sp.Expr) -> Fraction:
        """Read one node."""
        if node.is_Float or node.is_Rational:
            exact = sp.Rational(node)
            return Fraction(self.ring(int(exact.p)), int(exact.q))
        if node.is_Add:
            return self.add([self.fraction(argument) for argument in node.args])
        if node.is_Mul:
            return self.multiply([self.fraction(argument) for argument in node.args])
        if node.is_Pow:
            base = node.base if node.exp.is_Integer else sp.sqrt(node.base)
            power = int(node.exp if node.exp.is_Integer else 2 * node.exp)
            factor = self.fraction(base) if power > 0 else self.invert(self.fraction(base))
            return self.multiply([factor] * abs(power))
        if node.func is sp.tanh:
            argument = node.args[0]
            return self.multiply([self.fraction(sp.sinh(argument)), self.invert(self.fraction(sp.cosh(argument)))])
        raise TypeError(f"{node} was not listed as a generator")

    def add(self, terms: Sequence[Fraction]) -> Fraction:
        """Add over the least common product of factors."""
        scale = lcm(*(term.scale for term in terms))
        factors: dict[Poly, int] = {}
        for term in terms:
            for factor, power in term.factors.items():
                factors[factor] = max(power, factors.get(factor, 0))
        total = self.ring.zero
        for term in terms:
            numerator = term.numerator * (scale // term.scale)
            for factor, power in factors.items():
                for _ in range(power - term.factors.get(factor, 0)):
                    numerator = self.reduce(numerator * factor)
            total += numerator
        return Fraction(total, scale, factors) if total else Fraction(total)

    def multiply(self, terms: Sequence[Fraction]) -> Fraction:
        """Multiply, shortest numerators first."""
        numerator, scale = self.ring.one, 1
        factors: dict[Poly, int] = {}
        for term in sorted(terms, key=lambda t: len(t.numerator)):
            numerator = self.reduce(numerator * term.numerator)
            scale *= term.scale
            for factor, power in term.factors.items():
                factors[factor] = factors.get(factor, 0) + power
        return Fraction(numerator, scale, factors)

    def invert(self, term: Fraction) -> Fraction:
        """Invert a fraction; a generator with a known square moves to the numerator, 1/g = g/g^2."""
        if not term.numerator:
            raise ZeroDivisionError
        numerator = self.ring(term.scale)
        for factor, power in term.factors.items():
            numerator = self.reduce(numerator * factor**power)
        content, rest = term.numerator.primitive()
        powers = [min(column) for column in zip(*rest.monoms(), strict=True)]
        rest = rest.quo(self.ring.from_dict({tuple(powers): ZZ(1)}))
        result = Fraction(numerator, 1, {})
        for i, power in enumerate(powers):
            for _ in range(power):
                result = self.multiply([result, self._inverse_generator(i)])
        return self.multiply([result, self._over(rest * content)])

    def _inverse_generator(self, i: int) -> Fraction:
        """Return 1/g."""
        if i not in self.squares:
            return Fraction(self.ring.one, 1, {self.gens[i]: 1})
        return self.multiply([Fraction(self.gens[i]), self._over(self.squares[i])])

    def _over(self, polynomial: Poly) -> Fraction:
        """Return 1/polynomial, its content and sign taken out of the factor."""
        content, rest = polynomial.primitive()
        sign = -1 if rest.LC < 0 else 1
        if rest == sign:
            return Fraction(self.ring(sign), int(content))
        return Fraction(self.ring(sign), int(content), {rest * sign: 1})

    def reduce(self, polynomial: Poly) -> Poly:
        """Replace even powers of generators whose square is known, nested roots first."""
        for i in sorted(self.squares, reverse=True):
            highest = max((powers[i] for powers in polynomial), default=0)
            if highest < 2:
                continue
            parts: dict[int, dict[tuple[int, ...], Any]] = {}
            for powers, coefficient in polynomial.items():
                half, odd = divmod(powers[i], 2)
                parts.setdefault(half, {})[(*powers[:i], odd, *powers[i + 1 :])] = coefficient
            polynomial = self.ring.zero
            for half in range(highest // 2, -1, -1):
                polynomial = polynomial * self.squares[i] + self.ring.from_dict(parts.get(half, {}))
        return polynomial
