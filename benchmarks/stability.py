"""Stability under the varying mesh stiffness: the chart of the LSP stage, and whether the rig is stable.

Run as ``python -m benchmarks.stability``; it writes the tables of docs/stability.md and its figure.
"""

from pathlib import Path
from typing import Any

import numpy as np
from ltcgear.runtime.linear.chart import RPM, Chart, draw_up
from ltcgear.runtime.linear.floquet import Floquet, find_multipliers
from ltcgear.runtime.linear.periodic import vary
from ltcgear.runtime.model.building import build
from ltcgear.runtime.model.library import Library
from ltcgear.runtime.results.table import Table
from ltcgear.runtime.view.figures.stability_figures import draw_chart
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.scene.load import load_scene

PAGE = Path(__file__).resolve().parents[1] / "docs" / "stability.md"
FIGURE = PAGE.parent / "images" / "stability-lsp.png"
BEGIN, END = "<!-- {} -->\n", "<!-- end of {} -->\n"
UNDAMPED = {"effects.damping": "off", "effects.mesh_damping": "off"}
SPEEDS, VARIATIONS = np.linspace(100, 700, 240), np.linspace(0, 3, 60)
TONGUES = 6
STAGES = ("lsp", "hsp", "psh", None)
RANGE = np.linspace(5, 20, 31)
"""Speeds of the rig's motor [rpm]; 15 is its own."""


def opened(scene: str, changes: dict[str, str] | None = None) -> tuple[Library, Any]:
    """Build a scene; return its library and parameters."""
    model = build_model(load_scene(scene, changes or {}))
    library = build(obtain(model))
    return library, library.parameters(model.values())


def table_of_tongues(chart: Chart) -> str:
    """Return the widest tongues, first order beside multipliers in their middles."""
    undamped, damped = opened("lsp", UNDAMPED), opened("lsp")
    lifted = {tongue.resonance.name: tongue.least for tongue in draw_up(*damped, chart.speeds, np.array([1.0])).tongues}
    columns = ("tongue", "modes [Hz]", "speed [rpm]", "half width [rpm]", "growth in the middle [1/s]",
               "by multipliers", "with damping from variation")  # fmt: skip
    rows = []
    for tongue in chart.tongues[:TONGUES]:
        modes = ", ".join(f"{hertz:.1f}" for hertz in tongue.resonance.frequencies_hz)
        growth = find_multipliers(vary(*undamped, speed=tongue.speed)).multipliers[0].growth
        half = float(tongue.half_width(np.array(1.0))) / RPM
        least = lifted.get(tongue.resonance.name)
        numbers = f"{abs(tongue.speed) / RPM:.1f}", f"{half:.2f}", f"{tongue.coupling:.1f}", f"{growth:.1f}"
        rows.append((tongue.resonance.name, modes, *numbers, None if least is None else f"{least:.1f}"))
    return Table("", columns, tuple(rows)).to_markdown()


def rig(stage: str | None, changes: dict[str, str] | None = None) -> Floquet:
    """Find the rig's multipliers while one stage's stiffness varies, or all stages' (None)."""
    return find_multipliers(vary(*opened("rig-2mw", changes), stage))


def row(stage: str | None, damped: Floquet, undamped: Floquet | None, charted: Chart | None) -> tuple[str, ...]:
    """Return a row of the rig's table."""
    first, periodic = damped.multipliers[0], damped.periodic
    cells = [stage or "all", f"{1e3 * periodic.period:.4g}", f"{len(periodic.borders) - 1}"]
    cells += [f"{abs(first.value):.6f}", f"{first.growth:.5f}", f"{first.frequency_hz:.2f}"]
    cells.append("-" if undamped is None else f"{abs(undamped.multipliers[0].value):.6f}")
    cells.append("-" if charted is None else f"{min(tongue.least for tongue in charted.tongues):.1f}")
    return tuple(cells)


def table_of_rig() -> str:
    """Return the multipliers of the rig, stage by stage and all together."""
    columns = ("varies", "period [ms]", "jumps in it", "largest multiplier", "growth [1/s]", "its frequency [Hz]",
               "largest without damping", "unstable from variation, 5 to 20 rpm")  # fmt: skip
    rows = []
    for stage in STAGES:
        charted = None if stage is None else draw_up(*opened("rig-2mw"), RANGE * RPM, np.array([1.0]), stage)
        rows.append(row(stage, rig(stage), None if stage is None else rig(stage, UNDAMPED), charted))
    return Table("", columns, tuple(rows)).to_markdown()


def main() -> None:
    """Compute, print the tables and write page and figure."""
    chart = draw_up(*opened("lsp", UNDAMPED), SPEEDS * RPM, VARIATIONS)
    draw_chart(chart, "lsp without damping: where the varying mesh stiffness makes small motions grow", FIGURE)
    text = PAGE.read_text("utf-8")
    for name, made in (("tongues", table_of_tongues(chart)), ("rig", table_of_rig())):
        print(made)
        begin, end = BEGIN.format(name), END.format(name)
        before, rest = text.split(begin)
        text = before + begin + made + end + rest.split(end)[1]
    PAGE.write_text(text, "utf-8")


if __name__ == "__main__":
    main()
