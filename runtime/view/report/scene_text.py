"""Scene text in the report, and the sources of its numbers."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping


LONGEST = 200_000
"""Characters of a scene's text that are shown."""


def list_scene(attributes: Mapping[str, Any], sources: Mapping[str, str]) -> dict[str, Any]:
    """Return a scene's lines with their kinds, changes on the command line, and sources by number."""
    text = str(attributes.get("scene_text", ""))
    lines = text[:LONGEST].splitlines() + [f"# ... {len(text) - LONGEST} characters more"] * (len(text) > LONGEST)
    return {
        "lines": [(_kind(line), line) for line in lines],
        "changes": json.loads(attributes.get("changes") or "{}"),
        "sources": [_split(key, source) for key, source in sources.items()],
    }


def _kind(line: str) -> str:
    """Say what a line of TOML is: ``head`` of a table, ``note``, or "" for anything else."""
    start = line.lstrip()
    return "note" if start.startswith("#") else "head" if start.startswith("[") else ""


def _split(key: str, source: str) -> dict[str, str]:
    """Split a source into its label and the rest."""
    label, _, rest = source.partition(": ")
    return {"key": key, "label": label, "source": rest or source}
