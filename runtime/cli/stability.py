"""Command stability: whether small motions grow under varying mesh stiffness."""

from pathlib import Path
from typing import Annotated

import typer

from ..view.tables import printed
from .app import app
from .opening import Opened, compile_model, open_scene
from .options import AsJson, Changes, Force, SceneName
from .progress import progress

MeshName = Annotated[
    str | None,
    typer.Option(
        "--mesh", metavar="NAME", show_default="all", help="Whose stiffness varies: a stage, as lsp, or lsp.sun_planet."
    ),
]
Speeds = Annotated[
    str | None,
    typer.Option("--speed", metavar="A:B:N", show_default="the scene's", help="Speeds of the reference [rpm]."),
]
Variations = Annotated[
    str | None,
    typer.Option(
        "--variation", metavar="A:B:N", show_default="1", help="Factors on the stiffness' deviation from its mean."
    ),
]
StabilityFile = Annotated[
    Path | None, typer.Option("-o", "--output", help="File to write, .csv, .png, .svg or .pdf.", show_default="none")
]


@app.command()
def stability(
    scene: SceneName, mesh: MeshName = None, speed: Speeds = None, variation: Variations = None,
    output: StabilityFile = None, changes: Changes = None, force: Force = False, as_json: AsJson = False,
) -> None:  # fmt: skip
    """Tell whether small motions grow under the varying mesh stiffness: Floquet multipliers, stability chart."""
    from ..view.figures.stability_figures import check_file
    from .number_ranges import read_range

    speeds = read_range("--speed", speed or "0", "100:600:60", single=True)
    variations = read_range("--variation", variation or "1", "0:2:40", single=True)
    if output is not None:
        check_file(output, scene)
    opened = open_scene(scene, changes, output)
    if len(speeds) == 1 and len(variations) == 1:
        _show_multipliers(opened, mesh, float(speeds[0]) if speed else None, float(variations[0]), output, as_json)
        return
    from ..linear.chart import RPM, draw_up
    from ..linear.periodic import reference_speed
    from ..view.figures.stability_figures import write_chart
    from ..view.tables.stability_tables import describe_chart, tabulate_chart

    library = compile_model(opened)
    p = library.parameters(opened.model.values())
    held = speeds * RPM if speed else abs(reference_speed(library, p)) + 0 * speeds
    with progress(f"stability {opened.scene.name}", len(held), "speeds") as told:
        chart = draw_up(library, p, held, variations, mesh, told)
    title = f"{opened.scene.name}: parametric stability, stiffness of {mesh or 'all meshes'} varying"
    files = [] if output is None else [write_chart(chart, title, output)]
    data = describe_chart(opened.scene.name, chart)
    printed.show(as_json, data, lambda shown: printed.listed(tabulate_chart(shown), files))


def _show_multipliers(
    opened: Opened, mesh: str | None, rpm: float | None, variation: float, output: Path | None, as_json: bool
) -> None:
    """Find the multipliers at one speed and one variation."""
    from ..linear.chart import RPM
    from ..linear.floquet import find_multipliers
    from ..linear.periodic import reference_speed, take_sense, vary
    from ..view.figures.stability_figures import write_multipliers
    from ..view.tables.stability_tables import describe_multipliers, tabulate_multipliers

    library = compile_model(opened)
    p = library.parameters(opened.model.values())
    speed = reference_speed(library, p) if rpm is None else take_sense(library, p, rpm * RPM)
    periodic = vary(library, p, mesh, speed)
    with progress(f"stability {opened.scene.name}", 1, "period") as told:
        found = find_multipliers(periodic, variation, told)
    title = f"{opened.scene.name}: Floquet multipliers at {speed / RPM:.5g} rpm, variation {variation:g}"
    files = [] if output is None else [write_multipliers(found, title, output)]
    data = {**describe_multipliers(opened.scene.name, found, speed), "variation": variation}
    printed.show(as_json, data, lambda shown: printed.listed(tabulate_multipliers(shown), files))
