"""Attributes of result files, written to NetCDF and read back."""

import json
import math
import sys
from collections.abc import Mapping
from functools import cache
from importlib.metadata import version
from typing import Any

PLAIN = (
    "scene", "method", "why", "engine", "rtol", "rate_hz", "why_rate", "band_hz", "status", "simulated_s",
    "real_time_factor", "energy_residual", "static_strain_j",
)  # fmt: skip
"""Parts of a summary that are text or a number."""
STRUCTURED = ("counts", "warnings", "seconds", "accuracy", "setting")
"""Parts that are kept as JSON."""
UNFINISHED, GOES_ON = "not finished", "--resume goes on"
"""How the status of a part begins, and how that of a stopped run ends."""
FORCES, STATISTICS = "forces", "statistics"
"""What statistics of mesh forces are called in a summary, and in a file."""


def to_attributes(attributes: Mapping[str, Any] | None, summary: Mapping[str, Any]) -> dict[str, Any]:
    """Return the attributes of a result: versions, data on its scene, and its summary."""
    told = {**_versions(), **(attributes or {}), **summary}
    if FORCES in told:
        told[STATISTICS] = told.pop(FORCES)
    return {k: v if isinstance(v, (str, int, float)) else json.dumps(finite(v)) for k, v in told.items()}


def read_summary(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Return the summary that attributes keep, which ``file_schema`` has found to be what ltcgear writes."""
    kept: dict[str, Any] = {name: attributes[name] for name in PLAIN if name in attributes}
    kept = {name: value.item() if hasattr(value, "item") else value for name, value in kept.items()}
    kept |= {name: None if kept.get(name) == "null" else kept.get(name) for name in ("why", "why_rate")}
    kept |= {name: json.loads(attributes[name]) for name in STRUCTURED if name in attributes}
    forces = json.loads(attributes[STATISTICS])
    return kept | {FORCES: {mesh: _numbers(one) for mesh, one in forces.items()}}


def _numbers(one: Mapping[str, float | None]) -> dict[str, float]:
    """Return statistics with what JSON does not know as numbers again."""
    return {name: math.nan if value is None else value for name, value in one.items()}


def finite(data: Any) -> Any:  # noqa: ANN401
    """Replace numbers that JSON does not know by null."""
    if isinstance(data, dict):
        return {key: finite(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [finite(value) for value in data]
    return None if isinstance(data, float) and not math.isfinite(data) else data


@cache
def _versions() -> dict[str, Any]:
    """Return the versions at work."""
    versions = {name: version(name) for name in ("ltcgear", "casadi", "numpy", "xarray")}
    return {"ltcgear": versions["ltcgear"], "versions": versions | {"python": sys.version.split()[0]}}
