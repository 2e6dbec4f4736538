"""Command export-fmu: a scene for other simulation programs."""

from pathlib import Path
from typing import Annotated

import typer

from ..view.tables import printed
from .app import app
from .opening import compile_model, open_scene, rate_of
from .options import AsJson, Changes, Force, SceneName

FmuFile = Annotated[Path, typer.Option("-o", "--output", help="File to write, .fmu.")]
Kind = Annotated[
    str, typer.Option("--kind", help="co-simulation (FMI 2.0, integrator inside) or model-exchange (FMI 3.0).")
]


@app.command("export-fmu")
def export_fmu(
    scene: SceneName,
    output: FmuFile,
    kind: Kind = "co-simulation",
    changes: Changes = None,
    force: Force = False,
    as_json: AsJson = False,
) -> None:
    """Write a scene as an FMU. Loads that are one number become inputs."""
    from ..export.fmu.binary import require_compiler
    from ..export.fmu.package import check_fmu, check_kind, write_fmu

    check_kind(kind)
    check_fmu(output, scene)
    require_compiler()
    opened = open_scene(scene, changes, output, steered=True)
    library = compile_model(opened)
    written = write_fmu(
        library, opened.model.values(), output, kind=kind, name=opened.scene.name,
        title=opened.scene.title, tables=opened.model.tables, inputs=opened.inputs, t_end=opened.scene.simulation.t_end,
        rate=rate_of(opened, library),
    )  # fmt: skip
    printed.show(as_json, written, printed.exported_fmu)
