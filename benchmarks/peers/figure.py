"""The figure of the peers: error against time, tool by tool."""

from pathlib import Path
from typing import Any

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from .page import RACES
from .race import TARGET

COLOURS = {"ltcgear": "tab:red", "SciPy on our C": "tab:blue", "scikit-sundae on our C": "tab:green",
           "SciPy on NumPy": "tab:purple", "Exudyn": "tab:orange"}  # fmt: skip
MARKS = "osv^D"


def draw_races(data: dict[str, Any], path: Path) -> None:
    """Draw error against least time of all races, and save the figure."""
    races = [key for key in RACES if key in data]
    figure = Figure(figsize=(5.2 * len(races), 5.6), layout="constrained")
    FigureCanvasAgg(figure)
    for axes, key in zip(figure.subplots(1, len(races), squeeze=False)[0], races, strict=True):
        seen: dict[str, int] = {}
        for row in data[key]["rows"]:
            points = sorted((p["error"], p["min"]) for p in row["points"])
            mark = MARKS[seen.get(row["tool"], 0)]
            seen[row["tool"]] = seen.get(row["tool"], 0) + 1
            errors, seconds = ([p[i] for p in points] for i in (0, 1))
            label = f"{row['tool']}: {row['solver']}"
            axes.loglog(errors, seconds, mark + "-", color=COLOURS[row["tool"]], label=label, markersize=4, linewidth=1)
        axes.axvline(TARGET, color="0.5", linewidth=0.8, linestyle="--")
        axes.set(title=RACES[key], xlabel="error of mesh forces over their vibration", ylabel="seconds")
        axes.invert_xaxis()
        axes.grid(True, which="major", linewidth=0.3)
        axes.legend(fontsize=7, ncols=2, loc="upper left", bbox_to_anchor=(0.0, -0.14))
    figure.savefig(path, dpi=110)
