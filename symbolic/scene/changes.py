"""Changes of a scene by dotted key, as in ``--set`` and the points of a sweep."""

from collections.abc import Mapping
from typing import Any

from ltcgear.generated.errors import SceneError

from .defects import clean
from .toml import MOST_PARTS, Raw, TomlError, parse_toml


def put_changes(raw: Raw, changes: Mapping[str, str], label: str) -> None:
    """Replace values of a scene by dotted key.

    Raises
    ------
    SceneError
        If a key does not exist.
    """
    for key, value in changes.items():
        _put(raw, key, value, label)


def _put(raw: Raw, key: str, value: str, label: str) -> None:
    """Set one dotted key; whole numbers are list indices."""
    path = key.split(".")
    if len(path) > MOST_PARTS:
        raise SceneError(
            f"{label}: {clean(key)}: is nested too deeply, {len(path)} parts; no key of a scene has above {MOST_PARTS}"
        )
    parsed = _parse(value)
    table: Any = raw
    for i, part in enumerate(path):
        fault = _fault_of_place(table, path[:i], part)
        if fault:
            raise SceneError(f"{label}: {clean(key)}: {fault}")
        place: Any = int(part) if isinstance(table, list) else part
        if i + 1 == len(path):
            table[place] = parsed
        else:
            table = table[place] if isinstance(table, list) else table.setdefault(place, {})
    if path[-1] == "value" and "source" in table:  # the file's label does not speak for another value
        table["source"] = "assumed: set in place of the file's value"


def _fault_of_place(table: Any, above: list[str], part: str) -> str:  # noqa: ANN401
    """Say why a key path has no entry of a name; empty if it has."""
    here = ".".join(above)
    if not isinstance(table, list | dict):
        return f"{above[-1]!r:.60} is a value, not a table"
    if isinstance(table, dict):
        if not part.isdecimal() or not above or table:
            return ""
        return f"{here} is no list yet, so it has no place {part}; set the whole list first, {here}='[...]'"
    if part.isascii() and part.isdecimal() and int(part) < len(table):
        return ""
    count = f"the places 0 to {len(table) - 1}" if table else "no places"
    return f"the list {here} has {count}, not {part!r:.60}; set the whole list first, {here}='[...]'"


def _parse(value: str) -> Any:  # noqa: ANN401
    """Read a value as TOML if it is valid TOML, else as text."""
    try:
        read = parse_toml(f"v = {value}")
    except TomlError:
        return value
    return read["v"] if len(read) == 1 else value
