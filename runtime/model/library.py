"""Library of a model: the generated functions compiled and ready to call."""

import ctypes
import shutil
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import TypeVar

import casadi as ca
import numpy as np
from ltcgear.generated import store
from ltcgear.generated.contract import FUNCTIONS, Artifact, Manifest
from ltcgear.generated.drafts import draft
from ltcgear.generated.errors import CompileError
from numpy.typing import NDArray

from .parameter_values import read_values

Loaded = TypeVar("Loaded")
Vector = NDArray[np.float64]
UNLOADABLE = (OSError, RuntimeError, AttributeError)
NO_COMPILER = "no C compiler found: running on CasADi's virtual machine; to simulate, install gcc or clang"


@dataclass(frozen=True)
class Library:
    """A generated model, ready to run.

    Attributes
    ----------
    manifest
        Names and shapes.
    path
        The shared library, None where the functions run on CasADi's virtual machine.
    functions
        The functions of the contract by name.
    artifact
        What it was built from.
    code
        The shared library as it was loaded, None where there is none.
    """

    manifest: Manifest
    path: Path | None
    functions: dict[str, ca.Function]
    artifact: Artifact
    code: ctypes.CDLL | None = None

    @cached_property
    def graphs(self) -> dict[str, ca.Function]:
        """Return the functions as graphs, for whole-integrator C and for derivatives."""
        return _graphs(self.artifact)

    @property
    def engine(self) -> str:
        """Say what evaluates the functions."""
        return "compiled C" if self.path else "CasADi virtual machine"

    def parameters(self, values: Mapping[str, float]) -> Vector:
        """Return the parameter vector, shape (n_p,); LtcgearError with every name or number that is wrong."""
        return read_values(self.manifest, values)

    def index(self, ending: str) -> NDArray[np.int64]:
        """Return the indices of deviations (``""``) or of their rates (``".rate"``)."""
        places = {(state.kind, state.body, state.axis): i for i, state in enumerate(self.manifest.states)}
        deviations = [key for key in places if key[0] == "deviation"]
        wanted = [("rate", *key[1:]) for key in deviations] if ending else deviations
        return np.array([places[key] for key in wanted], dtype=np.int64)


def build(artifact: Artifact) -> Library:
    """Make the functions of a generated model callable.

    Raises
    ------
    CompileError
        If there is a compiler and it fails, or what it makes cannot be loaded; there is no silent fallback.
    """
    compiler = store.compiler()
    if compiler is None:
        return Library(artifact.manifest, None, _graphs(artifact), artifact)
    make = partial(store.library, artifact.c, compiler)
    functions, code = load(make, lambda path: (external(path), ctypes.CDLL(str(path))))
    return Library(artifact.manifest, make(), functions, artifact, code)


def load(make: Callable[[], Path], loader: Callable[[Path], Loaded]) -> Loaded:
    """Load a compiled library; where that fails, delete it, compile it once more and load that.

    Parameters
    ----------
    make
        Returns where the library is, compiled if it is not there.
    loader
        Loads it; an error of ``UNLOADABLE`` where that fails.

    Raises
    ------
    CompileError
        If the library that was just compiled cannot be loaded either.
    """
    path = make()
    try:
        return loader(path)
    except UNLOADABLE:
        pass  # leave the handler: its traceback may hold parts of the library
    try:
        path.unlink(missing_ok=True)
        path = make()
        # What was once loaded from a path stands for that path until the process ends: load from another.
        with draft(path.parent) as folder:
            return loader(Path(shutil.copy(path, folder)))
    except UNLOADABLE as error:
        raise CompileError(
            f"{path}: cannot be loaded, not even compiled afresh; if programs may not run from there (noexec), "
            f"set LTCGEAR_CACHE to another folder; the loader says: {error}"
        ) from error


def external(path: Path) -> dict[str, ca.Function]:
    """Load the functions of a shared library; its right-hand side depends smoothly on x only."""
    options = {"rhs": {"is_diff_in": [True, False, False]}}
    return {name: ca.external(name, str(path), options.get(name, {})) for name in FUNCTIONS}


def _graphs(artifact: Artifact) -> dict[str, ca.Function]:
    """Read the serialised graphs."""
    unpacked = ca.StringDeserializer(artifact.graphs).unpack()
    return {function.name(): function for function in unpacked}
