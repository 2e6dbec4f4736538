"""Checkpoint of a stopped run, and what it must share with the run that resumes it."""

import json
import sys
import zlib
from collections.abc import Mapping
from importlib.metadata import version
from math import isclose
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from ltcgear.generated.errors import LtcgearError
from ltcgear.generated.writing import follow, written_whole
from numpy.typing import NDArray

from ..model.library import Library
from ..model.load_tables import Pairs
from .checksums import digest_arrays

Snapshot = dict[str, NDArray[np.generic]]
"""Arrays from which an integration is resumed."""
AGAIN = "--force in place of --resume begins anew"
ROUNDED = 1e-13
"""Relative difference of parameters that is rounding: they follow from a scene's numbers by libraries."""
DAMAGE = (OSError, ValueError, KeyError, EOFError, TypeError, NotImplementedError, MemoryError, BadZipFile, zlib.error)
"""What a damaged checkpoint raises."""
SHOWN = 3
"""Most differences listed in a refusal."""


def checkpoint_of(target: Path) -> Path:
    """Return where the checkpoint of a result under way is."""
    real = follow(target)
    return real.with_name(f"{real.stem}.checkpoint.npz")


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
    MachineError
        If it cannot be written.
    """
    arrays: dict[str, Any] = {**kept, "description": np.array(json.dumps(description))}
    arrays["digest"] = np.array(digest_arrays(arrays))
    path = checkpoint_of(target)
    retry = "--resume goes on" if path.exists() else "run the same command again"
    with written_whole(path, retry) as draft, draft.open("wb") as file:
        np.savez(file, **arrays)


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
        if str(kept.pop("digest")) != digest_arrays(kept):
            raise ValueError("not what was written")
        found = json.loads(str(kept.pop("description")))
        if not isinstance(found, dict):
            raise ValueError("no description")
    except DAMAGE as error:
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
    """Return whether two entries are equal; parameters up to rounding, which may differ between processors."""
    if name.startswith("parameter ") and isinstance(one, float) and isinstance(two, float):
        return isclose(one, two, rel_tol=ROUNDED)
    return one == two


def _difference(name: str, there: Any, here: Any) -> str:  # noqa: ANN401
    """Say how one entry differs; long ones are named only."""
    short = all(isinstance(value, (int, float)) or len(str(value)) < 24 for value in (there, here))
    return f"{name} {there} there, {here} here" if short else f"other {name}"
