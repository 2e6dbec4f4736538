"""Page of the paper: runs, modes and the record of the fit in one HTML file."""

import json
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import TYPE_CHECKING, Any

import numpy as np
from ltcgear.generated.writing import write_text

from ...analysis.lines import find_clues
from ...linear.response import respond
from ...results.statistics import steady_start, window
from ...studies.wu2021.comparison import compare, published
from ...studies.wu2021.line_origins import count_chance, tell_lines
from ...studies.wu2021.table9 import FACTOR_AIM, MEAN_AIM, tell_loads
from ..html import open_templates
from ..plots import draw_paper_figures
from ..report.theme import themed, write_svg
from .paper_figures import (
    COLOURS,
    MESHES,
    draw_continuous,
    draw_fit,
    draw_floating,
    draw_response,
    draw_transient,
    split_run,
)

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    import xarray as xr
    from matplotlib.figure import Figure

    from ...linear.modes import Mode
    from ...linear.system import Linear

ROOM, NEEDING = "ltcgear.runtime.view.wu2021", "the page of ltcgear paper (leave it out with --quick)"
EXCITED = "hsp.sun_planet.1"
RIPPLE = 0.1
"""Length of a mean that takes away the meshes' ripple but not the slowest mode [s]."""
LISTED = 15
"""How many of the lowest modes are listed."""
CAPTIONS = {
    9: "Printed: measured and simulated spectra of the front chassis, main lines as marked on the lower edge.",
    10: "Printed: measured and simulated spectra of the output shaft, main lines as marked on the lower edge.",
    11: "Printed: four curves about 3.34e5 N, between 2.95e5 and 3.73e5 N (Table 9).",
    12: "Printed: three curves about 0.97e5 N, between 0.61e5 and 1.33e5 N (Table 9).",
    13: "Printed: one curve about 1.09e5 N, between 0.80e5 and 1.38e5 N (Table 9).",
}
"""Content of the paper's figures, as far as its text and tables give it."""


@dataclass(frozen=True)
class PageContent:
    """What the page is made of.

    Attributes
    ----------
    datasets, linears, modes
        Long runs, linear systems and their named modes of the rig, by name: assumed, fitted.
    transient, step_s
        A run in which the load steps up, and when it does [s].
    shares
        Each planet's share of the load with a pin out of place, by how the sun is held.
    changes
        What was set in place of the scenes' values, KEY=VALUE.
    """

    datasets: "Mapping[str, xr.Dataset]"
    linears: "Mapping[str, Linear]"
    modes: "Mapping[str, Sequence[Mode]]"
    transient: "xr.Dataset"
    step_s: float
    shares: "Mapping[str, Sequence[float]]"
    changes: tuple[str, ...] = ()


@cache
def fitted() -> dict[str, Any]:
    """Read the record of the fit (``published/fitted.json``, written by ``benchmarks.identify``)."""
    source = resources.files("ltcgear.runtime.studies.wu2021") / "published" / "fitted.json"
    found: dict[str, Any] = json.loads(source.read_text(encoding="utf-8"))
    return found


def check_page() -> None:
    """Refuse before anything is computed where no page can be written.

    Raises
    ------
    LtcgearError
        If Jinja2 is missing.
    """
    open_templates(ROOM, NEEDING)


def write_page(material: PageContent, path: "Path") -> "Path":
    """Write the page; it appears whole or not at all."""
    return write_text(compose(material), path)


def compose(material: PageContent) -> str:
    """Return the page's HTML."""
    first = material.datasets["assumed"]
    start = steady_start(first)
    clues = find_clues(window(first, start))
    meshes, sources = clues.meshes, clues.sources
    loads = tell_loads(material.datasets, start)
    text: str = open_templates(ROOM, NEEDING).get_template("paper.html").render(
        published=published(), record=fitted(), loads=loads, aims=(MEAN_AIM, FACTOR_AIM), verdict=_verdict(loads),
        table7=compare(first, start)["table7"],
        lines=tell_lines(sources, material.modes, material.datasets, start),
        chance={rig: count_chance(sources, own) for rig, own in material.modes.items()},
        modes=_list_modes(material.modes), figures=_draw(material, meshes), captions=CAPTIONS, rigs=list(COLOURS),
        step=_tell_step(material), steady=_tell_steady(material), shares=material.shares,
        changes=material.changes, turns=_turns(first),
        meshes=meshes, below=sum(row["rigs"]["assumed"]["mean_off"] > 0 for row in loads),
        versions=first.attrs.get("ltcgear", ""), times=(start, float(first["time"][-1])),
    )  # fmt: skip
    return text


def _verdict(loads: list[dict[str, Any]]) -> dict[str, dict[str, float]]:
    """Return the largest distance from print of means and load factors, by rig."""
    return {
        rig: {key: max(abs(row["rigs"][rig][key]) for row in loads) for key in ("mean_off", "factor_off")}
        for rig in loads[0]["rigs"]
    }


def _list_modes(modes: "Mapping[str, Sequence[Mode]]") -> list[dict[str, Any]]:
    """Return the lowest modes of the rigs side by side, by number."""
    return [
        {
            rig: {"hz": own[k].frequency_hz, "damping": own[k].damping_ratio, "name": own[k].name}
            for rig, own in modes.items()
        }
        for k in range(min(LISTED, *(len(own) for own in modes.values())))
    ]


def _tell_step(material: PageContent) -> list[dict[str, Any]]:
    """Return how far mesh forces overshoot their means at full load after the step, ripple and all or without it."""
    time, means = material.transient["time"].values, _means(material.datasets["assumed"])
    after, ripple = time >= material.step_s, round(RIPPLE / float(time[1] - time[0]))
    rows = []
    for mesh in MESHES:
        force = np.abs(material.transient["mesh_force"].sel(mesh=mesh).values) / means[mesh]
        smooth = np.convolve(force, np.ones(ripple) / ripple, mode="same")[: len(force) - ripple]
        slow = float(smooth[after[: len(smooth)]].max())
        rows.append({"mesh": mesh, "peak": float(force[after].max()), "slow": slow})
    return rows


def _means(dataset: "xr.Dataset") -> dict[str, float]:
    """Return the mean force of each mesh in the second half of a run [N]."""
    steady = window(dataset)["mesh_force"]
    return {mesh: float(np.abs(steady.sel(mesh=mesh)).mean()) for mesh in MESHES}


def _tell_steady(material: PageContent) -> list[dict[str, Any]]:
    """Return how much load factors of successive parts of the second half of a run differ."""
    rows = []
    for rig, dataset in material.datasets.items():
        for mesh in MESHES:
            middle, _, mean, high = split_run(dataset, mesh)
            factors = (high / mean)[middle >= min(steady_start(dataset), middle[-1])]
            rows.append({"rig": rig, "mesh": mesh, "low": float(factors.min()), "high": float(factors.max())})
    return rows


def _turns(dataset: "xr.Dataset") -> dict[str, float]:
    """Return how often input and output turn in a run."""
    speed = dataset["speed"].mean("time")
    length = float(dataset["time"][-1] - dataset["time"][0])
    return {name: abs(float(speed.sel(rotor=name))) * length / (2 * np.pi) for name in ("lsp.ring", "psh.output")}


def _draw(material: PageContent, meshes: "Mapping[str, float]") -> dict[str, str]:
    """Draw all figures; return them as SVG by name."""
    with themed():
        frequency = np.linspace(10.0, 700.0, 691)
        drawn: dict[str, Figure] = {
            f"{rig}-{number}": figure
            for rig, dataset in material.datasets.items()
            for number, figure in draw_paper_figures(dataset).items()
        }
        drawn |= {
            "response": draw_response(
                {rig: respond(linear, EXCITED, frequency) for rig, linear in material.linears.items()}, meshes
            ),
            "transient": draw_transient(material.transient, material.step_s, _means(material.datasets["assumed"])),
            "continuous": draw_continuous(material.datasets),
            "floating": draw_floating(material.shares),
            "fit": draw_fit(fitted()["unknowns"]),
        }
        for figure in drawn.values():
            _number_plainly(figure)
        return {name: write_svg(figure, name, _label(figure)) for name, figure in drawn.items()}


def _number_plainly(figure: "Figure") -> None:
    """Write the numbers of logarithmic axes without raised exponents, which are no plain text."""
    for axes in figure.axes:
        if axes.get_yscale() == "log":
            axes.yaxis.set_major_formatter(lambda value, place: f"{value:g}")


def _label(figure: "Figure") -> str:
    """Return what a figure shows in words: its titles."""
    titles = [axes.get_title("left") for axes in figure.axes]
    return " ".join(title for title in (figure.get_suptitle(), *titles) if title)
