"""Template of a scene: read once, changed any number of times, also in other processes."""

import hashlib
from collections.abc import Callable, Iterator, Mapping
from copy import deepcopy
from pathlib import Path
from typing import Any

from ltcgear.generated.contract import Artifact
from ltcgear.generated.errors import SceneError

from ..assembly import build_model
from ..scene.changes import put_changes
from ..scene.load import Source, describe_scene, make_scene, read_source
from ..scene.toml import Raw
from ..schema.scene_schema import Scene
from ..schema.series import Pairs
from .pipeline import content_key, obtain

LABELS = ("source", "title")
"""Keys of a scene that affect no number."""


class Template:
    """A scene of which variants are made, each by replacing values of the scene.

    Text and tables are read at construction. CSV files are read once, by the first variant that names them; a copy in
    another process has them and needs no file.

    Parameters
    ----------
    source
        Name of a shipped scene, path of a TOML file, or the result of ``read_source``.
    changes
        Dotted key -> value for all variants, as ``load_scene`` takes them.

    Raises
    ------
    SceneError
        If the scene cannot be read, or a key does not exist.
    """

    def __init__(self, source: str | Path | Source, changes: Mapping[str, str] | None = None) -> None:
        read = read_source(source)
        self.label, self.name, self.text, self.folder = read.label, read.name, read.text, read.folder
        self.raw, self.files, self.changes = read.tables(), dict(read.files), dict(changes or {})
        put_changes(self.raw, self.changes, self.label)

    def scene(self, changes: Mapping[str, str]) -> Scene:
        """Return a variant's scene.

        Raises
        ------
        SceneError
            If it has defects; the message lists all of them.
        """
        raw: Raw = deepcopy(self.raw)
        put_changes(raw, changes, self.label)
        return make_scene(raw, name=self.name, label=self.label, folder=self.folder, files=self.files)

    def make(self, changes: Mapping[str, str]) -> tuple[str, dict[str, float], dict[str, Pairs]]:
        """Return the key of a variant's C in the store, its parameters in SI, and its tables over time.

        Raises
        ------
        SceneError
            As `scene`.
        """
        model = build_model(self.scene(changes))
        return content_key(model), model.values(), model.tables

    def obtain(
        self, changes: Mapping[str, str], told: Callable[[str, float], None] = lambda stage, seconds: None
    ) -> Artifact:
        """Return a variant's C from the store; if missing, it is derived, checked and stored.

        Raises
        ------
        SceneError
            As `scene`.
        CheckError
            If the equations do not pass their checks.
        """
        return obtain(build_model(self.scene(changes)), told)

    def times(self, changes: Mapping[str, str]) -> tuple[float, float | None]:
        """Return the simulated time [s] and the sampling rate [Hz] of a variant's scene.

        Without a rate, the caller chooses one.
        """
        simulation = self.scene(changes).simulation
        return simulation.t_end, simulation.rate

    def entries(self) -> dict[str, Any]:
        """Return all keys and values that affect numbers, so that two templates can be compared."""
        tables = {
            f"table {name}": hashlib.sha256(repr(rows).encode()).hexdigest() for (name, *_), rows in self._tables()
        }
        return {"scene": self.name} | dict(_flatten(self.raw, "")) | tables

    def _tables(self) -> Iterator[tuple[tuple[str, str, str], Pairs]]:
        """Yield the files read, in an order independent of the time of reading."""
        yield from sorted(self.files.items())

    def about(self) -> dict[str, Any]:
        """Return the scene's attributes for a file; no ``scene_json`` if it has defects unless varied."""
        try:
            return describe_scene(self.scene({}), self.text, self.changes)
        except SceneError:
            return {"scene": self.name, "scene_text": self.text, "changes": self.changes}


def _flatten(node: Any, key: str) -> Iterator[tuple[str, Any]]:  # noqa: ANN401
    """Yield the values of nested tables by dotted key."""
    if isinstance(node, dict):
        for name, value in node.items():
            if not (name in LABELS and isinstance(value, str)):  # tables may bear these names
                yield from _flatten(value, f"{key}.{name}" if key else name)
    else:
        yield key, node
