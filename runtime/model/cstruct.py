"""C structures of the compiled integration, shared with Python."""

import ctypes
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
from ltcgear.generated import store
from ltcgear.generated.errors import CompileError
from numpy.typing import NDArray

from .contact_levels import AT_BORDER
from .library import Library
from .shared_library import load

SOURCES = (
    "head.c", "switching.c", "regimes.c", "extremes.c", "sums.c", "erk.c", "points.c", "march.c", "rows.c",
    "filter.c", "adjoint.c",
)  # fmt: skip
NEEDED = "simulating needs a C compiler, and none was found; install gcc or clang, or name one with CC"
FAULTS = (
    "",
    "a value is not finite",
    "the step size fell below what the time can tell apart",
    "too many steps in a segment",
    "two switching instants of one mesh fall together; check its contact ratio",
    "a switching instant could not be located",
    "samples lie beside the nodes of a block that was cut",
    "the motion grows without bound",
    "an engine stopped",
)
"""Reasons for which an integration ends, in the order of the C's enumeration."""
STOPPED = len(FAULTS) - 1

SHARED = (
    # sizes, places and numbers that stay
    ("fixed", "whole", "n n_levels n_signals n_holds n_nodes n_forces angle speed free held uniform finds_borders"),
    ("fixed", "whole", "last capacity most_steps most_points point_room summed"),
    ("fixed", "real", "rtol shortest widest unresolved held_speed held_value end sampling turning passing"),
    ("fixed", "real", "span_from span_to"),
    ("fixed", "reals", "origin scale points last_terms weights fine error slack zeros"),
    ("fixed", "reals", "rule_at rule_weight rule_motion rule_filter"),
    ("fixed", "wholes", "hold_index"),
    ("fixed", "function", "motion phases borders energy"),
    ("fixed", "advance", "advance"),
    # the leg: load signals are linear in time from its base to its knot
    ("leg", "real", "knot base"),
    ("leg", "reals", "signals signals_knot slope"),
    # what a march remembers from segment to segment
    ("kept", "whole", "fresh expected steps rhs jacobian rejected segments events regimes"),
    ("kept", "real", "time unpassed work jump_energy longest first step"),
    ("kept", "reals", "z p heading lowest steady"),
    ("kept", "wholes", "cells last_turn"),
    ("kept", "bytes", "sides"),
    # what it hands on, and room to work in
    ("passing", "whole", "done filled pointed seen began"),
    ("passing", "real", "reached"),
    ("passing", "reals", "sample_x sample_time sample_levels sample_steps s path node_work x y y_after trial"),
    ("passing", "reals", "point_x point_time point_weight point_levels"),
    ("passing", "reals", "stages power rate balance forces seen_time seen_forces arc_lowest arc_steady"),
    ("passing", "reals", "stage_forces arc_sums sums"),
    ("passing", "reals", "now after ahead gain"),
    ("passing", "reals", "s_now s_end signals_end z_near z_far g_now g_start g_slope g_noise node_values fine_values"),
    ("passing", "wholes", "changed arc_cells"),
    ("passing", "bytes", "new_sides arc_sides"),
)
"""Role, kind and names of the shared fields, in the order of both structures."""
FIELDS = tuple((name, kind, role) for role, kind, names in SHARED for name in names.split())
NAMES = {role: tuple(name for name, _, of in FIELDS if of == role) for role in ("fixed", "leg", "kept", "passing")}
"""Role of fields -> their names."""
KIND = {name: kind for name, kind, _ in FIELDS}
STAGES, FINE = 7, 64
"""Stages of the explicit method; intervals of a segment at whose ends indicators are evaluated."""
ADVANCE = ctypes.CFUNCTYPE(None, ctypes.c_double)
DTYPES: dict[str, Any] = {"reals": np.float64, "wholes": np.int64, "bytes": np.bool_}
PREAMBLE = f"""#ifndef _POSIX_C_SOURCE
#define _POSIX_C_SOURCE 199309L /* a clock that nobody sets */
#endif
#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#ifndef EXPORTED
#define EXPORTED __attribute__((visibility("default")))
#endif
#define STAGES {STAGES}
#define FINE {FINE}
#define AT_BORDER {AT_BORDER!r} /* how close to a border [cycles] counts as being there, besides rounding */

typedef long long whole;
typedef int (*generated)(const double **arg, double **res, whole *iw, double *w, int mem);
typedef struct {{
  generated run;
  const double **arg;
  double **res;
  whole *iw;
  double *w;
}} function;
"""


class Function(ctypes.Structure):
    """A generated function with the arrays it is bound to."""

    _fields_ = [(name, ctypes.c_void_p) for name in ("run", "arg", "res", "iw", "w")]


KINDS: dict[str, tuple[Any, str]] = {
    "whole": (ctypes.c_longlong, "whole {}"),
    "real": (ctypes.c_double, "double {}"),
    "reals": (ctypes.c_void_p, "double *{}"),
    "wholes": (ctypes.c_void_p, "whole *{}"),
    "bytes": (ctypes.c_void_p, "unsigned char *{}"),
    "function": (Function, "function {}"),
    "advance": (ADVANCE, "void (*{})(double)"),
}
"""Kind of a field -> its type in Python, and its declaration in C."""


class MarchStruct(ctypes.Structure):
    """The structure ``march`` of the C."""

    _fields_ = [(name, KINDS[kind][0]) for name, kind, _ in FIELDS]


@cache
def source(parts: tuple[str, ...] = SOURCES) -> str:
    """Return the integrator's C, or some parts of it."""
    fields = "\n".join(f"  {KINDS[kind][1].format(name)};" for name, kind, _ in FIELDS)
    texts = ((Path(__file__).parent / "c" / name).read_text("utf-8") for name in parts)
    return "\n".join([PREAMBLE, f"typedef struct {{\n{fields}\n}} march;\n", *texts])


@cache
def engine() -> ctypes.CDLL:
    """Return the compiled integrator.

    Raises
    ------
    CompileError
        If there is no compiler.
    """
    compiler = store.compiler()
    if compiler is None:
        raise CompileError(NEEDED)
    found = load(lambda: store.library(source(), compiler), lambda path: ctypes.CDLL(str(path)))
    found.ltcgear_march.argtypes = [ctypes.POINTER(MarchStruct), ctypes.c_longlong, ctypes.c_double]
    found.ltcgear_pass.argtypes = [ctypes.POINTER(MarchStruct), ctypes.c_double, ctypes.c_double]
    found.ltcgear_pass.restype = None
    column = (ctypes.c_void_p, ctypes.c_longlong)
    found.ltcgear_rows.argtypes = [ctypes.POINTER(Function), ctypes.c_longlong, *column * 4]
    count, data = ctypes.c_longlong, ctypes.c_void_p
    found.ltcgear_filter.argtypes = [*[count] * 4, *[data] * 4, count, data, data]
    found.ltcgear_sums.argtypes = [count, count, data, data, data]
    found.ltcgear_filter.restype = found.ltcgear_sums.restype = None
    return found


def bound(library: Library, name: str) -> tuple[Function, list[NDArray[Any]]]:
    """Return a generated function for the C to call, and the arrays of arguments, results and work that it needs.

    Raises
    ------
    CompileError
        If the model is not compiled.
    """
    if library.code is None:
        raise CompileError(NEEDED)
    function: ca.Function = library.functions[name]
    arrays = [
        np.zeros(max(size, 4), dtype)
        for size, dtype in (
            (function.sz_arg(), np.uint64), (function.sz_res(), np.uint64), (function.sz_iw(), np.int64),
            (function.sz_w(), np.float64),
        )
    ]  # fmt: skip
    code = ctypes.cast(getattr(library.code, name), ctypes.c_void_p).value
    return Function(code, *(array.ctypes.data for array in arrays)), arrays


class Shared:
    """Data shared by C and Python: scalars in a C structure, which points to NumPy arrays.

    Parameters
    ----------
    state
        The structure.
    kinds
        Kinds of its fields by name.

    Attributes
    ----------
    state
        The structure.
    arrays
        Its arrays by name.
    """

    def __init__(self, state: Any, kinds: Mapping[str, str]) -> None:  # noqa: ANN401
        self.state, self._kinds = state, kinds
        self.arrays: dict[str, NDArray[Any]] = {}
        self._bound: list[Any] = []

    def share(self, name: str, values: Any) -> NDArray[Any]:  # noqa: ANN401
        """Let the C point to an array with these values, and return it; its bytes stay where they are from now on."""
        array = np.array(values, dtype=DTYPES[self._kinds[name]], order="C")
        self.arrays[name] = array
        setattr(self.state, name, array.ctypes.data)
        return array

    def bind(self, name: str, library: Library, results: Sequence[int] = ()) -> None:
        """Let the C call a generated function, whose first results go to these addresses."""
        function, arrays = bound(library, name)
        arrays[1][: len(results)] = results
        self._bound.append(arrays)
        setattr(self.state, name, function)


class Native(Shared):
    """The state of an integration in C."""

    def __init__(self) -> None:
        super().__init__(MarchStruct(), KIND)
        self.engine = engine()

    def value(self, name: str) -> NDArray[Any]:
        """Return a copy of what a field holds."""
        return self.arrays[name].copy() if name in self.arrays else np.array(getattr(self.state, name))

    def assign(self, name: str, value: NDArray[Any]) -> None:
        """Put a value into a field."""
        if name in self.arrays:
            self.arrays[name][...] = value
        else:
            setattr(self.state, name, value.item())

    def call_back(self, advance: Any) -> None:  # noqa: ANN401
        """Let the C integrate by a function of Python's, of a duration [s], which sets what it has reached."""
        self.state.advance = ADVANCE(advance)

    def march(self, segments: int, seconds: float) -> int:
        """Integrate on (``model/c/march.c``), without the interpreter's lock."""
        return int(self.engine.ltcgear_march(ctypes.byref(self.state), segments, seconds))
