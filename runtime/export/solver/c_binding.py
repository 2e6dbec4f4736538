"""C binding of a model for a solver of the user's."""

import ctypes
from functools import cache
from pathlib import Path

from ltcgear.generated import store
from ltcgear.generated.errors import CompileError

from ...model import cstruct
from ...model.shared_library import load

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


class DynamicsStruct(ctypes.Structure):
    """The structure ``dynamics`` of the C."""

    _fields_ = [(name, cstruct.KINDS[kind][0]) for name, kind in KINDS.items()]


class Callee(cstruct.Shared):
    """A model's functions with the arrays that the C needs.

    Attributes
    ----------
    engine
        The compiled functions.
    address
        Where the structure is that they take.
    """

    def __init__(self) -> None:
        super().__init__(DynamicsStruct(), KINDS)
        self.engine, self.address = engine(), ctypes.addressof(self.state)


@cache
def source() -> str:
    """Return the C: parts of the integrator's, and its own."""
    fields = "\n".join(f"  {cstruct.KINDS[kind][1].format(name)};" for name, kind in KINDS.items())
    own = (Path(__file__).parents[2] / "model" / "c" / "dynamics.c").read_text("utf-8")
    return "\n".join([cstruct.source(), f"typedef struct {{\n{fields}\n}} dynamics;\n", own])


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
