"""What to change on the rig: the parameters that move its first modes and the vibration of its last mesh.

Run as ``python -m benchmarks.sensitivities``; it writes the tables of docs/sensitivities.md and their figures.
"""

from pathlib import Path
from typing import Any

from ltcgear.runtime.model.building import build
from ltcgear.runtime.model.library import Library
from ltcgear.runtime.results.table import Table
from ltcgear.runtime.studies.sensitivity.items import list_modes, list_output
from ltcgear.runtime.view.tables.sensitivity_tables import chosen, write_listing
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.mechanics.model import Model
from ltcgear.symbolic.scene.load import load_scene

PAGE = Path(__file__).resolve().parents[1] / "docs" / "sensitivities.md"
FIGURES = PAGE.parent / "images"
BEGIN, END = "<!-- {} -->\n", "<!-- end -->\n"
SCENE, MODES, TOP = "rig-2mw", 8, 3
OUTPUT, MEASURE, WINDOW = "mesh_force:psh.mesh", "vibration", (0.1, 0.2)
SHOWN = 6
"""Bars in a panel."""


def opened() -> tuple[Library, Model]:
    """Build the rig."""
    model = build_model(load_scene(SCENE))
    return build(obtain(model)), model


def modes_table(data: dict[str, Any]) -> str:
    """Return the strongest parameters of the first modes in Markdown."""
    rows = []
    for item in data["items"][:MODES]:
        strongest = ", ".join(f"{row['parameter']} {row['relative']:+.3f}" for row in chosen(item, "size")[:TOP])
        rows.append((item["mode"], f"{item['value']:.2f}", item["class"], strongest))
    return Table("", ("mode", "Hz", "class", "% for 1 %"), tuple(rows)).to_markdown()


def output_table(data: dict[str, Any]) -> str:
    """Return the strongest parameters of the output in Markdown."""
    rows = tuple(
        (row["parameter"], f"{row['value']:.4g} {row['unit']}", f"{row['relative']:+.2f}")
        for row in chosen(data["items"][0], "size")[:SHOWN]
    )
    return Table("", ("parameter", "value", "% for 1 %"), rows).to_markdown()


def measure() -> tuple[dict[str, Any], dict[str, Any]]:
    """Return what moves modes and output."""
    library, model = opened()
    p = library.parameters(model.values())
    modes = {"scene": SCENE, **list_modes(library, p, model.tables)}
    settings = {"measure": MEASURE, "window": WINDOW, "method": "auto", "rtol": 1e-8}
    return modes, {"scene": SCENE, **list_output(library, p, model.tables, OUTPUT, **settings)}


def main() -> None:
    """Write tables and figures."""
    modes, output = measure()
    text = PAGE.read_text("utf-8")
    for name, made in (("modes", modes_table(modes)), ("output", output_table(output))):
        begin = BEGIN.format(name)
        before, rest = text.split(begin)
        text = before + begin + made + END + rest.split(END, 1)[1]
        print(made)
    PAGE.write_text(text, "utf-8")
    write_listing(modes, FIGURES / "sensitivities-modes.png", SHOWN)
    write_listing(output, FIGURES / "sensitivities-output.png", SHOWN)


if __name__ == "__main__":
    main()
