"""Lobatto quadrature on a smooth segment of motion.

Gauss's rule with both ends among its points (Abramowitz and Stegun 25.4.32): so both sides of a jump are seen.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import Legendre
from numpy.typing import NDArray

Vector = NDArray[np.float64]

MOST = 11
"""Points of the largest rule; what needs more is cut into panels."""
MOTION, FILTERED = 1e-6, 1e-3
"""Error of an integral of the fastest vibration, and of its product with the filter's fastest, over their size. Both
are bounds: most of a motion is slower, and the fastest part of it small."""
ANGLES = np.linspace(0.0, 15.0, 15001)
"""Angles [rad] in half a panel at which rules are tried."""


class Rules(NamedTuple):
    """Lobatto's rules of 2 to ``MOST`` points on 0..1, one after the other.

    Attributes
    ----------
    at, weight
        Points and weights, shape (MOST (MOST + 1) / 2 - 1,).
    motion, filtered
        Angle [rad] in half a panel up to which each rule errs by less than ``MOTION`` and ``FILTERED``,
        shape (MOST - 1,).
    """

    at: Vector
    weight: Vector
    motion: Vector
    filtered: Vector


@cache
def lobatto_rules() -> Rules:
    """Return the rules."""
    pairs = [_rule(count) for count in range(2, MOST + 1)]
    errors = [np.abs(np.exp(1j * np.outer(ANGLES, at)) @ weight / 2 - np.sinc(ANGLES / np.pi)) for at, weight in pairs]
    motion, filtered = (np.array([_reach(error, most) for error in errors]) for most in (MOTION, FILTERED))
    at = np.concatenate([(1 + at) / 2 for at, _ in pairs])
    return Rules(at, np.concatenate([weight / 2 for _, weight in pairs]), motion, filtered)


def _rule(count: int) -> tuple[Vector, Vector]:
    """Return a rule's points and weights on -1..1."""
    polynomial = Legendre.basis(count - 1)
    at = np.concatenate([[-1.0], np.sort(polynomial.deriv().roots().real), [1.0]])
    return at, np.asarray(2 / (count * (count - 1) * polynomial(at) ** 2))


def _reach(error: Vector, most: float) -> float:
    """Return the largest angle up to which an error stays below a bound."""
    return float(ANGLES[max(int(np.argmax(error > most)) - 1, 0)])
