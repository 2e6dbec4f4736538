"""Command sensitivity: what to change to move a frequency or an output."""

from pathlib import Path
from typing import Annotated

import typer
from ltcgear.generated.errors import LtcgearError

from ..view.tables import printed
from .app import app
from .opening import compile_model, open_scene
from .options import AsJson, Changes, EndTime, Force, Method, SceneName

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
    str, typer.Option("--measure", help="mean, rms (about zero), vibration (rms about the mean), max or min.")
]
First = Annotated[
    float | None, typer.Option("--from", help="First instant that counts [s].", show_default="half of the run")
]
AdjointTolerance = Annotated[float, typer.Option("--rtol", help="Relative tolerance of the run and its adjoint.")]


@app.command()
def sensitivity(
    scene: SceneName, mode: ModeNumber = None, output: OutputName = None, measure: Measure = "rms",
    t_end: EndTime = None, start: First = None, method: Method = "auto", rtol: AdjointTolerance = 1e-8,
    top: Top = None, file: Listing = None, changes: Changes = None, force: Force = False, as_json: AsJson = False,
) -> None:  # fmt: skip
    """Tell what to change: how eigenfrequencies, or an output of a simulation, follow every parameter."""
    from ..simulation.run_settings import check_options
    from ..studies.sensitivity.items import list_modes, list_output
    from ..view.tables.sensitivity_tables import check_listing, make_tables, write_listing

    if file is not None:
        check_listing(file, scene)
    if mode is not None and output is not None:
        raise LtcgearError("sensitivity: both --mode and --output were given; give one of them")
    check_options(method, rtol, t_end)
    opened = open_scene(scene, changes, file)
    library = compile_model(opened)
    p, tables = library.parameters(opened.model.values()), opened.model.tables
    if output is None:
        found = list_modes(library, p, tables, mode)
    else:
        end = t_end if t_end is not None else opened.scene.simulation.t_end
        window = (start if start is not None else end / 2, end)
        found = list_output(library, p, tables, output, measure=measure, window=window, method=method, rtol=rtol)
    data = {"scene": opened.scene.name, **found}
    shown = top or (10 if len(data["items"]) <= 2 else 3)
    files = [] if file is None else [write_listing(data, file, top or 10)]
    printed.show(as_json, data, lambda listed: printed.listed(make_tables(listed, shown), files))
