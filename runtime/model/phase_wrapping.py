"""Phase wrapping: whole revolutions are taken off mesh phases and angles without loss.

A speed ratio of gears is a ratio of whole numbers, so how far a mesh phase comes in N turns of the
reference is known exactly, and so is what is left of it after whole periods.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import lcm, pi

import numpy as np
from ltcgear.generated.contract import Clock, Manifest
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Whole = NDArray[np.int64]

TURN = 2 * pi
LARGEST, NEAR = 10**6, 1e-14
"""Denominators that speed ratios of teeth may have, and how close [relative] a number then comes to one."""


@dataclass(frozen=True)
class ClockNumbers:
    """A clock in numbers: index of its start, advance a turn of the reference, period, its unit [cycles] or [rad]."""

    index: int
    advance: Fraction
    period: int
    unit: float
    mesh: str

    def after(self, turns: int) -> tuple[int, float]:
        """Return the whole periods [cycles] that go by in some turns of the reference, and the rest [unit]."""
        below = self.advance.denominator
        rest = self.advance.numerator * turns % (below * self.period)
        return (self.advance.numerator * turns - rest) // below, self.unit * (rest / below)


class Clocks:
    """What becomes of a model's clocks when whole turns are taken off the reference angle.

    Parameters
    ----------
    manifest
        Tells the clocks.
    p
        Parameters at reference angle 0, shape (n_p,).
    """

    def __init__(self, manifest: Manifest, p: Vector) -> None:
        self.first = np.array(p, dtype=np.float64)
        self.courses = read_courses(manifest, p)
        self.by_mesh = {course.mesh: course for course in self.courses if course.mesh}
        names = [state.name for state in manifest.states]
        self.angle = names.index("reference.angle") if "reference.angle" in names else None

    def turns_in(self, phi: float) -> int:
        """Return the whole turns in a reference angle [rad], towards zero; one that lacks a rounding is whole."""
        return int(phi / TURN * (1 + 4 * np.finfo(float).eps))

    def parameters(self, turns: int) -> Vector:
        """Return the parameters for reference angles from which some turns have been taken off."""
        p = self.first.copy()
        for course in self.courses:
            p[course.index] += course.after(turns)[1]
        return p

    def cycles(self, meshes: Sequence[str], turns: int) -> Whole:
        """Return the whole cycles by which some turns reduce the phases of meshes; 0 for a mesh at rest."""
        found = (self.by_mesh.get(mesh) for mesh in meshes)
        return np.array([course.after(turns)[0] if course else 0 for course in found], dtype=np.int64)

    def outputs(self, batch: Callable[..., Vector], x: Vector, s: Vector, phi: Vector | None, turns: Whole) -> Vector:
        """Evaluate the outputs at many times.

        Parameters
        ----------
        batch
            The model's ``outputs``.
        x, s
            States, levels and signals, shapes (m, n) and (m, n_s).
        phi, turns
            Reference angles [rad] less whole turns, None if those of the states lack them, and these, shapes (m,).

        Returns
        -------
        numpy.ndarray
            Shape (m, n_y). Phases of meshes lack the cycles that the turns took off, see `unwound`.
        """
        cuts = np.flatnonzero(np.diff(turns)) + 1
        if self.angle is not None and phi is not None:
            x = x.copy()
            x[:, self.angle] = phi
        found = [
            batch(x[first:last], s[first:last], self.parameters(int(turns[first])))
            for first, last in pairwise([0, *cuts, len(turns)])
        ]
        return found[0] if len(found) == 1 else np.concatenate(found)

    def unwound(self, meshes: Sequence[str], turns: Whole) -> Vector:
        """Return what the phases of meshes lack after some turns [cycles], shape (m, meshes)."""
        different, place = np.unique(turns, return_inverse=True)
        lacking = np.array([self.cycles(meshes, int(each)) for each in different], dtype=np.float64)
        return np.asarray(lacking.reshape(len(different), len(meshes))[place])


def read_courses(manifest: Manifest, p: Vector) -> list[ClockNumbers]:
    """Return a model's clocks in numbers, with its parameters' values, shape (n_p,)."""
    units = dict(manifest.parameters)
    number = {name: float(value) for (name, _), value in zip(manifest.parameters, p, strict=True)}
    index = {name: i for i, name in enumerate(units)}
    return [
        ClockNumbers(
            index[clock.start], _advance(clock, number), lcm(*(round(number[name]) for name in clock.periods)),
            TURN if units[clock.start] == "rad" else 1.0, clock.mesh,
        )
        for clock in manifest.clocks
    ]  # fmt: skip


def _advance(clock: Clock, number: dict[str, float]) -> Fraction:
    """Return the cycles or turns by which a clock advances in a turn of the reference."""
    teeth, ratio, frame = (
        rational(number[name]) if name else Fraction(other)
        for name, other in ((clock.teeth, 1), (clock.ratio, 0), (clock.frame, 0))
    )
    return teeth * (ratio - frame)


def rational(value: float) -> Fraction:
    """Return the ratio of whole numbers that a number approximates; the number itself if none is close enough."""
    near = Fraction(value).limit_denominator(LARGEST)
    return near if abs(near - Fraction(value)) <= NEAR * abs(value) else Fraction(value)
