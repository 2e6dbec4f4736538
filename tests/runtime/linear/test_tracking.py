"""Modes followed from point to point: through crossings, along veerings, as subspaces, as they come and go."""

from types import SimpleNamespace

import numpy as np
import pytest
from ltcgear.runtime.linear.tracking import correlate, match, track

TWO_PI = 2 * np.pi


def modes_of(K):
    """Modes of M = 1 as the tracking sees them: displacements and rates."""
    squares, shapes = np.linalg.eigh(K)
    modes = []
    for k, (square, shape) in enumerate(zip(squares, shapes.T, strict=True)):
        iw = 1j * np.sqrt(square)
        right, left = np.concatenate([shape, iw * shape]), np.concatenate([shape, shape / np.conj(iw)]) / 2
        modes.append(SimpleNamespace(shape=right, left=left, group=k, frequency_hz=np.sqrt(square) / TWO_PI))
    return modes


def two(detuning, coupling):
    return modes_of(np.array([[10 + detuning, coupling], [coupling, 10 - detuning]]))


def frequencies(points, tracks):
    return np.array([[points[i][k].frequency_hz for k in row] for i, row in enumerate(tracks)])


def test_tracks_go_through_a_crossing():
    points = [two(s, 0.0) for s in np.linspace(-1, 1.05, 12)]
    found = frequencies(points, track(points, 3))
    assert (np.diff(found[:, 0]) * np.diff(found[:, 1]) < 0).all()
    assert np.diff(np.sign(found[:, 0] - found[:, 1])).any()


def test_tracks_veer_where_the_steps_resolve_it():
    points = [two(s, 0.4) for s in np.linspace(-2, 2, 81)]
    found = frequencies(points, track(points, 0))
    assert (found[:, 0] < found[:, 1]).all()
    assert np.abs(np.diff(found, axis=0)).max() < 0.02


def test_repeated_modes_are_one_subspace():
    """Any mixture of a repeated pair is all of it; where it splits, both parts come from it."""
    pair = modes_of(np.diag([4.0, 9.0, 9.0]))
    angle = 0.7
    turn = np.array([[1, 0, 0], [0, np.cos(angle), -np.sin(angle)], [0, np.sin(angle), np.cos(angle)]])
    other = modes_of(turn @ np.diag([4.0, 9.0, 9.1]) @ turn.T)
    pair[2].group = pair[1].group
    assert correlate(pair, other) == pytest.approx(np.array([[1, 0, 0], [0, 1, 1], [0, 1, 1]]), abs=1e-4)
    assert match(pair, other)[0] == (0, 0)
    other[2].group = other[1].group
    assert correlate(pair, other) == pytest.approx(np.array([[1, 0, 0], [0, 1, 1], [0, 1, 1]]), abs=1e-4)


def test_modes_that_come_and_go_have_tracks_of_their_own():
    points = [modes_of(np.diag([1.0, 2.0, 3.0]))[:n] for n in (2, 3, 2)]
    assert track(points, 0).tolist() == [[0, 1, -1], [0, 1, 2], [0, 1, -1]]
