"""Modes of the rig beside the paper's Table 8, and what modes of a long train take: writes docs/modes.md's tables.

Run as ``OPENBLAS_NUM_THREADS=1 python -m benchmarks.modes``; it takes a minute.
"""

import json
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from time import perf_counter
from typing import Any
from unittest.mock import patch

from ltcgear.generated import store
from ltcgear.runtime.linear.modes import Mode, find_modes
from ltcgear.runtime.linear.naming import describe_modes, sum_by
from ltcgear.runtime.linear.system import Linear, linearise
from ltcgear.runtime.model.building import build
from ltcgear.runtime.model.equilibrium import find_equilibrium
from ltcgear.runtime.model.library import Library
from ltcgear.runtime.model.operating_point import OperatingPoint
from ltcgear.runtime.model.topology import Topology
from ltcgear.runtime.results.amplitude_spectrum import Sources
from ltcgear.runtime.results.table import Table
from ltcgear.runtime.studies.accuracy.machine import describe_machine
from ltcgear.runtime.studies.wu2021.line_origins import forced_name, printed_lines
from ltcgear.runtime.view.figures.shape_figures import draw_shapes
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.describe.geometry_report import describe
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.mechanics.model import Model
from ltcgear.symbolic.scene.builder import SceneBuilder
from ltcgear.symbolic.scene.load import load_scene
from ltcgear.symbolic.schema.scene_schema import Scene

from .growth.scenes import stage_keys
from .marks import put

DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGE, DATA, FIGURE = DOCS / "modes.md", DOCS / "data" / "modes.json", DOCS / "images" / "modes-rig.png"
STAGES, PLANETS, FEW, ROUNDS = 15, 12, 40, 5
DRAWN = [1, 2, 3, 5, 10, 35]
"""Modes of the figure: one of each kind of motion."""


def long_train(stages: int, planets: int) -> Scene:
    """Put planetary stages in a row, of which every other one is turned round, so that no shaft turns fast.

    Parameters
    ----------
    stages
        How many; each has a sun, a carrier and its planets, and a ring that is fixed.
    planets
        Planets of each stage.
    """
    scene = SceneBuilder(f"{stages} stages of {planets} planets", mesh_stiffness="mean")
    for k in range(1, stages + 1):
        scene.planetary(f"stage{k}", **stage_keys(planets))
    for k in range(1, stages):
        end = "sun" if k % 2 else "carrier"
        ends = f"stage{k}.{end}", f"stage{k + 1}.{end}"
        scene.coupling(f"shaft{k}", *ends, stiffness="1e7 N*m/rad", damping_ratio=0.02)
    last = "sun" if stages % 2 else "carrier"
    scene.load("drive", "stage1.carrier", speed="2 rpm").load("brake", f"stage{stages}.{last}", torque="-5 N*m")
    return scene.build()


def rig() -> tuple[Scene, Linear, list[Mode]]:
    """Return the rig, linearised, and its modes."""
    scene = load_scene("rig-2mw")
    model = build_model(scene)
    library = build(obtain(model))
    p = library.parameters(model.values())
    linear = linearise(OperatingPoint(library, p, find_equilibrium(library, p)))
    return scene, linear, describe_modes(linear, find_modes(linear))


def list_table(modes: list[Mode], topology: Topology) -> str:
    """Return the rig's modes in Markdown."""
    told = {name: topology.links[group].told for name, group in topology.groups.items()}
    columns = "mode", "Hz", "damping", "class", "what it is", "kinetic energy", "strain energy"
    rows = []
    for k, mode in enumerate(modes, start=1):
        kinetic = _largest(sum_by(mode.members, topology.labels))
        strain = _largest(sum_by(mode.strain, told))
        alike = f" x{mode.multiplicity}" if mode.multiplicity > 1 else ""
        numbers = k, f"{mode.frequency_hz:.2f}", f"{mode.damping_ratio:.2%}"
        rows.append((*numbers, f"{mode.kind}{alike}", mode.name, kinetic, strain))
    return Table("", columns, tuple(rows)).to_markdown()


def _largest(shares: dict[str, float]) -> str:
    """Write the two largest shares; what is less than a percent is left out."""
    return ", ".join(f"{name} {share:.0%}" for name, share in list(shares.items())[:2] if share > 0.01)


def lines(scene: Scene) -> dict[float, tuple[str, list[str]]]:
    """Return the lines of Table 8: what explains each but for a free vibration, and where it was seen."""
    told = describe(scene)
    meshes = {name: stage["mesh_frequency_hz"] for name, stage in told["stages"].items()}
    carriers = {f"{name}.carrier": name for name in told["stages"] if f"{name}.carrier" in told["members"]}
    turns = {name: abs(told["members"][name]["speed_rpm"]) / 60 for name in carriers}
    sources = Sources(meshes, turns, stages=carriers)
    return {value: (forced_name(value, sources), places) for value, places in printed_lines().items()}


def line_table(scene: Scene, modes: list[Mode]) -> str:
    """Return the lines that are no harmonics or sidebands beside the modes next to them, in Markdown."""
    rows = []
    for value, (name, places) in lines(scene).items():
        if not name:
            mode = min(modes, key=lambda mode: abs(mode.frequency_hz - value))
            off = mode.frequency_hz / value - 1
            next_to = f"{mode.frequency_hz:.1f}", f"{off:+.1%}", mode.kind, mode.name
            rows.append((f"{value:g}", "; ".join(places), *next_to))
    columns = "line Hz", "where", "next mode Hz", "off", "class", "what it is"
    return Table("", columns, tuple(rows)).to_markdown()


def explained(scene: Scene) -> str:
    """Return the lines that are harmonics or sidebands, in a sentence."""
    named = [f"{value:g} ({name})" for value, (name, _) in lines(scene).items() if name]
    return "Harmonics and sidebands: " + ", ".join(named) + ".\n"


def measure() -> dict[str, Any]:
    """Measure the steps of modes after loading, least of some rounds [s], for the rig and a long train."""
    cases = {"rig-2mw": (load_scene("rig-2mw"), None), "long": (long_train(STAGES, PLANETS), FEW)}
    found: dict[str, Any] = {"machine": describe_machine(), "cases": {}}
    for name, (scene, count) in cases.items():
        model = build_model(scene)
        # To compile the long train's C takes minutes, and its functions are called a few times only.
        with nullcontext() if count is None else patch.object(store, "compiler", return_value=None):
            library = build(obtain(model))
        rounds = [_round(library, model, count) for _ in range(ROUNDS)]
        seconds = {key: min(one[key] for one in rounds) for key in rounds[0]}
        members = sum(body.inertia is not None for body in model.bodies)
        found["cases"][name] = {
            "title": scene.title, "members": members, "freedoms": len(library.index("")), "count": count,
            "seconds": seconds, "total": min(sum(one.values()) for one in rounds),
        }  # fmt: skip
    return found


def _round(library: Library, model: Model, count: int | None) -> dict[str, float]:
    """Take a model from its parameters to its modes once, graphs read anew."""
    library.__dict__.pop("graphs", None)
    p, seconds = library.parameters(model.values()), {}

    def timed(name: str, work: Callable[[], Any]) -> Any:  # noqa: ANN401
        clock = perf_counter()
        made = work()
        seconds[name] = perf_counter() - clock
        return made

    at = timed("equilibrium", lambda: find_equilibrium(library, p, tables=model.tables))
    linear = timed("linearise", lambda: linearise(OperatingPoint(library, p, at)))
    modes = timed("eigenvalues", lambda: find_modes(linear, count))
    timed("strain and names", lambda: describe_modes(linear, modes))
    return seconds


def time_table(data: dict[str, Any]) -> str:
    """Return what was measured, in Markdown."""
    names = list(data["cases"]["long"]["seconds"])
    rows = []
    for name, case in data["cases"].items():
        title = case["title"] if name == "long" else name
        cells = (f"{case['seconds'][key]:.3f}" for key in names)
        sizes = case["members"], case["freedoms"], case["count"] or "all"
        rows.append((title, *sizes, *cells, f"{case['total']:.2f}"))
    columns = "train", "members", "freedoms", "modes", *names, "together"
    return Table("", columns, tuple(rows)).to_markdown()


def main() -> None:
    """Compute and measure, write page, data and figure."""
    scene, linear, modes = rig()
    draw_shapes(linear, modes, DRAWN, scene.title, FIGURE)
    data = measure()
    DATA.write_text(json.dumps(data, indent=1) + "\n", "utf-8")
    put(PAGE, {
        "list": list_table(modes, Topology(linear.library.manifest)), "lines": line_table(scene, modes),
        "explained": explained(scene), "times": time_table(data),
    })  # fmt: skip
    print(PAGE.read_text("utf-8"))


if __name__ == "__main__":
    main()
