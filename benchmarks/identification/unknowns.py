"""Unknowns: the numbers to be identified, with what is held of each before any measurement."""

from dataclasses import dataclass
from math import exp, log
from typing import Any

import numpy as np
from ltcgear.generated.errors import LtcgearError
from numpy.typing import NDArray

Vector = NDArray[np.float64]
SIGMAS = 2.0
"""Standard deviations of the prior between its centre and the further bound."""


@dataclass(frozen=True)
class Unknown:
    """A number of a scene that is to be identified.

    Attributes
    ----------
    name
        What it is, in words.
    keys
        Keys of the scene that all have this one value.
    unit
        Unit of the numbers below; empty for a pure number.
    start, low, high
        The value assumed so far, and the bounds within which physics puts it.
    source
        Where the bounds come from.
    logarithmic
        Whether ratios count and not differences, as for sizes that are greater than zero.
    """

    name: str
    keys: tuple[str, ...]
    unit: str
    start: float
    low: float
    high: float
    source: str
    logarithmic: bool = True

    @property
    def width(self) -> float:
        """Return the standard deviation held before: of the logarithm, or of the number itself [unit]."""
        middle = self._flat(self.start)
        return max(self._flat(self.high) - middle, middle - self._flat(self.low)) / SIGMAS

    def value(self, z: float) -> float:
        """Return the number that lies ``z`` standard deviations from the assumed one."""
        flat = self._flat(self.start) + z * self.width
        return exp(flat) if self.logarithmic else flat

    def place(self, value: float) -> float:
        """Return how many standard deviations a number lies from the assumed one."""
        return (self._flat(value) - self._flat(self.start)) / self.width

    def text(self, z: float) -> str:
        """Write the number as a scene has it."""
        return f"{self.value(z):.12g} {self.unit}".strip()

    def _flat(self, value: float) -> float:
        return log(value) if self.logarithmic else value


def read_unknowns(tables: list[dict[str, Any]]) -> list[Unknown]:
    """Read unknowns from plain tables.

    Raises
    ------
    LtcgearError
        If a table lacks something, or a number lies outside its bounds.
    """
    found = []
    for k, table in enumerate(tables, start=1):
        label = table.get("name", f"unknown {k}")
        try:
            unknown = Unknown(**table | {"keys": tuple(table["keys"])})
        except (TypeError, KeyError) as error:
            raise LtcgearError(f"{label}: {error}; give name, keys, unit, start, low, high and source") from error
        if not unknown.low < unknown.start < unknown.high or (unknown.logarithmic and unknown.low <= 0):
            raise LtcgearError(
                f"{label}: low {unknown.low:g}, start {unknown.start:g} and high {unknown.high:g} must rise"
            )
        found.append(unknown)
    return found


def changes_of(unknowns: list[Unknown], z: Vector) -> dict[str, str]:
    """Return the scene keys and values of a point, as ``--set`` takes them."""
    return {key: unknown.text(place) for unknown, place in zip(unknowns, z, strict=True) for key in unknown.keys}


def bounds_of(unknowns: list[Unknown]) -> tuple[Vector, Vector]:
    """Return the lowest and the highest point [standard deviations]."""
    low, high = ([unknown.place(getattr(unknown, name)) for unknown in unknowns] for name in ("low", "high"))
    return np.array(low), np.array(high)
