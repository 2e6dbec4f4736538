"""Scene files: TOML, or tables of the Python builder, become a frozen Scene; all defects are reported at once."""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from importlib import resources
from itertools import islice
from pathlib import Path
from typing import Any

from ltcgear.generated.errors import SceneError
from pydantic import ValidationError

from ..schema.scene_schema import Scene
from ..schema.series import FILES, FOLDER, Files
from ..schema.source_files import UnreadableError, of_process, read_bytes
from .changes import put_changes
from .defects import clean, explain, list_faults
from .toml import Raw, TomlError, parse_toml
from .validate import too_many, validate, validate_parts

SOURCE = re.compile(r"(printed|derived|assumed|fitted): \S.*", re.DOTALL)
NAMED = ("stages", "rotors", "couplings", "loads")  # tables whose keys are the user's names
LARGEST_FILE = 1_000_000
LONGEST_NAME = 100
"""Maximum length of a scene's name from its file name."""
MOST_READ = 1000
"""Largest number of defects put into words per kind of check."""
SHIPPED = resources.files("ltcgear.symbolic") / "scenes"


def shipped_scenes() -> list[str]:
    """Return the names of the scenes that come with ltcgear, sorted."""
    return sorted(Path(entry.name).stem for entry in SHIPPED.iterdir() if entry.name.endswith(".toml"))


@dataclass(frozen=True)
class Source:
    """Source text of a scene; it is read once, so it may be a pipe or a file.

    Attributes
    ----------
    label
        Heading of messages: the path without control characters.
    name
        The scene's name.
    text
        The TOML.
    folder
        Folder of the files that it names.
    files
        Tables of files already read, which are not read again.
    """

    label: str
    name: str
    text: str
    folder: Path
    files: Files = field(default_factory=dict)

    @property
    def paths(self) -> list[Path]:
        """Return the files read for it."""
        return [self.folder / name for name, *_ in self.files]

    def tables(self) -> Raw:
        """Return its tables as parsed from TOML.

        Raises
        ------
        SceneError
            If it is no TOML.
        """
        try:
            return parse_toml(self.text)
        except TomlError as error:
            raise SceneError(f"{self.label}: {clean(str(error))}") from error


def read_source(source: str | Path | Source) -> Source:
    """Read the source text of a scene; a `Source` is returned unchanged.

    Parameters
    ----------
    source
        Name of a shipped scene, or path of a TOML file or of a pipe that gives one.

    Raises
    ------
    SceneError
        If it cannot be read.
    """
    if isinstance(source, Source):
        return source
    if str(source) in shipped_scenes():
        name = str(source)
        return Source(name, name, (SHIPPED / f"{name}.toml").read_text(encoding="utf-8"), Path(str(SHIPPED)))
    path, label = Path(source), clean(str(source)) or '""'
    text = _read(path, label)
    name = "".join(c if c.isprintable() else "_" for c in path.stem)
    return Source(label, name[:LONGEST_NAME] or "scene", text, Path() if of_process(path) else path.parent)


def load_scene(source: str | Path | Source, changes: Mapping[str, str] | None = None) -> Scene:
    """Read a scene.

    Parameters
    ----------
    source
        Name of a shipped scene, path of a TOML file, or the result of `read_source`.
    changes
        Dotted key -> value that replaces the file's (as ``--set`` does).

    Raises
    ------
    SceneError
        If the scene cannot be found or has defects; the message lists all of them.
    """
    source = read_source(source)
    raw = source.tables()
    put_changes(raw, changes or {}, source.label)
    return make_scene(raw, name=source.name, label=source.label, folder=source.folder, files=source.files)


def make_scene(
    raw: Raw, name: str = "scene", label: str = "scene", folder: Path | None = None, files: Files | None = None
) -> Scene:
    """Validate a raw scene (tables of TOML) and freeze it.

    Parameters
    ----------
    raw
        The tables.
    name
        The scene's name.
    label
        Heading of messages.
    folder
        Folder of the files that it names; default: the current folder.
    files
        Tables of files already read, which are not read again; files read now are added.
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
    crowds = list(too_many(plain))
    if crowds:
        raise SceneError(list_faults(label, crowds))
    return _freeze(plain, name, sources, label, faults, {FOLDER: folder or Path(), FILES: files})


def restore_scene(text: str) -> Scene:
    """Restore a scene from ``Scene.model_dump_json()``, as stored in result files, with name and sources.

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
        raise SceneError(f"{label}: is not what ltcgear writes: {clean(str(error))}") from error
    return _freeze(kept, name, sources, label, [])


def describe_scene(scene: Scene, text: str = "", changes: Mapping[str, str] | None = None) -> dict[str, Any]:
    """Return the attributes that store a scene in a result (``attributes`` of ``simulate``), for `restore_scene`.

    Parameters
    ----------
    scene
        The scene; all its numbers and their sources are kept.
    text, changes
        Source text of the scene, and the values replaced in it.
    """
    kept = {"scene": scene.name, "title": scene.title, "scene_json": scene.model_dump_json()}
    return kept | {"scene_text": text, "changes": dict(changes or {})}


def _freeze(
    plain: Raw, name: str, sources: dict[str, str], label: str, faults: list[str], context: Raw | None = None
) -> Scene:
    """Make a Scene from plain values, or report all defects, ``faults`` included."""
    context = context or {FOLDER: Path()}
    try:
        scene = Scene.model_validate({**plain, "name": name, "sources": sources}, context=context)
    except ValidationError as error:
        told = {fault.split(":")[0] for fault in faults if ": value is missing;" in fault}
        found = [line for item in islice(error.errors(), MOST_READ) for line in explain(item)]
        faults += [line for line in found if line.split(":")[0] + ".source" not in told]
        faults += validate_parts(plain, context)
    else:
        faults += validate(scene)
    if faults:
        raise SceneError(list_faults(label, faults))
    return scene


def _read(path: Path, label: str) -> str:
    """Return the text of a scene file."""
    try:
        data = read_bytes(path, LARGEST_FILE)
        if len(data) > LARGEST_FILE:
            raise SceneError(
                f"{label}: has more than {LARGEST_FILE} bytes, this is no scene; tables over time go into a CSV file"
            )
        return data.decode("utf-8-sig").replace("\r\n", "\n")
    except (FileNotFoundError, NotADirectoryError):
        near = get_close_matches(path.stem[:LONGEST_NAME], shipped_scenes(), 1)
        hint = f'did you mean "{near[0]}"? ' if near else ""
        listing = ", ".join(shipped_scenes())
        raise SceneError(f"{label}: no such file and no shipped scene; {hint}shipped scenes: {listing}") from None
    except UnicodeDecodeError as error:
        raise SceneError(f"{label}: cannot be read as UTF-8 text: {error}; save it in UTF-8") from None
    except OSError as error:
        raise SceneError(f"{label}: cannot be read: {error.strerror}; give another path or rights to read it") from None
    except UnreadableError as error:
        raise SceneError(f"{label}: {error}") from None


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
