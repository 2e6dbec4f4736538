"""Cheapest setting that meets an error."""

from collections.abc import Mapping
from typing import Any

from .run_errors import value_of

LIMITS = (0.1, 0.01, 1e-3, 1e-4)
"""Errors for which a record names the cheapest setting."""
Data = Mapping[str, Any]


def find_cheapest(record: Data, limit: float) -> Data | None:
    """Return the point of a record that meets an error in the least time, None if none does.

    An error counts with the reference's own uncertainty on top.

    Parameters
    ----------
    record
        What ``ltcgear accuracy --json`` prints.
    limit
        The error of the record's measure.
    """
    measure, floor = record["reference"]["measure"], record["reference"]["floor"]
    if record["reference"]["reason"] is not None or measure is None:
        return None
    meets = []
    for point in record["points"]:
        value = value_of(point["errors"], measure) if point["reason"] is None else None
        if value is not None and value + floor <= limit:
            meets.append(point)
    return min(meets, key=lambda point: float(point["seconds"]), default=None)


def list_cheapest(record: Data) -> list[dict[str, Any]]:
    """Return for each of ``LIMITS`` the cheapest setting, None in its place where nothing meets it."""
    listed = []
    for limit in LIMITS:
        point = find_cheapest(record, limit)
        entry = {"error": limit, "method": None, "rtol": None, "seconds": None, "found": None, "real_time_factor": None}
        if point is not None:
            entry |= {key: point[key] for key in ("method", "rtol", "seconds", "real_time_factor")}
            entry["found"] = value_of(point["errors"], record["reference"]["measure"])
        listed.append(entry)
    return listed
