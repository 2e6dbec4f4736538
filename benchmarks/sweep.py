"""What a sweep costs beside its runs, and what two processes are worth: 1000 gearboxes with pins out of place.

Run as ``python -m benchmarks.sweep``; the figures on docs/sweeps.md are replaced. Rounds of one process and of two
take turns, and the fastest of each is told, since other programs only slow a round down. Hashes tell what the machine
has left for a second process, as for ensembles.
"""

import json
import os
import tempfile
from pathlib import Path
from time import perf_counter, process_time

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from ltcgear.runtime import build, load_sweep, simulate, sweep
from ltcgear.symbolic import Template

from .ensemble import hash_all
from .marks import put

PAGE = Path(__file__).parent.parent / "docs" / "sweeps.md"
DATA = PAGE.parent / "data" / "sweeps.json"
PLANETS = 4
ERRORS = "stages.lsp.position_errors"
CHANGES = {
    "effects.planet_position_error": "on",
    ERRORS: "[" + ", ".join(f"{{ planet = {k + 1} }}" for k in range(PLANETS)) + "]",
}
VARY = [f"{ERRORS}.{k}.tangential=0 um:20 um" for k in range(PLANETS)]
POINTS, T_END, ROUNDS = 1000, 0.75, 2
SHARE = 10
"""Every so many points are simulated alone."""


def time_sweep(folder: Path, workers: int, number: int) -> tuple[float, float, Path]:
    """Return the seconds of a whole sweep, those of this process' work, and the file."""
    target, clock, work = folder / f"{workers}-{number}.nc", perf_counter(), process_time()
    sweep(Template("lsp", CHANGES), VARY, target, sample="normal", points=POINTS, t_end=T_END, workers=workers)
    return perf_counter() - clock, process_time() - work, target


def time_runs(target: Path) -> float:
    """Return the seconds of work of a run alone, the mean over some points of a sweep."""
    template, found = Template("lsp", CHANGES), load_sweep(target)
    keys = [text.partition("=")[0] for text in VARY]
    library, seconds = build(template.obtain({})), []
    for point in range(0, POINTS, SHARE):
        _, values, tables = template.make({key: f"{float(found[key][point])!r} um" for key in keys})
        clock = process_time()
        simulate(library, values, t_end=T_END, rate=8192, tables=tables)
        seconds.append(process_time() - clock)
    return float(np.mean(seconds))


def time_hashes(workers: int) -> float:
    """Return the seconds of some hashes by one thread or several."""
    clock = perf_counter()
    hash_all(workers, 16)
    return perf_counter() - clock


def measure() -> dict[str, float]:
    """Return seconds of the sweeps and of a run, the fastest of rounds that take turns, and the shares found."""
    one, two, work, alone, single, double = [], [], [], [], [], []
    with tempfile.TemporaryDirectory() as folder:
        for number in range(ROUNDS):
            seconds, own, target = time_sweep(Path(folder), 1, number)
            one.append(seconds)
            work.append(own / POINTS)
            single.append(time_hashes(1))
            alone.append(time_runs(target))
            two.append(time_sweep(Path(folder), 2, number)[0])
            double.append(time_hashes(2))
            print(f"one process {one[-1]:.1f} s, two {two[-1]:.1f} s, a run {1e3 * alone[-1]:.1f} ms", flush=True)
        shares = load_sweep(target)["mesh_load_factor"].sel(group="lsp.sun_planet").values
    low, high = np.quantile(shares, [0.5, 0.95])
    seconds = {
        "one": min(one),
        "two": min(two),
        "point": min(work),
        "alone": min(alone),
        "available": min(single) / min(double),
    }
    return seconds | {"median": float(low), "high": float(high)}


def write(found: dict[str, float]) -> str:
    """Return the figures as the page has them."""
    run, point = 1e3 * found["alone"], 1e3 * found["point"]
    return (
        f"- {POINTS} points of `lsp`, {T_END:g} s each, with normal errors of 20 um of all four pins: one process "
        f"takes {found['one']:.0f} s, two take {found['two']:.0f} s, {found['one'] / found['two']:.2f} times as fast, "
        f"where the machine had {found['available']:.2f} for two hashes at once.\n"
        f"- A run alone takes {run:.1f} ms of processor time, a point of the sweep {point:.1f} ms: scene, model, "
        f"metrics, row and start add {100 * (point - run) / run:.1f} %.\n"
        f"- The sun's mesh load factor K_gamma: {found['median']:.3f} in the median, {found['high']:.3f} at 95 %.\n"
    )


if __name__ == "__main__":
    measured = measure()
    DATA.write_text(json.dumps(measured, indent=1) + "\n", "utf-8")
    put(PAGE, {"cost": write(measured)})
