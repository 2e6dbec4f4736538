"""Solvers of others on a right-hand side of the rig: restarted at every switching instant, read at the same times.

All integrate y = x - x_eq with the tolerance of ``ltcgear``: rtol, and rtol times the size of each state. One-step
methods begin each segment with the longest step of the last one; for LSODA that has been tried and gains nothing.
"""

from bisect import bisect_right
from collections.abc import Callable
from typing import Any

import numpy as np
from ltcgear.runtime.model.function import Kernel
from numpy.typing import NDArray
from scipy import integrate

from .rig import T_END, Rate, Rig, Segment

Vector = NDArray[np.float64]
Path = tuple[Vector, Vector]
"""What a segment gives: y at the times asked for, shape (times, n), and y at its end."""
MOST_STEPS = 1_000_000


def our_rate(rig: Rig) -> Rate:
    """Return our compiled right-hand side on buffers that are never made anew."""
    kernel = Kernel(rig.library.functions["rhs"])
    x, s, p = kernel.arguments
    p[:] = rig.p

    def rate(state: Vector, levels: Vector) -> Vector:
        x[:], s[:] = state, levels
        kernel.evaluate()
        return kernel.results[0]

    return rate


class Jacobian:
    """Our compiled Jacobian as a dense array."""

    def __init__(self, rig: Rig) -> None:
        function = rig.library.functions["jac_rhs"]
        self.kernel = Kernel(function)
        self.kernel.arguments[2][:] = rig.p
        self.entries = tuple(np.array(part) for part in function.sparsity_out(0).get_triplet())
        self.full = np.zeros((len(rig.at.x),) * 2)

    def __call__(self, x: Vector, levels: Vector) -> Vector:
        """Return d x' / d x, valid until the next call."""
        self.kernel.arguments[0][:], self.kernel.arguments[1][:] = x, levels
        self.kernel.evaluate()
        self.full[self.entries] = self.kernel.results[0]
        return self.full


def asked(segment: Segment, times: Vector) -> Vector:
    """Return the instants to be reached in a segment: its start, the samples in it, its end."""
    return np.concatenate([[segment.start], times[times < segment.end], [segment.end]])


class Restarted:
    """A solver that is restarted at the switching instants.

    Parameters
    ----------
    rig, rate
        The rig and a right-hand side of it.
    jacobian
        d x' / d x, or None where the solver is to find it by differences.
    restarts
        Whether it is restarted; if not, it integrates over the jumps, and every call looks up the levels.
    """

    def __init__(
        self, rig: Rig, rate: Rate, jacobian: Callable[[Vector, Vector], Vector] | None = None, restarts: bool = True
    ) -> None:
        self.rig, self.rate, self.jacobian = rig, rate, jacobian
        self.levels, self.x, self.calls = rig.at.levels, np.zeros(len(rig.at.x)), 0
        self.plan = list(zip(rig.segments, rig.inside, strict=True))
        self.ends = [] if restarts else [segment.end for segment in rig.segments[:-1]]
        if not restarts:
            self.plan = [(Segment(0.0, T_END, rig.segments[0].levels), np.arange(1, len(rig.times)))]

    def run(self, rtol: float) -> Vector:
        """Return the states at the rig's times, shape (times, n)."""
        rig, self.rtol, self.atol, self.step, self.calls = self.rig, rtol, rtol * self.rig.scale, 0.0, 0
        found, y = np.zeros((len(rig.times), len(rig.at.x))), np.zeros(len(rig.at.x))
        for segment, inside in self.plan:
            self.levels = segment.levels
            found[inside], y = self.advance(segment, y, rig.times[inside])
        return found + rig.at.x

    def advance(self, segment: Segment, y: Vector, times: Vector) -> Path:
        """Integrate one segment."""
        raise NotImplementedError

    def f(self, t: float, y: Vector) -> Vector:
        """Return y'; a fresh array, since solvers keep what they are given."""
        self.calls += 1
        return self.rate(np.add(y, self.rig.at.x, out=self.x), self.levels_at(t)).copy()

    def levels_at(self, t: float) -> Vector:
        """Return the mesh levels: the segment's, or those at an instant if there are no restarts."""
        return self.rig.segments[bisect_right(self.ends, t)].levels if self.ends else self.levels

    def jac(self, t: float, y: Vector) -> Vector:
        """Return d y' / d y."""
        assert self.jacobian is not None
        return self.jacobian(y + self.rig.at.x, self.levels_at(t))


class Stepwise(Restarted):
    """SciPy's solver classes in NumPy: DOP853, Radau."""

    def __init__(self, method: Any, *given: Any, **options: Any) -> None:  # noqa: ANN401
        super().__init__(*given, **options)
        self.method = method

    def advance(self, segment: Segment, y: Vector, times: Vector) -> Path:
        """Integrate one segment step by step, reading the samples from each step's own polynomial."""
        options: dict[str, Any] = {"rtol": self.rtol, "atol": self.atol}
        if self.jacobian is not None and self.method is integrate.Radau:
            options["jac"] = self.jac
        if self.step:
            options["first_step"] = min(self.step, segment.end - segment.start)
        solver = self.method(self.f, segment.start, y, segment.end, **options)
        found, longest = np.zeros((len(times), len(y))), 0.0
        read = 0
        while solver.status == "running":
            message = solver.step()
            if solver.status == "failed":
                raise RuntimeError(message)
            longest = max(longest, solver.step_size)
            due = int(np.searchsorted(times, solver.t, side="right"))
            if due > read:
                found[read:due] = solver.dense_output()(times[read:due]).T
                read = due
        found[read:], self.step = solver.y, longest
        return found, solver.y


class Odeint(Restarted):
    """LSODA by ``odeint``: the whole segment in compiled code, which calls back for right-hand sides."""

    def advance(self, segment: Segment, y: Vector, times: Vector) -> Path:
        """Integrate one segment."""
        due = asked(segment, times)
        options: dict[str, Any] = {"Dfun": self.jac} if self.jacobian is not None else {}
        path, told = integrate.odeint(
            self.f, y, due, tfirst=True, rtol=self.rtol, atol=self.atol, full_output=True, mxstep=MOST_STEPS, **options
        )
        if told["message"] != "Integration successful.":
            raise RuntimeError(told["message"])
        return path[1 : len(times) + 1], path[-1]


class Sundae(Restarted):
    """CVODE by scikit-sundae, as its manual uses it: one solver, begun anew at every switching instant."""

    def __init__(self, method: str, *given: Any, **options: Any) -> None:  # noqa: ANN401
        super().__init__(*given, **options)
        self.method = method

    def run(self, rtol: float) -> Vector:
        """Make the solver, then go on as all do."""
        from sksundae.cvode import CVODE

        options: dict[str, Any] = {"method": self.method, "rtol": rtol, "atol": rtol * self.rig.scale}
        options |= {"max_num_steps": MOST_STEPS}
        if self.jacobian is not None:
            options["jacfn"] = self._jacobian
        self.solver = CVODE(self._rate, **options)
        return super().run(rtol)

    def advance(self, segment: Segment, y: Vector, times: Vector) -> Path:
        """Integrate one segment."""
        due = asked(segment, times)
        solution = self.solver.solve(due, y)
        if not solution.success:
            raise RuntimeError(solution.message)
        if len(due) == 2:  # then it returns its own steps
            return np.tile(solution.y[-1], (len(times), 1)), solution.y[-1]
        return solution.y[1 : len(times) + 1], solution.y[-1]

    def _rate(self, t: float, y: Vector, rate: Vector) -> None:
        """Write y'."""
        self.calls += 1
        rate[:] = self.rate(np.add(y, self.rig.at.x, out=self.x), self.levels_at(t))

    def _jacobian(self, t: float, y: Vector, rate: Vector, matrix: Vector) -> None:
        """Write d y' / d y."""
        matrix[:] = self.jac(t, y)
