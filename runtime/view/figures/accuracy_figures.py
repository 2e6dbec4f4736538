"""Figures of accuracy against time, one panel each and all in one figure."""

from __future__ import annotations

from itertools import cycle
from math import isfinite
from typing import TYPE_CHECKING, Any

from ...simulation.methods.registry import METHODS
from ...studies.accuracy.cheapest import LIMITS, find_cheapest
from ...studies.accuracy.phases import PHASES
from ...studies.accuracy.reference import MARGIN
from ...studies.accuracy.run_errors import KINDS, value_of
from ..plots import BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILLION, make_canvas, save_figure

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from matplotlib.axes import Axes

Data = dict[str, Any]
LOOKS = ((BLUE, "o"), (GREEN, "^"), (ORANGE, "v"), (PURPLE, "D"), (VERMILLION, "s"), (SKY, "P"))
"""Colours of Okabe and Ito, and marks."""
STYLES = dict(zip(METHODS, cycle(LOOKS), strict=False))
"""Colour and mark of each method."""
NAMES = {
    "mesh_force": "mesh force", "bearing_force": "bearing force", "transmission_error": "transmission error",
    "load_share": "load share", "spectrum": "spectrum [dB]", "states": "states",
}  # fmt: skip


def draw_all(record: Data, folder: Path, suffix: str = ".png") -> list[Path]:
    """Draw every panel into a file of its own, and all into ``overview``.

    Parameters
    ----------
    record
        What ``ltcgear accuracy --json`` prints.
    folder
        Where to; it must exist.
    suffix
        Format.
    """
    paths = []
    for name, draw in PANELS.items():
        figure = make_canvas(7.0, 4.8)
        draw(figure.add_subplot(), record)
        paths.append(folder / f"{name}{suffix}")
        save_figure(figure, paths[-1], 120)
    return [*paths, draw_overview(record, folder / f"overview{suffix}")]


def draw_overview(record: Data, path: Path) -> Path:
    """Draw all panels in one figure."""
    figure = make_canvas(15.5, 9.0)
    for axes, draw in zip(figure.subplots(2, 3).flat, PANELS.values(), strict=True):
        draw(axes, record)
    about = f"{record['scene']}: {record['t_end']:g} s simulated, preset {record['preset']}"
    figure.suptitle(about, x=0.01, ha="left", fontsize=12)
    return save_figure(figure, path, 80)


def _curves(record: Data) -> Iterator[tuple[str, list[Data]]]:
    """Yield each method with its points, those that did not run too."""
    for method in dict.fromkeys(point["method"] for point in record["points"]):
        yield method, [point for point in record["points"] if point["method"] == method]


def _error(record: Data, point: Data) -> float:
    """Return a point's error by the record's measure; not a number where there is none."""
    value = value_of(point["errors"], record["measure"]) if record["measure"] else None
    return float("nan") if value is None or value <= 0 else value


def _draw_curves(axes: Axes, record: Data, place: Callable[[Data], tuple[float, float]]) -> None:
    """Draw a curve for each method; a gap where a point did not run, grey where the reference is too uncertain."""
    axes.set_xscale("log")
    axes.set_yscale("log")
    for method, points in _curves(record):
        colour, mark = STYLES[method]
        places = [place(point) if point["reason"] is None else (float("nan"),) * 2 for point in points]
        if not any(isfinite(sum(spot)) for spot in places):
            continue
        axes.plot(*zip(*places, strict=True), "-", color=colour, lw=1.2, alpha=0.7)
        for trusted, fill, edge in ((True, colour, colour), (False, "white", GREY)):
            some = [spot for spot, point in zip(places, points, strict=True) if bool(point["trusted"]) == trusted]
            if some:
                label = method if trusted or not any(point["trusted"] for point in points) else None
                axes.plot(*zip(*some, strict=True), mark, ms=5, label=label, mfc=fill, mec=edge)


def _finish(axes: Axes, title: str, x: str, y: str) -> None:
    """Give axes a title, labels with units, a grid and a legend if there is anything to label."""
    axes.set_title(title, loc="left", fontsize=11)
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.grid(alpha=0.3, lw=0.5)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    if axes.get_legend_handles_labels()[1]:
        axes.legend(frameon=False, fontsize=9)


def _error_axis(axes: Axes, record: Data) -> None:
    """Let errors fall to the right, and mark the limits and the uncertainty of the reference."""
    floor = record["reference"]["floor"]
    errors = [_error(record, point) for point in record["points"] if point["reason"] is None]
    known = [error for error in errors if isfinite(error)] or list(LIMITS)
    axes.set_xlim(2 * max(known), max(0.5 * min(known), floor or 0.0))
    for limit in LIMITS:
        axes.axvline(limit, color=GREY, lw=0.6, ls=":")
    if floor:
        axes.axvspan(1e-16, MARGIN * floor, color=GREY, alpha=0.12, lw=0)


def _label(record: Data) -> str:
    """Name the record's error."""
    return f"error: {KINDS.get(record['measure'], 'none')}"


def draw_error_time(axes: Axes, record: Data) -> None:
    """Draw the integrator's seconds a simulated second over the error."""
    t_end = record["t_end"]
    _draw_curves(axes, record, lambda point: (_error(record, point), point["seconds"] / t_end))
    axes.axhline(1.0, color="black", lw=0.8, ls="--")
    axes.annotate("real time", (0.99, 1.0), xycoords=("axes fraction", "data"), ha="right", va="bottom", fontsize=8)
    _error_axis(axes, record)
    _finish(axes, "Time for an error (grey: too near the reference)", _label(record), "seconds a simulated second")


def draw_error_calls(axes: Axes, record: Data) -> None:
    """Draw the right-hand sides a simulated second over the error."""
    t_end = record["t_end"]
    _draw_curves(axes, record, lambda point: (_error(record, point), point["counts"]["rhs"] / t_end))
    _error_axis(axes, record)
    _finish(axes, "Right-hand sides for an error", _label(record), "calls a simulated second")


def draw_tolerance(axes: Axes, record: Data) -> None:
    """Draw the error over the tolerance, and where both are equal."""
    _draw_curves(axes, record, lambda point: (point["rtol"], _error(record, point)))
    ends = sorted({point["rtol"] for point in record["points"]})
    axes.plot(ends, ends, color="black", lw=0.8, ls="--", label="error = rtol")
    axes.invert_xaxis()
    _finish(axes, "Does the error follow the tolerance?", "relative tolerance", _label(record))


def draw_kinds(axes: Axes, record: Data) -> None:
    """Draw all kinds of error of the method that is cheapest for 0.1 %, over the tolerance."""
    best = find_cheapest(record, 1e-3)
    title = "No setting for 0.1 %" if best is None else f"What is off, by {best['method']}"
    points = [] if best is None else [p for p in record["points"] if p["method"] == best["method"] and not p["reason"]]
    for (kind, name), (colour, mark) in zip(NAMES.items(), LOOKS, strict=True):
        found = [(point["rtol"], value_of(point["errors"], kind)) for point in points]
        known = [(rtol, value) for rtol, value in found if value]
        if known:
            axes.plot(*zip(*known, strict=True), f"-{mark}", color=colour, ms=4, lw=1.2, label=name)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.invert_xaxis()
    _finish(axes, title, "relative tolerance", "error")


def draw_cheapest(axes: Axes, record: Data) -> None:
    """Draw the time of the cheapest setting for each limit."""
    for place, entry in enumerate(record["best"]):
        if entry["method"] is None:
            axes.annotate("none", (place, 0.02), xycoords=("data", "axes fraction"), ha="center", fontsize=9)
            continue
        axes.bar(place, entry["seconds"] / record["t_end"], color=STYLES[entry["method"]][0], width=0.7)
        text = f"{entry['method']}\nrtol {entry['rtol']:.1e}\n{entry['real_time_factor']:.2g} x real time"
        axes.annotate(
            text, (place, entry["seconds"] / record["t_end"]), xytext=(0, 3), textcoords="offset points", ha="center",
            va="bottom", fontsize=8,
        )  # fmt: skip
    axes.set_xticks(range(len(record["best"])), [f"{100 * entry['error']:g} %" for entry in record["best"]])
    axes.margins(y=0.3)
    _finish(axes, "Cheapest setting for an error", _label(record), "seconds a simulated second")


def draw_phases(axes: Axes, record: Data) -> None:
    """Draw what a run takes from nothing and from the store, phase by phase."""
    phases = record["phases"] or {}
    names = ["start", *PHASES]
    for place, (run, colour) in enumerate((("cold", BLUE), ("warm", ORANGE))):
        seconds = phases.get(run)
        if seconds is None:
            continue
        spots = [number + 0.4 * place - 0.2 for number in range(len(names))]
        word = {"cold": "from nothing", "warm": "from the store"}[run]
        values = [seconds[name] for name in names]
        axes.barh(spots, values, 0.38, color=colour, label=f"{word}: {seconds['total']:.2f} s")
        for spot, value in zip(spots, values, strict=True):
            axes.annotate(
                f"{value:.2f}", (value, spot), xytext=(3, 0), textcoords="offset points", va="center", fontsize=7
            )
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.5, -0.5)
    _finish(axes, f"Phases of a run of {record['t_end']:g} s", "seconds", "")


PANELS = {
    "error-time": draw_error_time,
    "error-calls": draw_error_calls,
    "tolerance": draw_tolerance,
    "kinds": draw_kinds,
    "cheapest": draw_cheapest,
    "phases": draw_phases,
}
"""File name -> what draws it."""
