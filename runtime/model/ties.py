"""Stable order by size: values that differ by rounding only are sorted by name."""

import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

TIE = 1e-9
"""Difference that is a tie, over the largest size."""


def order_by_size(sizes: ArrayLike, names: Sequence[str] | None = None) -> list[int]:
    """Return the indices that sort some sizes, largest first; ties by name, or by index without names.

    Parameters
    ----------
    sizes
        Shape (n,); infinite ones come first, NaN last.
    names
        Shape (n,). Numbers in them count as numbers: ``planet.2`` comes before ``planet.10``.
    """
    values = np.nan_to_num(np.asarray(sizes, dtype=float), nan=-np.inf, posinf=np.inf, neginf=-np.inf)
    near = TIE * float(np.abs(values[np.isfinite(values)]).max(initial=0.0))
    runs: list[list[int]] = []
    for k in np.argsort(-values, kind="stable").tolist():
        if runs and (values[k] == values[runs[-1][0]] or values[runs[-1][0]] - values[k] <= near):
            runs[-1].append(k)
        else:
            runs.append([k])
    keys = [_split(name) for name in names] if names is not None else [[]] * values.size
    return [k for run in runs for k in sorted(run, key=lambda k: (keys[k], k))]


def largest_first(sizes: Mapping[str, float]) -> dict[str, float]:
    """Return sizes by name, largest first; ties by name."""
    names = list(sizes)
    return {names[k]: sizes[names[k]] for k in order_by_size([sizes[name] for name in names], names)}


def _split(name: str) -> list[Any]:
    """Return the words and numbers that a name is made of, in turn."""
    return [int(part) if part.isdecimal() else part for part in re.split(r"(\d+)", name)]
