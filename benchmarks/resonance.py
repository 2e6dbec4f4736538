"""Resonances of the 2 MW rig: the crossings that excite most, its Campbell diagram, and a frequency response.

Run as ``python -m benchmarks.resonance``; it writes the table of docs/resonance.md and its figures.
"""

from pathlib import Path
from typing import Any

from ltcgear.runtime.linear.campbell import sweep_speed
from ltcgear.runtime.linear.crossings import find_crossings
from ltcgear.runtime.linear.modes import find_modes
from ltcgear.runtime.linear.naming import describe_modes
from ltcgear.runtime.linear.orders import list_orders
from ltcgear.runtime.linear.resonance import tell_campbell, tell_response
from ltcgear.runtime.linear.response import choose_frequencies, respond
from ltcgear.runtime.linear.system import linearise
from ltcgear.runtime.model.building import build
from ltcgear.runtime.model.equilibrium import find_equilibrium
from ltcgear.runtime.model.library import Library
from ltcgear.runtime.model.members import train_of
from ltcgear.runtime.model.operating_point import OperatingPoint
from ltcgear.runtime.results.table import Table
from ltcgear.runtime.view.figures.resonance_figures import draw_campbell, draw_response
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.scene.load import load_scene

PAGE = Path(__file__).resolve().parents[1] / "docs" / "resonance.md"
IMAGES = PAGE.parent / "images"
BEGIN, END = "<!-- resonance -->\n", "<!-- end -->\n"
SCENE, EXCITED, HARMONICS = "rig-2mw", "hsp.sun_planet.1", 3
NEAR = 0.3
"""Crossings up to this part of the speed beside it are listed."""
ROWS = 7
COLUMNS = (
    "crossing", "rpm", "Hz", "speed margin", "mode", "mesh force per um [kN]", "mesh force by its own stiffness [kN]",
)  # fmt: skip


def built() -> tuple[Library, Any]:
    """Return the rig's library and parameters."""
    model = build_model(load_scene(SCENE))
    library = build(obtain(model))
    return library, library.parameters(model.values())


def campbell() -> dict[str, Any]:
    """Follow the rig's modes over speed."""
    library, p = built()
    found = sweep_speed(library, p)
    orders = list_orders(library.manifest, p, HARMONICS)
    return tell_campbell(SCENE, found, orders, find_crossings(found, orders))


def response() -> dict[str, Any]:
    """Let an error of one mesh excite the rig."""
    library, p = built()
    linear = linearise(OperatingPoint(library, p, find_equilibrium(library, p)))
    modes = describe_modes(linear, find_modes(linear))
    return tell_response(
        SCENE, respond(linear, EXCITED, choose_frequencies(modes, 10.0)), modes, train_of(library.manifest)
    )


def table(data: dict[str, Any]) -> str:
    """Write the crossings near the rig's speed that excite most."""
    modes = {mode["mode"]: mode for mode in data["modes"]}
    near = [item for item in data["crossings"] if abs(item["margin"]) <= NEAR and item["force"]]
    rows = tuple(
        (item["crossing"], f"{item['at']:.2f}", f"{item['frequency_hz']:.1f}", f"{item['margin']:+.1%}",
         f"{modes[item['modes'][0]]['class']}, {modes[item['modes'][0]]['name']}",
         f"{item['force_per_um'] / 1e3:.2f}", f"{item['force'] / 1e3:.2f}")
        for item in near[:ROWS]
    )  # fmt: skip
    return Table("", COLUMNS, rows).to_markdown()


def main() -> None:
    """Compute, print the table and write page and figures."""
    data = campbell()
    made = table(data)
    print(made)
    draw_campbell(data, IMAGES / "campbell.png")
    draw_response(response(), IMAGES / "response.png")
    before, rest = PAGE.read_text("utf-8").split(BEGIN)
    PAGE.write_text(before + BEGIN + made + END + rest.split(END)[1], "utf-8")


if __name__ == "__main__":
    main()
