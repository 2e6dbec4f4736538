"""Build hook: an editable install sees one folder, .links/ltcgear, whose three links are the parts."""

from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

PARTS = ("symbolic", "generated", "runtime")


class NamespaceLinks(BuildHookInterface):
    """Create the link folder that ``dev-mode-dirs`` points to."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Link each part below ``.links/ltcgear``; a wheel maps the folders itself."""
        if version == "editable":
            home = Path(self.root, ".links", "ltcgear")
            home.mkdir(parents=True, exist_ok=True)
            for part in PARTS:
                link = home / part
                if not link.is_symlink():
                    link.symlink_to(Path("..", "..", part), target_is_directory=True)
