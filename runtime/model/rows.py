"""Batch evaluation: a generated function at many rows of arguments, by one call of C."""

import ctypes
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .cstruct import bound, engine
from .library import Library

Vector = NDArray[np.float64]


class Batch:
    """A function of (x, s, p) with one dense result, bound once and then called without CasADi.

    Other threads run meanwhile; a batch itself belongs to one of them at a time.

    Parameters
    ----------
    library, name
        Model and which of its functions.

    Raises
    ------
    CompileError
        If there is no compiler.
    """

    def __init__(self, library: Library, name: str) -> None:
        function = library.functions[name]
        self.library, self.name, self.engine = library, name, engine()
        self.widths = [function.nnz_in(i) for i in range(function.n_in())]
        self.width = function.nnz_out(0)
        self._function, self._arrays = bound(library, name)

    def __call__(self, *columns: Vector) -> Vector:
        """Evaluate at many rows.

        Parameters
        ----------
        columns
            Per argument an array of shape (rows, size), or (size,) where it does not change.

        Returns
        -------
        numpy.ndarray
            Shape (rows, size of the result).

        Raises
        ------
        ValueError
            If the shapes do not fit the function or each other.
        RuntimeError
            If the function fails.
        """
        given = [np.ascontiguousarray(column, dtype=np.float64) for column in columns]
        counts = {len(column) for column in given if column.ndim == 2}
        if len(counts) != 1 or [column.shape[-1] for column in given] != self.widths:
            shapes = ", ".join(str(column.shape) for column in given)
            raise ValueError(f"{self.name} takes rows of {self.widths} numbers; got arrays of {shapes}")
        rows = counts.pop()
        out = np.empty((rows, self.width))
        places: list[Any] = []
        for column in given:
            places += [column.ctypes.data, column.shape[1] if column.ndim == 2 else 0]
        if self.engine.ltcgear_rows(ctypes.byref(self._function), rows, *places, out.ctypes.data, self.width):
            raise RuntimeError(f"{self.name} failed")
        return out


def over_time(library: Library, name: str, *columns: Vector) -> Vector:
    """Evaluate one of a model's functions at many rows, see ``Batch``."""
    return Batch(library, name)(*columns)
