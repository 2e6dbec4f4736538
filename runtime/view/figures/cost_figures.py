"""Figure of the cost of effects and of the error of mesh forces without them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from ltcgear.generated.errors import LtcgearError
from ltcgear.generated.writing import check_output

from ..plots import BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILLION, make_canvas, save_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SUFFIXES = (".png", ".svg", ".pdf")
COSTS = (
    ("seconds_per_simulated_second", "time a simulated second", BLUE),
    ("ns_call", "time a right-hand side", SKY),
    ("operations", "operations of a right-hand side", ORANGE),
)
BENEFITS = (
    ("force_rms", "vibration of mesh force (rms)", "o", BLUE),
    ("force_peak", "largest mesh force", "^", VERMILLION),
    ("load_share", "largest planet's share", "s", GREEN),
    ("spectrum", "spectrum at mesh orders", "D", PURPLE),
)
SMALLEST = 1e-4  # [%] changes below are drawn at the edge


def check_figure(path: Path, *sources: str) -> None:
    """Refuse a figure that cannot be written or has no known format, before anything is computed."""
    check_output(path, *sources)
    if path.suffix not in SUFFIXES:
        raise LtcgearError(f"{path}: figures are {', '.join(SUFFIXES)}; name it {path.with_suffix('.png')}")


def draw_costs(data: dict[str, Any], path: Path) -> Path:
    """Draw cost and benefit of the effects of a scene side by side.

    Parameters
    ----------
    data
        What ``ltcgear cost --json`` prints; the first variant is the full scene.
    path
        File to write; its suffix is the format.

    Returns
    -------
    Path
        The file written.
    """
    full, *others = data["variants"]
    figure = make_canvas(12.0, 2.8 + 0.7 * max(len(others), 1))
    left, right = figure.subplots(1, 2, sharey=True)
    _draw_costs(left, full, others)
    _draw_benefits(right, others)
    names = [f"{row['effect']}\n{row['value']} \N{RIGHTWARDS ARROW} {row['without']}" for row in others]
    left.set_yticks(range(len(others)), names, fontsize=9)
    left.set_ylim(len(others) - 0.5, -0.5)
    figure.suptitle(f"{data['scene']}: each effect left out by itself", x=0.01, ha="left", fontsize=12)
    return save_figure(figure, path)


def _quantity(row: dict[str, Any], key: str) -> float | None:
    """Return one cost of a variant."""
    value = row["ops"]["rhs"] if key == "operations" else row[key]
    return None if value is None else float(value)


def _draw_costs(axes: Axes, full: dict[str, Any], others: list[dict[str, Any]]) -> None:
    """Draw how much cheaper the scene is without each effect [%]."""
    height = 0.8 / len(COSTS)
    for number, (key, label, colour) in enumerate(COSTS):
        whole = _quantity(full, key) or np.nan
        parts = [_quantity(row, key) if not row["reason"] else None for row in others]
        saved = [np.nan if part is None else 100 * (1 - part / whole) for part in parts]
        places = np.arange(len(others)) + (number - (len(COSTS) - 1) / 2) * height
        axes.barh(places, saved, height * 0.9, color=colour, label=label)
    for place, row in enumerate(others):
        if row["reason"]:
            axes.annotate(
                "cannot be run", (0, place), xytext=(4, 0), textcoords="offset points", va="center", fontsize=9
            )
    axes.axvline(0.0, color="black", lw=0.8)
    _finish(axes, "what leaving it out saves [%]")


def _draw_benefits(axes: Axes, others: list[dict[str, Any]]) -> None:
    """Draw how far the mesh forces are off without each effect [%]; unchanged forces are at the edge."""
    for number, (key, label, mark, colour) in enumerate(BENEFITS):
        found = [row["changes"][key] for row in others]
        sizes = [np.nan if value is None else max(100 * abs(value), SMALLEST) for value in found]
        places = np.arange(len(others)) + 0.18 * (number - (len(BENEFITS) - 1) / 2)
        axes.plot(sizes, places, mark, color=colour, label=label, ms=7, mec="white", clip_on=False)
    axes.set_xscale("log")
    axes.set_xlim(left=SMALLEST)
    _finish(axes, f"what is off without it: size of change [%]; {SMALLEST:g} stands for less")


def _finish(axes: Axes, label: str) -> None:
    """Give axes a light grid and a legend above, where it hides nothing."""
    axes.set_xlabel(label)
    axes.grid(alpha=0.3, lw=0.5)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=1, frameon=False, fontsize=9)
