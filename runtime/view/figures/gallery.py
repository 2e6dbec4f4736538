"""Figures of a survey."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from ...analysis.survey import Seen, Survey
from ...results.select import split_output
from ...results.train_record import read_train
from .cycle_figures import draw_range_means, draw_ranges
from .load_figures import (
    carrier_turns,
    draw_bearings,
    draw_forces,
    draw_load_duration,
    draw_shares,
    draw_transmission_error,
)
from .orbit_figures import draw_orbits
from .spectrum_figures import draw_envelope, draw_spectrogram, draw_spectrum, draw_waterfall

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ...analysis.trace import FloatArray

REACH, BINS = 4.0, 32
"""Highest frequency of spectrograms and waterfalls over that of the fastest mesh, and bins shown at least."""


def draw_survey(found: Survey) -> Iterator[tuple[str, Figure]]:
    """Draw all figures of a survey, one after another, each with its name."""
    train = read_train(found.span)
    for group in dict.fromkeys(map(train.group, found.forces)):
        yield f"forces-{group}", draw_forces(found.span, group)
    for share in found.shares:
        yield f"shares-{share.group}", draw_shares(share, _turns(found, share.group))
    for seen in found.seen:
        yield from _draw_seen(found, seen)
    for mesh in dict.fromkeys(train.front(error.mesh) for error in found.errors):
        own = [error for error in found.errors if train.front(error.mesh) == mesh]
        yield f"transmission-{mesh}", draw_transmission_error(own)
    if found.durations:
        yield "load-duration", draw_load_duration(found.durations)
    if found.cycles:
        yield "rainflow", draw_ranges(found.cycles)
    for cycles in found.cycles:
        if cycles.span.size:
            yield f"rainflow-{split_output(cycles.name)[1]}", draw_range_means(cycles)
    if found.bearings:
        yield "bearings", draw_bearings(found.bearings)
    if found.orbits:
        yield "orbits", draw_orbits(found.orbits)


def _turns(found: Survey, group: str) -> FloatArray | None:
    """Return the turns of a group's carrier, None if it is at rest or hardly turns."""
    turns = carrier_turns(found.span, read_train(found.span).stage(group))
    return turns if turns is not None and turns[-1] >= 1.0 else None


def _draw_seen(found: Survey, seen: Seen) -> Iterator[tuple[str, Figure]]:
    """Draw what was found of one output."""
    name = seen.output.replace(":", "-")
    reach = min(found.clues.band.end_hz, float(seen.spectrum.axis[-1]))
    yield f"spectrum-{name}", draw_spectrum(seen.spectrum, seen.lines, reach)
    yield f"density-{name}", draw_spectrum(seen.density, highest=reach)
    if seen.orders is not None:
        yield f"orders-{name}", draw_spectrum(seen.orders, seen.order_lines)
    end = min(reach, float(seen.waterfall.frequency[-1]))
    fastest = max((float(course.max()) for course in seen.courses.values()), default=end)
    highest = min(end, max(REACH * fastest, BINS * seen.waterfall.resolution))
    yield f"spectrogram-{name}", draw_spectrogram(seen.waterfall, seen.courses, highest)
    yield f"waterfall-{name}", draw_waterfall(seen.waterfall, seen.courses, highest)
    yield f"envelope-{name}", draw_envelope(seen.envelope, seen.envelope_lines)
