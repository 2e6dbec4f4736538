"""Adjoint jump conditions where stiffness or a regime changes.

At an instant t* with h(x, p) = 0 the rates jump: dx+ = dx- + (f- - f+) dt*, dt* = - (h_x dx- + h_p dp) / h', the
saltation of Hiskens and Pai (2000). The adjoint is its transpose, plus the gain or loss of the output.
"""

from collections.abc import Iterator

import casadi as ca
import numpy as np
from ltcgear.generated.contract import HELD
from ltcgear.generated.errors import SolverError
from numpy.typing import NDArray

from ...model.contact_levels import Phases, at_border, levels_of, lower
from ...model.function import Kernel
from ...model.library import Library
from .backward import Backward
from .course import Course, Piece

Vector = NDArray[np.float64]
Setting = tuple[Vector, Vector]


class Jumps:
    """The jumps of a course.

    Parameters
    ----------
    course
        The run.
    output
        Place of the output among the model's reports.
    """

    def __init__(self, course: Course, output: int) -> None:
        self.course, self.library, self.output = course, course.library, output
        manifest = course.library.manifest
        self.names = [name for name, _ in manifest.parameters]
        self.holds = [self.names.index(hold) for hold in manifest.holds]
        self.levels = len(manifest.levels)
        self.rhs, self.outputs = (Kernel(course.library.functions[name]) for name in ("rhs", "outputs"))
        self.phases = Kernel(course.library.functions["phases"])
        self.phase = gradient_of(course.library, "phases", (0, 2))
        self.border = gradient_of(course.library, "borders", (0,))
        self.output_gradient = gradient_of(course.library, "outputs", (0,))

    def begin(self, backward: Backward, piece: Piece, time: float) -> float:
        """Let adjoint and gradient begin with the output at a time after a piece's start; return its rate [1/s]."""
        weights = np.zeros(len(self.library.manifest.reports))
        weights[self.output] = 1.0
        x = (self.course.nodes.matrix(np.array([time / piece.duration])) @ piece.x)[0]
        s = piece.s_at(time)
        of_x, of_s, of_p = (part.copy() for part in self.output_gradient(x, s, piece.p, weights))
        backward.adjoint[:], backward.gradient[:] = of_x, of_p
        return float(of_x @ self.rhs(x, s, piece.p)[0] + of_s @ self._drift(piece))

    def follow_end(self, backward: Backward, before: Piece, after: Piece, rate: float) -> None:
        """Add what it is worth that an output is looked at where a piece ends, and changes at a rate [1/s] there.

        Raises
        ------
        SolverError
            If a border is only touched, where the instant has no derivative.
        """
        x, s, p = before.x[-1], before.s_at(before.duration), before.p
        for (h_x, h_s, h_p), _, _ in self._steps(before, after, (s, p)):
            approach = self._approach(before, float(h_x @ self.rhs(x, s, p)[0] + h_s @ self._drift(before)))
            backward.adjoint[:] -= rate / approach * h_x
            backward.gradient[:] -= rate / approach * h_p
            return

    def go_back(
        self, backward: Backward, before: Piece, after: Piece, a: float, b: float, shifted: float = 0.0
    ) -> None:  # fmt: skip
        """Take adjoint and gradient from after the end of a piece to before it.

        ``shifted`` is the rate of an output evaluated just after the last change [1/s].

        Raises
        ------
        SolverError
            If a border is only touched, where the instant has no derivative.
        """
        x, s, p = before.x[-1], before.s_at(before.duration), before.p
        f = np.array(self.rhs(x, s, p)[0])
        steps = list(self._steps(before, after, (s, p)))
        for (h_x, h_s, h_p), one, two in reversed(steps):
            lost = self._gained(backward.adjoint, x, one, a, b) - self._gained(backward.adjoint, x, two, a, b)
            lost, shifted = lost + shifted, 0.0
            if lost == 0.0:
                continue
            approach = self._approach(before, float(h_x @ f + h_s @ self._drift(before)))
            backward.adjoint[:] -= lost / approach * h_x
            backward.gradient[:] -= lost / approach * h_p

    def _drift(self, piece: Piece) -> Vector:
        """Return the rates of levels and signals within a piece [1/s]."""
        return np.concatenate([np.zeros(self.levels), piece.slope])

    def _approach(self, piece: Piece, rate: float) -> float:
        """Return the rate of the event function at the end of a piece; it must not be zero."""
        if rate == 0.0:
            raise SolverError(
                f"at t = {piece.start + piece.duration:.6g} s the motion only touches a border, so that nothing "
                "says how its instant moves; change the load or the speed a little, or end before it"
            )
        return rate

    def one_sided(self, first: Piece) -> list[str]:
        """Name the parameters that move a mesh phase off the switching point where it starts.

        The derivative given is that of a slightly larger phase: for a smaller one, the jump lies
        within the run.
        """
        tau, rate, share = (part.copy() for part in self.phases(first.x[0], first.s, first.p))
        phases, moved = Phases(tau, rate, share), np.zeros(len(self.names), dtype=np.bool_)
        for cells in (first.cells, first.cells + 1):
            for mesh in np.flatnonzero(np.abs(tau - lower(cells, share)) <= at_border(phases)):
                moved |= self._border(first.x[0], (first.s, first.p), int(mesh), int(cells[mesh]))[2] != 0
        return [name for name, there in zip(self.names, moved, strict=True) if there]

    def _gained(self, adjoint: Vector, x: Vector, setting: Setting, a: float, b: float) -> float:
        """Return adjoint' f + a y + b y^2 / 2."""
        s, p = setting
        value = float(adjoint @ self.rhs(x, s, p)[0])
        if a or b:
            y = float(self.outputs(x, s, p)[0][self.output])
            value += a * y + b * y * y / 2
        return value

    def _steps(
        self, before: Piece, after: Piece, setting: Setting
    ) -> Iterator[tuple[tuple[Vector, Vector, Vector], Setting, Setting]]:
        """List the changes in order: gradient of the event function, and levels and parameters on both sides.

        Sides that change with a level, since forces jump with it, do so at the level's instant.
        """
        x = before.x[-1]
        changed = np.flatnonzero(before.crossed)
        flipped = np.flatnonzero(before.sides != after.sides)
        for count, mesh in enumerate(changed, start=1):
            s, p = setting[0].copy(), setting[1]
            s[mesh] = levels_of(before.cells[mesh : mesh + 1] + before.crossed[mesh])[0]
            if count == len(changed):
                p = self._with_sides(p, after.sides)
            border = int(before.cells[mesh] + max(before.crossed[mesh], 0))
            yield self._border(x, setting, int(mesh), border), setting, (s, p)
            setting = (s, p)
        if len(changed):
            return
        sides = before.sides.copy()
        for hold in flipped:
            sides[hold] = after.sides[hold]
            p = self._with_sides(setting[1], sides)
            weights = np.zeros(len(sides))
            weights[hold] = 1.0
            h_x, h_s, h_p = (part.copy() for part in self.border(x, *setting, weights))
            yield (h_x, h_s, h_p), setting, (setting[0], p)
            setting = (setting[0], p)

    def _border(self, x: Vector, setting: Setting, mesh: int, border: int) -> tuple[Vector, Vector, Vector]:
        """Return the gradient of a mesh phase less a switching point, given as the cell that starts there."""
        weights = np.zeros(2 * self.levels)
        weights[mesh], weights[self.levels + mesh] = 1.0, -float(border % 2)
        h_x, h_s, h_p = (part.copy() for part in self.phase(x, *setting, weights))
        return h_x, h_s, h_p

    def _with_sides(self, p: Vector, sides: NDArray[np.bool_]) -> Vector:
        """Return the parameters with other sides held."""
        p = p.copy()
        p[self.holds] = np.where(sides, HELD, -HELD)
        return p


def gradient_of(library: Library, name: str, results: tuple[int, ...]) -> Kernel:
    """Return the gradients of a weighted sum of a function's results with respect to x, s and p."""
    graph = library.graphs[name]
    point = [ca.SX.sym(graph.name_in(i), graph.sparsity_in(i)) for i in range(graph.n_in())]
    values = graph.call(point)
    chosen = ca.vertcat(*(values[i] for i in results))
    weights = ca.SX.sym("w", chosen.numel())
    value = ca.dot(weights, chosen)
    return Kernel(
        ca.Function("border", [*point, weights], [ca.densify(ca.gradient(value, symbol)) for symbol in point])
    )
