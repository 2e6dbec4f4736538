"""Time span of a result that is analysed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from ltcgear.generated.errors import LtcgearError

from ..results.rounding import STILL
from ..results.statistics import are_followed, sampling_rate, steady_start, window
from .trace import FEWEST, tell_bounds

if TYPE_CHECKING:
    import xarray as xr

NEEDED = (
    "mesh_force", "mesh_deflection", "mesh_phase", "bearing_force_x", "pin_force_x", "displacement_x", "speed",
    "twist", "acceleration_x",
)  # fmt: skip
"""Quantities whose samples must be numbers throughout."""
CHANGING = 0.01
"""Relative change of speed over a span above which lines over frequency are smeared and orders are better."""


def cut(dataset: xr.Dataset, start_s: float | None = None, stop_s: float | None = None) -> xr.Dataset:
    """Cut a record to the span that is analysed.

    Statistics along the motion belong to the span over which the run took them, its second half; they are kept only
    where that span is asked for.

    Parameters
    ----------
    dataset
        Simulation result.
    start_s, stop_s
        First and last instant [s]; the second half of the record where left out.

    Raises
    ------
    LtcgearError
        If the span lies outside the record, is too short, or has samples that are not numbers.
    """
    if dataset.sizes.get("time", 0) < FEWEST:
        raise LtcgearError(
            f"the record has {dataset.sizes.get('time', 0)} samples, {FEWEST} at least are needed; simulate longer"
        )
    time = dataset["time"].values
    first, last, half = float(time[0]), float(time[-1]), 0.5 / sampling_rate(dataset)
    start = steady_start(dataset) if start_s is None else start_s
    stop = last if stop_s is None else stop_s
    if not first - half <= start < stop <= last + half:
        raise LtcgearError(
            f"--from {start:.6g} --to {stop:.6g}: the record runs from {first:.6g} s to {last:.6g} s; "
            "give two instants in it, the first before the second"
        )
    part = window(dataset, start - 0.01 * half, stop + 0.01 * half)
    if part.sizes["time"] < FEWEST:
        raise LtcgearError(
            f"--from {start:.6g} --to {stop:.6g}: {part.sizes['time']} samples, {FEWEST} at least are needed; "
            f"give {tell_bounds(FEWEST / sampling_rate(dataset), last - first)[0]} s or more"
        )
    _refuse_gaps(part, dataset)
    return part if are_followed(dataset, start, stop) else part.drop_vars("statistics", errors="ignore")


def _refuse_gaps(part: xr.Dataset, dataset: xr.Dataset) -> None:
    """Refuse samples that are not numbers, as a failed run leaves them; name the span without any."""
    for name in NEEDED:
        if name in part:
            bad = ~np.isfinite(part[name].transpose("time", ...).values)
            rows = np.flatnonzero(bad.any(axis=1))
            if rows.size:
                time, item = part["time"].values, part[name][part[name].dims[1]].values[int(np.argmax(bad[rows[0]]))]
                raise LtcgearError(
                    f"{name}:{item}: not a number from {time[rows[0]]:.6g} s on; {_before_gaps(dataset)}"
                )


def _before_gaps(dataset: xr.Dataset) -> str:
    """Say which part of a record may be analysed that has samples that are not numbers."""
    whole = [np.isfinite(dataset[name].transpose("time", ...).values).all(axis=1) for name in NEEDED if name in dataset]
    count = int(np.argmin(np.logical_and.reduce(whole)))
    if count < FEWEST:
        return "too little comes before it; simulate again"
    time = dataset["time"].values
    middle = time[count // 2 if count > 4 * FEWEST else 0]
    return f"analyse what comes before it, --from {middle:.9g} --to {time[count - 1]:.9g}"


def speed_change(part: xr.Dataset) -> float:
    """Return how far the fastest rotor's speed varies in a span, over its largest [1]; 0 where no rotor turns.

    Each speed is first averaged over fifths of the span, so that vibration does not count.
    """
    if "speed" not in part:
        return 0.0
    speed = np.abs(part["speed"].transpose("time", "rotor").values)
    fifths = np.array([block.mean(axis=0) for block in np.array_split(speed, 5)])
    fastest = int(np.argmax(fifths.max(axis=0)))
    top = float(fifths[:, fastest].max())
    return float(np.ptp(fifths[:, fastest])) / top if top > STILL else 0.0
