"""Origins of the frequencies of Table 8: harmonics, sidebands, modes, or none of these."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...results.amplitude_spectrum import Sources, name_line
from .comparison import LIST_LIMIT, position_spectrum, published

if TYPE_CHECKING:
    import xarray as xr

    from ...linear.modes import Mode

NEAR = 0.01
"""Relative distance at which a printed line counts as a harmonic or sideband: measured speeds are not exact."""
HIGHEST = 5
"""Highest order that counts within ``NEAR``: those of the slowest mesh would explain every line."""
SHARP = 0.5
"""Distance [Hz] at which a high harmonic counts: the width of a line of 2 s."""
FAINT = 1e-3
"""Share of the strongest line below which there is no peak."""
MODES_BELOW = 3000.0
"""Modes below this are counted [Hz]."""
GRID = 0.5
"""Distance of the frequencies over which chance is counted [Hz]."""


@dataclass(frozen=True)
class Explanation:
    """What a printed line is.

    Attributes
    ----------
    frequency_hz, places
        The line [Hz] and where it was seen.
    kind
        ``harmonic``, ``sideband``, ``mode`` or ``unexplained``.
    name
        The harmonic or the sideband, with any sharp harmonic of higher order after it; or the mode next to it.
    off
        Relative distance of what explains it first, or of the next mode.
    """

    frequency_hz: float
    places: tuple[str, ...]
    kind: str
    name: str
    off: float


def printed_lines(kinds: Sequence[str] = ("measured", "simulated")) -> dict[float, list[str]]:
    """Return the lines of Table 8 [Hz] with where each was seen, in order."""
    found: dict[float, list[str]] = {}
    for row in published()["table8"]["rows"]:
        for kind in kinds:
            for value in row.get(kind, []):
                place = f"{kind}, {row[f'{kind}_position']}" if f"{kind}_position" in row else kind
                found.setdefault(float(value), []).append(place)
    return dict(sorted(found.items()))


def forced_name(frequency_hz: float, sources: Sources) -> str:
    """Name a line as a low harmonic or sideband within ``NEAR``, or "" where it is none.

    Parameters
    ----------
    frequency_hz
        The line [Hz].
    sources
        Mesh frequency of each stage and turns of each carrier [Hz], by name.
    """
    return name_line(frequency_hz, sources, NEAR * frequency_hz, HIGHEST)


def sharp_names(frequency_hz: float, meshes: Mapping[str, float]) -> list[str]:
    """Return the harmonics of higher order that lie within ``SHARP`` of a line."""
    orders = {stage: round(frequency_hz / frequency) for stage, frequency in meshes.items() if frequency > 0}
    return [
        f"{order} {stage}"
        for stage, order in orders.items()
        if order > HIGHEST and abs(order * meshes[stage] - frequency_hz) <= SHARP
    ]


def explain_lines(sources: Sources, modes: Sequence["Mode"]) -> list[Explanation]:
    """Explain the lines that the paper's simulation showed.

    Parameters
    ----------
    sources
        Mesh frequency of each stage and turns of each carrier [Hz], by name.
    modes
        Modes of the model, with names.

    Returns
    -------
    list of Explanation
        In order of frequency. Harmonics and sidebands come first, since a mode sounds where it is driven.
    """
    return [_explain(value, tuple(places), sources, modes) for value, places in printed_lines(("simulated",)).items()]


def _explain(
    value: float, places: tuple[str, ...], sources: Sources, modes: Sequence["Mode"],
) -> Explanation:  # fmt: skip
    """Explain one line."""
    sharp = sharp_names(value, sources.meshes)
    if name := forced_name(value, sources) or next(iter(sharp), ""):
        kind = "harmonic" if " + " not in name and " - " not in name else "sideband"
        off = _frequency(name, sources) / value - 1
        return Explanation(value, places, kind, " or ".join(dict.fromkeys([name, *sharp])), off)
    mode = min(modes, key=lambda mode: abs(mode.frequency_hz - value))
    off = mode.frequency_hz / value - 1
    return Explanation(value, places, "mode" if abs(off) <= NEAR else "unexplained", mode.name, off)


def _frequency(name: str, sources: Sources) -> float:
    """Return the frequency of a name given by ``name_line`` [Hz]."""
    known, total, sign = {**sources.carriers, **sources.meshes}, 0.0, 1.0
    order = 1.0
    for word in name.split():
        if word in "+-":
            sign = 1.0 if word == "+" else -1.0
        elif word.isdigit():
            order = float(word)
        else:
            total, order = total + sign * order * known[word], 1.0
    return total


def count_chance(sources: Sources, modes: Sequence["Mode"]) -> dict[str, float]:
    """Count how much is explained by chance: how many of all frequencies between the printed lines would be.

    Returns
    -------
    dict
        ``forced`` and ``mode``, shares of the frequencies that are a low harmonic or sideband, and that have a mode,
        within ``NEAR``; ``modes``, how many modes lie below ``MODES_BELOW``.
    """
    lines = list(printed_lines(("simulated",)))
    places = np.arange(lines[0], lines[-1], GRID)
    own = np.array([mode.frequency_hz for mode in modes if mode.frequency_hz > 0])
    forced = [bool(forced_name(float(place), sources)) for place in places]
    near = (np.abs(own[:, None] - places) <= NEAR * places).any(axis=0)
    below = int(np.count_nonzero(own < MODES_BELOW))
    return {"forced": float(np.mean(forced)), "mode": float(np.mean(near)), "modes": below}


def own_peak(
    dataset: "xr.Dataset", members: Sequence[str], frequency_hz: float, start_s: float
) -> tuple[float, float] | None:
    """Find our strongest peak next to a printed line.

    Parameters
    ----------
    dataset
        Result with accelerations.
    members
        Members at the position.
    frequency_hz, start_s
        The line [Hz], and the first instant used [s].

    Returns
    -------
    (frequency, share) or None
        Of the highest peak within ``NEAR`` [Hz], a bin above both its neighbours, and its amplitude over that of the
        strongest line up to 700 Hz; None if there is no peak of ``FAINT`` at least, or nothing was simulated.
    """
    from scipy.signal import find_peaks

    found = []
    for member in members:
        spectrum = position_spectrum(dataset, member, start_s)
        if spectrum is None:
            continue
        _, _, frequency, amplitude = spectrum
        top = float(amplitude[(frequency > 0) & (frequency < LIST_LIMIT)].max())
        peaks, _ = find_peaks(amplitude, height=FAINT * top)
        near = peaks[np.abs(frequency[peaks] - frequency_hz) <= NEAR * frequency_hz]
        found += [(float(amplitude[peak]) / top, float(frequency[peak])) for peak in near if top > 0]
    return max(found)[::-1] if found else None


def tell_lines(
    sources: Sources, modes: Mapping[str, Sequence["Mode"]], datasets: Mapping[str, "xr.Dataset"], start_s: float
) -> list[dict[str, Any]]:  # fmt: skip
    """Return the rows of Table 8's explanation, each by the name of a rig: assumed, fitted."""
    rows = []
    explained = {rig: explain_lines(sources, own) for rig, own in modes.items()}
    members: dict[float, list[str]] = {}
    for row in published()["table8"]["rows"]:
        for value in row.get("simulated", []):
            members.setdefault(float(value), []).extend(row["members"])
    for k, first in enumerate(next(iter(explained.values()))):
        per_rig = {}
        for rig, items in explained.items():
            item = items[k]
            peak = own_peak(datasets[rig], members[first.frequency_hz], first.frequency_hz, start_s)
            per_rig[rig] = {"kind": item.kind, "name": item.name, "off": item.off, "peak": peak}
        rows.append({"frequency": first.frequency_hz, "places": list(first.places), "rigs": per_rig})
    return rows
