"""Mode tracking over speed or load, by left and right eigenvectors."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from .modes import Mode

Vector = NDArray[np.float64]
Indices = NDArray[np.int64]
NEAR = 1e-2
"""Weight of the relative change of frequency, which decides where shapes do not."""


def correlate(one: Sequence[Mode], two: Sequence[Mode]) -> Vector:
    """Return how much of each mode of one point is each of another's, shape (n_1, n_2), 1 for the same.

    With left vectors l and right ones r of both points it is (l_1^H r_2) (l_2^H r_1), which the size of the vectors
    does not touch; for undamped symmetric systems it is the mass-weighted modal assurance criterion. Of repeated
    modes any mixture is one, so products are summed over those of a group: how much of the mode lies in the
    other's subspace.
    """
    left_1, right_1 = _stacked(one)
    left_2, right_2 = _stacked(two)
    product = (left_1.conj() @ right_2.T) * (left_2.conj() @ right_1.T).T
    return np.abs(_sharing(one) @ product @ _sharing(two)) / np.minimum(*_sizes(one, two))


def _stacked(modes: Sequence[Mode]) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    return np.array([mode.left for mode in modes]), np.array([mode.shape for mode in modes])


def _sharing(modes: Sequence[Mode]) -> Vector:
    """Return which modes share a group."""
    groups = np.array([mode.group for mode in modes])
    return np.asarray(groups[:, None] == groups[None, :], dtype=np.float64)


def _sizes(one: Sequence[Mode], two: Sequence[Mode]) -> tuple[Vector, Vector]:
    """Return the sizes of both modes' groups for every pair."""
    a, b = _sharing(one).sum(axis=1), _sharing(two).sum(axis=1)
    return np.broadcast_to(a[:, None], (len(a), len(b))), np.broadcast_to(b[None, :], (len(a), len(b)))


def match(one: Sequence[Mode], two: Sequence[Mode]) -> list[tuple[int, int]]:
    """Return which mode of a point is which of the next, as pairs of places; the best assignment on the whole."""
    if not one or not two:
        return []
    f_1, f_2 = (np.array([mode.frequency_hz for mode in modes]) for modes in (one, two))
    apart = np.abs(f_1[:, None] - f_2[None, :]) / np.maximum(1e-300, np.maximum(f_1[:, None], f_2[None, :]))
    rows, columns = linear_sum_assignment(NEAR * apart - correlate(one, two))
    return list(zip(rows.tolist(), columns.tolist(), strict=True))


def track(points: Sequence[Sequence[Mode]], home: int) -> Indices:
    """Follow modes from one point to both ends.

    Parameters
    ----------
    points
        Modes at every point of the axis.
    home
        Where they are numbered: column k is the home point's mode k. Modes that come up elsewhere follow.

    Returns
    -------
    numpy.ndarray
        Shape (points, tracks): the place of each track's mode among those of the point, -1 where it is not.
    """
    columns: list[dict[int, int]] = [{home: k} for k in range(len(points[home]))]
    for way in (range(home + 1, len(points)), range(home - 1, -1, -1)):
        for here in way:
            before = here - way.step
            pairs = dict(match(points[before], points[here]))
            for column in columns:
                if column.get(before) in pairs:
                    column[here] = pairs[column[before]]
            fresh = set(range(len(points[here]))) - set(pairs.values())
            columns += [{here: k} for k in sorted(fresh)]
    return np.array([[column.get(i, -1) for column in columns] for i in range(len(points))], dtype=np.int64)
