"""The floating effect: planets' shares with a floating sun and with one on a stiff bearing.

Run as ``python -m benchmarks.floating``; it writes the table of docs/floating.md and its figure.
"""

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from ltcgear.runtime.model.building import build
from ltcgear.runtime.results.table import Table
from ltcgear.runtime.simulation.simulate import simulate
from ltcgear.runtime.view.plots import BLUE, ORANGE
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.scene.load import load_scene

PAGE = Path(__file__).resolve().parents[1] / "docs" / "floating.md"
FIGURE = PAGE.parent / "images" / "floating.png"
BEGIN, END = "<!-- floating -->\n", "<!-- end -->\n"
ERROR = {
    "effects.planet_position_error": "on",
    "stages.lsp.position_errors": '[{ planet = 1, tangential = "50 um" }]',
}
STIFF = {
    "stages.lsp.sun.support": "bearing",
    "stages.lsp.sun.bearing": '{ stiffness = "1e10 N/m", damping_ratio = 0.03 }',
}
CASES = (("lsp", 1.0), ("rig-2mw", 3.0))


def measure(scene: str, seconds: float, stiff: bool) -> dict[str, Any]:
    """Simulate and return shares of the planets (mean force over their mean) and load factors of the sun's meshes."""
    opened = load_scene(scene, ERROR | (STIFF if stiff else {}))
    model = build_model(opened)
    library = build(obtain(model))
    result = simulate(library, model.values(), t_end=seconds, rate=opened.simulation.rate)
    forces = [value for name, value in result.summary["forces"].items() if name.startswith("lsp.sun_planet")]
    means = np.array([force["mean"] for force in forces])
    return {"shares": means / means.mean(), "factors": np.array([force["max"] for force in forces]) / means.mean()}


def table(found: dict[tuple[str, bool], dict[str, Any]]) -> str:
    """Return the table in Markdown."""
    columns = "scene", "sun", "share of planet 1 to 4", "spread", "largest force of planet 1 to 4 over mean share"
    rows = []
    for (scene, stiff), item in found.items():
        shares, factors = (", ".join(f"{value:.3f}" for value in item[key]) for key in ("shares", "factors"))
        spread = np.ptp(item["shares"])
        rows.append((scene, "stiff bearing" if stiff else "floating", shares, f"{spread:.3f}", factors))
    return Table("", columns, tuple(rows)).to_markdown()


def draw(found: dict[tuple[str, bool], dict[str, Any]]) -> None:
    """Draw the shares side by side."""
    figure, axes = plt.subplots(1, len(CASES), figsize=(9, 3.6), sharey=True, layout="constrained")
    for axis, (scene, _) in zip(axes, CASES, strict=True):
        for stiff, colour, shift in ((False, BLUE, -0.2), (True, ORANGE, 0.2)):
            shares = found[scene, stiff]["shares"]
            label = "sun on a stiff bearing" if stiff else "floating sun"
            axis.bar(np.arange(1, len(shares) + 1) + shift, shares - 1, 0.38, bottom=1, color=colour, label=label)
        axis.axhline(1.0, color="black", linewidth=0.8)
        axis.set(title=scene, xlabel="planet of the low-speed stage", xticks=range(1, len(shares) + 1))
    axes[0].set(ylabel="share of the sun's load, 1 in the mean", ylim=(0.89, 1.08))
    axes[0].legend(frameon=False, loc="lower right")
    figure.savefig(FIGURE, dpi=130)


def main() -> None:
    """Measure, print the table and write page and figure."""
    found = {(scene, stiff): measure(scene, seconds, stiff) for scene, seconds in CASES for stiff in (False, True)}
    made = table(found)
    print(made)
    draw(found)
    before, rest = PAGE.read_text("utf-8").split(BEGIN)
    PAGE.write_text(before + BEGIN + made + END + rest.split(END)[1], "utf-8")


if __name__ == "__main__":
    main()
