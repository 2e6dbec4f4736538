"""Parameter values, tables and arrays that a caller gives, each by a known name or refused."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from difflib import get_close_matches
from typing import Any, TypeGuard

import numpy as np
from ltcgear.generated.contract import BOUNDS, NOT_NEGATIVE, POSITIVE, SHARE, Manifest
from ltcgear.generated.errors import LtcgearError
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Pairs = Sequence[tuple[float, float]]

MOST_FAULTS = 8
"""Most faults in one message."""
REFUSALS = {
    POSITIVE: "must be greater than zero",
    NOT_NEGATIVE: "must not be negative",
    SHARE: "must lie between 0 and 1",
}
"""Kind of bounds -> what a number beyond them must be."""
SHOWN = 60
"""Characters of a wrong value shown in a message."""


def read_values(manifest: Manifest, values: Mapping[str, float]) -> Vector:
    """Return the parameter vector, shape (n_p,); LtcgearError with all names that are wrong."""
    tell(list(value_faults(manifest, values)), "values cannot be used")
    return np.array([float(values[name]) for name, _ in manifest.parameters])


def value_faults(manifest: Manifest, values: Mapping[str, float]) -> Iterator[str]:
    """Yield what is wrong with a set of values: names, and numbers that are none or that the laws cannot take."""
    if not isinstance(values, Mapping):
        yield f"values: {type(values).__name__}, must be names with numbers; take the model's (model.values())"
        return
    units = dict(manifest.parameters)
    for name in units:
        if name not in values:
            yield f"{name} is missing; begin with the model's values (model.values()) and replace some"
    yield from _strangers(values, units, "parameter")
    for name, unit in units.items():
        reason = _reason(manifest.bounds[name], values[name]) if name in values else ""
        if reason:
            yield f"{name} = {values[name]!r:.{SHOWN}}: {reason} [{unit or '1'}]"


def read_tables(wanted: Iterable[str], tables: Mapping[str, Pairs]) -> dict[str, Vector]:
    """Return tables by name as rows of time [s] and value, shape (rows, 2).

    Raises
    ------
    LtcgearError
        If one is missing, unknown, or not rows of finite numbers with ascending times.
    """
    if not isinstance(tables, Mapping):
        raise LtcgearError(f"tables: {type(tables).__name__}, must be names with rows; take the model's (model.tables)")
    names = dict.fromkeys(wanted)
    missing = (f"{name} is missing; begin with the model's (model.tables)" for name in names if name not in tables)
    tell([*missing, *_strangers(tables, names, "table")], "tables")
    return {name: _rows(name, tables[name]) for name in names}


def tell(faults: Sequence[str], what: str) -> None:
    """Raise a LtcgearError with the first of some faults, if any."""
    if faults:
        more = [f"and {len(faults) - MOST_FAULTS} more"] if len(faults) > MOST_FAULTS else []
        told = [*faults[:MOST_FAULTS], *more]
        raise LtcgearError(f"{what}: {told[0]}" if len(told) == 1 else "\n  ".join([f"{what}:", *told]))


def _strangers(given: Iterable[Any], known: Iterable[str], what: str) -> Iterator[str]:
    """Yield the names that the model does not know, with the nearest that it does."""
    known = list(known)
    for name in given:
        if name not in known:
            near = get_close_matches(str(name)[:SHOWN], known, 1)
            yield f"{name}: the model has no such {what}; " + (f'did you mean "{near[0]}"?' if near else "leave it out")


def is_number(value: object) -> TypeGuard[float]:
    """Say whether something is a real number, as Python or NumPy have them; truth values are none."""
    return isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)


def _reason(bounds: str, value: object) -> str:
    """Return why a number cannot be taken, ``""`` if it can."""
    try:
        number = float(value) if is_number(value) else np.nan
    except OverflowError:
        number = np.inf
    if not np.isfinite(number):
        return "must be a finite number"
    low, high = BOUNDS[bounds]
    return "" if low <= number <= high else REFUSALS.get(bounds, "")


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


def _rows(name: str, given: Pairs) -> Vector:
    """Return the rows of a table."""
    must = "must be rows of time [s] and value"
    try:
        rows = read_numbers(given, f"tables: {name}")
    except LtcgearError as error:
        raise LtcgearError(f"{error}; {must}") from error
    if rows.ndim != 2 or rows.shape[1] != 2 or not len(rows):
        raise LtcgearError(f"tables: {name}: shape {rows.shape}, {must}")
    time, value = rows.T
    with np.errstate(all="ignore"):
        slope = np.diff(value) / np.diff(time)
    checks = (
        (~np.isfinite(rows).all(axis=1), 0, "({1:g}, {2:g}) must be finite numbers"),
        (~(np.diff(time) > 0), 1, "times must ascend, but {1:.12g} follows {0:.12g}; sort the rows, keep one of each"),
        (~np.isfinite(slope), 1, "the value changes by {3:g} a second; move the rows apart"),
    )
    for wrong, after, text in checks:
        if wrong.any():
            i = int(np.flatnonzero(wrong)[0]) + after
            jump = abs(slope[i - 1]) if after else 0.0
            raise LtcgearError(f"tables: {name}: row {i + 1}: {text.format(time[i - 1], time[i], value[i], jump)}")
    return rows


def name_values(manifest: Manifest, p: Vector) -> dict[str, float]:
    """Return the parameters by name."""
    return dict(zip((name for name, _ in manifest.parameters), p.tolist(), strict=True))
