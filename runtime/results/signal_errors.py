"""Difference of two signals over their vibration."""

import numpy as np
from numpy.typing import NDArray

Signal = NDArray[np.float64] | NDArray[np.complex128]
STILL = 1e-6
"""Vibration over the mean below which a force counts as constant."""


def compare_signals(coarse: Signal, fine: Signal) -> dict[str, float | None]:
    """Compare a signal with that of a finer run; one in a plane is given as x + iy.

    Returns
    -------
    dict
        Root mean square and peak of the difference over the finer signal's vibration (its standard deviation) and over
        its mean's magnitude; None if there is nothing to refer to.
    """
    difference = np.abs(coarse - fine)
    mean, vibration = float(np.abs(fine.mean())), float(fine.std())
    sizes = {"vibration": vibration if vibration > STILL * mean else 0.0, "mean": mean}
    errors = {"rms": float(np.sqrt(np.mean(difference**2))), "peak": float(difference.max())}
    return {
        f"{error}_over_{size}": value / scale if scale > 0 else None
        for size, scale in sizes.items()
        for error, value in errors.items()
    }
