"""Rewrite what is committed and follows from the code: C, manifests, pages (`make regenerate`, `make docs`)."""

import sys
from pathlib import Path

from ltcgear.generated import store
from ltcgear.runtime.cli.command_page import write_commands
from ltcgear.symbolic.build import build_model
from ltcgear.symbolic.effect_page import write_effects
from ltcgear.symbolic.pipeline import generate
from ltcgear.symbolic.scene import load_scene

COMMITTED = {"rig-2mw": "rig_2mw", "lin-parker-3": "lin_parker_3"}
ROOT = Path(__file__).parents[1]
HOME = ROOT / "generated"
PAGES = {"commands.md": write_commands, "effects.md": write_effects}


def texts(scene: str) -> dict[str, str]:
    """Return the files of a committed scene as the present equations give them."""
    files = store.files(generate(build_model(load_scene(scene))))
    return {name: files[name] for name in ("model.c", "manifest.json")}


def main(docs_only: bool) -> None:
    store.write_folder(ROOT / "docs", {name: write() for name, write in PAGES.items()})
    print("wrote " + ", ".join(f"docs/{name}" for name in PAGES))
    for scene, folder in () if docs_only else COMMITTED.items():
        store.write_folder(HOME / folder, texts(scene))
        print(f"wrote generated/{folder}")


if __name__ == "__main__":
    main("--docs" in sys.argv)
