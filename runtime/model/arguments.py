"""Array arguments: what a caller gives, as arrays of real numbers, or refused."""

from typing import Any

import numpy as np
from ltcgear.generated.errors import LtcgearError
from numpy.typing import NDArray

Vector = NDArray[np.float64]


def read_numbers(given: Any, name: str) -> Vector:  # noqa: ANN401
    """Return an argument as an array of real numbers."""
    try:
        array = np.asarray(given)
    except ValueError as error:
        raise LtcgearError(f"{name}: {error}") from error
    if array.dtype.kind not in "fiu":
        raise LtcgearError(f"{name}: numbers of type {array.dtype}; must be real numbers, best float64")
    return np.ascontiguousarray(array, dtype=np.float64).reshape(array.shape)


def read_time(t: Any) -> float:  # noqa: ANN401
    """Return a time as a number."""
    array = read_numbers(t, "t")
    if array.ndim:
        raise LtcgearError(f"t: shape {array.shape}, must be one number, a time in seconds")
    return float(array)
