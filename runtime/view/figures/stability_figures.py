"""Figures of stability: the chart over speed and variation, and multipliers about the unit circle."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from ltcgear.generated.errors import LtcgearError
from ltcgear.generated.writing import check_output, write_rows

from ...linear.chart import RPM, Chart
from ...linear.floquet import MARGIN
from ..plots import BLUE, GREY, ORANGE, VERMILLION, make_canvas, save_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ...linear.floquet import Floquet
    from ...linear.tongues import Tongue

SUFFIXES = (".csv", ".png", ".svg", ".pdf")
NAMED, DRAWN = 8, 16
"""Numbers of tongues that are labelled, and whose boundaries are drawn."""
LOWERED = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
KINDS = {"primary": ("-", BLUE), "combination": ("--", VERMILLION), "difference": (":", ORANGE)}


def check_file(path: Path, *sources: str) -> None:
    """Refuse a file that cannot be written or has no known format, before anything is computed."""
    check_output(path, *sources)
    if path.suffix not in SUFFIXES:
        raise LtcgearError(f"{path}: stability is written as {', '.join(SUFFIXES)}; name it {path.with_suffix('.png')}")


def write_chart(chart: Chart, title: str, path: Path) -> Path:
    """Write a chart as a CSV file or draw it, by the file's suffix."""
    if path.suffix != ".csv":
        return draw_chart(chart, title, path)
    rows = (
        (speed / RPM, base, variation, chart.largest[k, m], chart.growth[k, m], int(chart.stable[k, m]))
        for k, (speed, base) in enumerate(zip(chart.speeds, chart.base_hz, strict=True))
        for m, variation in enumerate(chart.variations)
    )
    head = ("speed [rpm]", "base frequency [Hz]", "variation", "largest multiplier", "growth [1/s]", "stable")
    return write_rows([head, *rows], path)


def write_multipliers(found: Floquet, title: str, path: Path) -> Path:
    """Write multipliers as a CSV file or draw them, by the file's suffix."""
    if path.suffix != ".csv":
        return draw_multipliers(found, title, path)
    rows = ((m.value.real, m.value.imag, m.growth, m.frequency_hz, m.mode or "") for m in found.multipliers)
    return write_rows([("real part", "imaginary part", "growth [1/s]", "frequency [Hz]", "mode"), *rows], path)


def draw_chart(chart: Chart, title: str, path: Path) -> Path:
    """Draw where small motions grow over speed and variation, with the first-order boundaries of the tongues."""
    figure, axes = _canvas(10.0, 5.4)
    if min(chart.largest.shape) < 2:
        _draw_line(axes, chart)
    else:
        growth = np.log(np.maximum(chart.largest, 1.0)).T
        shown = np.ma.masked_where(chart.stable.T, growth)
        mesh = axes.pcolormesh(
            chart.speeds / RPM, chart.variations, shown, cmap="YlOrBr", vmin=0.0,
            vmax=max(float(growth.max()), MARGIN), shading="nearest",
        )  # fmt: skip
        figure.colorbar(mesh, ax=axes, label="growth in a period, ln |µ| (white: stable)", pad=0.02)
        _draw_tongues(axes, chart)
        axes.set_ylabel("stiffness variation [times the scene's]")
        axes.set_ylim(chart.variations[0], chart.variations[-1])
    if len(chart.speeds) > 1:
        _scale_speeds(axes, chart)
    axes.set_title(title, loc="left", fontsize=11)
    _finish(axes)
    return save_figure(figure, path)


def _scale_speeds(axes: Axes, chart: Chart) -> None:
    """Give axes their speeds below and the frequencies that go with them above."""
    speeds, factor = chart.speeds / RPM, float(chart.base_hz[0] / chart.speeds[0] * RPM)
    axes.set_xlim(speeds[0], speeds[-1])
    axes.set_xlabel("speed of the reference [rpm]")
    above = axes.secondary_xaxis("top", functions=(partial(np.multiply, factor), partial(np.multiply, 1 / factor)))
    above.set_xlabel("Ω/2π, mesh frequency or one over the common period [Hz]")


def _draw_line(axes: Axes, chart: Chart) -> None:
    """Draw the largest multiplier along the one axis that has more than one value."""
    along_speed = chart.largest.shape[0] > 1
    x = chart.speeds / RPM if along_speed else chart.variations
    axes.plot(x, chart.largest.ravel(), color=BLUE, lw=1.2, label="largest multiplier")
    axes.axhline(1.0, color="black", lw=0.8, label="border of stability")
    axes.set_ylabel("largest |µ|")
    if not along_speed:
        axes.set_xlabel("stiffness variation [times the scene's]")


def _draw_tongues(axes: Axes, chart: Chart) -> None:
    """Draw the first-order boundaries of the widest tongues, the widest with their names, and where others begin."""
    v = np.linspace(chart.variations[0], chart.variations[-1], 400)
    wide = [tongue for tongue in chart.tongues if np.isfinite(tongue.half_width(v)).any()][:DRAWN]
    told: set[str] = set()
    for tongue in wide:
        half, kind = tongue.half_width(v) / RPM, tongue.resonance.kind
        seen, (dash, colour), middle = np.isfinite(half), KINDS[kind], abs(tongue.speed) / RPM
        speeds = np.concatenate([(middle - half[seen])[::-1], middle + half[seen]])
        heights = np.concatenate([v[seen][::-1], v[seen]])
        label = None if kind in told else f"first order, {kind}"
        axes.plot(speeds, heights, dash, color=colour, lw=1.0, label=label)
        told.add(kind)
    others = [abs(tongue.speed) / RPM for tongue in chart.tongues if tongue not in wide]
    if others:
        edge = axes.get_xaxis_transform()
        axes.plot(others, [0.0] * len(others), "|", color=GREY, ms=8, transform=edge, label="middles of others")
    for place, tongue in enumerate(sorted(wide[:NAMED], key=lambda tongue: abs(tongue.speed))):
        _name(axes, tongue, place)


def _name(axes: Axes, tongue: Tongue, place: int) -> None:
    """Write a tongue's name over its middle, neighbours at different heights."""
    axes.annotate(
        _in_symbols(tongue), (abs(tongue.speed) / RPM, 0.985 - 0.06 * (place % 4)),
        xycoords=axes.get_xaxis_transform(), ha="center", va="top", fontsize=8,
        bbox={"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.85}, annotation_clip=False,
    )  # fmt: skip


def _in_symbols(tongue: Tongue) -> str:
    """Write a resonance in symbols."""
    (i, j), n = tongue.resonance.modes, tongue.resonance.order
    first, second = (f"ω{mode}".translate(LOWERED) for mode in (i, j))
    sign = "−" if tongue.resonance.kind == "difference" else "+"  # noqa: RUF001
    left = f"2{first}" if tongue.resonance.kind == "primary" else f"{first} {sign} {second}"
    return f"{left} = {'' if n == 1 else n}Ω"


def draw_multipliers(found: Floquet, title: str, path: Path) -> Path:
    """Draw the multipliers about the unit circle."""
    figure, axes = _canvas(5.6, 5.6)
    angle = np.linspace(0.0, 2 * np.pi, 361)
    axes.plot(np.cos(angle), np.sin(angle), color=GREY, lw=1.0, label="unit circle: border of stability")
    for grows, colour, mark, label in ((False, BLUE, "o", "does not grow"), (True, VERMILLION, "^", "grows")):
        values = [m.value for m in found.multipliers if (np.log(abs(m.value)) > MARGIN) == grows]
        if values:
            both = np.array([*values, *np.conj(values)])
            axes.plot(both.real, both.imag, mark, color=colour, ms=6, mec="white", label=label)
    axes.set_aspect("equal")
    axes.set_xlabel("real part of µ")
    axes.set_ylabel("imaginary part of µ")
    axes.set_title(title, loc="left", fontsize=11)
    _finish(axes)
    return save_figure(figure, path)


def _canvas(width: float, height: float) -> tuple[Figure, Axes]:
    """Return an empty figure [in] outside pyplot's global state, and its axes."""
    figure = make_canvas(width, height)
    return figure, figure.add_subplot()


def _finish(axes: Axes) -> None:
    """Give axes a light grid and a legend below, where it hides nothing."""
    axes.grid(alpha=0.25, lw=0.5)
    handles, _ = axes.get_legend_handles_labels()
    if handles:
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=3, frameon=False, fontsize=9)
