"""Matrix exponentials: exact motion of a model that is linear between its stiffness jumps.

Between two jumps x' = A x + b, whose solution is that of (x, 1)' = G (x, 1), a matrix exponential. The instants
of the jumps follow from kinematics: at a held speed a mesh phase is a straight line in time. Nothing here is
shared with the integrators.
"""

from collections.abc import Iterator
from fractions import Fraction
from itertools import pairwise
from math import lcm

import numpy as np
from ltcgear.generated.errors import LtcgearError
from numpy.typing import NDArray
from scipy.linalg import expm

from ..model.function import Kernel
from ..model.operating_point import OperatingPoint
from ..model.state_matrix import state_matrix

Vector = NDArray[np.float64]
LINEAR = 1e-9
"""Part of a right-hand side that may be left over by the linear prediction."""
SIZES = (1.0, 1e2, 1e4, 1e4, 1e4, 1e4)
"""Sizes of the states at which that is tried, in sizes of vibrations; the largest are beyond all deflections."""
TOGETHER = 1e-11
"""Instants closer than this share of the fastest tooth pitch are one."""
LONGEST = 100_000
"""The most pitches of the first mesh that a common period may have."""


class Exact:
    """A model that is linear between its jumps.

    Parameters
    ----------
    point
        The model where it starts.

    Raises
    ------
    LtcgearError
        If the model is not linear between jumps, or its speed is not held and constant.
    """

    def __init__(self, point: OperatingPoint) -> None:
        library, p, at = point.library, point.p, point.at
        if library.manifest.reference == "torque" or library.manifest.signals:
            raise LtcgearError("no exact solution: the jumps are known in advance at a held, constant speed only")
        self.library, self.p, self.start = library, p, at.x
        self.scale = point.scale
        self.levels = len(library.manifest.levels)
        tau, rate, share = Kernel(library.functions["phases"])(at.x, np.zeros(self.levels), p)
        self.tau, self.rate, self.share = tau.copy(), rate.copy(), share.copy()
        self._rhs = Kernel(library.functions["rhs"])
        self._known: dict[bytes, Vector] = {}
        self._check()

    def _check(self) -> None:
        """Refuse a model whose right-hand side is not that of its matrix at random states and levels."""
        random = np.random.default_rng(1)
        for size in SIZES:
            level = random.integers(0, 2, self.levels).astype(np.float64)
            z = random.normal(size=len(self.start)) * size
            found = self._rhs(self.start + self.scale * z, level, self.p)[0] / self.scale
            terms = self.generator(level)[:-1] * np.append(z, 1.0)
            if not np.abs(found - terms.sum(axis=1)).max() <= LINEAR * np.abs(terms).max():
                raise LtcgearError(
                    "no exact solution: the equations are not linear between jumps; set effects.lateral=off, "
                    "contact bilateral, mesh_stiffness two-level or mean, and leave friction out"
                )

    def generator(self, level: Vector) -> Vector:
        """Return G of (z, 1)' = G (z, 1) [1/s] under some mesh levels, with x = start + scale z."""
        key = level.tobytes()
        if key not in self._known:
            n = len(self.start)
            G = np.zeros((n + 1, n + 1))
            A = state_matrix(self.library, self.start, level, self.p)
            G[:n, :n] = A * self.scale[None, :] / self.scale[:, None]
            G[:n, n] = self._rhs(self.start, level, self.p)[0] / self.scale
            self._known[key] = G
        return self._known[key]

    def switchings(self, end: float) -> int:
        """Return how many jumps there are after 0 and up to ``end`` [s], those of all meshes together."""
        return sum(len(times) for times in self._borders(end))

    def _borders(self, end: float) -> Iterator[Vector]:
        """Return the switching instants [s] of each mesh after 0 and up to ``end``, for each kind of switching.

        Single contact begins at whole numbers of the phase and lasts for its share.
        """
        for tau, rate, share in zip(self.tau, self.rate, self.share, strict=True):
            for border in (0.0, share) if rate else ():
                first, last = (tau - border) * np.sign(rate), (tau - border + rate * end) * np.sign(rate)
                whole = np.arange(np.floor(first + TOGETHER) + 1, np.floor(last + TOGETHER) + 1)
                yield (whole - first) / abs(rate)

    def pieces(self, end: float) -> Iterator[tuple[float, float, Vector]]:
        """Yield the pieces between jumps: start, end [s] and levels."""
        instants = np.sort(np.concatenate([[0.0, end], *self._borders(end)]))
        apart = TOGETHER / max(np.abs(self.rate).max(initial=0.0), 1 / end)
        instants = instants[np.concatenate([[True], np.diff(instants) > apart])]
        for start, stop in pairwise(instants):
            part = np.mod(self.tau + self.rate * (start + stop) / 2, 1.0)
            yield float(start), float(stop), (part >= self.share).astype(np.float64)

    def clear(self, times: Vector) -> NDArray[np.bool_]:
        """Say of each time [s] whether no mesh is within a billionth of a pitch of a jump."""
        tau = self.tau + np.multiply.outer(times, self.rate)
        away = [np.abs(tau - border - np.rint(tau - border)) for border in (0.0, self.share)]
        return np.asarray(np.min(away, axis=0).min(axis=1, initial=1.0) > 1e-9)

    def solve(self, times: Vector) -> tuple[Vector, Vector]:
        """Return states and levels at ascending times [s], shapes (m, n) and (m, l).

        A time at which something jumps has the levels that end there.
        """
        z, done = np.append(np.zeros(len(self.start)), 1.0), 0
        out, levels = np.empty((len(times), len(self.start))), np.empty((len(times), self.levels))
        for start, stop, level in self.pieces(float(times[-1])):
            G = self.generator(level)
            last = done + int(np.searchsorted(times[done:], stop * (1 + 1e-14), side="right"))
            for i in range(done, last):
                out[i], levels[i] = (expm(G * (times[i] - start)) @ z)[:-1], level
            done, z = last, expm(G * (stop - start)) @ z
        return self.start + self.scale * out, levels

    def period(self) -> float:
        """Return the time [s] after which all mesh phases have gone through whole numbers of pitches."""
        moving = np.abs(self.rate[self.rate != 0])
        if not len(moving):
            raise LtcgearError("no period: no stiffness jumps")
        ratios = [Fraction(float(r / moving[0])).limit_denominator(LONGEST) for r in moving]
        pitches = lcm(*(ratio.denominator for ratio in ratios))
        away = max(abs(float(ratio) * moving[0] / r - 1) for ratio, r in zip(ratios, moving, strict=True))
        if pitches > LONGEST or away > 1e-12:
            raise LtcgearError(f"no period: the meshes' common one is longer than {LONGEST} pitches")
        return float(pitches / moving[0])

    def monodromy(self) -> Vector:
        """Return what one common period makes of a small change of state, in vibration sizes, shape (m, m).

        The reference angle, a clock, is left out.
        """
        kept = np.array([i for i, state in enumerate(self.library.manifest.states) if not state.is_reference])
        product = np.eye(len(kept))
        for start, stop, level in self.pieces(self.period()):
            product = expm(self.generator(level)[np.ix_(kept, kept)] * (stop - start)) @ product
        return product

    def growth(self) -> float:
        """Return the rate [1/s] at which small changes grow in the long run: ln |largest Floquet multiplier| / T."""
        return float(np.log(np.abs(np.linalg.eigvals(self.monodromy())).max()) / self.period())
