"""Callable: what a call of the right-hand side from Python takes over the same C called from C.

Run as ``python -m benchmarks.callable``; it takes half a minute and writes the tables of docs/own-solver.md and
docs/data/callable.json.
"""

import ctypes
import json
from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from ltcgear.generated import folders
from ltcgear.runtime.export.solver.dynamics import Dynamics
from ltcgear.runtime.model.building import build
from ltcgear.runtime.model.function import Kernel
from ltcgear.runtime.model.rows import Batch
from ltcgear.runtime.results.table import Cell, Table
from ltcgear.runtime.studies.accuracy.machine import describe_machine
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.scene.load import load_scene

from .marks import put

DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGE, DATA = DOCS / "own-solver.md", DOCS / "data" / "callable.json"
SCENES = ("psh", "lsp", "rig-2mw", "start-up")
CALLS, ROUNDS = 1000, 60
"""Calls that are timed at once, and how often, in turn; the least time of each counts."""
WAYS = {
    "Dynamics": "`Dynamics.rhs`, which lets other threads run",
    "held": "`Dynamics.rhs` after `hold`",
    "locked": "the same C by `ctypes.PyDLL`, which does not",
    "kernel": "`rhs` by CasADi on bound buffers, levels given",
    "casadi": "`rhs` by CasADi as it is, levels given",
}
"""Ways to call from Python."""


def batched(library: Any, x: Any, s: Any, p: Any) -> Callable[[], object]:  # noqa: ANN401
    """Return what calls the right-hand side from a loop in C."""
    batch, rows = Batch(library, "rhs"), np.tile(x, (CALLS, 1))
    return lambda: batch(rows, s, p)


def repeated(call: Callable[[], object]) -> Callable[[], object]:
    """Return what calls from a loop in Python."""

    def run() -> None:
        for _ in range(CALLS):
            call()

    return run


def locked_rhs(dynamics: Dynamics) -> Callable[..., Any]:
    """Return ``Dynamics.rhs`` by a call that holds the interpreter's lock."""
    call, address = ctypes.PYFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_double), dynamics._address
    run = call(ctypes.cast(dynamics._run, ctypes.c_void_p).value)
    to_x, to_p, rate = dynamics._x, dynamics._p, dynamics._rate

    def rhs(t: float, x: Any, p: Any) -> Any:  # noqa: ANN401
        to_x[:], to_p[:] = x, p
        run(address, t)
        return rate.copy()

    return rhs


def ways(name: str) -> tuple[dict[str, Any], dict[str, Callable[[], object]]]:
    """Return a scene's sizes, and what calls its right-hand side in each way so many times."""
    model = build_model(load_scene(name))
    library = build(obtain(model))
    free, held = (Dynamics(library, model.values(), model.tables) for _ in range(2))
    x, p = free.x0, free.p.copy()
    held.hold(0.0, x)
    free.rhs(0.0, x, p)
    s, kernel, function = free._arrays["s"].copy(), Kernel(library.functions["rhs"]), library.functions["rhs"]
    locked = locked_rhs(free)
    calls = {
        "C": batched(library, x, s, p),
        "Dynamics": repeated(lambda: free.rhs(0.0, x, p)),
        "held": repeated(lambda: held.rhs(0.0, x, p)),
        "locked": repeated(lambda: locked(0.0, x, p)),
        "kernel": repeated(lambda: kernel(x, s, p)[0].copy()),
        "casadi": repeated(lambda: function(x, s, p)),
        "jac": repeated(lambda: free.jac(0.0, x, p)),
    }
    return {"states": len(x), "parameters": len(p)}, calls


def measure(name: str) -> dict[str, Any]:
    """Time all ways in turn; return the least time of a call by each [s]."""
    found, calls = ways(name)
    found["seconds"] = {}
    for turn in range(ROUNDS):
        for way, call in calls.items():
            if way == "casadi" and turn >= ROUNDS // 10:
                continue
            clock = perf_counter()
            call()
            passed = (perf_counter() - clock) / CALLS
            found["seconds"][way] = min(passed, found["seconds"].get(way, np.inf))
    return found


def overhead(found: dict[str, Any], way: str = "Dynamics") -> float:
    """Return what a call takes over one from C [ns], an empty turn of Python's loop included."""
    return 1e9 * float(found["seconds"][way] - found["seconds"]["C"])


def scene_table(data: dict[str, Any]) -> str:
    """Return what calls take, scene by scene, in Markdown."""
    lines: list[tuple[Cell, ...]] = []
    for name, found in data["scenes"].items():
        times = {way: f"{1e9 * value:.0f} ns" for way, value in found["seconds"].items()}
        cells = (name, found["states"], found["parameters"], times["C"], times["Dynamics"])
        lines.append((*cells, f"{overhead(found):.0f} ns", times["jac"]))
    columns = ("scene", "states", "parameters", "from C", "`rhs`", "over C", "`jac`")
    return f"\n{Table('', columns, tuple(lines)).to_markdown()}\n"


def way_table(data: dict[str, Any]) -> str:
    """Return what the ways take over C, in Markdown."""
    rows = tuple(
        (told, *(f"{overhead(data['scenes'][name], way):.0f} ns" for name in SCENES)) for way, told in WAYS.items()
    )
    return f"\n{Table('', ('way', *SCENES), rows).to_markdown()}\n"


def main() -> None:
    """Measure, print the tables, and write page and data."""
    data = {"machine": describe_machine(), "scenes": {name: measure(name) for name in SCENES}}
    tables = {"overhead": scene_table(data), "ways": way_table(data)}
    print(*tables.values())
    folders.write_folder(DATA.parent, {DATA.name: json.dumps(data, indent=1) + "\n"})
    put(PAGE, tables)


if __name__ == "__main__":
    main()
