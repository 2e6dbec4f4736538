"""Record of a measurement as JSON and CSV."""

import csv
import io
import json
from importlib.metadata import version
from math import isfinite
from pathlib import Path
from typing import Any, TypeGuard

from ltcgear.generated import folders, store
from ltcgear.generated.errors import LtcgearError

from ...simulation.methods.registry import METHODS
from .run_errors import KINDS, value_of

FORMAT = 1
FOLDER = "accuracy"
Data = dict[str, Any]
AGAIN = "`ltcgear accuracy SCENE -o DIR` writes one"
BESIDE = ("name", "title", "sources", "simulation")
"""What a scene holds besides its model."""
LARGEST_FILE = 10_000_000
"""Bytes above which a file is no record."""


def digest_numbers(scene_json: str) -> str:
    """Return the key of a scene's numbers: of those it gives, as a result keeps them.

    What follows from them would not do. Libraries of linear algebra and of functions differ in last bits from one
    processor to another.
    """
    given = {name: value for name, value in json.loads(scene_json).items() if name not in BESIDE}
    return store.digest([json.dumps(given, sort_keys=True)])


def write_record(record: Data, folder: Path) -> list[Path]:
    """Write ``accuracy.json`` and ``accuracy.csv`` into a folder."""
    texts = {"accuracy.json": to_text(record), "accuracy.csv": to_csv(record)}
    folders.write_folder(folder, texts)
    return [folder / name for name in texts]


def to_text(record: Data) -> str:
    """Return a record as JSON, a line for each point."""
    lines = []
    for key, value in record.items():
        if key in ("points", "best"):
            inner = ",\n".join("    " + json.dumps(item, allow_nan=False) for item in value)
            lines.append(f'  "{key}": [\n{inner}\n  ]')
        else:
            lines.append(f'  "{key}": {json.dumps(value, allow_nan=False)}')
    return "{\n" + ",\n".join(lines) + "\n}\n"


def to_csv(record: Data) -> str:
    """Return the points as CSV, one per row, with units in the header."""
    counts = list(dict.fromkeys(name for point in record["points"] for name in point["counts"]))
    heading = ["method", "rtol", "reason", "trusted", *KINDS, "seconds", "median", "user", "rounds", *counts]
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow([name if name != "spectrum" else "spectrum [dB]" for name in heading])
    for point in record["points"]:
        errors = [value_of(point["errors"], kind) for kind in KINDS]
        times = [point["seconds"], *((point.get(who) or {}).get(what) for who, what in SPREADS), point["rounds"]]
        numbers = [point["counts"].get(name) for name in counts]
        rows.writerow([point["method"], point["rtol"], point["reason"], point["trusted"], *errors, *times, *numbers])
    return text.getvalue()


SPREADS = (("integrator", "median"), ("user", "min"))
"""Where the columns ``median`` and ``user`` of the CSV come from."""


def kept_path(model: str, numbers: str) -> Path:
    """Return where the store keeps the record of a model with its numbers."""
    return store.root() / FOLDER / f"{store.digest([model, numbers, version('ltcgear')])}.json"


def keep(record: Data) -> Path:
    """Put a record into the store, in place of an older one of the same model and numbers."""
    path = kept_path(record["model"], record["numbers"])
    folders.write_folder(path.parent, {path.name: to_text(record)})
    return path


def read_record(path: Path) -> Data:
    """Read a record; a file of the user's is checked, since nothing in it can be relied upon.

    Raises
    ------
    LtcgearError
        If it is missing, or no record of this format.
    """
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise ValueError("too large")
        found: Any = json.loads(path.read_text("utf-8"))
        fault = find_fault(found)
    except FileNotFoundError as error:
        raise LtcgearError(f"{path}: no such record; {AGAIN}") from error
    except OSError as error:
        raise LtcgearError(f"{path}: cannot be read: {error.strerror}; {AGAIN}") from error
    except (ValueError, RecursionError) as error:
        raise LtcgearError(f"{path}: not a record of `ltcgear accuracy` ({error}); {AGAIN}") from error
    if fault is not None:
        raise LtcgearError(f"{path}: not a record of `ltcgear accuracy`: {fault}; {AGAIN}")
    return dict(found)


def find_fault(found: Any) -> str | None:  # noqa: ANN401
    """Say what is wrong with data that should be a record; None if all that choosing a setting needs is there."""
    if not isinstance(found, dict) or found.get("format") != FORMAT:
        return f'"format" is not {FORMAT}'
    for key in ("scene", "model", "numbers"):
        if not isinstance(found.get(key), str):
            return f'"{key}" is not text'
    if not _is_number(found.get("t_end")):
        return '"t_end" is not a number'
    reference, points = found.get("reference"), found.get("points")
    if not isinstance(reference, dict) or not isinstance(points, list):
        return '"reference" or "points" is missing'
    if reference.get("reason", "") is not None:
        return f"it has no reference: {str(reference.get('reason'))[:200]}"
    if reference.get("measure") not in KINDS or not _is_number(reference.get("floor")):
        return '"reference" has no measure or no floor'
    faults = (_fault_of_point(point, reference["measure"]) for point in points)
    return next((f'"points", number {n}: {fault}' for n, fault in enumerate(faults, start=1) if fault), None)


def _fault_of_point(point: Any, measure: str) -> str | None:  # noqa: ANN401
    """Say what is wrong with a point."""
    if not isinstance(point, dict):
        return "not a table"
    if isinstance(point.get("reason"), str):
        return None
    if point.get("reason", "") is not None:
        return '"reason" is neither text nor null'
    if point.get("method") not in METHODS:
        return '"method" is not known'
    numbers = [point.get(key) for key in ("rtol", "seconds", "real_time_factor")]
    if not all(_is_number(number) and number > 0 for number in numbers):
        return '"rtol", "seconds" or "real_time_factor" is not a number above zero'
    entry = point.get("errors", {}).get(measure, "") if isinstance(point.get("errors"), dict) else ""
    if entry is not None and not (isinstance(entry, dict) and _is_number(entry.get("value"))):
        return f'"errors" has no value of {measure}'
    return None


def _is_number(value: Any) -> TypeGuard[float]:  # noqa: ANN401
    """Say whether a value is a finite number, not negative."""
    return isinstance(value, (int, float)) and not isinstance(value, bool) and isfinite(value) and value >= 0
