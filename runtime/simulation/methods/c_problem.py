"""Scaled problem of a segment: as a graph for CasADi, and as C that calls the compiled model.

As a graph of calls the problem is interpreted at every step. As C it is not: CasADi's multistep integrators look the
rates, their Jacobian and the quadrature up by name in the library that defines the problem. That C holds the scaling
only, so that it compiles in less than a second; the model's own functions are bound when it is loaded.
"""

import ctypes
from functools import partial
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
from ltcgear.generated import store
from ltcgear.generated.errors import LtcgearError

from ...model.library import Library
from ...model.shared_library import load

CALLED = ("rhs", "jac_rhs", "energy")
"""The model's functions that the problem calls."""
BINDING = """
typedef int (*ltcgear_function)(const casadi_real**, casadi_real**, casadi_int*, casadi_real*, int);
static ltcgear_function ltcgear_bound[{count}];
CASADI_SYMBOL_EXPORT void ltcgear_bind(const ltcgear_function* given) {{
  int i;
  for (i = 0; i < {count}; ++i) ltcgear_bound[i] = given[i];
}}
"""
CALL = """
int {name}(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {{
  return ltcgear_bound[{place}](arg, res, iw, w, mem);
}}
int {name}_checkout(void) {{ return 0; }}
void {name}_release(int mem) {{ (void)mem; }}
void {name}_incref(void) {{}}
void {name}_decref(void) {{}}
"""


def layout(library: Library) -> dict[str, int]:
    """Return the sizes of the parts of an integrator's parameter vector, in order."""
    n, s, numbers = (library.functions["rhs"].size1_in(i) for i in range(3))
    signals = len(library.manifest.signals)
    return {"duration": 1, "rtol": 1, "first": 1, "origin": n, "scale": n, "s": s, "slope": signals, "p": numbers}


def scaled_problem(library: Library, functions: dict[str, ca.Function], symbol: Any) -> dict[str, Any]:  # noqa: ANN401
    """Write the scaled problem with symbols of one kind (SX inlines, MX calls)."""
    part, z, t = _symbols(library, symbol)
    ode, power = _rates(functions, part, _place(library, part, z, t))
    if symbol is ca.SX:
        ode, power = ca.cse([ode, power])
    return {"x": z, "t": t, "p": ca.vertcat(*part.values()), "ode": ode, "quad": power}


def _symbols(library: Library, symbol: Any) -> tuple[dict[str, Any], Any, Any]:  # noqa: ANN401
    """Return symbols of the parameter vector's parts, of z and of the segment's own time."""
    part = {name: symbol.sym(name, size) for name, size in layout(library).items()}
    return part, symbol.sym("z", part["scale"].shape[0]), symbol.sym("t")


def _place(library: Library, part: dict[str, Any], z: Any, t: Any) -> tuple[Any, Any, Any]:  # noqa: ANN401
    """Return x, s and p of the model at z and t."""
    s = part["s"]
    if library.manifest.signals:
        s = s + ca.vertcat(np.zeros(len(library.manifest.levels)), part["slope"]) * part["duration"] * t
    return part["origin"] + part["scale"] * z, s, part["p"]


def _rates(functions: dict[str, ca.Function], part: dict[str, Any], at: tuple[Any, Any, Any]) -> tuple[Any, Any]:
    """Return the rates of z and of the work over the segment's own time."""
    rate, balance = functions["rhs"](*at), functions["energy"](*at)
    return part["duration"] * rate / part["scale"], part["duration"] * (balance[3] - balance[4])


def compiled_problem(library: Library) -> ca.Function:
    """Return the scaled problem as C around the compiled model, for CasADi's multistep integrators.

    Raises
    ------
    LtcgearError
        If there is no compiler.
    """
    compiler = store.compiler()
    if compiler is None or library.code is None:
        raise LtcgearError("the model was compiled but the compiler is gone")
    model = [ctypes.cast(getattr(library.code, name), ctypes.c_void_p).value for name in CALLED]
    return load(partial(store.library, problem_c(library), compiler), partial(_bound, model))


def _bound(model: list[int | None], path: Path) -> ca.Function:
    """Load a problem and pass it the functions of its model."""
    ctypes.CDLL(str(path)).ltcgear_bind((ctypes.c_void_p * len(CALLED))(*model))
    return ca.external("dae", str(path))


def problem_c(library: Library) -> str:
    """Emit the scaled problem as C.

    The text names the model that it calls: two models of one shape must not share what is bound.
    """
    generator = ca.CodeGenerator("problem.c", {"casadi_int": "long long int"})
    for function in _functions(library):
        generator.add(function)
    binding = BINDING.format(count=len(CALLED))
    calls = (CALL.format(name=name, place=place) for place, name in enumerate(CALLED))
    return "".join([f"/* around {store.digest([library.artifact.c])} */\n", generator.dump(), binding, *calls])


def _functions(library: Library) -> list[ca.Function]:
    """Write the functions that an integrator asks for: the whole problem, rates, quadrature, Jacobian."""
    part, z, t = _symbols(library, ca.MX)
    at = _place(library, part, z, t)
    ode, power = _rates(library.functions, part, at)
    size, none = z.shape[0], ca.MX(0, 1)
    jacobian = library.functions["jac_rhs"](*at, ca.MX(size, 1))[0]
    row, column = jacobian.sparsity().get_triplet()
    entries = part["duration"] * jacobian.nz[:] * part["scale"][column] / part["scale"][row]
    given = {"t": t, "x": z, "z": ca.MX.sym("z", 0), "p": ca.vertcat(*part.values()), "u": ca.MX.sym("u", 0)}
    results = {
        "dae": {"ode": ode, "alg": none, "quad": power, "zero": none},
        "daeF": {"ode": ode, "alg": none},
        "quadF": {"quad": power},
        "jacF": {
            "jac_ode_x": ca.MX(jacobian.sparsity(), entries), "jac_alg_x": ca.MX(0, size),
            "jac_ode_z": ca.MX(size, 0), "jac_alg_z": ca.MX(0, 0),
        },
    }  # fmt: skip
    return [
        ca.Function(name, list(given.values()), list(wanted.values()), list(given), list(wanted))
        for name, wanted in results.items()
    ]
