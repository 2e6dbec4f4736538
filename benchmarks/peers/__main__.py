"""Measure all peers, print, and write docs/peers.md, its figure and data (``python -m benchmarks.peers``)."""

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path
from statistics import median
from typing import Any

from ltcgear.generated import folders, store
from ltcgear.generated.errors import LtcgearError

from . import page, runners
from .figure import draw_races
from .floor import Floor, call_times, python_time
from .numpy_rig import NumpyRig
from .race import TARGET, race
from .rig import AGREES, RATE, T_END, Rate, Rig, disagreement, error, open_rig
from .solvers import our_rate
from .stage import open_stage

PARTS = ("numpy", "scipy", "sundae", "exudyn", "pydy")
MODULES = {"sundae": ("sksundae",), "exudyn": ("exudyn",), "pydy": ("pydy", "Cython")}
"""What is imported for a part and is not always installed."""
PACKAGES = ("casadi", "sympy", "numpy", "scipy", "scikit-sundae", "exudyn", "pydy", "cython")
OPTIMISED = " ".join(flag for flag in store.FLAGS if flag.startswith(("-O", "-march")))
"""Ours of the compiler's flags, for PyDy's C too."""
PATIENCE = 600
"""Seconds after which PyDy is stopped."""


def told(text: str) -> None:
    """Say how far it is."""
    print(text, file=sys.stderr, flush=True)


def checked(checks: dict[str, float], name: str, rig: Rig, rate: Rate) -> None:
    """Compare a peer's accelerations with ours before anything of it is timed.

    Raises
    ------
    LtcgearError
        If they differ.
    """
    checks[name] = disagreement(rig, rate)
    if not checks[name] <= AGREES:
        raise LtcgearError(f"{name}: accelerations differ from ours by {checks[name]:.1e}, more than {AGREES:g}")


def measure_rig(parts: set[str], checks: dict[str, float]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Check and time what runs the rig; return the race and the times of one call."""
    rig = open_rig()
    floors, rate = {name: Floor(rig, merged) for name, merged in (("written", False), ("merged", True))}, NumpyRig(rig)
    for name, floor in floors.items():
        checked(checks, f"hand-written C, {page.WRITTEN[name]}", rig, floor)
    checked(checks, "NumPy", rig, rate)
    loops = {name: {"min": min(t), "median": median(t)} for name, t in call_times(rig, floors).items()}
    x, levels = rig.at.x, rig.at.levels
    ours = our_rate(rig)
    python = {"numpy": python_time(lambda: rate(x, levels)), "generated": python_time(lambda: ours(x, levels))}
    one, two = runners.references(rig)
    reference = rig.forces(one)
    field = runners.our_runners(rig)
    field += runners.scipy_runners(rig) if "scipy" in parts else []
    field += runners.sundae_runners(rig) if "sundae" in parts else []
    field += runners.numpy_runners(rig, rate) if "numpy" in parts else []
    rows = race(field, lambda found: error(rig, found, reference), told)
    found = {
        "t_end": T_END, "rate": RATE, "switchings": len(rig.segments) - 1, "target": TARGET,
        "uncertainty": error(rig, two, reference), "rows": rows,
        "set_up": {method: runners.set_up_time(rig, method) for method in runners.METHODS},
    }  # fmt: skip
    return found, {"loop": loops, "python": python}


def measure_stage(checks: dict[str, float], torsional: bool) -> dict[str, Any]:
    """Check and time Exudyn on the stage, beside ours."""
    from .exudyn_stage import Lateral, Torsional

    rig = open_stage(torsional)
    peer = (Torsional if torsional else Lateral)(rig)
    checked(checks, f"{runners.EXUDYN}, {'torsional' if torsional else 'lateral'}", rig, peer)
    after, torque = runners.struck(rig)
    one, two = runners.references(after)
    reference = after.forces(one)
    field = runners.our_runners(after) + runners.exudyn_runners(peer, torque)
    rows = race(field, lambda found: error(after, found, reference), told)
    return {"target": TARGET, "uncertainty": error(after, two, reference), "rows": rows}


def run_module(name: str) -> dict[str, Any]:
    """Run a module of this folder in a process of its own with an empty store; return what it prints, or a bound."""
    with tempfile.TemporaryDirectory() as cache:
        command = [sys.executable, "-m", f"benchmarks.peers.{name}"]
        try:
            run = subprocess.run(
                command, capture_output=True, text=True, check=False, timeout=PATIENCE, cwd=page.PAGE.parents[1],
                env=os.environ | {"LTCGEAR_CACHE": cache, "CFLAGS": OPTIMISED},
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            return {"stopped_after": PATIENCE}
    if run.returncode != 0:
        raise LtcgearError(f"{name}: {run.stderr.strip().splitlines()[-1]}")
    found: dict[str, Any] = json.loads(run.stdout.splitlines()[-1])
    return found


def measure_making(checks: dict[str, float]) -> dict[str, Any]:
    """Time how long ltcgear and PyDy take from nothing to a right-hand side that can be called, by turns."""
    runs = [{name: run_module(name) for name in ("our_stage", "pydy_stage")} for _ in range(3)]
    found = {name: min((run[name] for run in runs), key=page.total) for name in runs[0]}
    if "stopped_after" not in found["pydy_stage"]:
        checks["PyDy"] = max(run["pydy_stage"]["disagreement"] for run in runs)
        if not checks["PyDy"] <= AGREES:
            raise LtcgearError(f"PyDy: accelerations differ from ours by {checks['PyDy']:.1e}, more than {AGREES:g}")
    stage = open_stage()
    rate = our_rate(stage)
    found["our_stage"]["call"] = python_time(lambda: rate(stage.at.x, stage.at.levels))
    return found


def surroundings() -> dict[str, Any]:
    """Return versions and machine."""
    versions = {"python": platform.python_version()}
    for name in PACKAGES:
        try:
            versions[name] = version(name)
        except PackageNotFoundError:
            versions[name] = "not installed"
    compiler = store.compiler()
    model = next((line.split(":")[1].strip() for line in store.processor().splitlines() if "model name" in line), "")
    return {
        "date": datetime.now(UTC).date().isoformat(), "versions": versions, "cpu": model, "cores": os.cpu_count(),
        "load": os.getloadavg()[0], "compiler": compiler.version.splitlines()[0] if compiler else "none",
        "flags": " ".join(store.FLAGS),
    }  # fmt: skip


def chosen() -> set[str]:
    """Read the command line: the parts to be measured."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.peers", description=__doc__)
    parser.add_argument("--only", nargs="+", choices=PARTS, default=PARTS, help="measure these only")
    parser.add_argument("--without", nargs="+", choices=PARTS, default=(), help="leave these out")
    given = parser.parse_args()
    parts = set(given.only) - set(given.without)
    missing = {part: name for part in parts for name in MODULES.get(part, ()) if find_spec(name) is None}
    for part, name in missing.items():
        raise LtcgearError(f"{name} is not installed: pip install 'ltcgear[peers]', or --without {part}")
    return parts


def main() -> None:
    """Measure, print, write the page and its data."""
    parts = chosen()
    checks: dict[str, float] = {}
    data: dict[str, Any] = {"surroundings": surroundings(), "left_out": sorted(set(PARTS) - parts), "checks": checks}
    told("the rig")
    data["rig"], data["calls"] = measure_rig(parts, checks)
    if "exudyn" in parts:
        told("the stage by Exudyn")
        data["stage"], data["torsion"] = (measure_stage(checks, torsional) for torsional in (False, True))
    if "pydy" in parts:
        told("the stage by PyDy")
        data["making"] = measure_making(checks)
    text = page.tables(data)
    print(text)
    Path(page.DATA).parent.mkdir(exist_ok=True)
    folders.write_folder(page.DATA.parent, {page.DATA.name: json.dumps(data, indent=1) + "\n"})
    draw_races(data, page.FIGURE)
    before, rest = page.PAGE.read_text("utf-8").split(page.BEGIN)
    after = rest.split(page.END)[1]
    folders.write_folder(page.PAGE.parent, {page.PAGE.name: before + page.BEGIN + text + page.END + after})


if __name__ == "__main__":
    try:
        main()
    except LtcgearError as failure:
        sys.exit(f"error: {failure}")
