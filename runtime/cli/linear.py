"""Command modes: small motions about the loaded equilibrium."""

from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from ltcgear.generated.errors import LtcgearError
from ltcgear.generated.writing import check_output

from ..api.restoring import choose_count, linearise_model
from ..view.tables import printed
from .app import app
from .opening import Opened, compile_model, open_scene
from .options import AsJson, Changes, Force, SceneName

if TYPE_CHECKING:
    from ..linear.system import Linear

Turn = Annotated[
    float | None,
    typer.Option("--turn", help="Hold the meshes as they stand after so many turns of the reference.",
                 show_default="means over the mesh phase"),
]  # fmt: skip
Count = Annotated[
    int | None,
    typer.Option("--count", metavar="N", help="How many of the lowest modes.", show_default="all; 40 of large trains"),
]
Drawn = Annotated[
    list[int] | None,
    typer.Option("--mode", metavar="K", help="A mode to draw, by its number.", show_default="the first 6; .html all"),
]
ModesFile = Annotated[
    Path | None,
    typer.Option("-o", "--output", show_default="none",
                 help="Table (.csv, .json), mode shapes (.png, .svg, .pdf), or moving ones (.html)."),
]  # fmt: skip
LISTS, PICTURES, PAGE = (".csv", ".json"), (".png", ".svg", ".pdf"), ".html"


@app.command()
def modes(
    scene: SceneName, turn: Turn = None, count: Count = None, mode: Drawn = None, output: ModesFile = None,
    changes: Changes = None, force: Force = False, as_json: AsJson = False,
) -> None:  # fmt: skip
    """List eigenfrequencies, damping and mode shapes at the loaded equilibrium; with -o, write or draw them."""
    from ..linear.modes import find_modes
    from ..linear.naming import describe_modes
    from ..model.topology import Topology
    from ..view.tables.mode_tables import list_modes, tabulate_modes

    if output is not None:
        check_output(output, scene)
    _check(turn, count, mode, output)
    opened = open_scene(scene, changes, output)
    linear = open_linear(opened, turn)
    wanted = choose_count(linear) if count is None else count
    found = describe_modes(linear, find_modes(linear, wanted))
    meshes = "at their mean stiffness" if turn is None else f"as they stand after {turn:g} turns"
    data: dict[str, Any] = {
        "scene": opened.scene.name, "turn": turn, "meshes": meshes, "freedoms": len(linear.positions),
        "lowest": wanted is not None, "modes": list_modes(found),
    }  # fmt: skip
    if output is not None:
        data["files"] = [str(_write(linear, found, mode, data | {"title": opened.scene.title}, output))]
    labels = Topology(linear.library.manifest).labels
    printed.show(as_json, data, lambda shown: printed.listed(tabulate_modes(shown, labels), shown.get("files", [])))


def open_linear(opened: Opened, turn: float | None = None) -> "Linear":
    """Compile a scene's model, find its equilibrium and linearise it there."""
    return linearise_model(compile_model(opened), opened.model, turn)


def _check(turn: float | None, count: int | None, chosen: list[int] | None, output: Path | None) -> None:
    """Refuse options that cannot be served, before anything is computed."""
    if turn is not None and not isfinite(turn):
        raise LtcgearError(f"--turn {turn}: not a finite number of turns; give one, for example 0.25")
    if count is not None and count < 1:
        raise LtcgearError(f"--count {count}: at least one mode is listed; give 1 or more, or leave --count out")
    if chosen and (output is None or output.suffix not in (*PICTURES, PAGE)):
        raise LtcgearError(
            "--mode: says which modes are drawn; give a picture to draw them in, for example -o modes.png"
        )
    if chosen and min(chosen) < 1:
        raise LtcgearError(f"--mode {min(chosen)}: modes are numbered from 1, as `ltcgear modes` lists them")
    if output is not None and output.suffix not in (*LISTS, *PICTURES, PAGE):
        known = ", ".join((*LISTS, *PICTURES, PAGE))
        raise LtcgearError(f"{output}: modes are written as {known}; name it {output.with_suffix('.csv')}")


def _tell_count(linear: "Linear", found: int, wanted: int) -> str:
    """Say how many modes there are, and how more are found where there are more."""
    there = len(linear.positions)
    if wanted <= there:
        return f"the lowest {found} modes were found; give a number up to that, or --count {wanted}"
    return f"there are {there} modes; give a number up to that" + (f", and --count {there}" if found < there else "")


def _write(linear: "Linear", found: list[Any], chosen: list[int] | None, data: dict[str, Any], path: Path) -> Path:
    """Write a table or draw mode shapes, by the suffix."""
    from ..view.tables.mode_tables import write_modes

    if path.suffix in LISTS:
        return write_modes(data, path)
    if chosen and max(chosen) > len(found):
        raise LtcgearError(f"--mode {max(chosen)}: {_tell_count(linear, len(found), max(chosen))}")
    from ..view.figures.shape_figures import draw_shapes
    from ..view.figures.shape_page import write_page

    if path.suffix == PAGE:
        numbers = sorted(set(chosen or range(1, len(found) + 1)))
        return write_page(linear, found, numbers, data["title"], path)
    return draw_shapes(linear, found, chosen or list(range(1, min(6, len(found)) + 1)), data["title"], path)
