"""First stage: a TOML file (or a Python builder) becomes a frozen Scene; all defects are told at once."""

import json
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
from .series import FILES, FOLDER, Files
from .validate import validate, validate_parts

Raw = dict[str, Any]
SOURCE = re.compile(r"(printed|derived|assumed|fitted): \S.*", re.DOTALL)
NAMED = ("stages", "rotors", "couplings", "loads")  # tables whose keys are the user's names
LARGEST_FILE = 1_000_000
REASONS = {
    "missing": "is missing",
    "string_pattern_mismatch": "names are small letters, digits and _, beginning with a letter",
    "string_type": "must be text in quotes, {given}",
    "string_unicode": "must be text in UTF-8",
    "string_too_short": "must not be empty",
    "string_too_long": "must have {max_length} characters at most",
    "int_type": "must be a whole number without quotes, {given}",
    "int_from_float": "must be a whole number, {given}",
    "float_type": "must be a number without quotes and unit, {given}",
    "list_type": "must be a list in brackets, {given}",
    "dict_type": "must be a table, {given}",
    "model_type": "must be a table, {given}",
    "model_attributes_type": "must be a table, {given}",
    "too_short": "must have {min_length} items, not {actual_length}",
    "too_long": "must have {max_length} items, not {actual_length}",
}
SHIPPED = resources.files(__package__) / "scenes"


def shipped_scenes() -> list[str]:
    """Return the names of the scenes that come with ltcgear, sorted."""
    return sorted(Path(entry.name).stem for entry in SHIPPED.iterdir() if entry.name.endswith(".toml"))


def read_scene_text(source: str | Path) -> str:
    """Return the text of a scene as it was written, for result files to keep.

    Raises
    ------
    SceneError
        If it cannot be read.
    """
    return _read(source)[1]


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
    label, _, raw = read_tables(source)
    put_changes(raw, changes or {}, label)
    return make_scene(raw, name=Path(str(source)).stem, label=label, folder=find_folder(source))


def read_tables(source: str | Path) -> tuple[str, str, Raw]:
    """Return what heads the messages about a scene, its text, and its tables as TOML gives them.

    Raises
    ------
    SceneError
        If it cannot be read, or is no TOML.
    """
    label, text = _read(source)
    try:
        return label, text, tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise SceneError(f"{label}: not valid TOML: {_clean(str(error))}") from error


def find_folder(source: str | Path) -> Path:
    """Return where the files that a scene names are looked up."""
    return Path(str(SHIPPED)) if str(source) in shipped_scenes() else Path(source).parent


def make_scene(
    raw: Raw, name: str = "scene", label: str = "scene", folder: Path | None = None, files: Files | None = None
) -> Scene:
    """Check a raw scene (what TOML gives) and freeze it.

    Parameters
    ----------
    raw
        The tables.
    name
        The scene's name.
    label
        What heads the messages.
    folder
        Where the files it names are looked up; the current folder where left out.
    files
        Tables of files that were read before, which are not read again; those that are read now are added.
    """
    sources: dict[str, str] = {}
    faults: list[str] = []
    try:
        plain = _split_sources(raw, (), sources, faults)
    except RecursionError:
        raise SceneError(f"{label}: tables or lists are nested too deeply") from None
    for key in ("name", "sources"):
        if key in plain:
            faults.append(f"{key}: is set by ltcgear; remove it")
            del plain[key]
    return _freeze(plain, name, sources, label, faults, {FOLDER: folder or Path(), FILES: files})


def restore_scene(text: str) -> Scene:
    """Return the scene of ``Scene.model_dump_json()``, as result files keep it, with name and sources.

    Raises
    ------
    SceneError
        If the text is not such a scene.
    """
    label = "kept scene"
    try:
        kept = json.loads(text)
        name, sources = kept.pop("name"), kept.pop("sources")
    except (ValueError, RecursionError, AttributeError, KeyError, TypeError) as error:
        raise SceneError(f"{label}: is not what ltcgear writes: {_clean(str(error))}") from error
    return _freeze(kept, name, sources, label, [])


def describe_scene(scene: Scene, text: str = "", changes: Mapping[str, str] | None = None) -> dict[str, Any]:
    """Return what a result keeps of its scene (``attributes`` of ``simulate``), so that it can be restored from it.

    Parameters
    ----------
    scene
        The scene; all its numbers and their sources are kept.
    text, changes
        The scene as it was written, and what was put in place of its values.
    """
    kept = {"scene": scene.name, "title": scene.title, "scene_json": scene.model_dump_json()}
    return kept | {"scene_text": text, "changes": dict(changes or {})}


def _freeze(
    plain: Raw, name: str, sources: dict[str, str], label: str, faults: list[str], context: Raw | None = None
) -> Scene:
    """Make the Scene of plain values, or tell all that is wrong, ``faults`` included."""
    context = context or {FOLDER: Path()}
    try:
        scene = Scene.model_validate({**plain, "name": name, "sources": sources}, context=context)
    except ValidationError as error:
        told = {fault.split(":")[0] for fault in faults if ": value is missing;" in fault}
        found = [line for item in error.errors() for line in _explain(item)]
        faults += [line for line in found if line.split(":")[0] + ".source" not in told]
        faults += validate_parts(plain, context)
    else:
        faults += validate(scene)
    if faults:
        raise SceneError(_listing(label, faults))
    return scene


def _read(source: str | Path) -> tuple[str, str]:
    """Return a label and the text of a scene."""
    name = str(source)
    if name in shipped_scenes():
        return name, (SHIPPED / f"{name}.toml").read_text(encoding="utf-8")
    path, label = Path(source), _clean(name) or '""'
    try:
        with path.open("rb") as file:
            data = file.read(LARGEST_FILE + 1)
        text = data.decode("utf-8-sig").replace("\r\n", "\n")
    except (FileNotFoundError, NotADirectoryError, IsADirectoryError) as error:
        what = "is a folder" if isinstance(error, IsADirectoryError) else "no such file and no shipped scene"
        near = get_close_matches(path.stem, shipped_scenes(), 1)
        hint = f'did you mean "{near[0]}"? ' if near else ""
        listing = ", ".join(shipped_scenes())
        raise SceneError(f"{label}: {what}; {hint}shipped scenes: {listing}") from None
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise SceneError(f"{label}: cannot be read as UTF-8 text: {reason}") from error
    if len(data) > LARGEST_FILE:
        raise SceneError(f"{label}: has more than {LARGEST_FILE} bytes, this is no scene")
    return label, text


def put_changes(raw: Raw, changes: Mapping[str, str], label: str) -> None:
    """Put values in place of a scene's, by dotted key.

    Raises
    ------
    SceneError
        If a key leads nowhere.
    """
    for key, value in changes.items():
        _put(raw, key, value, label)


def _put(raw: Raw, key: str, value: str, label: str) -> None:
    """Set one dotted key, whole numbers being places in lists; the value is read as TOML where it is, else as text."""
    try:
        read = tomllib.loads(f"v = {value}")
        parsed = read["v"] if len(read) == 1 else value
    except (ValueError, RecursionError):
        parsed = value
    path = key.split(".")
    table: Any = raw
    for i, part in enumerate(path):
        fault = _fault_of_place(table, path[:i], part)
        if fault:
            raise SceneError(f"{label}: {_clean(key)}: {fault}")
        place: Any = int(part) if isinstance(table, list) else part
        if i + 1 == len(path):
            table[place] = parsed
        else:
            table = table[place] if isinstance(table, list) else table.setdefault(place, {})
    if path[-1] == "value" and "source" in table:  # the file's label does not speak for another value
        table["source"] = "assumed: set in place of the file's value"


def _fault_of_place(table: Any, above: list[str], part: str) -> str:  # noqa: ANN401
    """Say why what stands under some keys has no place of a name, or nothing where it has."""
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


def _split_sources(node: Any, path: tuple[str, ...], sources: dict[str, str], faults: list[str]) -> Any:  # noqa: ANN401
    """Replace every ``{value, source}`` by its value and note the source under its dotted key."""
    if isinstance(node, list):
        return [_split_sources(item, (*path, str(i)), sources, faults) for i, item in enumerate(node)]
    if not isinstance(node, dict):
        return node
    if {"value", "source"} & set(node) and path and not (len(path) == 1 and path[0] in NAMED):
        key = ".".join(path)
        if set(node) != {"value", "source"}:
            extra = ", ".join(sorted(set(node) - {"value", "source"}))
            absent = "value" if "value" not in node else "source"
            what = f"{extra} does not belong here" if extra else f"{absent} is missing"
            faults.append(f'{key}.source: {what}; write {{ value = ..., source = "printed: where" }}')
            return node.get("value")
        if not isinstance(node["source"], str) or SOURCE.fullmatch(node["source"]) is None:
            labels = '"printed: ", "derived: ", "assumed: " or "fitted: "'
            faults.append(f"{key}.source: {node['source']!r:.60} must begin with {labels}")
        else:
            sources[key] = node["source"]
        return node["value"]
    return {key: _split_sources(value, (*path, key), sources, faults) for key, value in node.items()}


def _fields_at(path: tuple[str | int, ...], kind: str) -> list[str]:
    """Return the keys that the table at ``path``, in a stage of that kind, may hold."""
    here: list[type[BaseModel]] = [Scene]
    for part in path:
        nested = [
            model
            for table in here
            for model in _models(table.model_fields[str(part)].annotation if part in table.model_fields else None)
        ]
        here = [model for model in nested if model.__name__.lower() == kind] or nested or here
    return sorted({key for table in here for key in table.model_fields} - {"name", "sources"})


def _models(annotation: object) -> list[type[BaseModel]]:
    """Return the table models inside a type annotation."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for part in get_args(annotation) for model in _models(part)]


def _explain(item: Any) -> list[str]:  # noqa: ANN401
    """Turn one pydantic error into lines of: key, reason, cure."""
    location, kind = list(item["loc"]), ""
    if len(location) > 2 and location[0] == "stages" and location[2] != "[key]":
        kind = location.pop(2)  # pydantic puts it behind the stage's name
    location = [part for part in location if part != "[key]"]
    key = ".".join(str(part) for part in location)
    if item["type"] == "value_error":
        lines = str(item["ctx"]["error"]).split("\n")
        return [f"{key}{line}" if line.startswith(".") else f"{key}: {line}" for line in lines]
    if item["type"] == "extra_forbidden":
        known = _fields_at(tuple(location[:-1]), kind)
        return [f"{key}: unknown key; {schema.suggest(location[-1], known, 'known keys')}"]
    if item["type"] in ("union_tag_not_found", "union_tag_invalid"):
        given = item["input"].get("kind") if isinstance(item["input"], dict) else None
        what = f"{given!r:.60} is no kind of stage" if given is not None else "is missing"
        return [f'{key}.kind: {what}; write kind = "planetary" or kind = "pair"']
    return [f"{key}: {_reason(item)}"]


def _reason(item: Any) -> str:  # noqa: ANN401
    """Say in the scene's own words what pydantic finds wrong with a value."""
    given, context = f"not {item['input']!r:.60}", item.get("ctx", {})
    if item["type"] in REASONS:
        return REASONS[item["type"]].format(given=given, **context)
    if item["type"] == "literal_error":
        allowed = re.findall(r"'([^']*)'", context["expected"])
        return f"must be {context['expected']}, {given}; {schema.suggest(item['input'], allowed, 'values')}"
    return f"{item['msg'].replace('Input should be', 'must be')}, {given}"


def _clean(text: str) -> str:
    """Return a text for the terminal: on one line, of bounded length, control characters written out."""
    shown = "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)
    return shown if len(shown) <= 600 else f"{shown[:300]} ... {shown[-200:]}"


def _listing(label: str, faults: list[str]) -> str:
    """Put all faults into one message."""
    faults = list(dict.fromkeys(faults))
    head = f"{label}: {len(faults)} defect" + "s" * (len(faults) > 1)
    return "\n".join([head, *(f"  {_clean(fault)}" for fault in faults)])
