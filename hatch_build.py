"""Build hook: where the files of runtime/namespace go, which are the package ltcgear itself."""

from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

PARTS = ("symbolic", "generated", "runtime")
NAMESPACE = Path("runtime", "namespace")
FILES = ("__init__.py", "__init__.pyi", "__main__.py", "py.typed")


class PackageLayout(BuildHookInterface):
    """Put the package together."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Link parts and files below ``.links/ltcgear`` where it is editable; else add the files to the wheel."""
        places = {Path("ltcgear", name): NAMESPACE / name for name in FILES}
        if version != "editable":
            build_data["force_include"] |= {str(Path(self.root, place)): str(at) for at, place in places.items()}
            return
        for at, place in (places | {Path("ltcgear", part): Path(part) for part in PARTS}).items():
            link = Path(self.root, ".links", at)
            link.parent.mkdir(parents=True, exist_ok=True)
            if not link.is_symlink():
                link.symlink_to(Path("..", "..", place), target_is_directory=not place.suffix)
