"""Build: Artifact -> Library, the generated functions ready to call, compiled where there is a compiler."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import casadi as ca
import numpy as np
from ltcgear.generated import store
from ltcgear.generated.contract import FUNCTIONS, Artifact, Manifest
from numpy.typing import NDArray

Vector = NDArray[np.float64]
NO_COMPILER = "no C compiler found: running on CasADi's virtual machine (install gcc or clang for full speed)"


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
    """

    manifest: Manifest
    path: Path | None
    functions: dict[str, ca.Function]
    artifact: Artifact

    @cached_property
    def graphs(self) -> dict[str, ca.Function]:
        """Return the functions as graphs, for whole-integrator C and for derivatives."""
        return _graphs(self.artifact)

    @property
    def engine(self) -> str:
        """Say what evaluates the functions."""
        return "compiled C" if self.path else "CasADi virtual machine"

    def parameters(self, values: Mapping[str, float]) -> Vector:
        """Return the parameter vector; KeyError for a parameter that is missing."""
        return np.array([values[name] for name, _ in self.manifest.parameters])

    def index(self, ending: str) -> NDArray[np.int64]:
        """Return the indices of deviations (``""``) or of their rates (``".rate"``)."""
        names = [state.name for state in self.manifest.states]
        deviations = [
            i for i, name in enumerate(names) if not name.endswith(".rate") and not name.startswith("reference.")
        ]
        if not ending:
            return np.array(deviations, dtype=np.int64)
        return np.array([names.index(names[i] + ending) for i in deviations], dtype=np.int64)


def build(artifact: Artifact) -> Library:
    """Make the functions of a generated model callable.

    Raises
    ------
    CompileError
        If there is a compiler and it fails; there is no silent fallback.
    """
    compiler = store.compiler()
    if compiler is None:
        return Library(artifact.manifest, None, _graphs(artifact), artifact)
    path = store.library(artifact.c, compiler)
    return Library(artifact.manifest, path, external(path), artifact)


def external(path: Path) -> dict[str, ca.Function]:
    """Load the functions of a shared library; its right-hand side depends smoothly on x only."""
    options = {"rhs": {"is_diff_in": [True, False, False]}}
    return {name: ca.external(name, str(path), options.get(name, {})) for name in FUNCTIONS}


def _graphs(artifact: Artifact) -> dict[str, ca.Function]:
    """Read the serialised graphs."""
    unpacked = ca.StringDeserializer(artifact.graphs).unpack()
    return {function.name(): function for function in unpacked}
