"""Functions of one-sided contact, each of its own so that derivatives stay what they are between kinks."""

import sympy as sp


class Step(sp.Function):  # type: ignore[misc]  # SymPy is untyped
    """1 where z > 0, else 0."""

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """Return 0, the slope on either side."""
        return sp.S.Zero


class Ramp(sp.Function):  # type: ignore[misc]
    """The positive part of z."""

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """Return the step."""
        return Step(self.args[0])


class HalfSquare(sp.Function):  # type: ignore[misc]
    """Half the square of the positive part, the potential of ``Ramp``."""

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """Return the positive part."""
        return Ramp(self.args[0])


class NotBelow(sp.Function):  # type: ignore[misc]
    """The larger of z and a floor below zero: a damper's force that must not pull more than the spring pushes."""

    @classmethod
    def eval(cls, z: sp.Expr, floor: sp.Expr) -> sp.Expr | None:
        """Return 0 for z = 0, since the floor lies below."""
        return sp.S.Zero if z.is_zero else None


class NotBelowLoss(sp.Function):  # type: ignore[misc]
    """Pseudo-potential, in the rate v, of the force u = ``NotBelow(c v, floor)``: u v - u^2 / 2 c."""

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """Return the force; only the derivative by the rate, the first argument, is known."""
        if argindex != 1:
            raise sp.function.ArgumentIndexError(self, argindex)
        rate, damping, floor = self.args
        return NotBelow(damping * rate, floor)


class Given(sp.Function):  # type: ignore[misc]
    """A quantity that is computed elsewhere, over an argument z: its arguments are z, its value and its slope there."""

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """Return the slope; the value's own argument is not varied."""
        if argindex != 1:
            raise sp.function.ArgumentIndexError(self, argindex)
        return self.args[2]
