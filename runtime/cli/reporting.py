"""Command that writes a result as a page: report."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from ltcgear.generated.errors import LtcgearError

from .. import present
from ..options import AsJson, ResultPath
from ..results import check_target
from ..results import load as load_result
from .app import app
from .linear import FEW, MANY

if TYPE_CHECKING:
    from ltcgear.symbolic.schema import Scene

    from ..report.page import Background
    from ..results import Result

PageFile = Annotated[
    Path | None, typer.Option("-o", "--output", help="Page to write, .html.", show_default="beside the result")
]
At = Annotated[
    float | None,
    typer.Option("--at", metavar="S", help="Time in the middle of the close-up [s].", show_default="the record's end"),
]
Modes = Annotated[bool, typer.Option("--modes/--no-modes", help="Show mode shapes of the scene that the file holds.")]


@app.command()
def report(
    file: ResultPath, output: PageFile = None, at: At = None, modes: Modes = True, as_json: AsJson = False
) -> None:
    """Write a result as one page of HTML: stages in motion, figures, tables, the scene. It needs no network."""
    from ..report.page import check_templates, write_report

    target = file.parent / f"{file.stem}.html" if output is None else output
    check_target(target, file)
    if target.suffix not in (".html", ".htm"):
        raise LtcgearError(f"{target}: a report is a page of HTML; name it {target.with_suffix('.html')}")
    check_templates()
    result = load_result(file)
    write_report(result, target, find_background(result, modes), at)
    data = {"result": str(file), "file": str(target), "bytes": target.stat().st_size}
    present.show(as_json, data, lambda shown: print(f"wrote {shown['file']} ({shown['bytes'] / 1e6:.1f} MB)"))


def find_background(result: "Result", modes: bool) -> "Background":
    """Return sources and modes of the scene that a result holds; what cannot be had is left out, with the reason."""
    from ltcgear.symbolic.scene import restore_scene

    from ..report.page import Background

    text = str(result.dataset.attrs.get("scene_json", ""))
    if not text:
        return Background()
    try:
        scene = restore_scene(text)
    except LtcgearError as error:
        return Background(why_no_modes=f"the scene in the result is not understood ({error}).")
    sources = dict(scene.sources)
    if not modes:
        return Background(sources, why_no_modes="left out by --no-modes.")
    try:
        return Background(sources, **_modes(scene))
    except LtcgearError as error:
        return Background(sources, why_no_modes=f"{error}.")


def _modes(scene: "Scene") -> dict[str, Any]:
    """Return a scene's linear system and its named modes; only the lowest of a large train."""
    from ltcgear.symbolic.build import build_model
    from ltcgear.symbolic.pipeline import obtain

    from ..equilibrium import find_equilibrium
    from ..library import build
    from ..linear.modes import find_modes
    from ..linear.naming import describe_modes
    from ..linear.system import linearise

    model = build_model(scene)
    library = build(obtain(model))
    p = library.parameters(model.values())
    linear = linearise(library, p, find_equilibrium(library, p, tables=model.tables))
    wanted = FEW if len(linear.positions) > MANY else None
    return {"linear": linear, "modes": tuple(describe_modes(linear, find_modes(linear, wanted)))}
