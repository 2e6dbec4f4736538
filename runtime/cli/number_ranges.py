"""Number ranges of options: FIRST:LAST:NUMBER."""

from math import isfinite

import numpy as np
from ltcgear.generated.errors import LtcgearError
from numpy.typing import NDArray

MOST = 1000
"""Values of a range at most."""


def read_range(option: str, text: str, example: str, single: bool = False) -> NDArray[np.float64]:
    """Read ``FIRST:LAST:NUMBER`` as so many values, evenly from the first to the last.

    Parameters
    ----------
    option, text
        The option, and what it was given.
    example
        A range that makes sense there, for the message.
    single
        Whether one number will do.

    Raises
    ------
    LtcgearError
        If it is not three numbers, 0 <= first < last, and a whole number of 2 or more.
    """
    parts = text.split(":")
    try:
        if single and len(parts) == 1:
            first, last, count = float(text), float(text), 1
        else:
            first, last, count = float(parts[0]), float(parts[1]), int(parts[2])
    except (ValueError, IndexError):
        first, last, count = np.nan, np.nan, 0
    rises = first < last and len(parts) == 3 and count > 1
    if not (isfinite(first) and isfinite(last) and first >= 0 and (rises or count == 1 == len(parts))):
        raise LtcgearError(
            f"{option} {text}: write FIRST:LAST:NUMBER with 0 <= FIRST < LAST and a NUMBER above 1, "
            f"for example {option} {example}{', or one number, 0 or above' if single else ''}"
        )
    if count > MOST:
        raise LtcgearError(f"{option} {text}: {count} values, {MOST} at most; take fewer")
    return np.linspace(first, last, count)
