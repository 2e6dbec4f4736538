"""Axes of a sweep: numbers and choices of the scene, as written after ``--vary``."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np
from ltcgear.generated.errors import LtcgearError
from numpy.typing import NDArray

Vector = NDArray[np.float64]
NUMBER = re.compile(r"([+-]?(?:(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:e[+-]?[0-9]+)?|(?:inf(?:inity)?|nan)\b))\s*(.*)", re.I)
MOST = 1_000_000
"""Points of an axis, and of a sweep, at most."""
EXAMPLE = "write NAME=a:b:n, NAME=a:b or NAME=v1,v2,v3, such as loads.ring.speed='5 rpm:20 rpm:11'"
LONGEST = 500
"""Characters of a key, and of a value, at most."""
MOST_AXES, MOST_ITEMS = 60, 1000
"""Axes of a sweep, and values of a list, at most; each of a list's may be a structure of its own."""
LARGEST = 1e300
"""Size of a bound at most, so that ranges and draws are finite."""
WHOLE = 2.0**53
"""Size up to which every whole number is a float."""


@dataclass(frozen=True)
class SweepAxis:
    """A key of the scene and the values it takes: a list or, between two bounds, a range.

    Attributes
    ----------
    key
        Dotted key of the scene, as for ``--set``; a whole number is a place in a list.
    low, high
        Bounds of a range [unit], or mean and standard deviation of normal draws; 0 for a list.
    unit
        Unit as the scene writes it; "" for plain numbers and for a list of words.
    count
        Points of a range that is spaced evenly; None if a sample fills it.
    items
        Values of a list, as written; empty for a range.
    """

    key: str
    low: float = 0.0
    high: float = 0.0
    unit: str = ""
    count: int | None = None
    items: tuple[str, ...] = ()

    @property
    def crossed(self) -> bool:
        """Say whether the axis brings its own points, which are crossed with all others."""
        return bool(self.items) or self.count is not None

    @property
    def places(self) -> Vector:
        """Return the points it brings: numbers of a range [unit], places in a list."""
        if self.items:
            return np.arange(len(self.items), dtype=np.float64)
        return np.linspace(self.low, self.high, self.count or 0)

    def write(self, value: float) -> str:
        """Return a value as the scene reads it: the number so that it reads back the same, and the unit."""
        if self.items:
            return self.items[int(value)]
        number = f"{value:.0f}" if value.is_integer() and abs(value) < WHOLE else repr(value)
        return f"{number} {self.unit}".rstrip()

    def coordinate(self, values: Vector) -> tuple[NDArray[Any], dict[str, str]]:
        """Return values as a data set holds them: numbers, or words where the list has no numbers; attributes."""
        if not self.items:
            return values, {"units": self.unit or "1", "key": self.key}
        read = [_split(item) for item in self.items]
        units = {unit for _, unit in read if unit is not None}
        if all(number is not None for number, _ in read) and len(units) == 1:
            numbers = np.array([number for number, _ in read], dtype=np.float64)
            return numbers[values.astype(int)], {"units": units.pop() or "1", "key": self.key}
        return np.array(self.items)[values.astype(int)], {"key": self.key}

    def to_json(self) -> dict[str, Any]:
        """Return the axis as plain values."""
        return {"key": self.key, "low": self.low, "high": self.high, "unit": self.unit, "count": self.count} | {
            "items": list(self.items)
        }

    @classmethod
    def from_json(cls, kept: Mapping[str, Any]) -> "SweepAxis":
        """Return the axis that ``to_json`` wrote; ValueError where it has more points than any."""
        axis = cls(**{**kept, "items": tuple(kept["items"])})
        if axis.count is not None and not 1 <= axis.count <= MOST:
            raise ValueError(f"an axis of {axis.count} points")
        return axis


def read_axes(texts: Iterable[str]) -> tuple[SweepAxis, ...]:
    """Read axes, each as written after ``--vary`` (see `read_axis`).

    Raises
    ------
    LtcgearError
        If there is none, one is not readable, or two vary the same key.
    """
    axes = tuple(read_axis(text) for text in texts)
    if not axes:
        raise LtcgearError(f"--vary: a sweep varies one key of the scene at least; {EXAMPLE}")
    if len(axes) > MOST_AXES:
        raise LtcgearError(f"--vary: {len(axes)} keys are varied, {MOST_AXES} at most are served; take fewer")
    keys = [axis.key for axis in axes]
    for key in keys:
        if keys.count(key) > 1:
            raise LtcgearError(f"--vary {key}: is given {keys.count(key)} times; give each key once")
    return axes


def read_axis(text: str) -> SweepAxis:
    """Read ``NAME=a:b:n``, ``NAME=a:b`` or ``NAME=v1,v2,v3``.

    Both bounds have the scene's unit, written alike, or are plain numbers both.

    Raises
    ------
    LtcgearError
        If the text is none of these, a bound is not a finite number, or the range is empty.
    """
    key, equals, values = (part.strip() for part in text.partition("="))
    label = f"--vary {text.strip():.80}"
    if not equals or not all(key.split(".")) or re.search(r"\s", key):
        raise LtcgearError(f"{label}: no key of the scene; {EXAMPLE}")
    if not values:
        raise LtcgearError(f"{label}: no values; {EXAMPLE}")
    if len(key) > LONGEST or max(map(len, re.split("[,:]", values))) > LONGEST:
        raise LtcgearError(f"{label}: keys and values have {LONGEST} characters at most; {EXAMPLE}")
    parts = [part.strip() for part in values.split(":")]
    if len(parts) == 1:
        return SweepAxis(key, items=_read_items(values, label))
    if len(parts) > 3:
        raise LtcgearError(f"{label}: {len(parts)} parts between colons are too many; {EXAMPLE}")
    (low, unit), (high, other) = (_read_bound(part, label) for part in parts[:2])
    if unit != other:
        raise LtcgearError(
            f"{label}: the bounds have the units {unit or 'none'!r} and {other or 'none'!r}; write both in the same"
        )
    count = _read_count(parts[2], low, high, label) if len(parts) == 3 else None
    return SweepAxis(key, low, high, unit, count)


def _read_items(text: str, label: str) -> tuple[str, ...]:
    """Read the values of a list, each once."""
    items = tuple(item.strip() for item in text.split(","))
    if len(items) > MOST_ITEMS:
        raise LtcgearError(f"{label}: {len(items)} values, a list has {MOST_ITEMS} at most; write NAME=a:b:n")
    if not all(items):
        raise LtcgearError(f"{label}: a value of the list is empty; write NAME=v1,v2,v3")
    meant = [item if _split(item)[0] is None else _split(item) for item in items]
    if len(set(meant)) < len(items):
        twice = next(item for item, value in zip(items, meant, strict=True) if meant.count(value) > 1)
        raise LtcgearError(f"{label}: {twice} is given twice; give each value once")
    for item in items:
        number, _ = _split(item)
        if number is not None and not isfinite(number):
            raise LtcgearError(f"{label}: {item} is not finite; give a number")
    return items


def _split(text: str) -> tuple[float | None, str | None]:
    """Split a number from its unit; None and None if there is no number."""
    match = NUMBER.fullmatch(text)
    return (float(match[1]), match[2]) if match else (None, None)


def _read_bound(text: str, label: str) -> tuple[float, str]:
    """Read a bound and its unit."""
    number, unit = _split(text)
    if number is None or unit is None:
        raise LtcgearError(f"{label}: the bound {text!r} is not a number with a unit; {EXAMPLE}")
    if not isfinite(number):
        raise LtcgearError(f"{label}: the bound {text!r} is not finite; give a number")
    if abs(number) > LARGEST:
        raise LtcgearError(f"{label}: the bound {text!r} is too large; give one below {LARGEST:g}")
    return number, unit


def _read_count(text: str, low: float, high: float, label: str) -> int:
    """Read how many points a range has, and check that there is a range."""
    if not text.isdecimal() or not 1 <= int(text) <= MOST:
        raise LtcgearError(f"{label}: {text!r} points; give a whole number from 1 to {MOST}")
    count = int(text)
    if not low < high:
        raise LtcgearError(
            f"{label}: the range is empty, for {low:g} is not below {high:g}; give the lower bound first"
        )
    if count == 1:
        raise LtcgearError(f"{label}: a range of one point; give 2 points at least, or the value alone, NAME=v")
    if (there := np.unique(np.linspace(low, high, count)).size) < count:
        raise LtcgearError(f"{label}: the range has {there} different numbers for {count} points; give fewer points")
    return count
