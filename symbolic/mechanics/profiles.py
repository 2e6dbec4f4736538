r"""Profiles over the mesh phase tau [cycles], as CasADi functions of tau and a few numbers.

All have the period of a tooth pitch (``tooth``: of the gear's turns) and are written by their distance from
the middle of a contact, wrapped to half a pitch either way, so that wrapping never falls where they vary.
"""

from collections.abc import Callable, Sequence
from functools import cache
from math import comb, pi
from typing import Any

import casadi as ca

Value = Any  # CasADi's SX, which carries no types


def _wrapped(cycles: Value, period: Value = 1) -> Value:
    """Return cycles less whole periods, from minus half a period to half a period."""
    return cycles - period * ca.floor(cycles / period + 0.5)


def _step(z: Value) -> Value:
    """Rise from 0 at z = 0 to 1 at z = 1 with six derivatives: the integral of (1 - y^2)^6 over y = 2 z - 1.

    An integrator of order five sees no edge where it begins and ends.
    """
    y = ca.fmin(ca.fmax(2 * z - 1, -1), 1)
    square, total = y**2, 0
    for n in range(6, -1, -1):
        total = total * square + (-1) ** n * comb(6, n) / (2 * n + 1)
    return 0.5 + 3003 / 2048 * y * total


def _smooth(tau: Value, level: Value, single: Value, double: Value, share: Value, width: Value) -> Value:
    """Return the stiffness of single and double contact with transitions of a width [cycles] around eq 9's jumps."""
    outward = ca.fabs(_wrapped(tau - share / 2))
    return single + (double - single) * _step((outward - share / 2) / width + 0.5)


def _series(tau: Value, level: Value, mean: Value, *amplitudes: Value) -> Value:
    """Return mean + sum of a_n cos(2 pi n tau) + b_n sin(2 pi n tau); the amplitudes come as a_1, b_1, a_2, ..."""
    one = ca.cos(2 * pi * tau), ca.sin(2 * pi * tau)
    total, cosine, sine = mean, *one
    for a, b in zip(amplitudes[::2], amplitudes[1::2], strict=True):
        total = total + a * cosine + b * sine
        cosine, sine = cosine * one[0] - sine * one[1], sine * one[0] + cosine * one[1]
    return total


def _arcs(tau: Value, level: Value, share: Value, *coefficients: Value) -> Value:
    """Return a parabola over single and one over double contact, each about the middle of its contact."""
    single, double = (
        c[0] + y * (c[1] + y * c[2])
        for c, y in (
            (coefficients[:3], _wrapped(tau - share / 2)),
            (coefficients[3:], _wrapped(tau - (1 + share) / 2)),
        )
    )
    return single + level * (double - single)


def _tooth(tau: Value, level: Value, size: Value, number: Value, teeth: Value, share: Value) -> Value:
    """Return the error of one tooth of a gear: full in its single contact, taken over and handed on in double."""
    past, rest = _wrapped(tau - number, teeth), 1 - share
    return size * (_step(past / rest + 1) - _step((past - share) / rest))


def _constant(tau: Value, level: Value, size: Value) -> Value:
    """Return what does not depend on the phase."""
    return size


def _smooth_mean(single: Value, double: Value, share: Value, width: Value) -> Value:
    """Return the mean of ``_smooth``: transitions take as much as they give."""
    return share * single + (1 - share) * double


def _arcs_mean(share: Value, *c: Value) -> Value:
    """Return the mean of ``_arcs``."""
    return share * (c[0] + c[2] * share**2 / 12) + (1 - share) * (c[3] + c[5] * (1 - share) ** 2 / 12)


#: Kind -> value at a phase, and what stands for it where nothing varies: its mean; a single tooth's error is left out.
KINDS: dict[str, tuple[Callable[..., Value], Callable[..., Value]]] = {
    "smooth": (_smooth, _smooth_mean),
    "series": (_series, lambda mean, *amplitudes: mean),
    "arcs": (_arcs, _arcs_mean),
    "tooth": (_tooth, lambda *numbers: 0),
    "constant": (_constant, lambda size: size),
}


@cache
def _function(kind: str, count: int) -> ca.Function:
    """Lower one kind: (tau, level, varying, numbers) -> value and its slope per cycle."""
    tau, level, varying = ca.SX.sym("tau"), ca.SX.sym("level"), ca.SX.sym("varying")
    numbers = [ca.SX.sym(f"n{i}") for i in range(count)]
    value, mean = (ca.SX(written) for written in (KINDS[kind][0](tau, level, *numbers), KINDS[kind][1](*numbers)))
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
        1, or 0 for the mean in place of what varies.
    numbers
        What shapes the profile, in the order of its function.
    """
    value, slope = _function(kind, len(numbers))(tau, level, varying, *numbers)
    return value, ca.densify(slope)
