"""Table and figure of the self-test."""

from __future__ import annotations

import re
from math import isfinite
from typing import TYPE_CHECKING, Any

from ...results.table import Table
from ...studies.selftest.suite import NO_METHOD, OK, REFUSED, SLOW, WRONG
from ..plots import BLUE, ORANGE, SKY, VERMILLION, make_canvas, save_figure

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes

Data = dict[str, Any]
COLOURS = {OK: SKY, SLOW: ORANGE, WRONG: VERMILLION, REFUSED: "#dddddd"}


def methods_of(data: Data) -> list[str]:
    """Return the methods that were run, in order."""
    found = (result["method"] for case in data["cases"] for result in case["results"])
    return list(dict.fromkeys(method for method in found if method != NO_METHOD))


def worst(result: Data) -> Data | None:
    """Return the finding that is nearest to its limit, or farthest beyond; None if nothing was found."""
    return max(result["findings"], key=_part, default=None)


def _part(finding: Data) -> float:
    """Return a value over its limit; infinite where it is not a number, or the limit is zero and it is not."""
    value, limit = finding["value"], finding["limit"]
    if value is None or not isfinite(value):
        return float("inf")
    if limit > 0:
        return float(value / limit)
    return 0.0 if value <= limit else float("inf")


def cell(result: Data) -> str:
    """Return the text of a cell: the verdict, and the worst value over its limit."""
    finding = worst(result)
    if finding is None or result["verdict"] == REFUSED:
        return str(result["verdict"])
    return f"{result['verdict']} {_short(finding['value'])}/{_short(finding['limit'])}"


def _short(value: float | None) -> str:
    """Return a number in few letters, as 1.7e-9."""
    text = "nan" if value is None else f"{value:.2g}"
    return re.sub(r"e([-+])0*", lambda found: "e" + found[1].strip("+"), text)


def row_of(case: Data, methods: list[str]) -> list[Data]:
    """Return a case's result for each method; one that integrates nothing has the same for all."""
    by_method = {result["method"]: result for result in case["results"]}
    return [by_method[method if method in by_method else NO_METHOD] for method in methods or [NO_METHOD]]


def reasons(data: Data) -> list[str]:
    """Return why results are not ok, equal ones once."""
    grouped: dict[tuple[str, str, str], list[str]] = {}
    for case in data["cases"]:
        for result in case["results"]:
            if result["reason"]:
                grouped.setdefault((case["name"], result["verdict"], result["reason"]), []).append(result["method"])
    return [
        f"{name}, {', '.join(methods)}: {verdict}: {reason}" for (name, verdict, reason), methods in grouped.items()
    ]


def make_table(data: Data) -> Table:
    """Return case by method: verdict and worst value over its limit."""
    methods = methods_of(data)
    rows = tuple(
        (case["name"], *("\n".join(cell(result).split(" ", 1)) for result in row_of(case, methods)))
        for case in data["cases"]
    )
    seconds = sum(result["seconds"] for case in data["cases"] for result in case["results"])
    notes = (*reasons(data), f"Value / limit of the finding that is nearest to its limit; {seconds:.1f} s integrated.")
    form = "long" if data["full"] else "short"
    return Table(f"Hard cases, {form} form", ("case", *(methods or ["result"])), rows, notes)


def draw_matrix(data: Data, path: Path) -> Path:
    """Draw the matrix of cases and methods.

    Parameters
    ----------
    data
        What ``ltcgear selftest --json`` prints.
    path
        File to write; its suffix is the format.
    """
    methods = methods_of(data) or [NO_METHOD]
    size = (3.4 + 1.25 * len(methods), 1.2 + 0.42 * len(data["cases"]))
    figure = make_canvas(*size)
    axes = figure.subplots()
    for number, case in enumerate(data["cases"]):
        for place, result in enumerate(row_of(case, methods)):
            _draw_cell(axes, place, number, result)
    axes.set(xlim=(-0.5, len(methods) - 0.5), ylim=(len(data["cases"]) - 0.5, -0.5))
    axes.set_xticks(range(len(methods)), methods)
    axes.set_yticks(range(len(data["cases"])), [case["name"] for case in data["cases"]])
    axes.xaxis.tick_top()
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)
    figure.supxlabel("value / limit of the finding that is nearest to its limit", fontsize=9, color=BLUE)
    return save_figure(figure, path)


def _draw_cell(axes: Axes, x: int, y: int, result: Data) -> None:
    """Draw one cell."""
    from matplotlib.patches import Rectangle

    axes.add_patch(Rectangle((x - 0.48, y - 0.46), 0.96, 0.92, color=COLOURS[result["verdict"]], lw=0))
    axes.text(x, y, "\n".join(cell(result).split(" ", 1)), ha="center", va="center", fontsize=8)
