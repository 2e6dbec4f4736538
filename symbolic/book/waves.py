r"""Printed profiles over the mesh phase: letters and functions.

:math:`\operatorname{wrap}(z)` is z less its nearest whole number; :math:`\operatorname{R}` rises smoothly from 0
at z = 0 to 1 at z = 1.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import sympy as sp

from ..elements.base import real
from ..elements.tooth_pairs import Wrapped
from ..mechanics.profiles import KINDS, ProfileFunctions, ProfileKind

TAU, LEVEL = real("tau"), real("level")
COS, SIN, ORDER = sp.IndexedBase("a"), sp.IndexedBase("b"), sp.Symbol("n", integer=True, positive=True)
COUNT = sp.Symbol("H", integer=True, positive=True)
ZETA = real("zeta")


class Wrap(Wrapped):
    """A phase less the nearest whole number, as a real function with a slope between its jumps."""

    is_extended_real = True

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """Return 1."""
        return sp.S.One


class Rise(sp.Function):  # type: ignore[misc]  # SymPy is untyped
    """Smooth rise from 0 at z = 0 to 1 at z = 1, with six derivatives."""

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """Return the slope."""
        return sp.Rational(3003, 1024) * (1 - _middle(self.args[0]) ** 2) ** 6

    @classmethod
    def definition(cls, z: sp.Expr) -> sp.Expr:
        """Return the integral that it is."""
        return sp.Rational(3003, 2048) * sp.Integral((1 - ZETA**2) ** 6, (ZETA, -1, _middle(z)))


def _middle(z: sp.Expr) -> sp.Expr:
    """Return 2 z - 1 within -1 and 1."""
    return sp.Min(sp.Max(2 * z - 1, -1), 1)


@dataclass(frozen=True)
class Wave:
    """A quantity over the phase: what it is called, its formula and the letters of its numbers, in their order."""

    title: str
    formula: sp.Expr
    numbers: Callable[[int], tuple[sp.Expr, ...]]


def _sum(mean: sp.Expr, tau: sp.Expr, amplitudes: Sequence[sp.Expr]) -> sp.Expr:
    """Return a mean and harmonics, for any number of amplitudes."""
    angle = 2 * sp.pi * ORDER * tau
    return mean + sp.Sum(COS[ORDER] * sp.cos(angle) + SIN[ORDER] * sp.sin(angle), (ORDER, 1, COUNT))


PRINTED = ProfileFunctions(
    half=sp.Rational(1, 2),
    magnitude=sp.Abs,
    wrap=lambda z, period: period * Wrap(z / period),
    rise=Rise,
    polynomial=lambda y, c: sum(factor * y**power for power, factor in enumerate(c)),
    harmonics=_sum,
)
"""Functions of profiles in SymPy."""


def _amplitudes(count: int) -> tuple[sp.Expr, ...]:
    """Return mean and amplitudes, a_1, b_1, a_2, ..."""
    pairs = [pair for n in range(1, (count - 1) // 2 + 1) for pair in (COS[n], SIN[n])]
    return (real("k_mean"), *pairs)


def _wave(name: str, kind: ProfileKind) -> Wave:
    """Write a kind of profile in its letters."""
    letters = tuple(map(real, kind.letters))
    formula = kind.value(PRINTED, TAU, LEVEL, *letters)
    return Wave(kind.title, formula, _amplitudes if name == "series" else lambda count: letters)


WAVES = {name: _wave(name, kind) for name, kind in KINDS.items()}
"""Kind of profile -> how it is printed."""
