"""The command that tells what to change: sensitivity."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from ltcgear.generated.errors import LtcgearError

from .. import present
from ..options import AsJson, Changes, EndTime, Method, SceneName
from .app import app
from .opening import Opened, compile_model, open_scene

if TYPE_CHECKING:
    from ..library import Library

ModeNumber = Annotated[
    int | None,
    typer.Option("--mode", min=1, help="Number of a mode in the list of `modes`.", show_default="all"),
]
Top = Annotated[
    int | None, typer.Option("--top", min=1, help="How many parameters to show.", show_default="10; 3 of many modes")
]
Listing = Annotated[
    Path | None, typer.Option("-o", "--file", help="File to write: .csv, .png, .svg or .pdf.", show_default="none")
]


OutputName = Annotated[
    str | None,
    typer.Option(
        "--output", metavar="QUANTITY:ITEM", help="An output of a simulation.", show_default="eigenfrequencies"
    ),
]
Measure = Annotated[
    str, typer.Option("--measure", help="mean, rms (about zero) or vibration (rms about the mean) of the output.")
]
First = Annotated[
    float | None, typer.Option("--from", help="First instant that counts [s].", show_default="half of the run")
]
AdjointTolerance = Annotated[float, typer.Option("--rtol", help="Relative tolerance of the run and its adjoint.")]


@app.command()
def sensitivity(
    scene: SceneName, mode: ModeNumber = None, output: OutputName = None, measure: Measure = "rms",
    t_end: EndTime = None, start: First = None, method: Method = "auto", rtol: AdjointTolerance = 1e-8,
    top: Top = None, file: Listing = None, changes: Changes = None, as_json: AsJson = False,
) -> None:  # fmt: skip
    """Tell what to change: how eigenfrequencies, or an output of a simulation, follow every parameter."""
    from ..sensitivity.listing import check_listing, make_tables, write_listing
    from ..simulation import check_options

    if file is not None:
        check_listing(file)
    if mode is not None and output is not None:
        raise LtcgearError("sensitivity: both --mode and --output were given; give one of them")
    check_options(method, rtol, t_end)
    opened = open_scene(scene, changes)
    library = compile_model(opened)
    if output is None:
        data = {"scene": opened.scene.name, **_modes(opened, library, mode)}
    else:
        end = t_end if t_end is not None else opened.scene.simulation.t_end
        first = start if start is not None else end / 2
        data = {"scene": opened.scene.name, **_output(opened, library, output, measure, (first, end), method, rtol)}
    shown = top or (10 if len(data["items"]) <= 2 else 3)
    files = [] if file is None else [write_listing(data, file, top or 10)]
    present.show(as_json, data, lambda listed: present.listed(make_tables(listed, shown), files))


def _modes(opened: Opened, library: "Library", mode: int | None) -> dict[str, Any]:
    """Return how eigenfrequencies follow the parameters."""
    from ..equilibrium import find_equilibrium
    from ..linear.modes import find_modes
    from ..linear.sensitivity import differentiate_modes
    from ..linear.system import linearise
    from ..sensitivity.ranking import list_influences

    p = library.parameters(opened.model.values())
    linear = linearise(library, p, find_equilibrium(library, p, tables=opened.model.tables))
    modes = find_modes(linear)
    if mode is not None and mode > len(modes):
        raise LtcgearError(f"--mode {mode}: {opened.scene.name} has {len(modes)} modes; `ltcgear modes` lists them")
    if mode is not None and modes[mode - 1].kind == "rigid":
        raise LtcgearError(f"--mode {mode}: a rigid-body mode, 0 Hz whatever the parameters; give another")
    items = []
    for found in differentiate_modes(linear, modes, None if mode is None else [mode]):
        many = f", {found.repeated} alike" if found.repeated > 1 else ""
        beside = {"damping ratio": found.damping_ratio}
        rows = list_influences(library.manifest, p, found.mode.frequency_hz, found.frequency_hz, beside)
        items.append(
            {
                "name": f"mode {found.number} ({found.mode.kind}{many})", "mode": found.number, "unit": "Hz",
                "value": found.mode.frequency_hz, "damping_ratio": found.mode.damping_ratio, "class": found.mode.kind,
                "repeated": found.repeated, "influences": [row.to_json() for row in rows],
            }
        )  # fmt: skip
    return {"title": "what moves its eigenfrequencies", "unit": "Hz", "items": items}


def _output(
    opened: Opened, library: "Library", output: str, measure: str, window: tuple[float, float], method: str, rtol: float
) -> dict[str, Any]:
    """Return how an output of a simulation follows the parameters."""
    from ..choice import choose
    from ..equilibrium import find_equilibrium
    from ..sensitivity.adjoint import differentiate_output
    from ..sensitivity.ranking import is_continuous, list_influences
    from ..sensitivity.worth import check_measure, find_output
    from ..simulation import AUTO

    (start, end), tables = window, opened.model.tables
    check_measure(measure, start, end)
    place = find_output(library.manifest, output)
    p = library.parameters(opened.model.values())
    at = find_equilibrium(library, p, tables=tables)
    chosen = choose(library, at, p, rtol).method if method == AUTO else method
    found = differentiate_output(
        library, p, at, place, measure=measure, start=start, t_end=end, method=chosen, rtol=rtol, tables=tables
    )
    unit = library.manifest.reports[place].unit
    rows = list_influences(library.manifest, p, found.value, found.gradient)
    sided = [name for name in found.one_sided if is_continuous(name)]
    notes = [f"starts on a border of its mesh, derivative for a phase that has gone on: {', '.join(sided)}"] * bool(
        sided
    )
    notes += [
        f"a jump falls on t = {t:g} s, derivatives hold to one side: move it with --from or --t-end"
        for t in found.edges
    ]
    item = {
        "name": f"{measure} of {output}, {start:g} to {end:g} s", "unit": unit, "value": found.value,
        "method": chosen, "pieces": found.pieces, "steps": found.steps, "one_sided": sided,
        "notes": notes, "influences": [row.to_json() for row in rows],
    }  # fmt: skip
    return {"title": f"what moves the {measure} of {output}", "unit": unit, "items": [item]}
