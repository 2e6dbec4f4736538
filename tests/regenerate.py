"""Rewrite the committed C and manifests of the shipped scenes (`make regenerate`)."""

from pathlib import Path

from ltcgear.generated import store
from ltcgear.symbolic.build import build_model
from ltcgear.symbolic.pipeline import generate
from ltcgear.symbolic.scene import load_scene

COMMITTED = {"rig-2mw": "rig_2mw", "lin-parker-3": "lin_parker_3"}
HOME = Path(__file__).parents[1] / "generated"


def texts(scene: str) -> dict[str, str]:
    """Return the files of a committed scene as the present equations give them."""
    files = store.files(generate(build_model(load_scene(scene))))
    return {name: files[name] for name in ("model.c", "manifest.json")}


def main() -> None:
    for scene, folder in COMMITTED.items():
        store.write_folder(HOME / folder, texts(scene))
        print(f"wrote generated/{folder}")


if __name__ == "__main__":
    main()
