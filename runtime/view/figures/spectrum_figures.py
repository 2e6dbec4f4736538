"""Figures of spectra: amplitudes and densities over frequency or order, envelopes, spectrograms and waterfalls."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...analysis.envelope import Envelope
from ...analysis.lines import NamedLine
from ...analysis.spectrum import Spectrum
from ...analysis.trace import FloatArray
from ...analysis.waterfall import Waterfall
from ..plots import BLUE, GREY, VERMILLION, finish_axes, make_canvas
from .drawing import HEIGHT, WIDTH, label_axes, open_axes, pool, scale_of, thin

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DECADES = 4
"""Decades of amplitude that a figure shows."""
HARMONICS = 3
"""Harmonics of each mesh that are drawn over a spectrogram."""
ROWS, PIXELS, POINTS = 24, 300, 160
"""Spectra in a waterfall, bins in a spectrogram's picture, points of a waterfall's spectrum, at most."""
STEADY = 0.02
"""Change of speed from which a waterfall goes by speed, where that only rises or only falls."""


def draw_spectrum(spectrum: Spectrum, lines: Sequence[NamedLine] = (), highest: float | None = None) -> Figure:
    """Draw a spectrum; lines are numbered at their peaks and named in the legend.

    Parameters
    ----------
    spectrum
        Amplitudes or a density, over frequency or order.
    lines
        From ``name_lines``.
    highest
        Where the axis ends [axis unit]; the spectrum's end where left out.
    """
    word = "Amplitude spectrum" if spectrum.kind == "amplitude" else "Power spectral density"
    x = "frequency [Hz]" if spectrum.axis_unit == "Hz" else f"order: cycles in a turn of {spectrum.shaft} [1]"
    figure, axes = open_axes(f"{word}: {spectrum.title}", x, "")
    _draw_curve(axes, spectrum, lines, highest)
    return figure


def _draw_curve(axes: Axes, spectrum: Spectrum, lines: Sequence[NamedLine], highest: float | None = None) -> None:
    """Draw a spectrum's curve, its lines, and with what it was taken."""
    end = float(spectrum.axis[-1]) if highest is None else highest
    shown = (spectrum.axis > 0.0) & (spectrum.axis <= end)
    density = spectrum.kind == "density"
    top = float(spectrum.value[shown].max())
    size, unit = (1.0, spectrum.unit) if density else scale_of(spectrum.unit, top)
    axes.plot(*thin(spectrum.axis[shown], spectrum.value[shown] / size), color=BLUE, lw=0.9, label=_made(spectrum))
    if top > 0.0:
        decades = 2 * DECADES if density else DECADES
        axes.set_yscale("log")
        axes.set_ylim(top / size * 10.0**-decades, top / size * 4.0)
    axes.set_xlim(0.0, end)
    axes.set_ylabel(f"{'density' if density else 'amplitude'} [{unit.replace('^2', '²')}]")
    number_lines(axes, [line for line in lines if line.place <= end], size, spectrum.axis_unit)
    finish_axes(axes)


def _made(spectrum: Spectrum) -> str:
    """Say with which window a spectrum was taken, and what it tells apart."""
    unit = " Hz" if spectrum.axis_unit == "Hz" else " orders"
    averaged = f"\n{spectrum.averaged} segments averaged" if spectrum.averaged > 1 else ""
    return (
        f"{spectrum.window} window, {spectrum.start_s:.4g} to {spectrum.stop_s:.4g} s\n"
        f"bins {spectrum.resolution:.3g}{unit} apart\nnoise bandwidth {spectrum.bandwidth:.3g}{unit}{averaged}"
    )


def number_lines(axes: Axes, lines: Sequence[NamedLine], size: float, axis_unit: str) -> None:
    """Put numbers at peaks; the legend names them, for names at the peaks would collide."""
    for number, line in enumerate(lines, start=1):
        axes.annotate(
            str(number), (line.place, line.amplitude / size), xytext=(0, 3), textcoords="offset points", ha="center",
            va="bottom", fontsize=8,
        )  # fmt: skip
        place = f"{line.place:.1f} Hz" if axis_unit == "Hz" else f"order {line.place:.3f}"
        axes.plot([], [], " ", label=f"{number}: {place}" + (f" = {_short(line.name)}" if line.name else ""))


def _short(name: str, longest: int = 44) -> str:
    """Shorten a name that would not leave room for the curve."""
    return name if len(name) <= longest else name[: longest - 3] + "..."


def draw_envelope(envelope: Envelope, lines: Sequence[NamedLine] = (), highest: float | None = None) -> Figure:
    """Draw the part of an output in a band with its envelope, and the envelope's spectrum.

    Parameters
    ----------
    envelope
        From ``find_envelope``.
    lines
        Of the envelope's spectrum.
    highest
        Where the spectrum's axis ends [Hz]; at the band's width where left out.
    """
    figure = make_canvas(WIDTH, 1.6 * HEIGHT)
    above, below = figure.subplots(2, 1)
    size, unit = scale_of(envelope.unit, float(envelope.value.max()))
    band = f"{envelope.low_hz:.4g} to {envelope.high_hz:.4g} Hz"
    label_axes(above, f"Envelope: {envelope.title}, {band}", "time [s]", f"in the band [{unit}]")
    above.plot(*thin(envelope.time, envelope.carrier / size), color=GREY, lw=0.6, label="in the band")
    above.plot(*thin(envelope.time, envelope.value / size), color=VERMILLION, lw=1.2, label="envelope")
    above.margins(x=0.0)
    finish_axes(above)
    label_axes(below, "Its amplitude spectrum", "frequency [Hz]", "")
    _draw_curve(below, envelope.spectrum, lines, envelope.high_hz - envelope.low_hz if highest is None else highest)
    return figure


def draw_spectrogram(
    waterfall: Waterfall, courses: Mapping[str, FloatArray] | None = None, highest: float | None = None
) -> Figure:
    """Draw amplitudes over time and frequency, with the first harmonics of the meshes.

    Parameters
    ----------
    waterfall
        From ``find_waterfall``.
    courses
        Mesh frequencies at its instants [Hz], from ``mesh_courses``.
    highest
        Where the frequency axis ends [Hz]; at the spectra's end where left out.
    """
    from matplotlib.colors import LogNorm

    figure, axes = open_axes(f"Spectrogram: {waterfall.title}", "time [s]", "frequency [Hz]", 1.15 * HEIGHT)
    end = float(waterfall.frequency[-1]) if highest is None else highest
    amplitude = waterfall.amplitude[:, (waterfall.frequency > 0.0) & (waterfall.frequency <= end)]
    top = float(amplitude.max()) or 1.0
    size, unit = scale_of(waterfall.unit, top)
    picture = np.maximum(pool(amplitude, PIXELS) / size, top / size * 10.0**-DECADES)
    half = 0.5 * (waterfall.time[1] - waterfall.time[0] if waterfall.time.size > 1 else waterfall.segment_s)
    extent = (waterfall.time[0] - half, waterfall.time[-1] + half, waterfall.resolution, end)
    image = axes.imshow(
        picture.T, origin="lower", aspect="auto", extent=extent, cmap="cividis", interpolation="none",
        norm=LogNorm(top / size * 10.0**-DECADES, top / size),
    )  # fmt: skip
    figure.colorbar(image, ax=axes, label=f"amplitude [{unit}]", location="left", pad=0.02)
    for number, (stage, course) in enumerate((courses or {}).items()):
        for harmonic in range(1, HARMONICS + 1):
            label = f"{stage} mesh, harmonics 1 to {HARMONICS}" if harmonic == 1 else None
            dash = (":", "--", "-.")[number % 3]
            axes.plot(waterfall.time, harmonic * course, dash, color="white", lw=1.1, label=label)
    axes.set_xlim(extent[0], extent[1])
    axes.set_ylim(0.0, end)
    axes.plot([], [], " ", label=_resolved(waterfall))
    finish_axes(axes)
    axes.grid(visible=False)
    _darken(axes)
    return figure


def _darken(axes: Axes) -> None:
    """Draw the legend's white strokes in grey, since its ground is white."""
    legend = axes.get_legend()
    for handle in legend.legend_handles if legend else []:
        if handle is not None and getattr(handle, "get_color", lambda: "")() == "white":
            handle.set(color=GREY)


def _resolved(waterfall: Waterfall) -> str:
    """Say with which window spectra were taken, and what they tell apart."""
    return (
        f"{waterfall.window} window, {waterfall.segment_s:.3g} s\nbins {waterfall.resolution:.3g} Hz apart\n"
        f"noise bandwidth {waterfall.bandwidth:.3g} Hz"
    )


def draw_waterfall(
    waterfall: Waterfall,
    courses: Mapping[str, FloatArray] | None = None,
    highest: float | None = None,
    *,
    places: tuple[FloatArray, str] | None = None,
    harmonics: int = 1,
) -> Figure:
    """Draw spectra one above another, by the shaft's speed where that only rises or only falls, else by time.

    Parameters
    ----------
    waterfall, courses, highest
        As for `draw_spectrogram`.
    places
        Positions of spectra and label of the axis, in place of speed or time.
    harmonics
        Of each mesh that are marked.
    """
    end = float(waterfall.frequency[-1]) if highest is None else highest
    place, label = places or _places(waterfall)
    figure, axes = open_axes(f"Waterfall: {waterfall.title}", "frequency [Hz]", label, 1.5 * HEIGHT)
    kept = np.unique(np.linspace(0, place.size - 1, min(ROWS, place.size)).astype(int))
    inside = (waterfall.frequency > 0.0) & (waterfall.frequency <= end)
    rows = pool(waterfall.amplitude[np.ix_(kept, np.flatnonzero(inside))], POINTS)
    frequency = np.linspace(waterfall.resolution, end, rows.shape[1])
    top = float(rows.max()) or 1.0
    tall = 3.0 * float(np.ptp(place[kept])) / max(kept.size - 1, 1) or 1.0
    size, unit = scale_of(waterfall.unit, top)
    for row, k in sorted(zip(rows, kept, strict=True), key=lambda pair: -float(place[pair[1]])):
        outline = place[k] + tall * np.concatenate([[0.0], row, [0.0]]) / top
        axes.fill(frequency[[0, *range(row.size), -1]], outline, fc="white", ec=BLUE, lw=0.8)
    axes.plot([], [], color=BLUE, lw=0.8, label=f"tallest: {top / size:.3g} {unit}\n{_resolved(waterfall)}")
    for number, (stage, course) in enumerate((courses or {}).items()):
        for harmonic in range(1, harmonics + 1):
            name = f"1 {stage}" if harmonics == 1 else f"{stage} mesh, harmonics 1 to {harmonics}"
            dash = (":", "--", "-.")[number % 3]
            axes.plot(harmonic * course, place, dash, color=VERMILLION, lw=1.1, label=name if harmonic == 1 else None)
    axes.set_xlim(0.0, end)
    finish_axes(axes)
    return figure


def _places(waterfall: Waterfall) -> tuple[FloatArray, str]:
    """Return the positions of spectra, and the axis' label."""
    speed = waterfall.speed
    steps = np.diff(speed)
    if speed.size > 1 and np.ptp(speed) > STEADY * speed.max() and (np.all(steps > 0.0) or np.all(steps < 0.0)):
        return speed, f"speed of {waterfall.shaft} [r/min]"
    return waterfall.time, "time [s]"
