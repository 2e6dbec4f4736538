"""Report page: result -> stages, frames, figures, tables -> one HTML file."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from math import isfinite, log
from typing import TYPE_CHECKING, Any

import numpy as np
from ltcgear.generated.errors import LtcgearError
from ltcgear.generated.writing import write_text

from ...results.rounding import round_statistics, without_rounding
from ..html import open_templates, read_asset
from .film import choose_windows, magnify, make_track, pack
from .heading import describe_run, list_versions
from .listing import list_tables, write_cell
from .mode_section import make_mode_section
from .panels import make_panels
from .scene_text import list_scene
from .sections import make_sections
from .stage import HEAD, LONGEST, pose_stage
from .theme import themed

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    import xarray as xr

    from ...linear.modes import Mode
    from ...linear.system import Linear
    from ...results.result import Result
    from .film import Track, Window
    from .panels import Panel

FEWEST = 2
"""Samples that a report needs."""
PACES = (1.0, 1 / 3, 0.1, 1 / 30, 0.01, 1 / 300, 0.001, 1e-4)
LASTS = 12.0
"""About how long a window lasts on the screen [s]."""
ROOM, NEEDING = "ltcgear.runtime.view.report", "ltcgear report"


@dataclass(frozen=True)
class Background:
    """Additional content of a report: the sources of numbers, and the modes of the linearised model.

    ``why_no_modes`` says why there are none.
    """

    sources: Mapping[str, str] = field(default_factory=dict)
    linear: Linear | None = None
    modes: tuple[Mode, ...] = ()
    why_no_modes: str = "the file holds no scene."


def write_report(result: Result, path: Path, background: Background | None = None, at: float | None = None) -> Path:
    """Write a result as one page of HTML that needs no network.

    Parameters
    ----------
    result
        The result.
    path
        File to write; it appears whole or not at all.
    background
        Sources of numbers and modes, where the scene is known.
    at
        Middle of the close-up of the animation [s]; the end of the record where left out.

    Raises
    ------
    LtcgearError
        If the file cannot be written, the instant lies outside the record, or Jinja2 is missing.
    """
    return write_text(compose_report(result, background or Background(), at), path)


def compose_report(result: Result, background: Background, at: float | None = None) -> str:
    """Return the page of a result; see ``write_report``."""
    environment = open_templates(ROOM, NEEDING)
    environment.filters["cell"] = write_cell
    dataset, lost = _numbers(result.dataset)
    _check(dataset, at)
    dataset = without_rounding(dataset)
    track, panels = _motion(dataset)
    windows = choose_windows(track, at)
    factor = magnify(track, panels)
    stages = pose_stage(track, panels, windows[0].first, factor)
    with themed():
        sections = make_sections(dataset, background.modes)
    sections.insert(-1, make_mode_section(background.linear, background.modes, background.why_no_modes))
    head = describe_run(result)
    head["warnings"] += [lost] if lost else []
    text: str = environment.get_template("report.html").render(
        head=head,
        stage=_stage(track, stages, windows, factor),
        film=_script_json(_film(track, stages, windows, factor)),
        sections=sections,
        tables=list_tables(dataset, round_statistics(result.summary.get("forces", {}), result.dataset)),
        scene=list_scene(dataset.attrs, background.sources),
        foot=list_versions(dataset.attrs),
        style=read_asset(ROOM, "report.css"),
        script=read_asset(ROOM, "report.js"),
    )
    return text


def check_templates() -> None:
    """Refuse to begin where Jinja2 is missing."""
    open_templates(ROOM, NEEDING)


def _numbers(dataset: xr.Dataset) -> tuple[xr.Dataset, str]:
    """Return the record up to where a run broke down and left what is no number, and what is said of that."""
    moving = [data.transpose("time", ...).values for data in dataset.data_vars.values() if "time" in data.dims]
    tables = [values.reshape(len(values), -1) for values in moving]
    bad = np.flatnonzero(~np.logical_and.reduce([np.isfinite(table).all(axis=1) for table in tables]))
    if not bad.size:
        return dataset, ""
    begin = f"{dataset['time'].values[bad[0]]:.6g} s"
    return dataset.isel(time=slice(0, int(bad[0]))), f"Samples from {begin} on are not numbers and are left out."


def _check(dataset: xr.Dataset, at: float | None) -> None:
    """Refuse a record without motion, and an instant outside it."""
    if dataset.sizes["time"] < FEWEST:
        raise LtcgearError(f"the record has {dataset.sizes['time']} samples; a report needs {FEWEST}, simulate longer")
    first, last = (float(dataset["time"].values[k]) for k in (0, -1))
    near = 1e-5 * (last - first)  # ends are told in six digits
    if at is not None and not (isfinite(at) and first - near <= at <= last + near):
        raise LtcgearError(f"--at {at:g}: the record runs from {first:g} s to {last:g} s; give an instant in it")


def _motion(dataset: xr.Dataset) -> tuple[Track, list[Panel]]:
    """Return what moves, and the stages it moves in."""
    try:
        panels = make_panels(dataset)
        return make_track(dataset), panels
    except (KeyError, IndexError) as error:
        raise LtcgearError(f"the result's drawing does not fit its data: {error} is missing; simulate again") from error


def _pace(window: Window, track: Track) -> float:
    """Return the playback speed at which a window lasts its viewing time."""
    span = float(track.time[window.samples][-1] - track.time[window.samples][0])
    return min(PACES, key=lambda pace: abs(log(max(span, 1e-12) / pace / LASTS)))


def _stage(track: Track, stages: list[dict[str, Any]], windows: list[Window], factor: float) -> dict[str, Any]:
    """Return what the section of the stage view shows."""
    for number, panel in enumerate(stages):
        panel["index"] = number
        for contact in panel["contacts"]:
            contact["short"] = contact["name"].partition(".")[2].replace("_", " ").replace(".", " ")
    parts = dict.fromkeys(wheel["part"] for panel in stages for wheel in panel["wheels"])
    shifts = bool(track.bodies)
    told = (
        "Members turn by their angles as simulated; how far they are pushed from their places is drawn "
        f"{factor:g} times as large."
        if shifts
        else "Members turn by their angles as simulated; nothing moves sideways in this scene."
    )
    return {
        "panels": stages, "alone": any(panel["alone"] for panel in stages), "parts": list(parts), "told": told,
        "windows": windows, "meshes": bool(track.meshes), "shifts": shifts, "factor": factor,
        "begin": f"{track.time[windows[0].first]:.6g} s",
        "paces": [(pace, "real time" if pace == 1 else f"1/{1 / pace:.0f} of real time") for pace in PACES],
    }  # fmt: skip


def _film(track: Track, stages: list[dict[str, Any]], windows: list[Window], factor: float) -> dict[str, Any]:
    """Return the data of the animation."""
    panel_keys, wheel_keys = ("frame", "scale", "unit", "measure"), ("body", "x", "y")
    contact_keys = ("name", "one", "two", "x", "y", "direction")
    panels = [
        _only(panel_keys, panel)
        | {
            "wheels": [_only(wheel_keys, wheel) for wheel in panel["wheels"]],
            "contacts": [_only(contact_keys, contact) for contact in panel["contacts"]],
        }
        for panel in stages
    ]
    return {
        "factor": factor,
        "longest": LONGEST,
        "head": HEAD,
        "rotors": track.rotors,
        "ratio": track.ratio.tolist(),
        "bodies": track.bodies,
        "meshes": track.meshes,
        "chosen": _leader(track),
        "windows": [pack(track, window) | {"pace": _pace(window, track)} for window in windows],
        "panels": panels,
    }


def _leader(track: Track) -> str | None:
    """Return the mesh that is shown first: the first one that carries half of what any carries."""
    carried = np.abs(track.force).mean(axis=0) if track.meshes else np.zeros(0)
    return next((mesh for mesh, own in zip(track.meshes, carried, strict=True) if own >= carried.max() / 2), None)


def _only(keys: tuple[str, ...], table: dict[str, Any]) -> dict[str, Any]:
    """Return the values of some keys."""
    return {key: table[key] for key in keys}


def _script_json(data: dict[str, Any]) -> str:
    """Write JSON that is safe in a script element."""
    return json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
