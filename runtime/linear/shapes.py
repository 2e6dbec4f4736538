"""Mode shapes for drawing: translation and rotation of each member in the layout."""

from dataclasses import dataclass

import numpy as np

from ..model.layout import Sheet
from .modes import Mode
from .system import Linear

SHIFT, TURN = 0.18, 0.7
"""Largest displacement drawn, over the radius of the largest circle of its stage, and largest turn drawn [rad]."""


@dataclass(frozen=True)
class DiscMotion:
    """How a disc moves in a mode, exaggerated: shift [m] along x and y, and turn [rad], complex amplitudes."""

    x: complex
    y: complex
    turn: complex


def exaggerate(linear: Linear, sheet: Sheet, mode: Mode) -> dict[str, DiscMotion]:
    """Return the motions of all discs in a mode, so large that they are seen, by body.

    All have one factor, so that shifts and turns compare; where turns would be more than ``TURN`` by it, turns
    have a smaller factor of their own. The phase is that at which the shape is most real.
    """
    moved = linear.motions.matrix[:, linear.kept] @ mode.shape
    moved = moved * np.exp(-0.5j * np.angle(np.sum(moved**2)))
    motion = {(state.body, state.axis): value for state, value in zip(linear.motions.states, moved, strict=True)}
    rows = {
        disc.body: [motion.get((disc.body, axis), 0j) for axis in "xy"]
        + [motion.get((disc.body, "u"), motion.get((disc.body, "theta"), 0j))]
        for disc in sheet.discs
    }
    shift = max(
        max(abs(rows[d.body][0]), abs(rows[d.body][1]), abs(rows[d.body][2]) * d.radius) / d.unit for d in sheet.discs
    )
    turn = max(abs(row[2]) for row in rows.values())
    factor = SHIFT / max(shift, 1e-300)
    turned = min(factor, TURN / max(turn, 1e-300))
    return {body: DiscMotion(factor * x, factor * y, turned * u) for body, (x, y, u) in rows.items()}
