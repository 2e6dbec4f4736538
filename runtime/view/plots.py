"""Figures of a simulation like those of Wu et al. 2021."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from ltcgear.generated.text import write_out
from ltcgear.generated.writing import written_whole

from ..analysis.lines import find_clues
from ..results.rounding import without_rounding
from ..results.statistics import mesh_frequencies, pressure_angles, steady_start, window
from ..results.train_record import read_train
from ..studies.wu2021.comparison import PRINTED_FORCE, named_lines, position_spectrum, published

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..results.amplitude_spectrum import FloatArray, Line

#: Okabe and Ito's colours, told apart by colour-blind readers.
BLUE, VERMILLION, GREEN, PURPLE = "#0072B2", "#D55E00", "#009E73", "#CC79A7"
ORANGE, SKY, GREY = "#E69F00", "#56B4E9", "#777777"
LINE_COLOURS = (BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY)
_SPECTRUM_LIMIT = 1000.0  # [Hz]
_DECADES = 4
_NAMED = 6


@dataclass(frozen=True)
class _ForceFigure:
    """What a figure of mesh forces shows: `periods` of `clock`'s mesh."""

    number: int
    group: str
    title: str
    clock: str
    periods: float
    legend_word: str


@dataclass(frozen=True)
class _SpectrumFigure:
    """What a figure of an acceleration spectrum shows: row `row` of Table 8."""

    number: int
    member: str
    title: str
    measured: str
    simulated: str


_FORCES = (
    _ForceFigure(11, "lsp.sun_planet", "LSP: mesh force between sun and planets", "lsp", 6, "planet"),
    _ForceFigure(12, "hsp.sun_planet", "HSP: mesh force between sun and planets", "lsp", 3, "planet"),
    _ForceFigure(13, "psh.mesh", "PSH: mesh force between input and output", "psh", 30, "mesh"),
)
_SPECTRA = (
    _SpectrumFigure(9, "lsp.planet.1", "Front chassis: acceleration of an LSP planet", "Front chassis", "LSP: bearing"),
    _SpectrumFigure(10, "psh.output", "Output shaft: acceleration of the PSH output", "Output shaft", "output bearing"),
)


def paper_figures(dataset: xr.Dataset, directory: str | Path, fmt: str = "png") -> list[Path]:
    """Draw the counterparts of the paper's Figures 9 to 13.

    Parameters
    ----------
    dataset
        Simulation result; a figure whose meshes or members it lacks is left out.
    directory
        Folder for the files, made if need be.
    fmt
        File format that matplotlib knows (``"png"``, ``"svg"``, ``"pdf"``).

    Returns
    -------
    list of Path
        ``figure09.png`` ... ``figure13.png``, those that were drawn.
    """
    folder = Path(directory)
    folder.mkdir(parents=True, exist_ok=True)
    drawn = draw_paper_figures(dataset)
    return [save_figure(figure, folder / f"figure{number:02d}.{fmt}") for number, figure in drawn.items()]


def draw_paper_figures(dataset: xr.Dataset) -> dict[int, Figure]:
    """Draw the counterparts of the paper's Figures 9 to 13, by number; one that the result cannot give is left out."""
    drawn, dataset = {}, without_rounding(dataset)
    for spectrum in _SPECTRA:
        figure = make_canvas(9.0, 4.6)
        if _draw_spectrum(figure.add_subplot(), dataset, spectrum):
            drawn[spectrum.number] = figure
    for force in _FORCES:
        figure = make_canvas(9.0, 4.2)
        if _draw_forces(figure.add_subplot(), dataset, force):
            drawn[force.number] = figure
    return drawn


def overview_figure(dataset: xr.Dataset, path: str | Path) -> Path:
    """Draw one wide picture: three panels of mesh forces and one spectrum.

    Parameters
    ----------
    dataset
        Simulation result; a panel whose meshes or members it lacks stays blank.
    path
        File to write; its suffix is the format.

    Returns
    -------
    Path
        The file written.
    """
    figure = make_canvas(15.0, 7.5)
    grid = figure.add_gridspec(3, 2, width_ratios=(1.25, 1.0))
    for row, force in enumerate(_FORCES):
        axes = figure.add_subplot(grid[row, 0])
        if not _draw_forces(axes, dataset, force):
            axes.set_axis_off()
    axes = figure.add_subplot(grid[:, 1])
    if not _draw_spectrum(axes, dataset, _SPECTRA[1]):
        axes.set_axis_off()
    return save_figure(figure, Path(path))


def make_canvas(width: float, height: float) -> Figure:
    """Empty figure [in] on an Agg canvas, outside pyplot's global state."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def save_figure(figure: Figure, path: Path, dpi: float = 150) -> Path:
    """Write a figure; the suffix is the format. Text in SVG stays text, and equal figures give equal files."""
    from matplotlib import rc_context

    write_plainly(figure)
    meta = {"Date": None} if path.suffix == ".svg" else {"CreationDate": None} if path.suffix == ".pdf" else {}
    with rc_context({"svg.fonttype": "none", "svg.hashsalt": "ltcgear"}), written_whole(path) as draft:
        figure.savefig(draft, dpi=dpi, metadata=meta)
    return path


def write_plainly(figure: Figure) -> None:
    """Read no text of a figure as mathematics but the numbers of its axes: a name or a title may hold any sign."""
    from matplotlib.text import Text
    from matplotlib.ticker import LogFormatter, ScalarFormatter

    numbers: set[Text] = set()
    for axis in (axis for axes in figure.axes for axis in (axes.xaxis, axes.yaxis)):
        if isinstance(axis.get_major_formatter(), LogFormatter | ScalarFormatter):
            numbers |= set(axis.findobj(Text)) - {axis.label}
    found = set(figure.findobj(Text))
    for text in found:  # whatever a matplotlibrc of the surroundings asks for
        text.set_usetex(False)
    for text in found - numbers:
        text.set_parse_math(False)
        text.set_text(write_out(text.get_text(), keep="\n"))


def _draw_forces(axes: Axes, dataset: xr.Dataset, plan: _ForceFigure) -> bool:
    """Draw a group's mesh forces over a short steady window; False if there are none."""
    steady = window(dataset)
    if "mesh_force" not in steady:
        return False
    names = [str(mesh) for mesh in steady["mesh"].values if read_train(steady).group(str(mesh)) == plan.group]
    if not names:
        return False
    forces, component = _oriented_forces(dataset, steady, names)
    time = steady["time"].values - steady["time"].values[0]
    shown = time <= _span(dataset, plan, float(time[-1]))
    axes.axhspan(float(forces.min()), float(forces.max()), color=GREY, alpha=0.12, lw=0, label="min-max, steady part")
    for number, (colour, force) in enumerate(zip(LINE_COLOURS, forces.T, strict=False), start=1):
        label = f"{plan.legend_word} {number}" if len(names) > 1 else "simulated"
        dash = "-" if number <= (len(names) + 1) // 2 else "--"  # opposite planets mesh in phase and coincide
        axes.plot(1e3 * time[shown], force[shown], dash, color=colour, lw=1.2, label=label)
    axes.axhline(_printed_mean(plan.group), color="black", ls="--", lw=1.2, label="printed mean")
    axes.set_title(f"{plan.title} (cf. Fig. {plan.number})", loc="left", fontsize=11)
    axes.set_xlabel(f"time after {steady['time'].values[0]:.3f} s [ms]")
    axes.set_ylabel(f"{component} force [10⁵ N]")
    axes.margins(x=0.0)
    finish_axes(axes)
    return True


def finish_axes(axes: Axes) -> None:
    """Give axes a light grid, and a legend beside them, where it hides no curve, if anything has a label."""
    axes.grid(alpha=0.25, lw=0.5)
    axes.spines[["top", "right"]].set_visible(False)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize=9)


def _oriented_forces(dataset: xr.Dataset, steady: xr.Dataset, names: list[str]) -> tuple[FloatArray, str]:
    """Return forces, shape (n, meshes) [1e5 N], positive on the loaded flank, and which component."""
    forces = steady["mesh_force"].sel(mesh=names).transpose("time", "mesh").values / PRINTED_FORCE
    forces = forces * np.where(forces.mean(axis=0) < 0.0, -1.0, 1.0)
    angles = pressure_angles(dataset)
    if not all(name in angles for name in names):
        return forces, "normal"
    return forces * np.cos([angles[name] for name in names]), "tangential"


def _span(dataset: xr.Dataset, plan: _ForceFigure, longest: float) -> float:
    """Length of the time window shown [s]."""
    frequency = mesh_frequencies(dataset).get(plan.clock, 0.0) if "mesh_phase" in dataset else 0.0
    return min(longest, plan.periods / frequency) if frequency > 0.0 else longest


def _printed_mean(group: str) -> float:
    """Mean force that Table 9 prints for a mesh group [1e5 N]."""
    return next(float(row["mean"]) for row in published()["table9"]["rows"] if row["meshes"] == group)


def _draw_spectrum(axes: Axes, dataset: xr.Dataset, plan: _SpectrumFigure) -> bool:
    """Draw a member's acceleration spectrum with named lines; False if there is none."""
    found = position_spectrum(dataset, plan.member, steady_start(dataset))
    if found is None:
        return False
    signal, unit, frequency, amplitude = found
    shown = (frequency > 0.0) & (frequency <= _SPECTRUM_LIMIT)
    top = float(amplitude[shown].max()) or 1.0
    axes.semilogy(frequency[shown], amplitude[shown], color=BLUE, lw=0.9, label="simulated")
    _mark_printed(axes, plan)
    clues = find_clues(window(dataset))
    _number_lines(axes, named_lines(frequency, amplitude, clues.sources, _NAMED, _SPECTRUM_LIMIT))
    axes.set_ylim(top * 10.0**-_DECADES, top * 4.0)
    axes.set_xlim(0.0, _SPECTRUM_LIMIT)
    axes.set_title(f"{plan.title} (cf. Fig. {plan.number})", loc="left", fontsize=11)
    axes.set_xlabel("frequency [Hz]")
    axes.set_ylabel(f"amplitude of {signal.partition(' of ')[0]} [{unit.replace('^2', '²')}]")
    finish_axes(axes)
    return True


def _number_lines(axes: Axes, lines: list[tuple[Line, str]]) -> None:
    """Put numbers at the peaks; the legend names them, for names at the peaks would collide."""
    for number, (line, name) in enumerate(lines, start=1):
        place = (line.frequency_hz, line.amplitude)
        axes.annotate(
            str(number),
            place,
            xytext=(0, 3),
            textcoords="offset points",
            ha="center",
            va="bottom",
            fontsize=9,
        )
        label = f"{number}: {line.frequency_hz:.1f} Hz" + (f" = {name}" if name else "")
        axes.plot([], [], " ", label=label)


def _mark_printed(axes: Axes, plan: _SpectrumFigure) -> None:
    """Mark Table 8's frequencies [Hz] on the lower edge; it prints no amplitudes."""
    rows = published()["table8"]["rows"]
    measured = next(row["measured"] for row in rows if row["measured_position"] == plan.measured)
    simulated = next(row["simulated"] for row in rows if row.get("simulated_position") == plan.simulated)
    edge = axes.get_xaxis_transform()
    for values, height, colour, mark, label in (
        (measured, 0.02, VERMILLION, "^", "paper, measured"),
        (simulated, 0.06, GREEN, "v", "paper, simulated"),
    ):
        axes.plot(
            values,
            [height] * len(values),
            mark,
            color=colour,
            ms=7,
            mec="white",
            label=label,
            transform=edge,
            zorder=3,
        )
