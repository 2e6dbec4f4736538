"""Derivatives for sensitivities: gradients of w' f and of w' (df/dx) v."""

from functools import cached_property

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from ..model.function import Kernel
from ..model.library import Library

Vector = NDArray[np.float64]
Complex = NDArray[np.complex128]
Parts = tuple[Vector, Vector, Vector]
ComplexParts = tuple[Complex, Complex, Complex]


class Gradients:
    """Reverse derivatives of a model's right-hand side f(x, s, p), each a few times its cost.

    Parameters
    ----------
    library
        The model.
    """

    def __init__(self, library: Library) -> None:
        self.library = library
        graph = library.graphs["rhs"]
        self._point = [ca.SX.sym(graph.name_in(i), graph.sparsity_in(i)) for i in range(graph.n_in())]
        self._rates = graph.call(self._point)[0]

    @cached_property
    def _force(self) -> Kernel:
        w = ca.SX.sym("w", self._rates.numel())
        return self._kernel(ca.dot(w, self._rates), w)

    @cached_property
    def _bend(self) -> Kernel:
        x = self._point[0]
        v, w = ca.SX.sym("v", x.numel()), ca.SX.sym("w", x.numel())
        return self._kernel(ca.dot(w, ca.jtimes(self._rates, x, v)), v, w)

    def _kernel(self, value: ca.SX, *directions: ca.SX) -> Kernel:
        """Return the gradients of a number with respect to x, s and p."""
        parts = [ca.densify(ca.gradient(value, symbol)) for symbol in self._point]
        return Kernel(ca.Function("gradients", [*self._point, *directions], parts))

    def of_rates(self, x: Vector, s: Vector, p: Vector, w: Vector) -> Parts:
        """Return the gradients of w' f with respect to x, s and p."""
        return _copied(self._force(x, s, p, w))

    def of_product(self, x: Vector, s: Vector, p: Vector, v: Complex, w: Complex) -> ComplexParts:
        """Return the gradients of conj(w)' (df/dx) v with respect to x, s and p."""
        real = _sum(self._bend, x, s, p, ((v.real, w.real, 1.0), (v.imag, w.imag, 1.0)))
        imaginary = _sum(self._bend, x, s, p, ((v.imag, w.real, 1.0), (v.real, w.imag, -1.0)))
        one, two, three = (a + 1j * b for a, b in zip(real, imaginary, strict=True))
        return one, two, three


def _copied(parts: list[Vector]) -> Parts:
    x, s, p = (part.copy() for part in parts)
    return x, s, p


def _sum(kernel: Kernel, x: Vector, s: Vector, p: Vector, terms: tuple[tuple[Vector, Vector, float], ...]) -> Parts:
    """Add the gradients of several products; those with a zero vector are left out."""
    total = [np.zeros(len(part)) for part in (x, s, p)]
    for v, w, sign in terms:
        if v.any() and w.any():
            for sum_, part in zip(total, kernel(x, s, p, v, w), strict=True):
                sum_ += sign * part
    one, two, three = total
    return one, two, three
