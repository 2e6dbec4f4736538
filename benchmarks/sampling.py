"""What the band and the statistics cost: the rig's integration alone, read raw, and read band-limited.

Run as ``python -m benchmarks.sampling``; it writes the table of docs/sampling.md. Processor time of one thread, the
variants in turn, the least of many.
"""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from time import thread_time

from ltcgear.runtime.model.building import build
from ltcgear.runtime.model.equilibrium import find_equilibrium
from ltcgear.runtime.model.operating_point import OperatingPoint
from ltcgear.runtime.results.table import Table
from ltcgear.runtime.simulation.integration import Integration
from ltcgear.runtime.simulation.run_settings import RunSettings
from ltcgear.runtime.simulation.simulate import Run
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.scene.load import load_scene

from .marks import put

PAGE = Path(__file__).resolve().parents[1] / "docs" / "sampling.md"
SCENE, T_END, RATE, RTOL, ROUNDS = "rig-2mw", 0.25, 8192.0, 1e-6, 25


def variants() -> dict[str, Callable[[], object]]:
    """Return what is measured by name."""
    model = build_model(load_scene(SCENE))
    library = build(obtain(model))
    p = library.parameters(model.values())
    at = find_equilibrium(library, p)
    settings = RunSettings(T_END, RATE, "erk", RTOL)

    def march() -> None:
        Integration(OperatingPoint(library, p, at), settings).follow(lambda block, points: None)

    def run(raw: bool) -> None:
        made = Run(library, p, replace(settings, raw=raw))
        made.follow(lambda t: None)
        made.conclude()

    return {
        "integration alone": march,
        "a run with `--raw`: outputs of the instant, statistics along the motion": lambda: run(True),
        "a run as it comes: band-limited outputs, the same statistics": lambda: run(False),
    }


def measure() -> dict[str, float]:
    """Return the least time of each variant [s]."""
    least: dict[str, float] = {}
    calls = variants()
    for name, call in [pair for _ in range(ROUNDS) for pair in calls.items()]:
        begun = thread_time()
        call()
        least[name] = min(thread_time() - begun, least.get(name, float("inf")))
    return least


def table(least: dict[str, float]) -> str:
    """Return the table in Markdown, times over those of the raw run."""
    raw = next(seconds for name, seconds in least.items() if "--raw" in name)
    rows = tuple((name, f"{seconds / T_END * 1e3:.0f}", f"{seconds / raw:.2f}") for name, seconds in least.items())
    return Table("", ("rig, rtol 1e-6", "ms a simulated second", "over raw"), rows).to_markdown()


def main() -> None:
    """Measure, and write the table."""
    put(PAGE, {"cost": table(measure())})


if __name__ == "__main__":
    main()
