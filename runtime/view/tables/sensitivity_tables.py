"""Tables, CSV and bar figure of sensitivities."""

from __future__ import annotations

from math import isfinite, nan
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ltcgear.generated.errors import LtcgearError
from ltcgear.generated.writing import check_output, write_rows

from ...model.ties import order_by_size
from ...results.table import Table
from ..plots import BLUE, VERMILLION, make_canvas, save_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FIGURES = (".png", ".svg", ".pdf")
ROUNDING = 1e-9
"""Relative change that is not worth a line."""
PANELS = 6
"""Most numbers that one figure shows."""
Item = dict[str, Any]


def check_listing(path: Path, *sources: str) -> None:
    """Refuse a file that cannot be written or has no known format, before anything is computed."""
    check_output(path, *sources)
    if path.suffix not in (".csv", *FIGURES):
        formats = ", ".join((".csv", *FIGURES))
        raise LtcgearError(f"{path}: sensitivities are written as {formats}; name it {path.with_suffix('.csv')}")


def chosen(item: Item, kind: str) -> list[Item]:
    """Return the influences of one kind that have a derivative."""
    return [row for row in item["influences"] if row["kind"] == kind and isfinite(row["derivative"])]


def make_tables(data: dict[str, Any], top: int) -> list[Table]:
    """Return tables for people: of each number its own where there are few, else one with a line each."""
    items = data["items"]
    if len(items) > 2:
        return [_overview(data, top)]
    return [table for item in items for table in (_sizes(item, top), _geometry(item, top)) if table.rows]


def _overview(data: dict[str, Any], top: int) -> Table:
    """List the strongest parameters of many numbers."""
    rows: list[tuple[str, ...]] = []
    for item in data["items"]:
        heads = [(item["name"], f"{item['value']:.2f}"), *[("", "")] * top]
        for head, row in zip(heads, chosen(item, "size")[:top], strict=False):
            rows.append((*head, row["parameter"], f"{row['relative']:+.3f}"))
    return Table(
        f"What moves each: the {top} strongest parameters", ("", data["unit"], "parameter", "% for 1 %"), tuple(rows)
    )


def _sizes(item: Item, top: int) -> Table:
    """List the strongest sizes of one number."""
    beside = list(item["influences"][0]["beside"]) if item["influences"] else []
    columns = ("parameter", "value", "unit", "% for 1 %", *(f"{name} for 1 %" for name in beside))
    rows = [
        (
            row["parameter"], f"{row['value']:.4g}", row["unit"], f"{row['relative']:+.4f}",
            *(f"{row['beside'][name] / 100:+.1e}" for name in beside),
        )
        for row in chosen(item, "size")[:top]
    ]  # fmt: skip
    return Table(f"{item['name']}, {item['value']:.6g} {item['unit']}: sizes", columns, tuple(rows), _notes(item))


def _notes(item: Item) -> tuple[str, ...]:
    """Say what has no derivative, and why."""
    without = [row["parameter"] for row in item["influences"] if not isfinite(row["derivative"])]
    notes = tuple(item.get("notes", ()))
    if not without:
        return notes
    return (*notes, f"no derivative, since without its balance there is no equilibrium: {', '.join(without)}")


def _geometry(item: Item, top: int) -> Table:
    """List the strongest radii, places, angles and phases of one number."""
    share = 100 / item["value"] if item["value"] else nan
    geometry = chosen(item, "geometry")
    order = order_by_size(
        [abs(row["derivative"]) * _step(row) for row in geometry], [row["parameter"] for row in geometry]
    )
    rows = [
        (row["parameter"], f"{row['value']:.4g}", f"{row['derivative'] * share * _step(row):+.2e} {_per(row)}")
        for row in (geometry[k] for k in order[:top])
        if abs(row["derivative"]) * _step(row) > ROUNDING * abs(item["value"])
    ]
    return Table(
        f"{item['name']}: radii, places, angles, phases, each by itself", ("parameter", "value", "change"), tuple(rows)
    )


def _step(row: Item) -> float:
    """Return the step of a place that its change is told for: 0.1 mm, 0.1 deg, a hundredth of all else."""
    return {"m": 1e-4, "rad": 1.7453292519943295e-3}.get(row["unit"], 1e-2)


def _per(row: Item) -> str:
    """Say for what step a change is told."""
    return "% for " + {"m": "0.1 mm", "rad": "0.1 deg", "": "0.01"}.get(row["unit"], f"0.01 {row['unit']}")


def write_listing(data: dict[str, Any], path: Path, top: int) -> Path:
    """Write all derivatives as CSV, or draw the strongest as bars, as the suffix says."""
    if path.suffix == ".csv":
        _write_csv(data, path)
    else:
        _draw(data, path, top)
    return path


def _write_csv(data: dict[str, Any], path: Path) -> None:
    """Write a line for each number and parameter."""
    beside = list(dict.fromkeys(name for item in data["items"] for row in item["influences"] for name in row["beside"]))
    about = ["name", "number", "number_unit", "parameter", "value", "unit", "kind"]
    rows = [[*about, "derivative", "percent_for_percent", *beside]]
    for item in data["items"]:
        for row in item["influences"]:
            given = [row["parameter"], row["value"], row["unit"], row["kind"], row["derivative"], row["relative"]]
            rows.append([item["name"], item["value"], item["unit"], *given, *row["beside"].values()])
    write_rows(rows, path)


def _draw(data: dict[str, Any], path: Path, top: int) -> None:
    """Draw the strongest sizes of the first numbers as bars."""
    from matplotlib.patches import Patch

    items = _unlike(data["items"], top)[:PANELS]
    columns = min(len(items), 2)
    rows = -(-len(items) // columns)
    figure = make_canvas(7.5 * columns, rows * (1.0 + 0.28 * top) + 0.6)
    for axes, item in zip(figure.subplots(rows, columns, squeeze=False).flat, items, strict=False):
        _bars(axes, item, top)
    for axes in figure.axes[len(items) :]:
        axes.set_visible(False)
    figure.suptitle(f"{data['scene']}: {data['title']}", x=0.01, ha="left", fontsize=12)
    handles = [Patch(color=colour, label=label) for label, colour in (("raises it", BLUE), ("lowers it", VERMILLION))]
    figure.legend(handles=handles, loc="outside lower right", ncols=2, frameon=False, fontsize=9)
    save_figure(figure, path)


def _unlike(items: list[Item], top: int) -> list[Item]:
    """Leave out what shows the same bars as the one before: modes that are alike."""
    bars = [[(row["parameter"], f"{row['relative']:.5f}") for row in chosen(item, "size")[:top]] for item in items]
    return [item for k, item in enumerate(items) if k == 0 or bars[k] != bars[k - 1]]


def _bars(axes: Axes, item: Item, top: int) -> None:
    """Draw the strongest sizes of one number, those that raise it in one colour, those that lower it in another."""
    shown = chosen(item, "size")[:top]
    colours = [BLUE if row["relative"] > 0 else VERMILLION for row in shown]
    axes.barh(range(len(shown)), [row["relative"] for row in shown], 0.7, color=colours)
    axes.set_yticks(range(len(shown)), [row["parameter"] for row in shown], fontsize=9)
    axes.invert_yaxis()
    axes.axvline(0.0, color="black", lw=0.8)
    axes.set_title(f"{item['name']}, {item['value']:.5g} {item['unit']}", loc="left", fontsize=10)
    axes.set_xlabel("change [%] for 1 % of the parameter", fontsize=9)
    axes.grid(axis="x", alpha=0.3, lw=0.5)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
