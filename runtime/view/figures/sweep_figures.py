"""Figures of sweeps: distributions, responses over one axis or two, spectra over an axis, Sobol indices."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from ltcgear.generated.errors import LtcgearError
from numpy.typing import NDArray

from ...analysis.waterfall import Waterfall
from ...model.ties import order_by_size
from ...results.amplitude_spectrum import noise_bandwidth
from ...results.train_record import read_train
from ...studies.sweep.influence import FLAT, SobolIndices, find_influences
from ...studies.sweep.sweep_axes import SweepAxis
from ...studies.sweep.sweep_reading import (
    WARNINGS,
    FloatArray,
    SweepNumbers,
    choose_shown,
    design_of,
    is_done,
    is_warned,
    is_whole,
    list_numbers,
    list_spectra,
    tell_warned,
)
from ..plots import VERMILLION, finish_axes, make_canvas
from .drawing import HEIGHT, WIDTH, dash_of, label_axes, scale_of, style_of
from .influence_figures import PANELS, draw_influences
from .spectrum_figures import ROWS, draw_waterfall

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from xarray import Dataset

BINS = 40
SHIFT = 0.06
"""Distance of points that belong to one word [distance of words]."""
HARMONICS = 3
"""Harmonics of each mesh that are drawn over a waterfall."""
CLOSE = 4.0
"""Multiples of the highest mesh frequency up to which a waterfall is drawn."""


def draw_sweep(dataset: Dataset) -> dict[str, Figure]:
    """Draw a sweep as suits its design.

    One axis that brings its points gives responses and, of spectra, waterfalls; two give maps; drawn points give
    distributions, crossed with one axis medians and quantiles over it, and those of ``saltelli`` Sobol indices too.

    Parameters
    ----------
    dataset
        A sweep.

    Returns
    -------
    dict
        Name of the figure, fit for a file -> figure.
    """
    design, metrics = design_of(dataset), choose_shown(dataset)
    crossed = [axis for axis in design.varied if axis.crossed]
    drawn = len(crossed) < len(design.varied)
    chosen = {(1, False): draw_response, (1, True): draw_bands}
    if is_whole(dataset):
        chosen[2, False] = draw_map
    draw = chosen.get((len(crossed), drawn), draw_distribution)
    figures = {_file_name(name): draw(dataset, name) for name in metrics if _has_numbers(dataset, name)}
    if len(crossed) == 1 and not drawn and _is_numeric(dataset, crossed[0]) and is_done(dataset).any():
        figures |= {_file_name(name): draw_spectra(dataset, name) for name in list_spectra(dataset)}
    if design.sample == "saltelli":
        figures |= _draw_influences(dataset, metrics)
    for figure in figures.values():
        figure.supxlabel("; ".join(tell_warned(dataset)), fontsize=8, color=VERMILLION)
    return figures


def _file_name(name: str) -> str:
    """Return a metric's name as a file may have it."""
    return name.replace(":", "-")


def _has_numbers(dataset: Dataset, metric: str) -> bool:
    """Say whether any run gave the metric."""
    return any(np.isfinite(number.values).any() for number in list_numbers(dataset, [metric]))


def _is_numeric(dataset: Dataset, axis: SweepAxis) -> bool:
    """Say whether an axis has numbers, not words."""
    return dataset[axis.key].dtype.kind in "fiu"


def _numbers_of(dataset: Dataset, metric: str) -> list[SweepNumbers]:
    """Return a metric's numbers, what is of failed runs as NaN."""
    done = is_done(dataset)
    return [
        SweepNumbers(one.metric, one.item, one.unit, one.words, np.where(done, one.values, np.nan))
        for one in list_numbers(dataset, [metric])
    ]


def _grouped(dataset: Dataset, metric: str) -> list[list[SweepNumbers]]:
    """Return a metric's numbers by the group of their items, ``lsp.sun_planet``, the first few groups."""
    train, groups = read_train(dataset), dict[str, list[SweepNumbers]]()
    for one in _numbers_of(dataset, metric):
        groups.setdefault(train.group(one.item), []).append(one)
    some = [[one for one in own if np.isfinite(one.values).any()] for own in groups.values()]
    return [own for own in some if own][:PANELS]


def _scaled(numbers: list[SweepNumbers]) -> tuple[list[FloatArray], str]:
    """Return values in a handy unit, and what an axis says of them."""
    size, unit = scale_of(numbers[0].unit, max(float(np.nanmax(np.abs(one.values))) for one in numbers))
    metric = numbers[0].metric
    name = metric if ":" in metric else metric.replace("_", " ")
    return [one.values / size for one in numbers], f"{name} [{unit}]"


def _title(words: str) -> str:
    """Return words with a capital first."""
    return words[:1].upper() + words[1:]


def _varied(dataset: Dataset, axis: SweepAxis) -> str:
    """Return what an axis says."""
    unit = dataset[axis.key].attrs.get("units", "")
    return f"{axis.key} [{unit}]" if unit else axis.key


def draw_distribution(dataset: Dataset, metric: str) -> Figure:
    """Draw how a metric is spread over the points: how many runs, and which share stays below.

    Parameters
    ----------
    dataset
        A sweep.
    metric
        A variable with a number or with items.
    """
    groups = _grouped(dataset, metric)
    figure = make_canvas(1.3 * WIDTH, HEIGHT * (0.2 + 0.8 * len(groups)))
    for own, (counted, summed) in zip(groups, figure.subplots(len(groups), 2, squeeze=False), strict=True):
        _draw_spread(counted, summed, own)
    for axes, title in zip(figure.axes, (_title(groups[0][0].words), _told(dataset)), strict=False):
        axes.set_title(title, loc="left", fontsize=11)
    return figure


def _bins(values: FloatArray, count: int) -> FloatArray:
    """Return the edges of equal bins over some values; what varies by rounding only does not fill them."""
    low, high = float(values.min()), float(values.max())
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    half = max(half, FLAT * abs(middle)) or 0.5
    return np.linspace(middle - half, middle + half, count + 1)


def _draw_spread(counted: Axes, summed: Axes, own: list[SweepNumbers]) -> None:
    """Draw the histograms of a group and their sums."""
    values, label = _scaled(own)
    kept = [some[np.isfinite(some)] for some in values]
    runs = max(some.size for some in kept)
    edges = _bins(np.concatenate(kept), min(BINS, max(8, 2 * int(np.sqrt(runs)))))
    for number, (one, some) in enumerate(zip(own, kept, strict=True)):
        style = _style(number, len(own))
        counted.stairs(np.histogram(some, edges)[0], edges, **style)
        places = np.sort(some)[[0, *range(some.size)]]
        share = np.arange(some.size + 1) / some.size
        summed.step(places, share, label=one.item or one.metric, where="post", **style)
    label_axes(counted, "", label, "runs")
    label_axes(summed, "", label, "share of runs below [1]")
    for axes in (counted, summed):
        finish_axes(axes)


def _style(number: int, count: int) -> dict[str, Any]:
    """Return how one of some curves is drawn: opposite planets may lie on each other, so one is thin and dashed."""
    colour, dash = style_of(number)
    dash = dash if count > 6 else dash_of(number, count)
    return {"color": colour, "ls": dash, "lw": 1.2 if dash == "--" or count < 3 else 2.2}


def _told(dataset: Dataset) -> str:
    """Say how many runs are shown."""
    done = is_done(dataset)
    design = design_of(dataset)
    failed = f", {int((~done).sum())} more failed" if not done.all() else ""
    return f"{int(done.sum())} runs{failed}, {design.sample}"


def draw_response(dataset: Dataset, metric: str) -> Figure:
    """Draw a metric over the one axis that is varied, a line for each item."""
    axis, warned = design_of(dataset).varied[0], is_warned(dataset)

    def plot(axes: Axes, place: FloatArray, values: FloatArray, **style: Any) -> None:  # noqa: ANN401
        axes.plot(place, values, **style)
        _mark(axes, place[warned], values[warned])

    return _draw_over(dataset, metric, axis, dataset[axis.key].values, plot)


def _mark(axes: Axes, x: FloatArray, y: FloatArray) -> None:
    """Mark points whose runs are warned about."""
    known = np.isfinite(x) & np.isfinite(y)
    if known.any():
        axes.plot(x[known], y[known], ls="none", marker="x", ms=8.0, color="black", gid=WARNINGS)


def draw_bands(dataset: Dataset, metric: str) -> Figure:
    """Draw a metric over the one axis with its own points: median, and 5 to 95 % of what is drawn of the others."""
    axis = next(axis for axis in design_of(dataset).varied if axis.crossed)
    levels, member = np.unique(dataset[axis.key].values, return_inverse=True)

    def plot(axes: Axes, place: FloatArray, values: FloatArray, **style: Any) -> None:  # noqa: ANN401
        low, middle, high = np.array([_quantiles(values[member == level]) for level in range(levels.size)]).T
        axes.errorbar(place, middle, [middle - low, high - middle], capsize=3.0, elinewidth=0.9, **style)

    figure = _draw_over(dataset, metric, axis, levels, plot)
    figure.axes[0].set_title(f"{figure.axes[0].get_title(loc='left')}, median and 5 to 95 %", loc="left", fontsize=11)
    return figure


def _quantiles(values: FloatArray) -> FloatArray:
    """Return the 5, 50 and 95 % quantiles; NaN where there are no values."""
    kept = values[np.isfinite(values)]
    return np.quantile(kept, [0.05, 0.5, 0.95]) if kept.size else np.full(3, np.nan)


def _draw_over(
    dataset: Dataset, metric: str, axis: SweepAxis, levels: NDArray[Any], plot: Callable[..., None]
) -> Figure:
    """Draw a metric over the values of an axis, a panel for each group."""
    groups = _grouped(dataset, metric)
    figure = make_canvas(WIDTH, HEIGHT * (0.3 + 0.7 * len(groups)))
    words = not _is_numeric(dataset, axis)
    place = np.arange(levels.size) if words else levels
    for panel, (own, axes) in enumerate(zip(groups, figure.subplots(len(groups), 1, squeeze=False).flat, strict=True)):
        values, label = _scaled(own)
        for number, (one, some) in enumerate(zip(own, values, strict=True)):
            style = _style(number, len(own)) | {"marker": ".", "label": one.item or metric}
            if words:  # side by side, since their points would hide each other
                style |= {"ls": "none", "ms": 9.0}
            shift = SHIFT * (number - 0.5 * (len(own) - 1)) if words else 0.0
            plot(axes, place + shift, some, **style)
        if words:
            axes.set_xticks(place, [str(level) for level in levels])
        title = "" if panel else _title(own[0].words)
        label_axes(axes, title, _varied(dataset, axis) if panel == len(groups) - 1 else "", label)
        finish_axes(axes)
    return figure


def draw_map(dataset: Dataset, metric: str) -> Figure:
    """Draw a metric of a finished sweep over the two axes that vary, a panel for each item, those that vary most."""
    design = design_of(dataset)
    one, other = design.varied
    marked = [design.values[is_warned(dataset), design.axes.index(axis)] for axis in design.varied]
    known = [one for one in _numbers_of(dataset, metric) if np.isfinite(one.values).any()]
    order = order_by_size([np.nanmax(one.values) - np.nanmin(one.values) for one in known])
    numbers = [known[k] for k in order[:PANELS]]
    values, label = _scaled(numbers)
    low, high = min(np.nanmin(some) for some in values), max(np.nanmax(some) for some in values)
    columns = min(len(numbers), 2)
    rows = -(-len(numbers) // columns)
    figure = make_canvas(WIDTH * (0.75 + 0.35 * (columns - 1)), HEIGHT * (0.4 + 0.6 * rows))
    panels = figure.subplots(rows, columns, squeeze=False)
    shape = one.places.size, other.places.size
    for axes, number, some in zip(panels.flat, numbers, values, strict=False):
        image = axes.pcolormesh(*_edges(one, other), some.reshape(shape).T, vmin=low, vmax=high, cmap="cividis")
        _mark(axes, *marked)
        label_axes(axes, number.item or metric, _varied(dataset, one), _varied(dataset, other))
        _name_places(axes, one, other)
    for axes in panels.flat[len(numbers) :]:
        axes.set_visible(False)
    figure.colorbar(image, ax=panels.ravel().tolist(), label=label)
    figure.suptitle(_title(numbers[0].words), x=0.01, ha="left", fontsize=11)
    return figure


def _edges(*axes: SweepAxis) -> list[FloatArray]:
    """Return the edges of an axis' cells, halfway between its points; lists are at whole numbers."""
    found = []
    for axis in axes:
        places = axis.places
        middle = 0.5 * (places[1:] + places[:-1])
        half = 0.5 * (places[1] - places[0]) if places.size > 1 else 0.5
        found.append(np.concatenate([[places[0] - half], middle, [places[-1] + half]]))
    return found


def _name_places(axes: Axes, one: SweepAxis, other: SweepAxis) -> None:
    """Write a list's values at its places."""
    if one.items:
        axes.set_xticks(one.places, one.items)
    if other.items:
        axes.set_yticks(other.places, other.items)


def draw_spectra(dataset: Dataset, metric: str, highest: float | None = None) -> Figure:
    """Draw spectra over the one axis that is varied, with the harmonics of the meshes: a Campbell diagram by runs.

    If the axis is a speed, lines of mesh orders are inclined, and those of eigenfrequencies vertical.

    Parameters
    ----------
    dataset
        A sweep over numbers.
    metric
        A spectrum, ``spectrum:acceleration:lsp.sun``.
    highest
        Where the frequency axis ends [Hz]; at `CLOSE` times the highest mesh frequency where left out.
    """
    axis = design_of(dataset).varied[0]
    rows = is_done(dataset)
    amplitude = dataset[metric].transpose("point", "frequency").values[rows]
    place = dataset[axis.key].values[rows]
    if not rows.any():
        raise LtcgearError(f"{metric}: no run came to its end, so there is nothing to draw")
    order = np.argsort(place)[:: -(-place.size // ROWS)]
    courses = {}
    if "mesh_frequency" in dataset:
        found = dataset["mesh_frequency"].transpose("point", "gear_set")
        columns = found.values[rows][order].T
        courses = dict(zip(map(str, found["gear_set"].values), columns, strict=True))
    frequency = dataset["frequency"].values
    top = max((float(course.max()) for course in courses.values()), default=0.0)
    end = min(float(frequency[-1]), CLOSE * top if top > 0.0 else np.inf) if highest is None else highest
    words = str(dataset[metric].attrs["long_name"])
    fall = _as_waterfall(metric, words, str(dataset[metric].attrs["units"]), frequency, amplitude[order], place[order])
    return draw_waterfall(
        fall, courses, end, places=(place[order].astype(float), _varied(dataset, axis)), harmonics=HARMONICS
    )


def _as_waterfall(
    metric: str, words: str, unit: str, frequency: FloatArray, amplitude: FloatArray, place: FloatArray
) -> Waterfall:
    """Return the spectra of many runs as those of one run that goes through them."""
    spacing = float(frequency[1])
    count = 2 * (frequency.size - 1)
    return Waterfall(
        metric, words, unit, place, frequency, amplitude, 1.0 / spacing, "hann", spacing,
        noise_bandwidth("hann", count) * spacing, np.zeros(0),
    )  # fmt: skip


def _draw_influences(dataset: Dataset, metrics: list[str]) -> dict[str, Figure]:
    """Draw Sobol indices of some metrics; nothing where too many runs failed."""
    try:
        found = find_influences(dataset, metrics)
    except LtcgearError:
        return {}
    own = {metric: [one for one in found if one.metric == metric and one.first.size] for metric in metrics}
    return {f"sobol-{_file_name(metric)}": draw_influences(some) for metric, some in own.items() if _vary(some)}


def _vary(found: list[SobolIndices]) -> bool:
    """Say whether any of some numbers varies."""
    return any(np.isfinite(one.first).all() for one in found)
