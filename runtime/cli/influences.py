"""The command that tells what to change: sensitivity."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from ltcgear.generated.errors import LtcgearError

from .. import present
from ..options import AsJson, Changes, SceneName
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


@app.command()
def sensitivity(
    scene: SceneName, mode: ModeNumber = None, top: Top = None, output: Listing = None, changes: Changes = None,
    as_json: AsJson = False,
) -> None:  # fmt: skip
    """Tell what to change: how eigenfrequencies follow every parameter."""
    from ..sensitivity.listing import check_listing, make_tables, write_listing

    if output is not None:
        check_listing(output)
    opened = open_scene(scene, changes)
    library = compile_model(opened)
    data = {"scene": opened.scene.name, **_modes(opened, library, mode)}
    shown = top or (10 if len(data["items"]) <= 2 else 3)
    files = [] if output is None else [write_listing(data, output, top or 10)]
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
