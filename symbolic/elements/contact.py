r"""Regimes of a law: smooth on either side of a border, and which side holds.

A border is where an indicator g passes through zero: teeth that come to push or cease to, a race that is
reached. ``Switch`` is 1 where g > 0 and 0 elsewhere, and so by the state alone; but while an integrator
goes from border to border, ``hold`` (a force or length beyond all others, 0 by default) keeps the side
on which it began, so that what it integrates has no kink and the border can be located as a zero of g.
"""

import sympy as sp

from .base import real

HOLD = real("hold")


class Step(sp.Function):  # type: ignore[misc]  # SymPy is untyped
    """1 where z > 0, else 0, whatever is held."""

    def _eval_derivative(self, symbol: sp.Symbol) -> sp.Expr:
        """Return 0, the slope on either side."""
        return sp.S.Zero


class Switch(sp.Function):  # type: ignore[misc]
    """1 where g + hold > 0, else 0: its arguments are the indicator g and what holds a side."""

    def _eval_derivative(self, symbol: sp.Symbol) -> sp.Expr:
        """Return 0, the slope on either side."""
        return sp.S.Zero


class Rest(sp.Function):  # type: ignore[misc]
    """1 where z > 0 although the switch of the first two arguments is 0: touching without a push."""

    def _eval_derivative(self, symbol: sp.Symbol) -> sp.Expr:
        """Return 0, the slope on either side."""
        return sp.S.Zero


class Lesser(sp.Function):  # type: ignore[misc]
    """The smaller of two; an indicator only, never differentiated."""


class Given(sp.Function):  # type: ignore[misc]
    """A quantity that is computed elsewhere, over an argument z: its arguments are z, its value and its slope there."""

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """Return the slope; the value's own argument is not varied."""
        if argindex != 1:
            raise sp.function.ArgumentIndexError(self, argindex)
        return self.args[2]
