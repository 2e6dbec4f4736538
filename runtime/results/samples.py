"""Samples that a run keeps: outputs, states and levels at instants, row by row."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..model.library import Library

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Rows:
    """Kept samples: numbers among all samples, times [s], outputs, states, levels, and steps so far.

    Shapes (m,), and (m, ...) of outputs, states and levels. States and levels are those of the instant.
    """

    index: NDArray[np.int64]
    time: Vector
    values: Vector
    x: Vector
    levels: Vector
    steps: Vector

    def __getitem__(self, part: slice) -> "Rows":
        """Return a copy of some of the rows."""
        return Rows(**{name: value[part].copy() for name, value in vars(self).items()})


def join_rows(rows: list[Rows]) -> Rows:
    """Join rows that follow each other."""
    return Rows(**{name: np.concatenate([vars(r)[name] for r in rows]) for name in vars(rows[0])})


def no_rows(library: Library) -> Rows:
    """Return no rows."""
    manifest = library.manifest
    sizes = {"values": manifest.reports, "x": manifest.states, "levels": manifest.levels}
    none: dict[str, Vector] = {name: np.zeros((0, len(items))) for name, items in sizes.items()}
    return Rows(np.zeros(0, dtype=np.int64), np.zeros(0), **none, steps=np.zeros(0))


def by_quantity(library: Library) -> dict[str, list[int]]:
    """Return quantity -> columns of the output vector."""
    columns: dict[str, list[int]] = {}
    for i, report in enumerate(library.manifest.reports):
        columns.setdefault(report.quantity, []).append(i)
    return columns
