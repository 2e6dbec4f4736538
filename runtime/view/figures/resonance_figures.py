"""Figures of resonance: the Campbell diagram, and frequency responses."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...linear.campbell import SPEED
from ...model.ties import order_by_size
from ..plots import BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILLION, make_canvas, save_figure

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes

Data = dict[str, Any]
COLOURS = {
    "torsional": BLUE, "rotational": BLUE, "translational": GREEN, "planet": PURPLE, "mixed": ORANGE,
    "divergent": VERMILLION,
}  # fmt: skip
"""Colour of each class of modes."""
CURVES = (BLUE, VERMILLION, GREEN, ORANGE, PURPLE, SKY)
DASHES = ("-", "--", "-.", ":")
WIDE = 6.0
"""Ratio of the fastest mesh frequency to the slowest from which frequencies are drawn by their logarithm."""
NAMED = 8
"""Crossings and peaks that are numbered."""
SHOWN = 1e-6
"""Share of the largest amplitude down to which a panel reaches."""
STRONG = 1e-3
"""Share of the strongest crossing's force below which one is not marked."""
PANELS = (
    ("mesh force", ("mesh_force",)),
    ("bearing and pin force", ("bearing_force_x", "bearing_force_y", "pin_force_x", "pin_force_y")),
    ("coupling torque", ("coupling_torque",)),
)
"""Amplitudes that are drawn together."""


def draw_campbell(data: Data, path: Path) -> None:
    """Draw eigenfrequencies over speed or load, the orders, and their crossings.

    Parameters
    ----------
    data
        What ``ltcgear campbell --json`` prints.
    path
        File to write; its suffix is the format.
    """
    figure = make_canvas(10.5, 6.5)
    axes = figure.add_subplot()
    low, high = _limits(data, axes)
    values = np.array(data["values"])
    for mode in data["modes"]:
        frequency = np.array(mode["frequency_hz"], dtype=np.float64)
        axes.plot(values, frequency, color=COLOURS.get(mode["class"], SKY), lw=1.3)
    for kind in dict.fromkeys(mode["class"] for mode in data["modes"]):
        axes.plot([], [], color=COLOURS.get(kind, SKY), lw=1.3, label=f"{kind} mode")
    _draw_orders(axes, data, low, high)
    _mark_crossings(axes, data, low, high)
    name = "speed" if data["axis"] == SPEED else "load"
    axes.axvline(data["home"], color="black", lw=1.0, label=f"the scene's own {name}")
    axes.set_xlim(values[0], values[-1])
    axes.set_ylim(low, high)
    axes.set_title(f"{data['scene']}: eigenfrequencies over {name}, and orders of the meshes", loc="left", fontsize=11)
    axes.set_xlabel("speed of the reference [rpm]" if name == "speed" else f"load [{data['unit']}]")
    axes.set_ylabel("frequency in the carriers' frames [Hz]")
    axes.grid(alpha=0.25, lw=0.5, which="both" if axes.get_yscale() == "log" else "major")
    axes.legend(loc="upper left", bbox_to_anchor=(1.09, 1.0), frameon=False, fontsize=8)
    save_figure(figure, path, 130)


def _limits(data: Data, axes: Axes) -> tuple[float, float]:
    """Choose the frequencies that are shown, and how: what orders reach, and half as much again."""
    turns = data["turns_per_s"]
    home = turns[int(np.argmin(np.abs(np.array(data["values"]) - data["home"])))] or max(turns)
    meshes = [order["order"] * home for order in data["orders"] if order["harmonic"] == 1 and not order["side"]]
    reached = [order["order"] * home for order in data["orders"]]
    modes = [f for mode in data["modes"] for f in mode["frequency_hz"] if f]
    high = 1.5 * max(reached, default=max(modes, default=1.0))
    if meshes and max(meshes) > WIDE * min(meshes):
        axes.set_yscale("log")
        return 0.5 * min(meshes), high
    return 0.0, max(high, 1.2 * min(modes, default=1.0))


def _draw_orders(axes: Axes, data: Data, low: float, high: float) -> None:
    """Draw the lines of the orders, each with its name where it leaves the figure."""
    values = np.linspace(data["values"][0], data["values"][-1], 500)
    turns = np.interp(values, data["values"], data["turns_per_s"])
    for order in data["orders"]:
        driven = order["order"] * turns
        thin = bool(order["side"])
        axes.plot(values, driven, color=GREY, lw=0.5 if thin else 0.8, ls=":" if thin else "--")
        inside = np.flatnonzero((driven <= high) & (driven >= low))
        if thin or not len(inside):
            continue
        last = inside[-1]
        at_side = last == len(values) - 1
        place = (values[-1], driven[-1]) if at_side else (np.interp(high, driven, values), high)
        axes.annotate(
            order["name"], place, xytext=(4, 0) if at_side else (0, 3), textcoords="offset points", fontsize=8,
            ha="left" if at_side else "center", va="center" if at_side else "bottom", color="#444444",
            rotation=0 if at_side else 60, annotation_clip=False,
        )  # fmt: skip
    if data["orders"]:
        axes.plot([], [], color=GREY, lw=0.8, ls="--", label="order of a mesh")
    if any(order["side"] for order in data["orders"]):
        axes.plot([], [], color=GREY, lw=0.5, ls=":", label="sideband")


def _mark_crossings(axes: Axes, data: Data, low: float, high: float) -> None:
    """Mark the crossings that excite, and number the strongest."""
    shown = [c for c in data["crossings"] if low <= c["frequency_hz"] <= high and not _weak(c, data)]
    for crossing in shown:
        axes.plot(
            crossing["at"], crossing["frequency_hz"], "o", color=VERMILLION, ms=3.5, mec="white", mew=0.4, zorder=3
        )
    if shown:
        axes.plot([], [], "o", color=VERMILLION, ms=3.5, label="crossing that excites")
    unit = " rpm" if data["axis"] == SPEED else " times the load"
    for number, crossing in enumerate(shown[:NAMED], start=1):
        axes.annotate(
            str(number), (crossing["at"], crossing["frequency_hz"]), xytext=(4, 4), textcoords="offset points",
            fontsize=8, fontweight="bold",
        )  # fmt: skip
        axes.plot(
            [],
            [],
            " ",
            label=f"{number}: {crossing['crossing']}\n    {crossing['at']:.4g}{unit}, {_strength(crossing)}",
        )


def _weak(crossing: Data, data: Data) -> bool:
    """Return whether an order hardly excites the mode it crosses."""
    key = "force" if any(c["force"] for c in data["crossings"]) else "force_per_um"
    if crossing["force_per_um"] is None:
        return False
    if not crossing["force_per_um"]:
        return True
    top = max((c[key] or 0.0 for c in data["crossings"]), default=0.0)
    return not (crossing[key] or 0.0) > STRONG * top


def _strength(crossing: Data) -> str:
    """Write how strongly a crossing excites."""
    if crossing["force_per_um"] is None:
        return "no damping"
    if crossing["force"]:
        return f"{crossing['force'] / 1e3:.3g} kN"
    return f"{crossing['force_per_um'] / 1e3:.3g} kN/µm"


def draw_response(data: Data, path: Path) -> None:
    """Draw amplitudes and phase of a frequency response; peaks are named with their modes.

    Parameters
    ----------
    data
        What ``ltcgear response --json`` prints.
    path
        File to write; its suffix is the format.
    """
    panels = [(name, _strongest(data, quantities)) for name, quantities in PANELS]
    panels = [(name, curves) for name, curves in panels if curves]
    figure = make_canvas(10.5, 2.2 + 2.6 * len(panels))
    grid = figure.subplots(1 + len(panels), 1, sharex=True, squeeze=False)[:, 0]
    places = [0, *range(2, 1 + len(panels))]
    for place, (name, curves) in zip(places, panels, strict=True):
        _draw_amplitudes(grid[place], data, name, curves)
    if panels:
        _draw_phases(grid[1], data, panels[0][1])
        _name_peaks(grid[0], data, panels[0][1][0])
    what = "transmission error" if data["unit"] == "m" else "torque ripple"
    grid[0].set_title(f"{data['scene']}: response to a {what} of {data['excited']}", loc="left", fontsize=11)
    grid[-1].set_xlabel("frequency [Hz]")
    for axes in grid:
        axes.grid(alpha=0.25, lw=0.5, which="both")
        if axes.get_legend_handles_labels()[0]:
            axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize=8)
    save_figure(figure, path, 130)


def _strongest(data: Data, quantities: tuple[str, ...]) -> list[Data]:
    """Return the outputs of some quantities with the largest amplitudes, one of equal planets.

    What the excited mesh shows comes first.
    """
    outputs = [
        output for output in data["outputs"] if output["quantity"] in quantities and max(output["amplitude"]) > 0
    ]
    order = order_by_size([max(output["amplitude"]) for output in outputs], [output["item"] for output in outputs])
    outputs = sorted((outputs[k] for k in order), key=lambda output: bool(output["item"] != data["excited"]))
    top = max((max(output["amplitude"]) for output in outputs), default=0.0)
    chosen: dict[str, Data] = {}
    for output in (output for output in outputs if max(output["amplitude"]) > SHOWN * top):
        chosen.setdefault(output["item"] if output["item"] == data["excited"] else output["group"], output)
    return list(chosen.values())[: len(CURVES)]


def _draw_amplitudes(axes: Axes, data: Data, name: str, curves: list[Data]) -> None:
    """Draw amplitudes over a micrometre, or over a newton metre."""
    micro = data["unit"] == "m"
    for number, (colour, output) in enumerate(zip(CURVES, curves, strict=False)):
        values = np.array(output["amplitude"]) * (1e-6 if micro else 1.0)
        label = output["item"] + {"_x": ", x", "_y": ", y"}.get(output["quantity"][-2:], "")
        axes.loglog(data["frequency_hz"], values, DASHES[number % len(DASHES)], color=colour, lw=1.2, label=label)
    unit = curves[0]["unit"].split("/")[0].replace("*", " ")
    axes.set_ylabel(f"{name}\n[{unit} over {'1 µm' if micro else '1 N m'}]", fontsize=9)
    top = max(max(output["amplitude"]) for output in curves) * (1e-6 if micro else 1.0)
    axes.set_ylim(top * SHOWN, top * 3)


def _draw_phases(axes: Axes, data: Data, curves: list[Data]) -> None:
    """Draw the phases of the curves of the first panel."""
    for number, (colour, output) in enumerate(zip(CURVES, curves, strict=False)):
        phase = np.array(output["phase_deg"])
        phase[1:][np.abs(np.diff(phase)) > 180] = np.nan  # no stroke across the figure where it wraps
        axes.plot(data["frequency_hz"], phase, DASHES[number % len(DASHES)], color=colour, lw=1.0)
    axes.set_ylim(-185, 185)
    axes.set_yticks([-180, -90, 0, 90, 180])
    axes.set_ylabel("phase of the\nabove [deg]", fontsize=9)


def _name_peaks(axes: Axes, data: Data, output: Data) -> None:
    """Mark the peaks of the first curve by numbers; the legend names their modes."""
    scale = 1e-6 if data["unit"] == "m" else 1.0
    heights = np.interp([peak["frequency_hz"] for peak in output["peaks"]], data["frequency_hz"], output["amplitude"])
    visible = [pair for pair in zip(output["peaks"], heights, strict=True) if pair[1] > SHOWN * heights.max()]
    for number, (peak, height) in enumerate(visible[:NAMED], start=1):
        place = (peak["frequency_hz"], scale * height)
        axes.annotate(
            str(number), place, xytext=(0, 3), textcoords="offset points", ha="center", va="bottom", fontsize=8,
            fontweight="bold",
        )  # fmt: skip
        label = f"{number}: {peak['frequency_hz']:.1f} Hz"
        if peak["mode"] is not None:
            mode = data["modes"][peak["mode"] - 1]
            label += f", mode {peak['mode']} ({mode['class']})"
        axes.plot([], [], " ", label=label)
