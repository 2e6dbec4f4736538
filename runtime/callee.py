"""Callee: the C around a model that a solver of the user's calls, and the one list of what it shares with Python."""

import ctypes
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from ltcgear.generated import store
from ltcgear.generated.errors import CompileError
from numpy.typing import NDArray

from . import native
from .library import Library, load

NEEDED = "calling a model from Python needs a C compiler, and none was found; install gcc or clang, or name one with CC"
FIELDS = (
    ("whole", "n n_levels n_signals n_holds n_entries n_outputs free held sided"),
    ("real", "base held_value"),
    ("wholes", "first sloping cells hold_index place_of"),
    ("bytes", "sides"),
    ("reals", "x p s course times values signals slope distances rate entries matrix"),
    ("function", "rhs jac_rhs phases borders outputs"),
)
"""Kind and names of all that the C and Python share."""
KINDS = {name: kind for kind, names in FIELDS for name in names.split()}


class State(ctypes.Structure):
    """The structure ``dynamics`` of the C."""

    _fields_ = [(name, native.KINDS[kind][0]) for name, kind in KINDS.items()]


class Callee:
    """A model's functions with what the C needs beside them.

    Attributes
    ----------
    engine
        The compiled functions.
    state
        The structure that they take; ``address`` is where it is.
    arrays
        Its arrays by name.
    """

    def __init__(self) -> None:
        self.engine, self.state = engine(), State()
        self.address = ctypes.addressof(self.state)
        self.arrays: dict[str, NDArray[Any]] = {}
        self._bound: list[Any] = []

    def share(self, name: str, values: Any) -> NDArray[Any]:  # noqa: ANN401
        """Let the C point to an array with these values, and return it."""
        array = np.array(values, dtype=native.DTYPES[KINDS[name]], order="C")
        self.arrays[name] = array
        setattr(self.state, name, array.ctypes.data)
        return array

    def bind(self, name: str, library: Library, results: list[int]) -> None:
        """Let the C call a generated function, whose results go to these addresses."""
        function, arrays = native.bound(library, name)
        arrays[1][: len(results)] = results
        self._bound.append(arrays)
        setattr(self.state, name, function)


@cache
def source() -> str:
    """Return the C: the march's, of which it uses parts, and its own."""
    fields = "\n".join(f"  {native.KINDS[kind][1].format(name)};" for name, kind in KINDS.items())
    own = (Path(__file__).parent / "native" / "dynamics.c").read_text("utf-8")
    return "\n".join([native.source(), f"typedef struct {{\n{fields}\n}} dynamics;\n", own])


@cache
def engine() -> ctypes.CDLL:
    """Return the compiled functions around the model's.

    Raises
    ------
    CompileError
        If there is no compiler.
    """
    compiler = store.compiler()
    if compiler is None:
        raise CompileError(NEEDED)
    found = load(lambda: store.library(source(), compiler), lambda path: ctypes.CDLL(str(path)))
    for name in ("rhs", "jac", "course", "borders"):
        getattr(found, f"ltcgear_dynamics_{name}").argtypes = [ctypes.c_void_p, ctypes.c_double]
    found.ltcgear_dynamics_outputs.argtypes = [ctypes.c_void_p, ctypes.c_longlong, *3 * [ctypes.c_void_p]]
    found.ltcgear_time_to_border.argtypes = [ctypes.c_longlong, *3 * [ctypes.c_void_p]]
    found.ltcgear_time_to_border.restype = ctypes.c_double
    return found
