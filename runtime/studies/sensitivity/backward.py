"""Adjoint integration along a smooth segment, in C, with derivatives by CasADi."""

import ctypes
from functools import partial
from typing import Any

import casadi as ca
import numpy as np
from ltcgear.generated import store
from ltcgear.generated.errors import CompileError, LtcgearError, SolverError
from numpy.typing import NDArray

from ...model.cstruct import FAULTS, NEEDED, STAGES, Function, engine
from ...model.library import Library
from ...model.shared_library import load
from .course import Course, Piece

Vector = NDArray[np.float64]
FIELDS: tuple[tuple[Any, str], ...] = (
    (Function, "motion report"),
    (ctypes.c_longlong, "n n_p n_s n_levels n_nodes steps most_steps"),
    (ctypes.c_double, "rtol step duration"),
    (ctypes.c_void_p, "points weights origin scale size path s slope p worth lambda gradient"),
    (ctypes.c_void_p, "x s_now stages gains report_x report_p trial after"),
)
"""The structure ``adjoint`` of ``model/c/adjoint.c``."""
MOST_STEPS = 1_000_000


class AdjointStruct(ctypes.Structure):
    """The structure ``adjoint`` of the C."""

    _fields_ = [(name, kind) for kind, names in FIELDS for name in names.split()]


class Backward:
    """The adjoint along a stored run, segment by segment.

    Parameters
    ----------
    course
        The run.
    output
        Place of the output among the model's reports.
    rtol
        Tolerance of the adjoint, over its size.

    Attributes
    ----------
    adjoint
        What a change of each state is worth, shape (n,).
    gradient
        What a change of each parameter has been worth since, shape (n_p,).
    """

    def __init__(self, course: Course, output: int, rtol: float) -> None:
        library, nodes = course.library, course.nodes
        self.course, self.state, self.arrays = course, AdjointStruct(), dict[str, Vector]()
        n, n_p, n_s = (library.functions["rhs"].size1_in(i) for i in (0, 2, 1))
        self._bound = [
            self._bind("motion", _motion_gradient(library)),
            self._bind("report", report_gradient(library, output)),
        ]
        state = self.state
        state.n, state.n_p, state.n_s, state.n_levels = n, n_p, n_s, len(library.manifest.levels)
        state.n_nodes, state.most_steps, state.rtol = len(nodes.points), MOST_STEPS, rtol
        state.step = 0.1 / course.point.fastest
        for name, values in {
            "points": nodes.points, "weights": nodes.weights, "origin": np.zeros(n), "scale": np.ones(n),
            "size": vibrating(course), "path": np.zeros((len(nodes.points), n)), "s": np.zeros(n_s),
            "slope": np.zeros(len(library.manifest.signals)), "p": np.zeros(n_p), "worth": np.zeros(2),
            "lambda": np.zeros(n), "gradient": np.zeros(n_p), "x": np.zeros(n), "s_now": np.zeros(n_s),
            "stages": np.zeros((STAGES, n)), "gains": np.zeros((STAGES, n_p)), "report_x": np.zeros(n),
            "report_p": np.zeros(n_p), "trial": np.zeros(n), "after": np.zeros(n),
        }.items():  # fmt: skip
            self.arrays[name] = np.array(values, dtype=np.float64, order="C")
            setattr(state, name, self.arrays[name].ctypes.data)
        self.adjoint, self.gradient = self.arrays["lambda"], self.arrays["gradient"]
        self._sweep = engine().ltcgear_adjoint
        self._sweep.argtypes = [ctypes.POINTER(AdjointStruct), ctypes.c_double, ctypes.c_double]

    def go_back(self, piece: Piece, start: float, end: float, a: float, b: float) -> None:
        """Go back over a part of a piece.

        Parameters
        ----------
        piece
            The piece.
        start, end
            The part, in time after the piece's start [s].
        a, b
            What the output is worth there, see ``Worth``.

        Raises
        ------
        SolverError
            If the adjoint cannot be followed.
        """
        for name, values in (("path", piece.x), ("s", piece.s), ("slope", piece.slope), ("p", piece.p)):
            self.arrays[name][...] = values
        self.arrays["worth"][:] = a, b
        self.state.duration = piece.duration
        fault = self._sweep(ctypes.byref(self.state), end, start)
        if fault or not np.isfinite(self.adjoint).all():
            raise SolverError(f"the sensitivities cannot be followed at t = {piece.start:.6g} s: {FAULTS[fault or 1]}")

    def _bind(self, name: str, function: ca.Function) -> list[Any]:
        """Let the C call a gradient; return what must live as long."""
        compiler = store.compiler()
        if compiler is None:
            raise CompileError(NEEDED)
        code = load(partial(store.library, _c_text(function), compiler), lambda path: ctypes.CDLL(str(path)))
        sizes = ((function.sz_arg(), np.uint64), (function.sz_res(), np.uint64), (function.sz_iw(), np.int64))
        arrays: list[Any] = [np.zeros(max(size, 4), dtype) for size, dtype in (*sizes, (function.sz_w(), np.float64))]
        address = ctypes.cast(getattr(code, function.name()), ctypes.c_void_p).value
        setattr(self.state, name, Function(address, *(array.ctypes.data for array in arrays)))
        return [code, *arrays]


def vibrating(course: Course) -> Vector:
    """Return the sizes of vibrations, zero for the motion of the reference: it is carried along, and no vibration."""
    states = course.library.manifest.states
    return np.array([0.0 if state.is_reference else size for state, size in zip(states, course.scale, strict=True)])


def _motion_gradient(library: Library) -> ca.Function:
    """Return the gradients of w' f with respect to x and p."""
    graph = library.graphs["rhs"]
    point = [ca.SX.sym(graph.name_in(i), graph.sparsity_in(i)) for i in range(graph.n_in())]
    w = ca.SX.sym("w", point[0].numel())
    return _gradients("motion_gradient", ca.dot(w, graph.call(point)[0]), point, w)


def report_gradient(library: Library, output: int) -> ca.Function:
    """Return the gradients of a y + b y^2 / 2 with respect to x and p, y one of the outputs.

    Raises
    ------
    LtcgearError
        If y is a step function, whose instants are unknown.
    """
    graph = library.graphs["outputs"]
    point = [ca.SX.sym(graph.name_in(i), graph.sparsity_in(i)) for i in range(graph.n_in())]
    y, worth = graph.call(point)[0][output], ca.SX.sym("worth", 2)
    if _sees(y, point[0]) and not ca.sparsify(ca.jacobian(y, point[0])).nnz():
        report = library.manifest.reports[output]
        raise LtcgearError(
            f"--output {report.quantity}:{report.item}: it jumps between values and stays as it is between, so "
            "that nothing tells how its mean moves; take a force or a deflection"
        )
    return _gradients("report_gradient", worth[0] * y + worth[1] * y**2 / 2, point, worth)


def _sees(y: ca.SX, x: ca.SX) -> bool:
    """Return whether an expression contains any of some symbols, even within a step function."""
    return bool({v.element_hash() for v in ca.symvar(y)} & {v.element_hash() for v in ca.vertsplit(x)})


def _gradients(name: str, value: ca.SX, point: list[ca.SX], weights: ca.SX) -> ca.Function:
    """Return the gradients of a value with respect to x and p as a function of (x, s, p, weights)."""
    results = [ca.densify(ca.gradient(value, symbol)) for symbol in (point[0], point[2])]
    return ca.Function(name, [*point, weights], ca.cse(results))


def _c_text(function: ca.Function) -> str:
    """Write a function as C."""
    generator = ca.CodeGenerator("gradient.c", {"casadi_int": "long long int"})
    generator.add(function)
    return str(generator.dump())
