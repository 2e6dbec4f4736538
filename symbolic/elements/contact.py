r"""Event functions of element laws, and switches that keep a law smooth between events.

A border is a zero of an event function g: teeth or a bearing come into contact or separate. By default ``Switch``
depends on the state alone, 1 where g > 0 and 0 elsewhere. During integration from border to border, ``hold`` (a force
or length larger than all others, 0 by default) keeps the initial side. So the right-hand side has no kink, and the
border can be located as a zero of g.
"""

import sympy as sp

from .base import real

HOLD = real("hold")


class Step(sp.Function):  # type: ignore[misc]  # SymPy is untyped
    """1 where z > 0, else 0, independent of any hold."""

    def _eval_derivative(self, symbol: sp.Symbol) -> sp.Expr:
        """Return 0, the slope on either side."""
        return sp.S.Zero


class Switch(sp.Function):  # type: ignore[misc]
    """1 where g + hold > 0, else 0: its arguments are the event function g and ``hold``."""

    def _eval_derivative(self, symbol: sp.Symbol) -> sp.Expr:
        """Return 0, the slope on either side."""
        return sp.S.Zero


class Rest(sp.Function):  # type: ignore[misc]
    """1 where z > 0 although the switch of the first two arguments is 0: contact without force."""

    def _eval_derivative(self, symbol: sp.Symbol) -> sp.Expr:
        """Return 0, the slope on either side."""
        return sp.S.Zero


class Lesser(sp.Function):  # type: ignore[misc]
    """The smaller of two; for event functions only, never differentiated."""


class Given(sp.Function):  # type: ignore[misc]
    """A quantity computed elsewhere as a function of z: its arguments are z, its value and its slope there."""

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """Return the slope; the value's own argument is not varied."""
        if argindex != 1:
            raise sp.function.ArgumentIndexError(self, argindex)
        return self.args[2]
