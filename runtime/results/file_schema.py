"""Schema of result files: whether data are what ltcgear writes, or why not."""

import json
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from ..model.quantity_names import LONG_NAMES
from .attributes import STATISTICS
from .checksums import find_changed
from .train_record import TRAIN

if TYPE_CHECKING:
    import xarray as xr

FORM = 2
"""Number of the form of result files; it grows when files that a later ltcgear reads are no longer those of before."""
NUMBER, WHOLE, MAYBE, WORDS = (int, float), (int,), (int, float, type(None)), (str, type(None))
DISC = {"body": (str,), "x": NUMBER, "y": NUMBER, "radius": NUMBER, "part": (str,), "unit": NUMBER}
MEMBER = {"stage": (str,), "part": (str,), "mass": (str,), "place": [(str,)], "held": (str,)}
SHAPES: dict[str, Any] = {
    "counts": {...: WHOLE},
    "warnings": [(str,)],
    "seconds": {...: NUMBER},
    "versions": {...: (str,)},
    "changes": {...: (str,)},
    STATISTICS: {...: {...: MAYBE}},
    "accuracy": {"meshes": {...: {...: MAYBE}}, "worst": WORDS, "reason": WORDS},
    "scene_json": {"effects": {...: (str,)}, "sources": {...: (str,)}},
    "setting": {...: (object,)},
    "sheet": {"discs": [DISC], "titles": [[(str, int, float)]], "width": NUMBER, "height": NUMBER},
    TRAIN: {"members": {...: MEMBER}, "joints": {...: {"stage": (str,), "group": (str,), "front": (str,)}}},
}
"""Attribute -> shape of its JSON: types, a list of one shape, a table of known keys, or of any (``...``)."""
TEXT = ("scene", "title", "method", "why", "why_rate", "engine", "status", "scene_text")
NUMBERS = ("rtol", "rate_hz", "band_hz", "simulated_s", "real_time_factor", "energy_residual", "static_strain_j")
NEEDED = ("time", "state", "reference_angle", "steps", "parameter_value", "parameter_unit")
NEEDED_ATTRIBUTES = ("method", "status", "counts", "warnings", STATISTICS, "sheet")
ALONE = ("reference_angle", "steps")
"""Variables over time alone."""
PLANAR = ("displacement", "velocity", "acceleration", "bearing_force", "pin_force")
"""Quantities with two axes."""
FIXED = ("statistics", "speed_ratio", "parameter_value")
"""Variables that do not change over time."""


def find_fault(dataset: "xr.Dataset") -> str:
    """Say what is not as ltcgear writes it; "" where all is well."""
    return next((fault for part in (_attributes, _variables, _time, _sums) for fault in part(dataset)), "")


def fits(value: object, shape: Any) -> bool:  # noqa: ANN401
    """Say whether a JSON value has a shape (see ``SHAPES``)."""
    if isinstance(shape, tuple):
        return isinstance(value, shape) and (bool in shape or object in shape or not isinstance(value, bool))
    if isinstance(shape, list):
        return isinstance(value, list) and all(fits(item, shape[0]) for item in value)
    if not isinstance(value, dict):
        return False
    if ... in shape:
        return all(fits(item, shape[...]) for item in value.values())
    return all(key in value and fits(value[key], inner) for key, inner in shape.items())


def _attributes(dataset: "xr.Dataset") -> Iterator[str]:
    """Yield what is wrong with the attributes."""
    kept = dataset.attrs
    yield from (f"attribute {name} is missing" for name in NEEDED_ATTRIBUTES if name not in kept)
    yield from (f"attribute {name} is no text" for name in TEXT if not isinstance(kept.get(name, ""), str))
    for name in NUMBERS:
        if not np.issubdtype(np.asarray(kept.get(name, 0.0)).dtype, np.number) or np.ndim(kept.get(name, 0.0)):
            yield f"attribute {name} is no number"
    for name, shape in SHAPES.items():
        if name in kept:
            try:
                value = json.loads(kept[name])
            except (TypeError, ValueError, RecursionError):
                yield f"attribute {name} is no JSON"
                continue
            if not fits(value, shape) or (name == "accuracy" and value["worst"] not in {None, *value["meshes"]}):
                yield f"attribute {name} does not hold what it should"


def _variables(dataset: "xr.Dataset") -> Iterator[str]:
    """Yield what is wrong with variables and the names of their items."""
    yield from (f"{name} missing" for name in NEEDED if name not in dataset.variables)
    if "rotor" in dataset.dims:
        yield from (f"{name} missing" for name in ("speed_ratio", "twist", "speed") if name not in dataset)
    for x, y in ((f"{quantity}_x", f"{quantity}_y") for quantity in PLANAR):
        if x in dataset and (y not in dataset or dataset[x].dims != dataset[y].dims):
            yield f"{y} missing"
    for name, data in dataset.data_vars.items():
        dimensions = 1 if (name in FIXED and name != "statistics") or name in ALONE else 2
        leading = data.dims[:1] == ("time",)
        if name in {*LONG_NAMES, *FIXED, "state"} and (data.ndim != dimensions or leading == (name in FIXED)):
            yield f"{name} has dimensions {', '.join(map(str, data.dims)) or 'none'}"
        if not np.issubdtype(data.dtype, np.number):
            yield f"{name} holds no numbers"
    for dimension in dataset.dims:
        items = dataset.indexes.get(dimension)
        if dimension != "time" and (items is None or not all(isinstance(item, str) for item in items)):
            yield f"the names of {dimension} are missing"
        elif dimension != "time" and items is not None and not items.is_unique:
            yield f"names of {dimension} occur twice"
    if "parameter_value" in dataset and not np.isfinite(dataset["parameter_value"].values.astype(float)).all():
        yield "parameters are not numbers"


def _time(dataset: "xr.Dataset") -> Iterator[str]:
    """Yield what is wrong with the instants of the samples."""
    time = dataset["time"].values
    if time.ndim != 1 or not np.issubdtype(time.dtype, np.floating) or not np.isfinite(time).all():
        yield "time is not a row of numbers"
        return
    steps = np.diff(time)
    if steps.size and not (steps > 0).all():
        yield "time does not rise"
    elif steps.size and steps.max() > steps.min() * (1 + 1e-6) + 1e-12 * abs(time[-1]):
        yield "samples are not equally far apart"


def _sums(dataset: "xr.Dataset") -> Iterator[str]:
    """Yield the attribute that was changed since it was written."""
    if changed := find_changed(dataset):
        yield f"attribute {changed} is not what was written"
