"""Figures of the page in addition to the paper's."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..plots import BLUE, GREEN, GREY, ORANGE, PURPLE, VERMILLION, make_canvas

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from ...linear.response import Response

COLOURS = {"assumed": BLUE, "fitted": VERMILLION}
STAGES = {"lsp": GREEN, "hsp": ORANGE, "psh": PURPLE}
MICRON = 1e-6
MESHES = {"lsp.sun_planet.1": "lsp", "hsp.sun_planet.1": "hsp", "psh.mesh": "psh"}
BLOCK = 0.25
"""Length of the parts of a run whose means and extremes are compared [s]."""


def draw_response(responses: Mapping[str, "Response"], meshes: Mapping[str, float]) -> "Figure":
    """Draw what a micrometre of error in the HSP sun mesh makes of the last mesh's force, over frequency.

    Parameters
    ----------
    responses
        By rig, to the error of one mesh.
    meshes
        Mesh frequencies [Hz], whose harmonics are marked.
    """
    figure = make_canvas(9.0, 4.2)
    axes = figure.add_subplot()
    for rig, response in responses.items():
        force = np.abs(response.of("mesh_force", "psh.mesh")) * MICRON / 1e3
        axes.semilogy(response.frequency, force, color=COLOURS[rig], lw=1.2, label=f"rig as {rig}")
    top = max(float(response.frequency[-1]) for response in responses.values())
    for stage, frequency in meshes.items():
        orders = np.arange(1, (5 if stage == "lsp" else int(top / frequency)) + 1) * frequency
        for k, value in enumerate(orders[orders <= top]):
            label = f"harmonics of {stage}" if k == 0 else None
            axes.axvline(float(value), color=STAGES[stage], lw=0.9, ls=":", label=label)
    axes.set_title("Force of the PSH mesh per micrometre of error in one HSP sun mesh", loc="left", fontsize=11)
    _finish(axes, "frequency [Hz]", "amplitude [kN/um]")
    return figure


def draw_transient(dataset: "xr.Dataset", step_s: float, means: Mapping[str, float]) -> "Figure":
    """Draw mesh forces while the load steps from a half to the whole.

    Parameters
    ----------
    dataset
        Result of the rig.
    step_s
        Instant of the step [s].
    means
        Mean force at the whole load by mesh [N].
    """
    figure = make_canvas(9.0, 4.2)
    axes = figure.add_subplot()
    time = dataset["time"].values
    for mesh in sorted(MESHES, key=lambda name: name != "hsp.sun_planet.1"):  # the liveliest behind the others
        force = np.abs(dataset["mesh_force"].sel(mesh=mesh).values)
        axes.plot(time, force / means[mesh], lw=0.7, color=STAGES[MESHES[mesh]], label=mesh)
    axes.axvline(step_s, color="black", lw=0.8, ls="--", label="load from 50 % to 100 %")
    axes.set_title(
        "A step of the generator's torque: mesh forces over their means at full load", loc="left", fontsize=11
    )
    _finish(axes, "time [s]", "force over mean [1]")
    return figure


def draw_continuous(datasets: Mapping[str, "xr.Dataset"]) -> "Figure":
    """Draw mean and extremes of mesh forces in successive parts of long runs."""
    figure = make_canvas(9.0, 4.2)
    panels = figure.subplots(1, len(MESHES))
    for axes, mesh in zip(panels, MESHES, strict=True):
        for rig, dataset in datasets.items():
            middle, low, mean, high = split_run(dataset, mesh)
            axes.plot(middle, mean, color=COLOURS[rig], lw=1.4, label=f"mean, {rig}")
            axes.fill_between(middle, low, high, color=COLOURS[rig], alpha=0.18, lw=0, label=f"min to max, {rig}")
        axes.set_title(mesh, loc="left", fontsize=10)
        axes.set_xlabel("time [s]")
        axes.grid(alpha=0.25, lw=0.5)
        axes.spines[["top", "right"]].set_visible(False)
    panels[0].set_ylabel("mesh force [10⁵ N]")
    handles, labels = panels[-1].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False, fontsize=9)
    figure.suptitle(f"Continuous running: each {BLOCK:g} s of a run by itself", x=0.01, ha="left", fontsize=11)
    return figure


def split_run(dataset: "xr.Dataset", mesh: str) -> tuple["NDArray[np.float64]", ...]:
    """Return middle [s], lowest, mean and highest force [1e5 N] of successive parts of a run."""
    time = dataset["time"].values
    force = np.abs(dataset["mesh_force"].sel(mesh=mesh).values) / 1e5
    count = max(int(float(time[-1] - time[0]) / BLOCK), 1)
    times, parts = np.array_split(time, count), np.array_split(force, count)
    rows = [(t.mean(), part.min(), part.mean(), part.max()) for t, part in zip(times, parts, strict=True)]
    return tuple(np.array(column) for column in zip(*rows, strict=True))


def draw_floating(shares: Mapping[str, Sequence[float]]) -> "Figure":
    """Draw the planets' shares of the load with one pin out of place, by how the sun is held."""
    figure = make_canvas(9.0, 3.6)
    axes = figure.add_subplot()
    width = 0.8 / len(shares)
    for k, ((name, values), colour) in enumerate(zip(shares.items(), (BLUE, ORANGE), strict=False)):
        places = np.arange(1, len(values) + 1) + (k - (len(shares) - 1) / 2) * width
        axes.bar(places, np.array(values) - 1, width, bottom=1.0, color=colour, label=name)
    axes.axhline(1.0, color="black", lw=0.8)
    axes.set_xticks(range(1, len(values) + 1))
    axes.set_title("LSP, one pin 50 um out of place: load of each planet", loc="left", fontsize=11)
    _finish(axes, "planet", "mean force over that of all [1]")
    return figure


def draw_fit(unknowns: Sequence[Mapping[str, Any]]) -> "Figure":
    """Draw assumed and fitted values between their bounds, with what the fit leaves uncertain."""
    figure = make_canvas(9.0, 0.9 + 0.32 * len(unknowns))
    axes = figure.add_subplot()
    for k, item in enumerate(unknowns):
        at, assumed, low, high = (_part(item, item[key]) for key in ("fitted", "assumed", "from", "to"))
        alone = [_part(item, value) for value in item["alone"]]
        axes.plot([0, 1], [k, k], color=GREY, lw=0.8, label="bounds" if k == 0 else None)
        axes.plot([low, high], [k, k], color=VERMILLION, lw=3.0, alpha=0.5, label="linearised" if k == 0 else None)
        axes.plot(alone, [k, k], color=VERMILLION, lw=6.0, label="alone" if k == 0 else None)
        axes.plot([at], [k], "o", color=VERMILLION, label="fitted" if k == 0 else None)
        axes.plot([assumed], [k], "|", ms=12, mew=2, color=BLUE, label="assumed" if k == 0 else None)
    axes.set_yticks(range(len(unknowns)), [item["name"] for item in unknowns], fontsize=9)
    axes.invert_yaxis()
    axes.set_title("What was fitted, between its bounds", loc="left", fontsize=11)
    _finish(axes, "place between lower and upper bound (ratios where the number is a size)", "")
    return figure


def _part(item: Mapping[str, Any], value: float) -> float:
    """Return where a value lies between the bounds, 0..1."""
    low, high = item["low"], item["high"]
    if low <= 0:
        return float((value - low) / (high - low))
    return float(np.log(value / low) / np.log(high / low))


def _finish(axes: "Axes", x: str, y: str) -> None:
    """Give axes their labels, a light grid and a legend beside them."""
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.grid(alpha=0.25, lw=0.5)
    axes.spines[["top", "right"]].set_visible(False)
    axes.margins(x=0.01)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize=9)
