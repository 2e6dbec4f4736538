r"""Frames and coordinates: the paper's inertial ones, and the integrated deviations.

The reference angle phi is the angle of the member whose speed is given. A stage's frame rotates with its carrier's
rigid motion, by :math:`\beta = \rho_C\varphi`; every body of the stage is described by its position (x, y) in that
frame and by its deviation :math:`u = \theta - \rho\varphi` from the rigid rotation. So no integrated quantity except
phi itself grows with the number of revolutions.
"""

from dataclasses import dataclass
from typing import Any

import sympy as sp

from ..elements.base import positive, real


def rotate(angle: Any, x: Any, y: Any, functions: Any) -> list[Any]:  # noqa: ANN401
    """Rotate a vector by an angle; ``functions`` is the library of cosine and sine, CasADi or SymPy."""
    cos, sin = functions.cos(angle), functions.sin(angle)
    return [cos * x - sin * y, sin * x + cos * y]


@dataclass(frozen=True)
class FrameMotion:
    """The symbols of one body in a rotating frame, and its accelerations by Newton's laws."""

    x: sp.Symbol
    y: sp.Symbol
    vx: sp.Symbol
    vy: sp.Symbol
    fx: sp.Symbol
    fy: sp.Symbol
    torque: sp.Symbol
    m: sp.Symbol
    inertia: sp.Symbol
    ratio: sp.Symbol
    frame_ratio: sp.Symbol
    phi_d: sp.Symbol
    phi_dd: sp.Symbol

    @classmethod
    def symbols(cls) -> "FrameMotion":
        """Make the symbols."""
        motion = [real(n) for n in ("x", "y", "v_x", "v_y", "F_x", "F_y", "T")]
        ratios = [real(n) for n in ("rho", "rho_C", "phi_d", "phi_dd")]
        return cls(*[*motion, positive("m"), positive("I"), *ratios])

    @property
    def arguments(self) -> tuple[sp.Symbol, ...]:
        """Return all symbols, in the order of the fields."""
        return tuple(vars(self).values())

    def newton(self) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
        """Return x'', y'', u'' by hand: force, Coriolis, centrifugal and Euler acceleration."""
        w, wd = self.frame_ratio * self.phi_d, self.frame_ratio * self.phi_dd
        return (
            self.fx / self.m + 2 * w * self.vy + w**2 * self.x + wd * self.y,
            self.fy / self.m - 2 * w * self.vx + w**2 * self.y - wd * self.x,
            self.torque / self.inertia - self.ratio * self.phi_dd,
        )
