"""Library of a model: the generated functions compiled and ready to call."""

import ctypes
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import casadi as ca
import numpy as np
from ltcgear.generated.contract import Artifact, Manifest
from numpy.typing import NDArray

from .parameter_values import read_values

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Library:
    """A generated model, ready to run.

    Attributes
    ----------
    manifest
        Names and shapes.
    path
        The shared library, None if the functions run on CasADi's virtual machine.
    functions
        The functions of the contract by name.
    artifact
        What it was built from.
    code
        The shared library as it was loaded, None if there is none.
    """

    manifest: Manifest
    path: Path | None
    functions: dict[str, ca.Function]
    artifact: Artifact
    code: ctypes.CDLL | None = None

    @cached_property
    def graphs(self) -> dict[str, ca.Function]:
        """Return the functions as graphs, for whole-integrator C and for derivatives."""
        return read_graphs(self.artifact)

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


def read_graphs(artifact: Artifact) -> dict[str, ca.Function]:
    """Read the serialised graphs."""
    unpacked = ca.StringDeserializer(artifact.graphs).unpack()
    return {function.name(): function for function in unpacked}
