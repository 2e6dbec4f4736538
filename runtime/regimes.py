"""Regimes as discrete states: which side of every border holds, and where within an arc one is crossed.

A border is a zero of one of the generated indicators g (teeth that come to push, a race that is reached). While an arc
is integrated its sides are held, so that nothing bends within it; the first border that it crosses ends it.
"""

from collections.abc import Callable

import numpy as np
from ltcgear.generated.contract import HELD
from numpy.typing import NDArray
from scipy.optimize import brentq

from .arcs import Arc, Frame
from .kernel import Kernel
from .library import Library
from .nodes import Nodes

Vector = NDArray[np.float64]
Sides = NDArray[np.bool_]
FINE = 64
"""Points of an arc at which indicators are looked at."""
PATIENCE = 6
"""Trials after which an arc ends as near to its border as the integrator's errors allow."""
AT_ONCE = 1e-12
"""Part of an arc that counts as its start."""
SLACK, NEAR = 0.1, 100.0
"""How far beyond a border counts as on it, over what the tolerance lets the indicator be off; and how many times as
far it may be by the errors of an integrator that starts again."""


class Regimes:
    """The sides of all borders of a run.

    Parameters
    ----------
    library, p
        Model and parameters, shape (n_p,).
    frame
        Scaling of the states, which gives indicators their size.
    nodes
        Nodes of an arc.
    rtol
        Tolerance of the states.
    s
        Levels and signals at the start.
    known
        Index of a state that is known without error, None where there is none.

    Attributes
    ----------
    sides
        True where the indicator is held positive, shape (n_g,).
    index
        Where the holds are in p, shape (n_g,).
    """

    def __init__(
        self, library: Library, p: Vector, frame: Frame, nodes: Nodes, rtol: float, s: Vector, known: int | None = None
    ) -> None:
        names = [name for name, _ in library.manifest.parameters]
        self.index = np.array([names.index(hold) for hold in library.manifest.holds], dtype=np.int64)
        self.p, self.frame, self.nodes = p, frame, nodes
        self.one, self.rhs = Kernel(library.functions["borders"]), Kernel(library.functions["rhs"])
        first = self._at(np.zeros(len(frame.scale)), s)
        self.sides: Sides = first > 0
        if not len(self.index):
            return
        self.many = Kernel(library.functions["borders"].map("borders_at_nodes", "serial", len(nodes.points), [2], []))
        self.fine = nodes.matrix(np.arange(FINE + 1) / FINE)
        error = SLACK * rtol * np.array([np.abs(self._at(z, s) - first) for z in np.eye(len(frame.scale))])
        if known is not None:
            error[known] = 0.0
        self.error, self.slack = error, error.max(axis=0)

    def _at(self, z: Vector, s: Vector) -> Vector:
        """Return the indicators of one state."""
        return np.array(self.one(self.frame.origin + self.frame.scale * z, s, self.p)[0])

    def inside(self, z: Vector, s: Vector) -> Vector:
        """Return the indicators with the sign that makes them positive on the side that holds."""
        return self.seen(self.frame.origin + self.frame.scale * z, s)

    def seen(self, x: Vector, s: Vector) -> Vector:
        """Return the same of an unscaled state."""
        return np.asarray(np.where(self.sides, 1.0, -1.0) * self.one(x, s, self.p)[0])

    def _noise(self, z: Vector) -> Vector:
        """Return how far indicators may be off by the errors of an integrator that starts again, shape (n_g,)."""
        return np.asarray(NEAR * (self.error * np.maximum(np.abs(z), 1.0)[:, None]).max(axis=0))

    def hold(self, p: Vector) -> None:
        """Put the sides into parameters."""
        p[self.index] = np.where(self.sides, HELD, -HELD)

    def settled(self, z: Vector, s: Vector) -> Sides:
        """Return the sides of a state, those it has unless it lies beyond a border, as after a jump."""
        if not len(self.index):
            return self.sides
        inside = self.inside(z, s)
        beyond = (inside < -self.slack) & ((inside < -self._noise(z)) | (self._slope(z, s) < 0))
        return np.asarray(self.sides ^ beyond)

    def cross(self, arc: Arc, s: Vector) -> tuple[float, Sides]:
        """Look for the first border that an arc crosses.

        Parameters
        ----------
        arc
            An arc that was integrated with the present sides held.
        s
            Levels and signals at its nodes, shape (nodes, n_s).

        Returns
        -------
        part, sides
            The part of the arc before that border, 1 where none is crossed; and the sides at the arc's start,
            others than those held where it begins on a border and goes beyond.
        """
        if not len(self.index):
            return 1.0, self.sides
        distance = self._along(arc, s)
        if not (distance < -self.slack).any():
            return 1.0, self.sides
        near = distance[0] <= self.slack
        at_once = near & (self._slope(arc.z[0], s[0]) < 0) & (distance < -self.slack).any(axis=0)
        if at_once.any():
            return 1.0, self.sides ^ at_once
        # What has just crossed and goes on may seem to return by the errors of the path between the integrator's steps.
        left = np.maximum.accumulate(np.abs(distance) > self._noise(np.abs(arc.z).max(axis=0)), axis=0)
        roots = self._roots(arc, s, np.where(near & ~left, 0.0, distance))
        # From a border on which it rested, a motion may leave so slowly that no slope tells.
        at_once[[which for part, which in roots if near[which] and part <= AT_ONCE]] = True
        if at_once.any():
            return 1.0, self.sides ^ at_once
        return min((part for part, _ in roots), default=1.0), self.sides

    def _slope(self, z: Vector, s: Vector) -> Vector:
        """Return the rates [N/s], [m/s] of the signed indicators from a state on, by a difference over a short time."""
        self.hold(self.p)
        rate = self.rhs(self.frame.origin + self.frame.scale * z, s, self.p)[0] / self.frame.scale
        step = 1e-6 * float((np.maximum(np.abs(z), 1.0) / np.maximum(np.abs(rate), 1e-300)).min())
        return np.asarray((self.inside(z + step * rate, s) - self.inside(z, s)) / step)

    def end(self, arc: Arc, s: Vector, trial: int) -> tuple[float, Sides]:
        """Look at the end of an arc that shall end on a border, as nearly as this trial asks for.

        Returns
        -------
        correction, sides
            By what part of the arc it is too short (negative where it is too long), and the sides after it: all
            borders change sides at which it ends and towards which it goes.
        """
        end, slope = self.inside(arc.z[-1], s[-1]), self._slope(arc.z[-1], s[-1])
        falling = slope < 0
        if not falling.any():
            return 0.0, self.sides
        reach = np.where(falling, np.abs(end), np.inf)
        which = int(np.argmin(reach / self.slack))
        noise = np.maximum(self._noise(arc.z[-1]) / self.slack, 1.0)
        slack = self.slack * noise ** min(trial / PATIENCE, 1.0)
        if reach[which] > slack[which]:
            return float(np.clip(-end[which] / slope[which] / arc.duration, -0.1, 0.1)), self.sides
        return 0.0, self.sides ^ (reach <= slack)

    def _along(self, arc: Arc, s: Vector) -> Vector:
        """Return the signed indicators along an arc, shape (FINE + 1, n_g), lowest points between included."""
        self.many.arguments[0][:] = (self.frame.origin + self.frame.scale * arc.z).ravel()
        self.many.arguments[1].reshape(len(s), -1)[:] = s
        self.many.arguments[2][:] = self.p
        self.many.evaluate()
        values = self.many.results[0].reshape(len(s), -1) * np.where(self.sides, 1.0, -1.0)
        fine = self.fine @ values
        middle, bend, slope = fine[1:-1], fine[2:] - 2 * fine[1:-1] + fine[:-2], (fine[2:] - fine[:-2]) / 2
        dips = (bend > 0) & (np.abs(slope) <= bend / 2)
        fine[1:-1] = np.where(dips, middle - slope**2 / (2 * np.where(dips, bend, 1.0)), middle)
        return fine

    def _roots(self, arc: Arc, s: Vector, distance: Vector) -> list[tuple[float, int]]:
        """Return where in the arc each border that it crosses is crossed first, and which it is."""
        found = []
        for which in np.flatnonzero((distance < -self.slack).any(axis=0)):
            row = int(np.argmax(distance[:, which] < -self.slack[which]))

            def distance_at(part: float, which: int = int(which)) -> float:
                return float(self._inside_at(arc, s, part)[which])

            found.append((_first_zero(distance_at, row), int(which)))
        return found

    def _inside_at(self, arc: Arc, s: Vector, part: float) -> Vector:
        """Return the signed indicators at a part of an arc."""
        row = self.nodes.matrix(np.array([part]))[0]
        return self.inside(row @ arc.z, s[0] + part * (s[-1] - s[0]))


def _first_zero(distance: Callable[[float], float], row: int) -> float:
    """Return the first zero before a row of the fine points, at whose dip the distance is negative."""
    steps = np.arange(row - 1, row + 1.01, 0.125) / FINE
    steps = np.clip(steps, 0.0, 1.0)
    values = [distance(t) for t in steps]
    for low, high, one, two in zip(steps, steps[1:], values, values[1:], strict=False):
        if one >= 0 > two:
            return float(brentq(distance, low, high, xtol=1e-15, rtol=1e-14))
    return float(steps[int(np.argmin(values))]) if values[0] >= 0 else float(steps[0])
