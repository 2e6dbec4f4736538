"""SUNDIALS 7 CVODE by scikit-sundae: the independent integrator.

It continues from segment to segment without a restart, and restarts where the equations change. It is not told where
a switching is due: its own root finding stops it where an event function falls to zero.
"""

import os
from collections.abc import Callable
from contextlib import redirect_stdout
from io import StringIO

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from sksundae.cvode import CVODE

from ...model.function import Kernel
from ..smooth_arc import Arc
from ..trajectory import Counts
from .c_problem import layout, scaled_problem
from .stepper import CONSTANT, MOST_STEPS, SegmentProblem

Vector = NDArray[np.float64]
for level in ("ERROR", "WARNING"):  # SUNDIALS would write to stdout, which is the commands' own
    os.environ.setdefault(f"SUNLOGGER_{level}_FILENAME", os.devnull)
ROOT = 2
"""What CVODE returns where it has found a root."""
STENCIL = 6
"""Steps between which a value is read: BDF's polynomials have the degree 5 at most."""


def interpolate(times: Vector, values: Vector, wanted: Vector) -> Vector:
    """Read values at other times, by polynomials through the ``STENCIL`` nearest of them (Lagrange).

    Shapes (n,), (n, k) and (m,); the times ascend and the wanted ones lie among them.
    """
    size = min(STENCIL, len(times))
    first = np.clip(np.searchsorted(times, wanted) - size // 2, 0, len(times) - size)
    chosen = first[:, None] + np.arange(size)
    near = times[chosen]
    weights = np.ones_like(near)
    for i in range(size):
        for j in range(size):
            if j != i:
                weights[:, i] *= (wanted - near[:, j]) / (near[:, i] - near[:, j])
    return np.asarray(np.einsum("mi,mik->mk", weights, values[chosen]))


class SundaeStepper:
    """CVODE's BDF with its own steps; nodes are interpolated between them."""

    finds_borders = True

    def __init__(self, given: SegmentProblem) -> None:
        library, frame = given.library, given.frame
        self.counts, self.last, self.frame, self.nodes, self.events = Counts(), 0.0, frame, given.nodes, given.events
        self.levels, self.size = len(library.manifest.levels), len(frame.scale)
        problem = scaled_problem(library, library.functions, ca.MX)
        arguments = [problem["t"], problem["x"], problem["p"]]
        self.rate = Kernel(ca.Function("rate", arguments, [problem["ode"], problem["quad"]]))
        jacobian = ca.Function("jacobian", arguments, [ca.jacobian(problem["ode"], problem["x"])])
        self.jacobian = Kernel(jacobian)
        self.entries = tuple(map(np.array, jacobian.sparsity_out(0).get_triplet()))
        self.part: dict[str, Vector] = {}
        parameters = np.zeros(problem["p"].shape[0])
        start = 0
        for name, length in layout(library).items():
            self.part[name] = parameters[start : start + length]
            start += length
        self.parameters = parameters
        self.part["duration"][:], self.part["scale"][:], self.part["p"][:] = 1.0, frame.scale, given.p
        self.options = {
            "rtol": given.rtol,
            "atol": np.full(self.size + 1, given.rtol),
            "jacfn": self._jacobian,
            "max_num_steps": MOST_STEPS,
        }
        self.times, self.values = np.zeros(0), np.zeros((0, self.size + 1))
        self.left: Vector | None = None
        self.now, self.border, self.evaluations = 0.0, np.inf, (0, 0)

    def renumber(self, p: Vector) -> None:
        """Continue with other parameters; restart if the equations change."""
        if not np.array_equal(p, self.part["p"]):
            self.part["p"][:], self.left = p, None

    def _rate(self, t: float, y: Vector, rate: Vector) -> None:
        """Write the rates of z and of the work."""
        out = self.rate(t, y[:-1], self.parameters)
        rate[:-1], rate[-1] = out[0], out[1][0]

    def _jacobian(self, t: float, y: Vector, rate: Vector, matrix: Vector) -> None:
        """Write d z' / d z; the work acts on nothing."""
        matrix[self.entries] = self.jacobian(t, y[:-1], self.parameters)[0]

    def _make_distances(self) -> Callable[[float, Vector, Vector], None]:
        """Return the event functions as CVODE asks for them, which counts them where they fall to zero only."""

        def distances(t: float, y: Vector, out: Vector) -> None:
            out[:] = self.events.distances(self.frame.origin + self.frame.scale * y[:-1], self._signals(t))

        distances.direction = [-1] * self.events.count  # type: ignore[attr-defined]
        return distances

    def _signals(self, t: float) -> Vector:
        """Return levels and signals at CVODE's own time."""
        s = self.part["s"].copy()
        s[self.levels :] += self.part["slope"] * t
        return s

    def advance(self, z: Vector, duration: float, origin: Vector, s: Vector, slope: Vector = CONSTANT) -> Arc:
        """Return the motion from z up to the first event; continue without a restart if nothing has changed."""
        if not self._goes_on(z, origin, s, slope):
            self._restart(z, origin, s, slope)
        start = self.now
        end = self._proceed(start + duration)
        path = interpolate(self.times, self.values, start + (end - start) * np.append(0.0, self.nodes))
        if not np.isfinite(path[-1]).all():
            raise RuntimeError("a value is not finite")
        path[0, :-1] = z
        self.left, self.now = path[-1, :-1], end
        self.times, self.values = self.times[-STENCIL:], self.values[-STENCIL:]
        self.counts.segments += 1
        return Arc(end - start, path[:, :-1], path[:, -1] - path[0, -1])

    def _goes_on(self, z: Vector, origin: Vector, s: Vector, slope: Vector) -> bool:
        """Return whether a motion continues the last one: same state, same equations, no event."""
        part = self.part
        return (
            self.left is not None
            and self.border != self.now
            and np.allclose(z, self.left, rtol=1e-12, atol=1e-12)  # the march knows a held angle to the last bit
            and np.array_equal(origin, part["origin"])
            and np.array_equal(slope, part["slope"])
            and np.allclose(s, self._signals(self.now), rtol=1e-12, atol=0.0)
        )

    def _restart(self, z: Vector, origin: Vector, s: Vector, slope: Vector) -> None:
        """Restart at CVODE's time zero."""
        part = self.part
        part["origin"][:], part["s"][:], part["slope"][:] = origin, s, slope
        y = np.append(z, 0.0)
        count = self.events.count
        borders = {"eventsfn": self._make_distances(), "num_events": count} if count else {}
        # A new solver: one that is used again keeps a list of all roots it has ever found.
        self.solver = CVODE(self._rate, **self.options, **borders)
        self.solver.init_step(0.0, y)
        self.times, self.values = np.zeros(1), y[None, :]
        self.now, self.border, self.evaluations = 0.0, np.inf, (0, 0)

    def _proceed(self, end: float) -> float:
        """Take steps until a time or an event is reached; return that time."""
        times, values = [], []
        reached = float(self.times[-1])
        with redirect_stdout(StringIO()):  # scikit-sundae prints what it returns as a message
            while reached < min(end, self.border):
                step = self.solver.step(end, "onestep")
                if not step.success:
                    raise RuntimeError(step.message)
                reached = float(step.t)
                times.append(reached)
                values.append(step.y)
                if step.status == ROOT:
                    self.border = reached
                if len(times) > MOST_STEPS:
                    raise RuntimeError(f"more than {MOST_STEPS} steps in a segment")
                self._count(int(step.nfev), int(step.njev))
        self.times = np.append(self.times, times)
        self.values = np.vstack([self.values, *values])
        return min(end, self.border)

    def _count(self, rhs: int, jacobian: int) -> None:
        """Take a step into the counts; CVODE's own are those since its start."""
        self.counts.steps += 1
        self.counts.rhs += rhs - self.evaluations[0]
        self.counts.jacobian += jacobian - self.evaluations[1]
        self.evaluations = rhs, jacobian
