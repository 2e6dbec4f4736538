"""Integrators of one segment of smooth motion behind one interface.

All integrate z with x = x_ref + S z, so that one relative tolerance refers to vibrations and not to how far a
shaft has turned; CasADi's over the segment's own time 0..1. ``cvodes``, ``idas`` and ``sundae`` run on the compiled
right-hand side and Jacobian, ``adams`` on the former alone; ``rosenbrock`` is emitted and compiled whole; ``erk`` is
part of the compiled march (``native/erk.c``).
"""

import ctypes
import re
from dataclasses import dataclass
from difflib import get_close_matches
from functools import partial
from importlib.util import find_spec
from typing import Any, Protocol

import casadi as ca
import numpy as np
from ltcgear.generated import store
from ltcgear.generated.errors import LtcgearError
from numpy.typing import NDArray

from ...model.function import Kernel
from ...model.library import Library, load
from ..event_functions import Watch
from ..smooth_arc import Arc, Frame
from .c_problem import compiled_problem, layout, scaled_problem

Vector = NDArray[np.float64]

METHODS = {
    "erk": "explicit Runge-Kutta 5(4), compiled with the march",
    "cvodes": "SUNDIALS CVODES, BDF, on compiled right-hand side and Jacobian",
    "adams": "SUNDIALS CVODES, Adams, on the compiled right-hand side; for tight tolerances without stiffness",
    "idas": "SUNDIALS IDAS, BDF, on compiled right-hand side and Jacobian",
    "rosenbrock": "L-stable Rosenbrock, compiled whole; for very stiff models",
    "sundae": "SUNDIALS 7 CVODE, BDF, which finds switchings by itself; for a second opinion",
}
PLUGINS = {"adams": "cvodes"}
"""CasADi's integrator behind a method, where it has another name."""
MULTISTEP = ("cvodes", "adams", "idas", "sundae")
EXPLICIT = ("erk", "adams")
"""Methods whose step is bound by the fastest motion, whether or not it vibrates."""
OPTIONAL = {"sundae": "sksundae"}
"""The module that a method needs and that is not always installed."""
MOST_STEPS = 1_000_000
SMALLEST = 1e-10
"""Step, in a segment's own time, below which cvodes gives up; idas has no such option and gets fewer steps."""
BUFFERED = 1
"""The memory of a function that its first buffer uses, where CasADi keeps the statistics of its calls."""
CONSTANT = np.zeros(0)
"""Rates of the load signals of a model that has none."""


@dataclass
class Counts:
    """What a run has cost; added up over segments."""

    steps: int = 0
    rhs: int = 0
    jacobian: int = 0
    rejected: int = 0
    segments: int = 0
    events: int = 0
    regimes: int = 0


class Stepper(Protocol):
    """Integrates one segment.

    One that ``finds_borders`` is not told when the next switching is due, and ends its arc where it finds it.

    Attributes
    ----------
    counts
        What it has cost so far.
    last
        The step it begins the next segment with [s], all that it remembers; 0 where it remembers nothing.
    """

    counts: Counts
    last: float
    finds_borders: bool

    def advance(self, z: Vector, duration: float, origin: Vector, s: Vector, slope: Vector = CONSTANT) -> Arc:
        """Return the motion from z on.

        ``s`` are levels and load signals at the segment's start, ``slope`` the signals' rates.
        """

    def renumber(self, p: Vector) -> None:
        """Go on with other parameters, shape (n_p,)."""


def check_method(method: str) -> None:
    """Refuse a method that there is not, or whose package is not installed."""
    if method not in METHODS:
        near = get_close_matches(method, METHODS, 1)
        hint = f'did you mean "{near[0]}"?' if near else f"there are auto, {', '.join(METHODS)}"
        raise LtcgearError(f"method {method!r}: unknown; {hint}")
    module = OPTIONAL.get(method)
    if module is not None and find_spec(module) is None:
        raise LtcgearError(f"method {method!r}: needs a package that is missing; pip install 'ltcgear[{method}]'")


def make_stepper(
    library: Library, method: str, rtol: float, frame: Frame, p: Vector, nodes: Vector, watch: Watch
) -> Stepper | None:
    """Make a stepper; None for ``erk``, which the march has in itself.

    Parameters
    ----------
    library, p
        Model and parameters.
    method
        A key of ``METHODS``.
    rtol
        Relative tolerance; the absolute one is the same times the scale of each state.
    frame
        Scaling.
    nodes
        Output times within a segment, in 0..1 with 1 last, shape (m,).
    watch
        The borders of the cells that the motion is in, for a stepper that finds them.

    Raises
    ------
    LtcgearError
        If there is no such method, or its package is not installed.
    """
    check_method(method)
    if method == "erk":
        return None
    if method == "sundae":
        from .sundials7 import SundaeStepper

        return SundaeStepper(library, rtol, frame, p, nodes, watch)
    if method in MULTISTEP:
        return _CasadiStepper(library, method, rtol, frame, p, nodes)
    return _WholeStepper(library, method, rtol, frame, p, nodes)


class _Base:
    """What both kinds share: the parameter vector and the call."""

    finds_borders = False

    def __init__(self, library: Library, method: str, rtol: float, frame: Frame, p: Vector, nodes: Vector) -> None:
        self.counts, self.last = Counts(), 0.0
        self.method, self.rtol, self.frame, self.nodes, self.library = method, rtol, frame, nodes, library
        self.size = len(frame.scale)
        self.function = self._make()
        self.kernel = Kernel(self.function)
        self.part: dict[str, Vector] = {}
        start, vector = 0, self.kernel.arguments[self.function.index_in("p")]
        for name, length in layout(library).items():
            self.part[name] = vector[start : start + length]
            start += length
        self.part["rtol"][:], self.part["scale"][:], self.part["p"][:] = rtol, frame.scale, p
        self.state = self.kernel.arguments[self.function.index_in("x0")]
        self.end = self.kernel.results[self.function.index_out("xf")]
        self.work = self.kernel.results[self.function.index_out("qf")]

    def _make(self) -> ca.Function:
        raise LtcgearError("a stepper makes its own function")

    def _count(self, duration: float) -> None:
        raise LtcgearError("a stepper keeps its own counts")

    def renumber(self, p: Vector) -> None:
        """Go on with other parameters."""
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


class _CasadiStepper(_Base):
    """An integrator of CasADi's that calls the compiled functions one by one."""

    def _make(self) -> ca.Function:
        options: dict[str, Any] = {"reltol": self.rtol, "abstol": self.rtol, "max_num_steps": MOST_STEPS}
        options |= {"linear_solver": "csparse", "show_eval_warnings": False, "quad_err_con": True}
        if self.method == "adams":
            # Such steps are short enough for iteration without a Jacobian, which costs less than half.
            options |= {"linear_multistep_method": "adams", "nonlinear_solver_iteration": "functional"}
        if self.method == "idas":
            options["max_num_steps"] = MOST_STEPS // 5
        else:
            options["min_step_size"] = SMALLEST
        problem = compiled_problem(self.library)
        return ca.integrator("segment", PLUGINS.get(self.method, self.method), problem, 0, self.nodes.tolist(), options)

    def _count(self, duration: float) -> None:
        stats = self.function.stats(BUFFERED)
        self.counts.segments += 1
        self.counts.steps += stats["nsteps"]
        self.counts.rhs += stats["nfevals"]
        # A set-up of the linear solver is a Jacobian: cvodes keeps none; calls are counted over all segments.
        self.counts.jacobian += stats["nlinsetups"]
        self.counts.rejected += stats["netfails"]


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


def whole_c(library: Library, method: str, nodes: Vector) -> str:
    """Emit a whole integrator as C, with tolerance and first step as parameters and with counters.

    CasADi bakes tolerances in and keeps no statistics in emitted C; four lines are changed for that, and
    each must be found exactly once, since the text is another release's to change.
    """
    problem = scaled_problem(library, library.graphs, ca.SX)
    function = ca.integrator("segment", method, problem, 0, nodes.tolist(), {"max_num_steps": MOST_STEPS})
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


class _WholeStepper(_Base):
    """An integrator that is one compiled C function; steps carry over from segment to segment."""

    def _make(self) -> ca.Function:
        compiler = store.compiler()
        if compiler is None:
            raise LtcgearError("the model was compiled but the compiler is gone")
        make = partial(store.library, whole_c(self.library, self.method, self.nodes), compiler)
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
