"""Ensembles: many runs side by side against the same runs one after the other.

Run as ``OPENBLAS_NUM_THREADS=1 python -m benchmarks.ensemble``; it takes a minute or two and writes the table of
docs/ensembles.md and docs/data/ensemble.json.
"""

import hashlib
import json
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

from ltcgear.generated import folders
from ltcgear.runtime.model.building import build
from ltcgear.runtime.results.table import Table
from ltcgear.runtime.simulation.ensemble import simulate_many
from ltcgear.runtime.studies.accuracy.machine import describe_machine
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.scene.load import load_scene

DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGE, DATA = DOCS / "ensembles.md", DOCS / "data" / "ensemble.json"
BEGIN, END = "<!-- ensembles -->\n", "<!-- end -->\n"
SCENES = ("lsp", "rig-2mw")
RUNS, T_END, ROUNDS = 16, 1.0, 7
LOADS = (0.6, 1.0)
"""Factors of all loads' torques, of the first and the last run."""
HASHED = bytes(50_000_000)
COLUMNS = ("scene", "runs", "workers", "seconds", "processor seconds", "speed-up", "available")


def timed(work: Callable[[], Any]) -> dict[str, float]:
    """Return the time that work takes, by the clock and of all processors [s]."""
    clock, spent = perf_counter(), process_time()
    work()
    return {"seconds": perf_counter() - clock, "cpu": process_time() - spent}


def make_ensemble(name: str) -> Callable[[int], None]:
    """Return what simulates a scene under several loads, with so many workers."""
    scene = load_scene(name)
    model = build_model(scene)
    library, values = build(obtain(model)), model.values()
    torques = [key for key in values if key.startswith("loads.") and key.endswith(".torque")]
    low, high = LOADS
    factors = [low + (high - low) * k / (RUNS - 1) for k in range(RUNS)]
    sets = [values | {key: factor * values[key] for key in torques} for factor in factors]
    options: dict[str, Any] = {"t_end": T_END, "rate": scene.simulation.rate, "method": "erk", "tables": model.tables}

    def run(workers: int) -> None:
        for result in simulate_many(library, sets, workers=workers, **options):
            if result.summary["status"] != "done":
                raise RuntimeError(result.summary["status"])

    return run


def hash_all(workers: int, count: int) -> None:
    """Hash so many times what no lock stands in the way of."""
    with ThreadPoolExecutor(workers) as pool:
        list(pool.map(lambda _: hashlib.sha256(HASHED).digest(), range(count)))


def measure(name: str, workers: int) -> dict[str, Any]:
    """Time one worker, several, and hashes by both, in turn."""
    run = make_ensemble(name)
    run(workers)  # loads and compiles what is needed
    found: dict[str, Any] = {"workers": workers, "runs": RUNS, "t_end": T_END}
    found |= {key: [] for key in ("one", "several", "one_hash", "several_hashes")}
    for _ in range(ROUNDS):
        found["one_hash"].append(timed(lambda: hash_all(1, 2 * workers)))
        found["one"].append(timed(lambda: run(1)))
        found["several"].append(timed(lambda: run(workers)))
        found["several_hashes"].append(timed(lambda: hash_all(workers, 2 * workers)))
    return found


def least(found: dict[str, Any], key: str, what: str = "seconds") -> float:
    """Return the least time of several [s]."""
    return float(min(each[what] for each in found[key]))


def speed_up(found: dict[str, Any]) -> float:
    """Return how many times as quick several workers are."""
    return least(found, "one") / least(found, "several")


def table(data: dict[str, Any]) -> str:
    """Return the table in Markdown."""
    lines: list[tuple[str, ...]] = []
    for name, found in data["scenes"].items():
        available = least(found, "one_hash") / least(found, "several_hashes")
        for key, workers in (("one", 1), ("several", found["workers"])):
            times = (f"{least(found, key, what):.3g}" for what in ("seconds", "cpu"))
            ratios = (f"{speed_up(found):.2f}", f"{available:.2f}") if key == "several" else ("1", "1")
            lines.append((name, str(found["runs"]), str(workers), *times, *ratios))
    return f"\n{Table('', COLUMNS, tuple(lines)).to_markdown()}\n"


def main() -> None:
    """Measure, print the table, and write page and data."""
    workers = max(len(os.sched_getaffinity(0)), 2)
    data = {"machine": describe_machine(), "scenes": {name: measure(name, workers) for name in SCENES}}
    made = table(data)
    print(made)
    before, rest = PAGE.read_text("utf-8").split(BEGIN)
    folders.write_folder(DATA.parent, {DATA.name: json.dumps(data, indent=1) + "\n"})
    folders.write_folder(DOCS, {PAGE.name: before + BEGIN + made + END + rest.split(END)[1]})


if __name__ == "__main__":
    main()
