"""Ladder: the rig from mean stiffness to nearly everything, rung by rung (``python -m benchmarks.ladder``).

It prints the table and writes it between the marks of docs/ladder.md.
"""

from pathlib import Path
from typing import Any

from ltcgear.generated import folders
from ltcgear.runtime.cli.progress import progress
from ltcgear.runtime.model.building import build
from ltcgear.runtime.results.table import Cell, Table
from ltcgear.runtime.studies.cost import ROUNDS, Variant, measure_costs
from ltcgear.runtime.studies.force_comparison import MEASURES
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.scene.load import load_scene
from rich.console import Console

SCENE, T_END, RATE, RTOL = "rig-2mw", 0.5, 8192.0, 1e-6
PAGE = Path(__file__).parents[1] / "docs" / "ladder.md"
BEGIN, END = "<!-- table -->\n", "<!-- end of table -->\n"
MESHES = ("lsp.sun_planet", "lsp.ring_planet", "hsp.sun_planet", "hsp.ring_planet", "psh.mesh")

TORSION = {"effects.lateral": "off"}
MEAN = {"effects.mesh_stiffness": "mean"}
SWITCHED = {"effects.mesh_stiffness": "two-level"}
WEIGHT = {"effects.gravity": "on"}
ERRORS = {
    "effects.planet_position_error": "on",
    "stages.lsp.position_errors": '[{ planet = 2, tangential = "40 um" }]',
    "stages.hsp.position_errors": '[{ planet = 2, tangential = "30 um" }]',
    "effects.eccentricity": "on",
    "stages.psh.input.eccentricity": '{ radius = "20 um" }',
    "stages.psh.output.eccentricity": '{ radius = "10 um" }',
    "effects.transmission_error": "on",
    **{f"stages.{mesh}.transmission_error.amplitudes": '["4 um", "2 um"]' for mesh in MESHES},
    "effects.tooth_errors": "on",
    "stages.psh.mesh.tooth_errors": '[{ gear = "output", tooth = 0, error = "8 um" }]',
}
FRICTION = {
    "effects.mesh_friction": "sliding",
    **{f"stages.{mesh}.friction.coefficient": "0.06" for mesh in MESHES},
    **{f"stages.{mesh}.friction.speed": "0.02 m/s" for mesh in MESHES},
}
BEARINGS = {
    "effects.bearing_friction": "on",
    "effects.bearing_clearance": "on",
    **{f"stages.{stage}.pin.clearance": "20 um" for stage in ("lsp", "hsp")},
    **{f"stages.{stage}.pin.friction": "0.005" for stage in ("lsp", "hsp")},
    **{f"stages.{stage}.pin.diameter": "300 mm" for stage in ("lsp", "hsp")},
}
BACKLASH = {"effects.contact": "backlash", **{f"stages.{mesh}.backlash": "0.3 mm" for mesh in MESHES}}

RUNGS: tuple[tuple[str, tuple[dict[str, str], ...]], ...] = (
    ("torsional, mean stiffness", (TORSION, MEAN)),
    ("torsional, two-level stiffness", (TORSION, SWITCHED)),
    ("lateral, two-level stiffness", (SWITCHED,)),
    ("+ gravity", (SWITCHED, WEIGHT)),
    ("+ errors of pins, axes and teeth", (SWITCHED, WEIGHT, ERRORS)),
    ("+ sliding friction of meshes", (SWITCHED, WEIGHT, ERRORS, FRICTION)),
    ("+ friction and clearance of pins", (SWITCHED, WEIGHT, ERRORS, FRICTION, BEARINGS)),
    ("+ backlash", (SWITCHED, WEIGHT, ERRORS, FRICTION, BEARINGS, BACKLASH)),
)
"""Name of each rung and its settings, each with what the one below has and more."""

COLUMNS = ("rung", "states", "ops rhs", "ops Jacobian", "ns a rhs", "s a simulated s", "steps", "rhs", "switchings")


def climb(rung: tuple[str, tuple[dict[str, str], ...]]) -> Variant:
    """Build one rung."""
    name, parts = rung
    settings = {key: value for part in parts for key, value in part.items()}
    model = build_model(load_scene(SCENE, settings))
    return Variant(name, "", "", build(obtain(model)), model.values())


def measure_ladder() -> list[dict[str, Any]]:
    """Measure all rungs, the top one first, since the others are compared with it."""
    with progress("build rungs", len(RUNGS), "rungs") as told:
        variants = []
        for rung in reversed(RUNGS):
            variants.append(climb(rung))
            told(len(variants))
    with progress(f"simulate {SCENE}", ROUNDS * len(variants) * T_END) as told:
        return measure_costs(variants, t_end=T_END, rate=RATE, rtol=RTOL, told=told)


def tabulate(rows: list[dict[str, Any]]) -> Table:
    """Make the table, lowest rung first."""
    lines: list[tuple[Cell, ...]] = []
    for row in reversed(rows):
        if row["reason"]:
            lines.append((row["effect"], *(None,) * (len(COLUMNS) + len(MEASURES) - 1)))
            continue
        sizes = (row["states"], row["ops"]["rhs"], row["ops"]["jacobian"])
        times = (round(row["ns_call"]), round(row["seconds_per_simulated_second"], 3))
        counts = tuple(row["counts"][key] for key in ("steps", "rhs", "events"))
        changes = tuple(None if row["changes"][key] is None else f"{row['changes'][key]:+.1%}" for key in MEASURES)
        lines.append((row["effect"], *sizes, *times, *counts, *changes))
    notes = tuple(f"{row['effect']}: {row['reason']}" for row in rows if row["reason"])
    headings = ("vibration", "peak", "load share", "spectrum")
    title = f"{SCENE}, {T_END} s, erk, rtol {RTOL:g}; changes against the top rung, worst mesh"
    return Table(title, (*COLUMNS, *headings), tuple(lines), notes)


def markdown(table: Table) -> str:
    """Write a table with its title and notes as Markdown."""
    notes = "".join(f"{note}\n" for note in ("", *table.notes)) if table.notes else ""
    return f"{table.title}:\n\n{table.to_markdown()}{notes}"


def main() -> None:
    """Measure, print, and write the page."""
    table = tabulate(measure_ladder())
    table.print(Console(width=160))
    page = PAGE.read_text("utf-8")
    head, tail = page[: page.index(BEGIN) + len(BEGIN)], page[page.index(END) :]
    folders.write_folder(PAGE.parent, {PAGE.name: f"{head}\n{markdown(table)}\n{tail}"})
    print(f"wrote {PAGE}")


if __name__ == "__main__":
    main()
