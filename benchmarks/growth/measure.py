"""One train, measured from its scene to its simulation in a process of its own."""

import json
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from ltcgear.generated import store
from ltcgear.runtime.model.building import build
from ltcgear.runtime.model.function import Kernel
from ltcgear.runtime.simulation.simulate import simulate
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import generate

from .scenes import train

T_END, RATE, METHOD, RTOL = 0.05, 8192.0, "erk", 1e-6
BATCH, BLOCKS, COMPILED, RUNS = 500, 20, 2, 3


def measure(planets: int, stages: int) -> dict[str, Any]:
    """Measure a train: operations, bytes of C, seconds, ns a call, memory [MB] at its most."""
    model = build_model(train(planets, stages))
    laps: dict[str, float] = {}
    artifact = generate(model, lambda stage, seconds: laps.update({stage: seconds}))
    counts = artifact.manifest.functions
    return {
        "planets": planets, "stages": stages, "states": len(artifact.manifest.states),
        "operations": counts["motion"].operations, "jacobian": counts["jac_rhs"].operations, "bytes": len(artifact.c),
        "derive": laps["derive"] + laps["check"] + laps["emit"], "compile": compile_seconds(artifact.c),
        **_run(build(artifact), model.values()),
        "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    }  # fmt: skip


def compile_seconds(text: str) -> float:
    """Return the least seconds of several compilations, none of them kept."""
    compiler, least = store.compiler(), np.inf
    if compiler is None:
        raise SystemExit("growth needs a C compiler: install gcc or clang")
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder, "model.c")
        source.write_text(text, encoding="utf-8")
        for _ in range(COMPILED):
            clock = perf_counter()
            subprocess.run([*compiler.command, *store.flags(), str(source), "-o", f"{folder}/model.so"], check=True)
            least = min(least, perf_counter() - clock)
    return float(least)


def _run(library: Any, values: dict[str, float]) -> dict[str, float]:  # noqa: ANN401
    """Return ns a call of ``motion`` and seconds a simulated second."""
    runs = [simulate(library, values, t_end=T_END, rate=RATE, method=METHOD, rtol=RTOL) for _ in range(RUNS)]
    seconds = min(run.summary["seconds"]["integrate"] for run in runs) / T_END
    batch = Kernel(library.functions["motion"].map(BATCH))
    x = np.zeros(len(library.manifest.states))
    for array, value in zip(batch.arguments, (x, np.zeros(0), library.parameters(values)), strict=True):
        array[:] = np.tile(value, BATCH)
    calls = []
    for _ in range(BLOCKS):
        clock = perf_counter()
        batch.evaluate()
        calls.append((perf_counter() - clock) / BATCH)
    return {"ns": 1e9 * min(calls), "simulate": seconds}


def apart(planets: int, stages: int) -> dict[str, Any]:
    """Measure in a process of its own, so that memory and warm caches are those of this train."""
    command = [sys.executable, "-m", "benchmarks.growth.measure", str(planets), str(stages)]
    run = subprocess.run(command, check=True, capture_output=True, text=True)
    result: dict[str, Any] = json.loads(run.stdout.splitlines()[-1])
    return result


if __name__ == "__main__":
    measure(3, 1)  # element types are derived once a process; what is measured is how trains of them grow
    print(json.dumps(measure(*map(int, sys.argv[1:3]))))
