"""Commands campbell and response: resonance."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer
from ltcgear.generated.errors import LtcgearError
from ltcgear.generated.writing import check_output, write_text

from ..results.terminal import say
from ..view.tables import printed
from .app import app
from .linear import open_linear
from .opening import compile_model, open_scene
from .options import AsJson, Changes, Force, SceneName
from .progress import progress

NumbersFile = Annotated[
    Path | None,
    typer.Option("-o", "--output", help="Figure (.png, .svg, .pdf) or numbers (.csv, .json).", show_default="none"),
]
SpeedRange = Annotated[
    str | None,
    typer.Option(
        "--speed", metavar="FIRST:LAST:NUMBER", help="Speeds of the reference [rpm].",
        show_default="0 to 1.5 times the scene's, 61",
    ),
]  # fmt: skip
LoadRange = Annotated[
    str | None,
    typer.Option("--load", metavar="FIRST:LAST:NUMBER", help="Factors of all torques.", show_default="none"),
]
Harmonics = Annotated[int, typer.Option("--harmonics", min=1, max=20, help="Harmonics of each mesh frequency.")]
Sidebands = Annotated[
    bool, typer.Option("--sidebands", help="Orders beside them too, at a carrier's turns and planets' passes.")
]
Excited = Annotated[
    str, typer.Option("--excite", metavar="MESH|LOAD", help="A mesh, by its transmission error, or a load's torque.")
]
From = Annotated[float | None, typer.Option("--from", help="Lowest frequency [Hz].", show_default="from the modes")]
To = Annotated[float | None, typer.Option("--to", help="Highest frequency [Hz].", show_default="from the modes")]


@app.command()
def campbell(
    scene: SceneName, speed: SpeedRange = None, load: LoadRange = None, harmonics: Harmonics = 3,
    sidebands: Sidebands = False, output: NumbersFile = None, changes: Changes = None,
    force: Force = False, as_json: AsJson = False,
) -> None:  # fmt: skip
    """Follow eigenfrequencies over speed or load, and find where orders of the meshes meet them."""
    from ..linear.campbell import sweep_load, sweep_speed
    from ..linear.crossings import find_crossings
    from ..linear.orders import list_orders
    from ..linear.resonance import tell_campbell, write_campbell
    from ..view.figures.resonance_figures import draw_campbell
    from ..view.tables.resonance_tables import tabulate_crossings
    from .number_ranges import read_range

    if speed is not None and load is not None:
        raise LtcgearError("campbell: both --speed and --load were given; give one of them")
    values = read_range("--speed", speed, "0:20:61") if speed is not None else None
    factors = read_range("--load", load, "0.2:2:31") if load is not None else None
    _check(output, scene)
    opened = open_scene(scene, changes, output)
    library = compile_model(opened)
    p, tables = library.parameters(opened.model.values()), opened.model.tables
    with progress(f"linearise {opened.scene.name}", 100, "points") as told:
        if factors is None:
            found = sweep_speed(library, p, values, tables=tables, told=told)
        else:
            found = sweep_load(library, p, factors, tables=tables, told=told)
    orders = list_orders(library.manifest, p, harmonics, sidebands)
    data = tell_campbell(opened.scene.name, found, orders, find_crossings(found, orders))
    printed.show_tables(as_json, data, tabulate_crossings)
    _write(output, data, as_json, write_campbell, draw_campbell)


@app.command()
def response(
    scene: SceneName, excite: Excited, lowest: From = None, highest: To = None, output: NumbersFile = None,
    changes: Changes = None, force: Force = False, as_json: AsJson = False,
) -> None:  # fmt: skip
    """Compute how forces answer to a sinusoidal error of a mesh [m], or to a ripple of a torque [N m]."""
    from ..linear.modes import find_modes
    from ..linear.naming import describe_modes
    from ..linear.resonance import tell_response, write_response
    from ..linear.response import choose_frequencies, respond
    from ..model.members import train_of
    from ..view.figures.resonance_figures import draw_response
    from ..view.tables.resonance_tables import tabulate_response

    _check(output, scene)
    opened = open_scene(scene, changes, output)
    linear = open_linear(opened)
    modes = describe_modes(linear, find_modes(linear))
    found = respond(linear, excite, choose_frequencies(modes, lowest, highest))
    data = tell_response(opened.scene.name, found, modes, train_of(linear.library.manifest))
    printed.show_tables(as_json, data, tabulate_response)
    _write(output, data, as_json, write_response, draw_response)


def _check(path: Path | None, scene: str) -> None:
    """Refuse a file that cannot be written, before anything is computed."""
    from ..linear.resonance import check_suffix

    if path is not None:
        check_output(path, scene)
        check_suffix(path)


def _write(
    path: Path | None, data: dict[str, Any], as_json: bool,
    write: Callable[[dict[str, Any], Path], None], draw: Callable[[dict[str, Any], Path], None],
) -> None:  # fmt: skip
    """Write what is asked for, and say so."""
    if path is None:
        return
    if path.suffix == ".json":
        write_text(json.dumps(data) + "\n", path)
    else:
        (write if path.suffix == ".csv" else draw)(data, path)
    if not as_json:
        say(f"wrote {path}")
