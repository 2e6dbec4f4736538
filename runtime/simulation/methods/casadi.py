"""Integrators of CasADi: SUNDIALS CVODES and IDAS, and the Rosenbrock method that it emits as C.

They integrate over the segment's own time 0..1. ``cvodes``, ``idas`` and ``adams`` run on the compiled right-hand side,
the first two on the compiled Jacobian too; ``rosenbrock`` is emitted and compiled whole.
"""

import ctypes
import re
from functools import partial
from typing import Any, ClassVar

import casadi as ca
import numpy as np
from ltcgear.generated import store
from ltcgear.generated.errors import LtcgearError
from numpy.typing import NDArray

from ...model.function import Kernel
from ...model.library import Library
from ...model.shared_library import load
from ..smooth_arc import Arc
from ..trajectory import Counts
from . import stepper
from .c_problem import compiled_problem, layout, scaled_problem
from .stepper import CONSTANT, SegmentProblem

Vector = NDArray[np.float64]
Options = dict[str, Any]
SMALLEST = 1e-10
"""Step, in a segment's own time, below which cvodes gives up; idas has no such option and gets fewer steps."""
BUFFERED = 1
"""The memory of a function that its first buffer uses, where CasADi keeps the statistics of its calls."""


class _Base:
    """What both kinds share: the parameter vector and the call."""

    finds_borders = False

    def __init__(self, problem: SegmentProblem) -> None:
        self.counts, self.last = Counts(), 0.0
        self.library, self.rtol, self.nodes = problem.library, problem.rtol, problem.nodes
        self.size = len(problem.frame.scale)
        self.function = self._make()
        self.kernel = Kernel(self.function)
        self.part: dict[str, Vector] = {}
        start, vector = 0, self.kernel.arguments[self.function.index_in("p")]
        for name, length in layout(self.library).items():
            self.part[name] = vector[start : start + length]
            start += length
        self.part["rtol"][:], self.part["scale"][:], self.part["p"][:] = problem.rtol, problem.frame.scale, problem.p
        self.state = self.kernel.arguments[self.function.index_in("x0")]
        self.end = self.kernel.results[self.function.index_out("xf")]
        self.work = self.kernel.results[self.function.index_out("qf")]

    def _make(self) -> ca.Function:
        raise LtcgearError("a stepper makes its own function")

    def _count(self, duration: float) -> None:
        raise LtcgearError("a stepper keeps its own counts")

    def renumber(self, p: Vector) -> None:
        """Continue with other parameters."""
        self.part["p"][:] = p

    def advance(self, z: Vector, duration: float, origin: Vector, s: Vector, slope: Vector = CONSTANT) -> Arc:
        """Return the motion from z on."""
        self.state[:] = z
        self.part["duration"][:], self.part["origin"][:], self.part["s"][:] = duration, origin, s
        self.part["slope"][:] = slope
        self.kernel.evaluate()
        self._count(duration)
        path = self.end.reshape(len(self.nodes), self.size)
        if not np.isfinite(path).all():
            raise RuntimeError("a value is not finite")
        return Arc(duration, np.vstack([z, path]), np.concatenate([[0.0], self.work]))


class _SundialsStepper(_Base):
    """An integrator of SUNDIALS' that calls the compiled functions one by one."""

    plugin: ClassVar[str]
    """CasADi's name of it."""

    def _options(self) -> Options:
        """Return its options in addition to the common ones."""
        return {"min_step_size": SMALLEST}

    def _make(self) -> ca.Function:
        options: Options = {"reltol": self.rtol, "abstol": self.rtol, "max_num_steps": stepper.MOST_STEPS}
        options |= {"linear_solver": "csparse", "show_eval_warnings": False, "quad_err_con": True}
        problem = compiled_problem(self.library)
        return ca.integrator("segment", self.plugin, problem, 0, self.nodes.tolist(), options | self._options())

    def _count(self, duration: float) -> None:
        stats = self.function.stats(BUFFERED)
        self.counts.segments += 1
        self.counts.steps += stats["nsteps"]
        self.counts.rhs += stats["nfevals"]
        # A set-up of the linear solver is a Jacobian: cvodes keeps none; calls are counted over all segments.
        self.counts.jacobian += stats["nlinsetups"]
        self.counts.rejected += stats["netfails"]


class CvodesStepper(_SundialsStepper):
    """CVODES with backward differentiation formulas."""

    plugin = "cvodes"


class AdamsStepper(_SundialsStepper):
    """CVODES with the formulas of Adams.

    Such steps are short enough for iteration without a Jacobian, which costs less than half.
    """

    plugin = "cvodes"

    def _options(self) -> Options:
        explicit = {"linear_multistep_method": "adams", "nonlinear_solver_iteration": "functional"}
        return super()._options() | explicit


class IdasStepper(_SundialsStepper):
    """IDAS with backward differentiation formulas."""

    plugin = "idas"

    def _options(self) -> Options:
        return {"max_num_steps": stepper.MOST_STEPS // 5}


TALLY = """
static long long ltcgear_tally[4];
static double ltcgear_step;
CASADI_SYMBOL_EXPORT void ltcgear_read(long long* counts, double* step) {
  int i;
  for (i = 0; i < 4; ++i) counts[i] = ltcgear_tally[i];
  *step = ltcgear_step;
}
"""
COUNT = """      ltcgear_tally[0] += d.n_steps; ltcgear_tally[1] += d.n_rhs; ltcgear_tally[2] += d.n_jac;
      ltcgear_tally[3] += d.n_reject; ltcgear_step = d.h_next; casadi_ivp_clear_stats(&d);
"""


def whole_c(library: Library, nodes: Vector) -> str:
    """Emit the whole Rosenbrock integrator as C, with tolerance and first step as parameters and with counters.

    CasADi bakes tolerances in and keeps no statistics in emitted C; four lines are changed for that, and
    each must be found exactly once, since the text is another release's to change.
    """
    problem = scaled_problem(library, library.graphs, ca.SX)
    function = ca.integrator("segment", "rosenbrock", problem, 0, nodes.tolist(), {"max_num_steps": stepper.MOST_STEPS})
    generator = ca.CodeGenerator("segment.c", {"casadi_int": "long long int"})
    generator.add(function)
    text = str(generator.dump())
    changes = (
        (r"  p\.abstol = [^;]*;", "  p.abstol = arg[2][1];"),
        (r"  p\.reltol = [^;]*;", "  p.reltol = arg[2][1];"),
        (r"  p\.h_init = [^;]*;", "  p.h_init = arg[2][2];"),
        (r"      if \(d\.status != IVP_SUCCESS\) return 1;\n", COUNT + r"\g<0>"),
        (r"static int casadi_f0\(", TALLY + r"\g<0>"),
    )
    for pattern, replacement in changes:
        pieces = list(re.finditer(pattern, text))
        pieces = [
            m
            for m in pieces
            if not text[m.end() :].startswith(
                "const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);"
            )
        ]
        if len(pieces) != 1:
            raise LtcgearError(
                f"CasADi's emitted integrator has changed: {pattern} found {len(pieces)} times, not once"
            )
        text = text[: pieces[0].start()] + pieces[0].expand(replacement) + text[pieces[0].end() :]
    return text


class RosenbrockStepper(_Base):
    """The Rosenbrock method as one compiled C function; steps carry over from segment to segment."""

    def _make(self) -> ca.Function:
        compiler = store.compiler()
        if compiler is None:
            raise LtcgearError("the model was compiled but the compiler is gone")
        make = partial(store.library, whole_c(self.library, self.nodes), compiler)
        self._reader, function = load(
            make, lambda path: (ctypes.CDLL(str(path)).ltcgear_read, ca.external("segment", str(path)))
        )
        self._tally, self._step = (ctypes.c_longlong * 4)(), ctypes.c_double()
        self._reader(self._tally, ctypes.byref(self._step))
        self._before = tuple(self._tally)
        return function

    def advance(self, z: Vector, duration: float, origin: Vector, s: Vector, slope: Vector = CONSTANT) -> Arc:
        """Integrate a segment, beginning with the step the last one ended with."""
        self.part["first"][:] = min(self.last / duration, 1.0)
        return super().advance(z, duration, origin, s, slope)

    def _count(self, duration: float) -> None:
        self._reader(self._tally, ctypes.byref(self._step))
        steps, rhs, jacobian, rejected = (now - before for now, before in zip(self._tally, self._before, strict=True))
        self._before, self.last = tuple(self._tally), self._step.value * duration
        self.counts.segments += 1
        self.counts.steps += steps
        self.counts.rhs += rhs
        self.counts.jacobian += jacobian
        self.counts.rejected += rejected
