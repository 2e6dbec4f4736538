r"""Printed stiffness and errors over the mesh phase; the C is made of ``profiles``.

:math:`\operatorname{wrap}(z)` is z less its nearest whole number; :math:`\operatorname{R}` rises smoothly from 0
at z = 0 to 1 at z = 1.
"""

from collections.abc import Callable
from dataclasses import dataclass

import sympy as sp

from ..elements.base import positive, real
from ..elements.tooth_pairs import Wrapped

TAU, LEVEL = real("tau"), real("level")
K1, K2, MEAN = positive("k_1"), positive("k_2"), real("k_mean")
SHARE, WIDTH = positive("varsigma"), positive("width")
SIZE, TOOTH, TEETH, VALUE = real("size"), real("tooth"), positive("teeth"), real("value")
COS, SIN, ORDER = sp.IndexedBase("a"), sp.IndexedBase("b"), sp.Symbol("n", integer=True, positive=True)
COUNT = sp.Symbol("H", integer=True, positive=True)
ARCS = tuple(tuple(real(f"c_{i}{mark}") for i in range(3)) for mark in ("", "'"))
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


def _smooth() -> sp.Expr:
    """Return two levels with transitions between them."""
    outward = sp.Abs(Wrap(TAU - SHARE / 2))
    return K1 + (K2 - K1) * Rise((outward - SHARE / 2) / WIDTH + sp.Rational(1, 2))


def _series() -> sp.Expr:
    """Return a mean and harmonics."""
    angle = 2 * sp.pi * ORDER * TAU
    return MEAN + sp.Sum(COS[ORDER] * sp.cos(angle) + SIN[ORDER] * sp.sin(angle), (ORDER, 1, COUNT))


def _arcs() -> sp.Expr:
    """Return a parabola over single contact and one over double contact."""
    single, double = (
        c[0] + c[1] * y + c[2] * y**2
        for c, y in zip(ARCS, (Wrap(TAU - SHARE / 2), Wrap(TAU - (1 + SHARE) / 2)), strict=True)
    )
    return single + LEVEL * (double - single)


def _tooth() -> sp.Expr:
    """Return the error of one tooth, taken over and handed on in double contact."""
    past = TEETH * Wrap((TAU - TOOTH) / TEETH)
    return SIZE * (Rise(past / (1 - SHARE) + 1) - Rise((past - SHARE) / (1 - SHARE)))


def _amplitudes(count: int) -> tuple[sp.Expr, ...]:
    """Return mean and amplitudes, a_1, b_1, a_2, ..."""
    pairs = [pair for n in range(1, (count - 1) // 2 + 1) for pair in (COS[n], SIN[n])]
    return (MEAN, *pairs)


WAVES: dict[str, Wave] = {
    "smooth": Wave("two levels with smooth transitions", _smooth(), lambda count: (K1, K2, SHARE, WIDTH)),
    "series": Wave("mean and harmonics", _series(), _amplitudes),
    "arcs": Wave("parabolas over single and double contact", _arcs(), lambda count: (SHARE, *ARCS[0], *ARCS[1])),
    "tooth": Wave("error of a single tooth", _tooth(), lambda count: (SIZE, TOOTH, TEETH, SHARE)),
    "constant": Wave("constant, of a pin out of place", VALUE, lambda count: (VALUE,)),
}
"""Kind of ``profiles.KINDS`` -> how it is printed."""
