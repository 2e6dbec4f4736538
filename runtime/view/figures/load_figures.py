"""Figures of loads: mesh forces, load shares, transmission errors, load durations and bearing forces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...analysis.bearings import BearingLoad
from ...analysis.duration import LoadDuration
from ...analysis.sharing import LoadShare, list_groups
from ...analysis.trace import FloatArray, list_items, pick, read_trace
from ...analysis.transmission import DEFINITIONS, TransmissionError
from ...model.members import CARRIER
from ...results.select import split_output
from ...results.statistics import mesh_frequencies
from ...results.train_record import read_train
from ..plots import BLUE, GREY, ORANGE, VERMILLION, finish_axes, make_canvas
from .drawing import HEIGHT, WIDTH, columns_for, dash_of, label_axes, open_axes, scale_of, style_of, thin

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

CYCLES = 6.0
"""Tooth meshes that a close look shows."""
CLOSE = 0.04
"""Part of a span shown in the detail of load shares."""
NAMES = 12
"""Curves in one figure at most."""


def draw_forces(dataset: xr.Dataset, group: str) -> Figure:
    """Draw the normal forces of a group of meshes: over all of a span, and the last tooth meshes closely.

    Parameters
    ----------
    dataset
        Result, or a span of it.
    group
        Such as ``lsp.sun_planet``.
    """
    traces = [read_trace(pick(dataset, "mesh_force", mesh)) for mesh in list_groups(dataset)[group][:NAMES]]
    figure = make_canvas(WIDTH, 1.5 * HEIGHT)
    above, below = figure.subplots(2, 1)
    size, unit = scale_of("N", max(float(np.abs(one.values).max()) for one in traces))
    time = traces[0].time
    close = time >= time[-1] - _close_look(dataset, group)
    last = f"The last {1e3 * (time[-1] - time[close][0]):.3g} ms"
    label_axes(above, f"Normal mesh forces of {group}", "time [s]", f"force [{unit}]")
    label_axes(below, last, "time [s]", f"force [{unit}]")
    columns = columns_for(len(traces))
    for number, one in enumerate(traces):
        colour, dash = style_of(number)
        label, over = split_output(one.name)[1], dash_of(number, len(traces))
        above.plot(*thin(time, one.values / size, columns), dash, color=colour, lw=0.7, label=label)
        below.plot(*thin(time[close], one.values[close] / size), over, color=colour, lw=1.1, label=label)
    for axes in (above, below):
        axes.margins(x=0.0)
        finish_axes(axes)
    return figure


def _close_look(dataset: xr.Dataset, group: str) -> float:
    """Return how long a close look lasts [s]: some tooth meshes, a twentieth of the span where none pass."""
    time = dataset["time"].values
    frequencies = mesh_frequencies(dataset, float(time[0])) if "mesh_phase" in dataset else {}
    frequency, whole = frequencies.get(read_train(dataset).stage(group), 0.0), float(time[-1] - time[0])
    return min(whole, CYCLES / frequency) if frequency > 0.0 else 0.05 * whole


def draw_shares(share: LoadShare, turns: FloatArray | None = None) -> Figure:
    """Draw how planets share their load; 1 is an equal share.

    Parameters
    ----------
    share
        From ``find_load_share``.
    turns
        Of the carrier at the share's instants [1], shape (n,), to draw over these; over time where left out.
    """
    label = "time [s]" if turns is None else "turns of the carrier [1]"
    title = f"Load shares of {share.group}: mesh load factor {share.mesh_load_factor:.3f}"
    figure = make_canvas(WIDTH, 1.5 * HEIGHT)
    above, below = figure.subplots(2, 1)
    x = share.time if turns is None else turns
    close = slice(-max(2, round(CLOSE * x.size)), None)
    label_axes(above, title, label, "share of an equal load [1]")
    label_axes(below, "The last of it", label, "share of an equal load [1]")
    for number, mesh in enumerate(share.meshes[:NAMES]):
        colour, dash = style_of(number)
        curve = share.share[:, number]
        known = np.isfinite(curve)
        text = f"{mesh}: mean {share.mean[number]:.3f}"
        above.plot(
            *thin(x[known], curve[known], columns_for(len(share.meshes))), dash, color=colour, lw=0.7, label=text
        )
        over = dash_of(number, len(share.meshes))
        below.plot(
            *thin(x[close], curve[close], columns_for(len(share.meshes))), over, color=colour, lw=1.1, label=mesh
        )
    for axes in (above, below):
        axes.axhline(1.0, color="black", lw=0.8, ls=":", label="equal share")
        axes.margins(x=0.0)
        finish_axes(axes)
    return figure


def draw_transmission_error(errors: Sequence[TransmissionError]) -> Figure:
    """Draw transmission errors over time, and the amplitudes of their mesh harmonics."""
    figure = make_canvas(WIDTH, 1.5 * HEIGHT)
    above, below = figure.subplots(2, 1)
    shown = list(errors)[:NAMES]
    size, unit = scale_of("m", max((float(np.abs(error.value).max()) for error in shown), default=1.0))
    same = {error.mesh for error in shown}
    title = f"Transmission error of {same.pop()}" if len(same) == 1 else "Transmission errors"
    label_axes(above, title, "time [s]", f"on the line of action [{unit}]")
    label_axes(below, "Amplitudes of mesh harmonics", "harmonic of the mesh frequency [1]", f"amplitude [{unit}]")
    width = 0.8 / max(len(shown), 1)
    for number, error in enumerate(shown):
        colour, dash = style_of(number)
        label = f"{error.mesh}, by {error.definition}\npeak to peak {error.peak_to_peak / size:.3g} {unit}"
        above.plot(
            *thin(error.time, error.value / size, columns_for(len(shown))), dash, color=colour, lw=0.8, label=label
        )
        places = np.arange(1, len(error.harmonics) + 1) + (number - 0.5 * (len(shown) - 1)) * width
        heights = np.nan_to_num(np.array(error.harmonics)) / size
        below.bar(places, heights, width, color=colour, label=f"{error.mesh}, by {error.definition}")
    for definition in dict.fromkeys(error.definition for error in shown):
        above.plot([], [], " ", label=_wrapped(f"{definition}: {DEFINITIONS[definition]}"))
    above.margins(x=0.0)
    for axes in (above, below):
        finish_axes(axes)
    return figure


def _wrapped(text: str) -> str:
    """Break a line that is too long for a legend."""
    from textwrap import fill

    return fill(text, 40)


def draw_load_duration(durations: Sequence[LoadDuration]) -> Figure:
    """Draw for how many tooth meshes or turns each load is exceeded."""
    shown = list(durations)[:NAMES]
    counted, unit_of_load = shown[0].counted, shown[0].unit
    size, unit = scale_of(unit_of_load, max(float(np.abs(one.edges).max()) for one in shown))
    figure, axes = open_axes("Load-duration distribution", f"{counted} above the load [1]", f"load [{unit}]")
    for number, one in enumerate(shown):
        colour, dash = style_of(number)
        label = split_output(one.name)[1]
        # A staircase: all that counts in a bin is above its lower edge.
        axes.step(one.exceeded, one.edges[:-1] / size, dash, where="post", color=colour, lw=1.2, label=label)
    axes.set_xscale("log")
    finish_axes(axes)
    return figure


def draw_bearings(loads: Sequence[BearingLoad]) -> Figure:
    """Draw the loads of bearings and pins as bars: root mean square, largest, and vibration."""
    size, unit = scale_of("N", max((load.peak for load in loads), default=0.0))
    figure = make_canvas(WIDTH, max(HEIGHT, 1.6 + 0.36 * len(loads)))
    axes = figure.add_subplot()
    label_axes(axes, "Forces of bearings and pins", f"magnitude of the force [{unit}]", "bearing or pin")
    places = np.arange(len(loads))[::-1]
    for shift, colour, word, values in (
        (0.27, BLUE, "root mean square", [load.rms for load in loads]),
        (0.0, ORANGE, "largest", [load.peak for load in loads]),
        (-0.27, VERMILLION, "standard deviation", [load.vibration for load in loads]),
    ):
        axes.barh(places + shift, np.array(values) / size, 0.26, color=colour, label=word)
    axes.set_yticks(places, [load.name for load in loads])
    axes.axvline(0.0, color=GREY, lw=0.8)
    finish_axes(axes)
    return figure


def carrier_turns(dataset: xr.Dataset, stage: str) -> FloatArray | None:
    """Return the turns of a stage's carrier since the start of the span [1], shape (n,); None if it is at rest."""
    name = read_train(dataset).part(stage, CARRIER)
    if name not in list_items(dataset, "twist"):
        return None
    from ...analysis.order_spectrum import TURN, shaft_angle

    angle = shaft_angle(dataset, name).values
    return np.asarray(np.abs(angle - angle[0]) / TURN)
