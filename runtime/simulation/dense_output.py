"""Dense output of a segment: nodes, and interpolation between them."""

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


class Nodes(Protocol):
    """Nodes in a segment's normalised time, the first 0 and the last 1."""

    @property
    def points(self) -> Vector:
        """Return the points, shape (count + 1,)."""

    def matrix(self, times: Vector) -> Vector:
        """Return what takes values at the points to values at ``times``, shape (len(times), count + 1)."""


@dataclass(frozen=True)
class Chebyshev:
    """Chebyshev-Lobatto points with barycentric interpolation (Berrut and Trefethen 2004)."""

    count: int

    @cached_property
    def points(self) -> Vector:
        """Return the points."""
        return np.asarray((1 - np.cos(np.pi * np.arange(self.count + 1) / self.count)) / 2)

    @cached_property
    def last_terms(self) -> Vector:
        """Return what takes values at the points to their last two Chebyshev coefficients, shape (2, count + 1)."""
        angles = np.pi * np.outer([self.count - 1, self.count], np.arange(self.count + 1)) / self.count
        terms = np.cos(angles) * 2 / self.count
        terms[:, [0, -1]] /= 2
        terms[1] /= 2
        return terms

    @cached_property
    def weights(self) -> Vector:
        """Return the barycentric weights."""
        weights = np.where(np.arange(self.count + 1) % 2 == 0, 1.0, -1.0)
        weights[[0, -1]] /= 2
        return weights

    def matrix(self, times: Vector) -> Vector:
        """Return the interpolation matrix."""
        gap = times[:, None] - self.points[None, :]
        hit = np.abs(gap) < 1e-14
        terms = self.weights / np.where(hit, 1.0, gap)
        terms[hit.any(axis=1)] = 0.0
        terms[hit] = 1.0
        return np.asarray(terms / terms.sum(axis=1, keepdims=True))


@dataclass(frozen=True)
class Uniform:
    """Equally spaced nodes that are the samples, so nothing is interpolated."""

    count: int

    @cached_property
    def points(self) -> Vector:
        """Return the points."""
        return np.arange(self.count + 1) / self.count

    def matrix(self, times: Vector) -> Vector:
        """Return the selection matrix."""
        chosen = np.rint(times * self.count).astype(np.int64)
        if (np.abs(times * self.count - chosen) > 1e-6).any():
            raise RuntimeError("samples lie beside the nodes of a block that was cut")
        return np.asarray(np.eye(self.count + 1)[chosen])
