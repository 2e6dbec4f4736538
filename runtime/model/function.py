"""CasADi function bound to NumPy buffers: no conversion, no allocation per call."""

from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


class Kernel:
    """Call a function on preallocated arrays.

    The arrays in ``results`` are overwritten by every call; copy what must last.

    Parameters
    ----------
    function
        A function whose arguments are dense (results may be sparse: they hold the non-zeros).
    """

    def __init__(self, function: ca.Function) -> None:
        self.function = function
        buffer: Any
        buffer, self._evaluate = function.buffer()
        self._buffer = buffer
        self.arguments = [np.zeros(function.nnz_in(i)) for i in range(function.n_in())]
        self.results = [np.zeros(function.nnz_out(i)) for i in range(function.n_out())]
        for i, array in enumerate(self.arguments):
            buffer.set_arg(i, memoryview(array.data))
        for i, array in enumerate(self.results):
            buffer.set_res(i, memoryview(array.data))

    def __call__(self, *values: Any) -> list[Vector]:  # noqa: ANN401
        """Evaluate; RuntimeError where the function fails."""
        for array, value in zip(self.arguments, values, strict=True):
            array[:] = value
        self.evaluate()
        return self.results

    def evaluate(self) -> None:
        """Evaluate on what the argument arrays hold; RuntimeError where the function fails."""
        self._evaluate()
        if self._buffer.ret() != 0:
            raise RuntimeError(f"{self.function.name()} failed")
