"""Rewrite what is committed and follows from the code: C, manifests, pages (`make regenerate`, `make docs`)."""

import re
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from ltcgear.generated import folders, store
from ltcgear.runtime.cli.command_page import write_commands
from ltcgear.runtime.export.plain_c.data import PlainRun, write_data
from ltcgear.runtime.model.library import Library
from ltcgear.runtime.simulation.sampling_rate import find_rate
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.describe.effect_page import write_effects
from ltcgear.symbolic.emit.pipeline import generate
from ltcgear.symbolic.scene.load import load_scene

COMMITTED = {"rig-2mw": "rig_2mw", "lin-parker-3": "lin_parker_3"}
ROOT = Path(__file__).parents[1]
HOME = ROOT / "generated"
PAGES = {"commands.md": write_commands, "effects.md": write_effects}


COMPUTED = re.compile(r"(static const double (?:values|start)\[\] = \{\n)(.*?)(\n\};)", re.DOTALL)
"""The arrays of data.c whose last digits are the processor's: results of functions of angles, and of an iteration."""
CLOSE = 1e-9
"""Over the largest number of a freedom's kind, how close they must come."""


def texts(scene: str) -> dict[str, str]:
    """Return the files of a committed scene as the present equations give them."""
    settings = load_scene(scene)
    model = build_model(settings)
    artifact = generate(model)
    files = store.files(artifact)
    # CasADi's virtual machine rather than a compiler's code for this processor.
    bare = Library(artifact.manifest, None, {}, artifact)
    bare = replace(bare, functions=bare.graphs)
    rate = find_rate(bare, model.values(), model.tables, settings.simulation.rate).rate
    data = write_data(bare, settings.name, PlainRun(model.values(), model.tables, settings.simulation.t_end, rate))
    return {name: files[name] for name in ("model.c", "manifest.json")} | {"data.c": data}


def fixed(text: str) -> str:
    """Return a text without the numbers whose last digits may differ between processors."""
    return COMPUTED.sub(r"\1\3", text)


def computed(text: str) -> list[np.ndarray]:
    """Return those numbers."""
    return [
        np.array([float(number) for number in found[2].split(",") if number.strip()])
        for found in COMPUTED.finditer(text)
    ]


def same(one: str, two: str) -> bool:
    """Tell whether two texts say the same."""
    close = (
        np.abs(a - b) <= CLOSE * np.maximum(np.abs(a), 1e-3) for a, b in zip(computed(one), computed(two), strict=True)
    )
    return fixed(one) == fixed(two) and all(each.all() for each in close)


def keep(target: Path, files: dict[str, str]) -> dict[str, str]:
    """Return the files that say something else than those of a folder."""
    old = {name: (target / name).read_text("utf-8") for name in files if (target / name).is_file()}
    return {name: text for name, text in files.items() if name not in old or not same(old[name], text)}


def main(docs_only: bool) -> None:
    folders.write_folder(ROOT / "docs", {name: write() for name, write in PAGES.items()})
    print("wrote " + ", ".join(f"docs/{name}" for name in PAGES))
    if docs_only:
        return
    for scene, folder in COMMITTED.items():
        folders.write_folder(HOME / folder, keep(HOME / folder, texts(scene)))
        print(f"wrote generated/{folder}")


if __name__ == "__main__":
    main("--docs" in sys.argv)
