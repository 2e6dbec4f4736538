"""First stage: a TOML file (or a Python builder) becomes a frozen Scene; all defects are told at once."""

import copy
import re
import tomllib
from collections.abc import Mapping
from difflib import get_close_matches
from importlib import resources
from pathlib import Path
from typing import Any, get_args

from ltcgear.generated.errors import SceneError
from pydantic import BaseModel, ValidationError

from . import schema
from .schema import Scene
from .validate import validate

Raw = dict[str, Any]
SOURCE = re.compile(r"(printed|derived|assumed|fitted): \S.*", re.DOTALL)
SHIPPED = resources.files(__package__) / "scenes"


def shipped_scenes() -> list[str]:
    """Return the names of the scenes that come with ltcgear, sorted."""
    return sorted(Path(entry.name).stem for entry in SHIPPED.iterdir() if entry.name.endswith(".toml"))


def load_scene(source: str | Path, changes: Mapping[str, str] | None = None) -> Scene:
    """Read a scene.

    Parameters
    ----------
    source
        Name of a shipped scene or path of a TOML file.
    changes
        Dotted key -> value, put in place of the file's values (as ``--set`` does).

    Raises
    ------
    SceneError
        If the scene cannot be found or has defects; the message lists all of them.
    """
    label, text = _read(source)
    try:
        raw = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise SceneError(f"{label}: not valid TOML: {error}") from error
    for key, value in (changes or {}).items():
        _put(raw, key, value, label)
    return make_scene(raw, name=Path(str(source)).stem, label=label)


def make_scene(raw: Raw, name: str = "scene", label: str = "scene") -> Scene:
    """Check a raw scene (what TOML gives) and freeze it; ``label`` heads the messages."""
    sources: dict[str, str] = {}
    faults: list[str] = []
    plain = _split_sources(copy.deepcopy(raw), (), sources, faults)
    for key in ("name", "sources"):
        if key in plain:
            faults.append(f"{key}: is set by ltcgear; remove it")
            del plain[key]
    try:
        scene = Scene.model_validate({**plain, "name": name, "sources": sources})
    except ValidationError as error:
        faults += [_explain(item) for item in error.errors()]
        raise SceneError(_listing(label, faults)) from None
    faults += validate(scene)
    if faults:
        raise SceneError(_listing(label, faults))
    return scene


def _read(source: str | Path) -> tuple[str, str]:
    """Return a label and the text of a scene."""
    name = str(source)
    if name in shipped_scenes():
        return name, (SHIPPED / f"{name}.toml").read_text(encoding="utf-8")
    path = Path(source)
    try:
        return name, path.read_text(encoding="utf-8")
    except (FileNotFoundError, IsADirectoryError, NotADirectoryError):
        near = get_close_matches(path.stem, shipped_scenes(), 1)
        hint = f'; did you mean "{near[0]}"?' if near else ""
        listing = ", ".join(shipped_scenes())
        raise SceneError(f"{name}: no such file and no shipped scene{hint} Shipped scenes: {listing}") from None
    except (OSError, UnicodeDecodeError, ValueError) as error:
        raise SceneError(f"{name}: cannot be read as UTF-8 text: {error}") from error


def _put(raw: Raw, key: str, value: str, label: str) -> None:
    """Set one dotted key; the value is read as TOML where it is TOML, else as text."""
    try:
        parsed = tomllib.loads(f"v = {value}")["v"]
    except tomllib.TOMLDecodeError:
        parsed = value
    *path, last = key.split(".")
    table: Any = raw
    for part in path:
        table = table.setdefault(part, {})
        if not isinstance(table, dict):
            raise SceneError(f"{label}: {key}: {part!r} is a value, not a table")
    table[last] = parsed


def _split_sources(node: Any, path: tuple[str, ...], sources: dict[str, str], faults: list[str]) -> Any:  # noqa: ANN401
    """Replace every ``{value, source}`` by its value and note the source under its dotted key."""
    if isinstance(node, list):
        return [_split_sources(item, (*path, str(i)), sources, faults) for i, item in enumerate(node)]
    if not isinstance(node, dict):
        return node
    if set(node) == {"value", "source"}:
        key = ".".join(path)
        if not isinstance(node["source"], str) or SOURCE.fullmatch(node["source"]) is None:
            faults.append(
                f'{key}.source: {node["source"]!r} must begin with "printed: ", "derived: ", "assumed: " or "fitted: "'
            )
        else:
            sources[key] = node["source"]
        return node["value"]
    return {key: _split_sources(value, (*path, key), sources, faults) for key, value in node.items()}


def _tables() -> list[type[BaseModel]]:
    """Return every table model of the schema."""
    return [t for t in vars(schema).values() if isinstance(t, type) and issubclass(t, schema.Table)]


def _fields_at(path: tuple[str | int, ...]) -> list[str]:
    """Return the keys that the table at ``path`` may hold."""
    here: list[type[BaseModel]] = [Scene]
    for part in path:
        nested = [
            model
            for table in here
            for model in _models(table.model_fields[str(part)].annotation if part in table.model_fields else None)
        ]
        here = nested or here
    return sorted({key for table in here for key in table.model_fields} - {"name", "sources"})


def _models(annotation: object) -> list[type[BaseModel]]:
    """Return the table models inside a type annotation."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for part in get_args(annotation) for model in _models(part)]


def _explain(item: Any) -> str:  # noqa: ANN401
    """Turn one pydantic error into: key, reason, cure."""
    location = [part for part in item["loc"] if part not in ("planetary", "pair")]
    key = ".".join(str(part) for part in location)
    if item["type"] == "extra_forbidden":
        known = _fields_at(tuple(location[:-1]))
        near = get_close_matches(str(location[-1]), known, 1)
        cure = f'did you mean "{near[0]}"?' if near else f"known keys: {', '.join(known)}"
        return f"{key}: unknown key; {cure}"
    if item["type"] == "missing":
        return f"{key}: is missing"
    if item["type"] == "union_tag_not_found":
        return f'{key}.kind: is missing; write kind = "planetary" or kind = "pair"'
    if item["type"] == "union_tag_invalid":
        return f'{key}.kind: must be "planetary" or "pair"'
    if item["type"] == "string_pattern_mismatch":
        return f"{key}: names are small letters, digits and _, beginning with a letter"
    if item["type"] == "value_error":
        return f"{key}: {item['ctx']['error']}"
    return f"{key}: {item['msg'][0].lower()}{item['msg'][1:]}, not {item['input']!r:.60}"


def _listing(label: str, faults: list[str]) -> str:
    """Put all faults into one message."""
    head = f"{label}: {len(faults)} defect" + "s" * (len(faults) > 1)
    return "\n".join([head, *(f"  {fault}" for fault in faults)])
