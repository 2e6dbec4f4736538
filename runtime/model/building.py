"""Building of a model: its C is compiled, or taken from the store, and loaded."""

import ctypes
from functools import partial
from pathlib import Path

import casadi as ca
from ltcgear.generated import store
from ltcgear.generated.contract import FUNCTIONS, Artifact

from .library import Library, read_graphs
from .shared_library import load

NO_COMPILER = "no C compiler found: running on CasADi's virtual machine; to simulate, install gcc or clang"


def build(artifact: Artifact) -> Library:
    """Make the functions of a generated model callable.

    Raises
    ------
    CompileError
        If there is a compiler and it fails, or what it makes cannot be loaded; there is no silent fallback.
    """
    compiler = store.compiler()
    if compiler is None:
        return Library(artifact.manifest, None, read_graphs(artifact), artifact)
    make = partial(store.library, artifact.c, compiler)
    functions, code = load(make, lambda path: (external(path), ctypes.CDLL(str(path))))
    return Library(artifact.manifest, make(), functions, artifact, code)


def external(path: Path) -> dict[str, ca.Function]:
    """Load the functions of a shared library; its right-hand side depends smoothly on x only."""
    options = {"rhs": {"is_diff_in": [True, False, False]}}
    return {name: ca.external(name, str(path), options.get(name, {})) for name in FUNCTIONS}
