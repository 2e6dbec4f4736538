"""Accuracy study of one scene, from its reference to its record."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from ...simulation.choose_method import choose
from ...simulation.run_settings import RunSettings
from ..selftest.case import Bench
from .cheapest import find_cheapest, list_cheapest
from .machine import describe_machine
from .patience import Patience
from .presets import Preset, choose_time, installed_methods
from .record import FORMAT
from .reference import find_reference
from .sweep import ROUNDS, Point, Sweep, time_call

Data = dict[str, Any]
AUTO_RTOL = 1e-6
"""Tolerance for which the record has the choice of ``--method auto``."""
PILOT = 0.15
"""Share of the patience in which ``auto`` must reach the end; else less time is simulated."""
REFERENCE_PATIENCE = 4.0
"""How many times longer than others the runs of the reference may take."""


@dataclass(frozen=True)
class Wanted:
    """What a study is of; what is None is the preset's."""

    scene: str
    title: str
    model: str
    numbers: str
    rate: float
    longest: float
    preset_name: str
    preset: Preset
    t_end: float | None = None
    methods: Sequence[str] | None = None
    rtols: Sequence[float] | None = None


def run_study(bench: Bench, wanted: Wanted, told: Callable[[float], None] = lambda done: None) -> Data:
    """Measure what accuracy costs in a scene.

    Parameters
    ----------
    bench
        The scene's model.
    wanted
        What is measured.
    told
        Called with the share that is done.

    Returns
    -------
    dict
        The record, as ``ltcgear accuracy --json`` prints it, but for its ``phases``.
    """
    preset = wanted.preset
    t_end = wanted.t_end
    long = choose_time(bench, preset, wanted.rate, wanted.longest) if t_end is None else t_end
    auto = choose(bench.point, RunSettings(long, rtol=AUTO_RTOL, tables=bench.tables)).method
    if t_end is None:
        t_end = Patience(PILOT * preset.patience).reach(bench, auto, AUTO_RTOL, t_end=long, rate=wanted.rate)
    reference = find_reference(bench, Patience(REFERENCE_PATIENCE * preset.patience), t_end=t_end, rate=wanted.rate)
    told(0.1)
    sweep = Sweep(
        wanted.methods or installed_methods(), wanted.rtols or preset.rtols, t_end, wanted.rate,
        Patience(preset.patience), preset.budget,
    )  # fmt: skip
    points = sweep.measure(bench, reference, lambda done: told(0.1 + 0.9 * done))
    record: Data = {
        "format": FORMAT, "scene": wanted.scene, "title": wanted.title, "model": wanted.model,
        "numbers": wanted.numbers, "preset": wanted.preset_name, "t_end": t_end, "rate": wanted.rate,
        "measure": reference.measure, "machine": describe_machine(), "ns_rhs": time_call(bench),
        "reference": reference.to_json(), "points": [point.to_json(t_end) for point in points],
        "auto": auto, "notes": _notes(points), "phases": None,
    }  # fmt: skip
    return record | {"best": list_cheapest(record)}


def _notes(points: Sequence[Point]) -> list[str]:
    """Say what was timed less often, or not run."""
    ran = [point for point in points if point.reason is None]
    once = [point for point in ran if not point.integrator]
    notes = [f"Least of {ROUNDS} runs in turns, after a first one that gives errors and counts."]
    if once:
        cheapest = min(point.first for point in once)
        notes.append(f"{len(once)} of {len(ran)} points, of {cheapest:.2g} s or more each, were timed in one run only.")
    return notes


def phases_setting(record: Data) -> tuple[str, float]:
    """Return method and tolerance for the phases: the cheapest for 0.1 %, else what ``simulate`` takes."""
    point = find_cheapest(record, 1e-3)
    return ("auto", 1e-6) if point is None else (point["method"], point["rtol"])
