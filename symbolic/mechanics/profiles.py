"""Profiles over the mesh phase tau [cycles]: stiffness and errors, written once for the C and for the book.

All have the period of a tooth pitch (``tooth``: of a gear revolution). They are functions of the distance from the
middle of a contact, wrapped to plus or minus half a pitch, so that they are constant where it wraps.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from math import comb
from typing import Any

import casadi as ca

Value = Any  # a number, CasADi's SX or SymPy's Expr


@dataclass(frozen=True)
class ProfileFunctions:
    """Functions used by profiles, in one algebra (CasADi or SymPy).

    Attributes
    ----------
    half
        One half.
    magnitude
        |z|.
    wrap
        (z, period) -> z less whole periods, from minus half a period to half a period.
    rise
        z -> 0 up to z = 0, 1 from z = 1 on, smooth between.
    polynomial
        (y, coefficients) -> c_0 + c_1 y + c_2 y^2.
    harmonics
        (mean, tau, amplitudes) -> mean + sum of a_n cos(2 pi n tau) + b_n sin(2 pi n tau); the amplitudes come as a_1,
        b_1, a_2, ...
    """

    half: Value
    magnitude: Callable[[Value], Value]
    wrap: Callable[[Value, Value], Value]
    rise: Callable[[Value], Value]
    polynomial: Callable[[Value, Sequence[Value]], Value]
    harmonics: Callable[[Value, Value, Sequence[Value]], Value]


@dataclass(frozen=True)
class ProfileKind:
    """A kind of profile.

    Attributes
    ----------
    title
        What it is.
    letters
        Letters of its numbers in the book, without amplitudes, of which there may be any number.
    value
        (functions, tau, level, *numbers) -> value at a phase.
    mean
        (*numbers) -> mean, the value where nothing varies; zero for a single tooth's error.
    """

    title: str
    letters: tuple[str, ...]
    value: Callable[..., Value]
    mean: Callable[..., Value]


def _smooth(
    of: ProfileFunctions, tau: Value, level: Value, single: Value, double: Value, share: Value, width: Value
) -> Value:
    """Return the stiffness of single and double contact with transitions of a width [cycles] around eq 9's jumps."""
    outward = of.magnitude(of.wrap(tau - share / 2, 1))
    return single + (double - single) * of.rise((outward - share / 2) / width + of.half)


def _series(of: ProfileFunctions, tau: Value, level: Value, mean: Value, *amplitudes: Value) -> Value:
    """Return a mean and harmonics."""
    return of.harmonics(mean, tau, amplitudes)


def _arcs(of: ProfileFunctions, tau: Value, level: Value, share: Value, *coefficients: Value) -> Value:
    """Return a parabola over single and one over double contact, each about the middle of its contact."""
    single = of.polynomial(of.wrap(tau - share / 2, 1), coefficients[:3])
    double = of.polynomial(of.wrap(tau - (1 + share) / 2, 1), coefficients[3:])
    return single + level * (double - single)


def _tooth(
    of: ProfileFunctions, tau: Value, level: Value, size: Value, number: Value, teeth: Value, share: Value
) -> Value:
    """Return the error of one tooth of a gear: full in its single contact, blended with its neighbours' in double."""
    past, rest = of.wrap(tau - number, teeth), 1 - share
    return size * (of.rise(past / rest + 1) - of.rise((past - share) / rest))


def _constant(of: ProfileFunctions, tau: Value, level: Value, size: Value) -> Value:
    """Return a value independent of the phase."""
    return size


def _smooth_mean(single: Value, double: Value, share: Value, width: Value) -> Value:
    """Return the mean of ``_smooth``: transitions do not change it."""
    return share * single + (1 - share) * double


def _arcs_mean(share: Value, *c: Value) -> Value:
    """Return the mean of ``_arcs``."""
    return share * (c[0] + c[2] * share**2 / 12) + (1 - share) * (c[3] + c[5] * (1 - share) ** 2 / 12)


_PARABOLAS = tuple(f"c_{i}{mark}" for mark in ("", "'") for i in range(3))
KINDS: dict[str, ProfileKind] = {
    "smooth": ProfileKind(
        "two levels with smooth transitions", ("k_1", "k_2", "varsigma", "width"), _smooth, _smooth_mean
    ),
    "series": ProfileKind("mean and harmonics", ("k_mean",), _series, lambda mean, *amplitudes: mean),
    "arcs": ProfileKind("parabolas over single and double contact", ("varsigma", *_PARABOLAS), _arcs, _arcs_mean),
    "tooth": ProfileKind("error of a single tooth", ("size", "tooth", "teeth", "varsigma"), _tooth, lambda *numbers: 0),
    "constant": ProfileKind("constant, of a pin out of place", ("value",), _constant, lambda size: size),
}
"""Kinds of profiles by name."""


# --- as graphs


def _rise(z: Value) -> Value:
    """Rise with six derivatives: the integral of (1 - y^2)^6 over y = 2 z - 1.

    For an integrator of order five its ends are smooth.
    """
    y = ca.fmin(ca.fmax(2 * z - 1, -1), 1)
    square, total = y**2, 0
    for n in range(6, -1, -1):
        total = total * square + (-1) ** n * comb(6, n) / (2 * n + 1)
    return 0.5 + 3003 / 2048 * y * total


def _harmonics(mean: Value, tau: Value, amplitudes: Sequence[Value]) -> Value:
    """Sum up harmonics, each computed from the previous one by a rotation."""
    one = ca.cos(2 * ca.pi * tau), ca.sin(2 * ca.pi * tau)
    total, cosine, sine = mean, *one
    for a, b in zip(amplitudes[::2], amplitudes[1::2], strict=True):
        total = total + a * cosine + b * sine
        cosine, sine = cosine * one[0] - sine * one[1], sine * one[0] + cosine * one[1]
    return total


GRAPHS = ProfileFunctions(
    half=0.5,
    magnitude=ca.fabs,
    wrap=lambda z, period: z - period * ca.floor(z / period + 0.5),
    rise=_rise,
    polynomial=lambda y, c: c[0] + y * (c[1] + y * c[2]),
    harmonics=_harmonics,
)
"""Functions of profiles in CasADi."""


@cache
def _function(kind: str, count: int) -> ca.Function:
    """Lower one kind: (tau, level, varying, numbers) -> value and its slope per cycle."""
    tau, level, varying = ca.SX.sym("tau"), ca.SX.sym("level"), ca.SX.sym("varying")
    numbers = [ca.SX.sym(f"n{i}") for i in range(count)]
    value, mean = ca.SX(KINDS[kind].value(GRAPHS, tau, level, *numbers)), ca.SX(KINDS[kind].mean(*numbers))
    results = [mean + varying * (value - mean), varying * ca.jacobian(value, tau)]
    return ca.Function(kind, [tau, level, varying, *numbers], results)


def evaluate(kind: str, tau: Value, level: Value, varying: Value, numbers: Sequence[Value]) -> tuple[Value, Value]:
    """Return a profile's value and its slope per cycle at a phase.

    Parameters
    ----------
    kind
        A key of ``KINDS``.
    tau, level
        Mesh phase [cycles], and mesh level where the profile jumps with it.
    varying
        1, or 0 for the mean.
    numbers
        Parameters of the profile, in the order of its function.
    """
    value, slope = _function(kind, len(numbers))(tau, level, varying, *numbers)
    return value, ca.densify(slope)
