"""Checkpoint: all that a stopped run needs to go on, and what it must have in common with the one that goes on."""

import json
import sys
from collections.abc import Mapping
from importlib.metadata import version
from math import isclose
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from ltcgear.generated.errors import LtcgearError

from .library import Library
from .march import Snapshot
from .signals import Pairs

AGAIN = "leave out --resume to begin anew"
ROUNDED = 1e-13
"""Relative difference of parameters that is rounding: they follow from a scene's numbers by libraries."""
SHOWN = 3
"""Differences that a refusal tells."""


def checkpoint_of(target: Path) -> Path:
    """Return where the checkpoint of a result under way is."""
    return target.with_suffix(".checkpoint.npz")


def describe_run(
    library: Library, values: Mapping[str, float], tables: Mapping[str, Pairs], settings: Mapping[str, Any]
) -> dict[str, Any]:
    """Return what makes a run what it is; two whose descriptions are equal are equal, on one machine to the last bit.

    Parameters
    ----------
    library, values, tables
        Model, parameters and tables over time.
    settings
        Method, tolerance, times and rates.
    """
    packages = {name: version(name) for name in ("ltcgear", "casadi", "numpy", "scipy")}
    return {
        **{f"version of {name}": number for name, number in packages.items()},
        "platform": sys.platform,
        "engine": library.engine,
        "equations": library.manifest.key,
        **settings,
        **{f"parameter {name}": value for name, value in values.items()},
        **{f"table {name}": [list(row) for row in rows] for name, rows in tables.items()},
    }


def write_checkpoint(target: Path, description: Mapping[str, Any], kept: Snapshot) -> None:
    """Write a checkpoint; it replaces the one before as a whole.

    Raises
    ------
    LtcgearError
        If it cannot be written.
    """
    path = checkpoint_of(target)
    draft = path.with_name(f".draft-{path.name}")
    arrays: dict[str, Any] = {**kept, "description": np.array(json.dumps(description))}
    try:
        with draft.open("wb") as file:
            np.savez(file, **arrays)
        draft.replace(path)
    except OSError as error:
        raise LtcgearError(
            f"{path}: cannot be written: {error.strerror or error}; make room, then --resume goes on"
        ) from error
    finally:
        draft.unlink(missing_ok=True)


def read_checkpoint(target: Path, description: Mapping[str, Any]) -> Snapshot:
    """Read the checkpoint of a run.

    Raises
    ------
    LtcgearError
        If there is none, it is damaged, or it is of a run with another description.
    """
    path = checkpoint_of(target)
    if not path.is_file():
        raise LtcgearError(f"{path}: no such checkpoint, so there is nothing to go on from; {AGAIN}")
    try:
        with path.open("rb") as opened, np.load(opened, allow_pickle=False) as file:
            kept = dict(file)
        found = json.loads(str(kept.pop("description")))
    except (OSError, ValueError, KeyError, EOFError, BadZipFile) as error:
        raise LtcgearError(f"{path}: damaged ({error}); {AGAIN}") from error
    differences = tell_differences(found, description)
    if differences:
        raise LtcgearError(f"{path}: of another run: {differences}; give the same, or {AGAIN}")
    return kept


def tell_differences(there: Mapping[str, Any], here: Mapping[str, Any]) -> str:
    """Say what differs between a description that was kept and one at hand; nothing where they are equal."""
    here = json.loads(json.dumps(here))
    names = [name for name in {**here, **there} if not _equal(name, here.get(name), there.get(name))]
    told = [_difference(name, there.get(name), here.get(name)) for name in names[:SHOWN]]
    return "; ".join(told) + (f" and {len(names) - SHOWN} more" if len(names) > SHOWN else "")


def _equal(name: str, one: object, two: object) -> bool:
    """Tell whether two entries are equal; parameters, which another processor may round otherwise, but for rounding."""
    if name.startswith("parameter ") and isinstance(one, float) and isinstance(two, float):
        return isclose(one, two, rel_tol=ROUNDED)
    return one == two


def _difference(name: str, there: Any, here: Any) -> str:  # noqa: ANN401
    """Say how one entry differs; long ones are named only."""
    short = all(isinstance(value, (int, float)) or len(str(value)) < 24 for value in (there, here))
    return f"{name} {there} there, {here} here" if short else f"other {name}"
