"""Options and arguments that commands share: names, help and bounds."""

from pathlib import Path
from typing import Annotated

import typer
from ltcgear.generated import writing

from ..simulation.methods.registry import AUTO, METHODS

SHORTEST_PAPER = 0.2  # [s]: half of it must hold some turns of the slowest mesh for tables and spectra

SceneName = Annotated[
    str, typer.Argument(metavar="SCENE", help="A shipped scene (see `ltcgear scenes`) or a TOML file.")
]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else on stdout.")]
Changes = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Replace a value of the scene, e.g. effects.mesh_law=paper."),
]
MaybeScene = Annotated[str | None, typer.Argument(metavar="[SCENE]", help="The scene whose equations are checked.")]
Sources = Annotated[bool, typer.Option("--sources", help="Say where each number comes from.")]
Printed = Annotated[bool, typer.Option("--paper", help="Compare the paper's printed equations with the derivation.")]
Fresh = Annotated[bool, typer.Option("--fresh", help="Derive again even if the store has it.")]
CFolder = Annotated[
    Path | None, typer.Option("-o", "--output", help="Folder for C and manifest.", show_default="the store's")
]
ResultFile = Annotated[
    Path | None, typer.Option("-o", "--output", help="NetCDF4 file to write, .nc.", show_default="none")
]
Resume = Annotated[
    bool, typer.Option("--resume", help="Go on with a run that was stopped or killed; give what it was given.")
]
Force = Annotated[
    bool,
    typer.Option(
        "--force", callback=writing.force, help="Write over whatever is there: another kind of file, an unfinished run."
    ),
]
ResultFolder = Annotated[Path, typer.Option("-o", "--output", help="Folder for result and figures.")]
EndTime = Annotated[
    float | None, typer.Option("--t-end", help="Time to simulate [s].", show_default="simulation.t_end of the scene")
]
SamplingRate = Annotated[
    float | None,
    typer.Option("--rate", metavar="HZ", help="Samples a second [Hz].", show_default="the scene's, or chosen for it"),
]
PaperEnd = Annotated[float, typer.Option("--t-end", help=f"Time to simulate [s], {SHORTEST_PAPER} at least.")]
*_FIRST, _LAST = (AUTO, *METHODS)
Method = Annotated[str, typer.Option("--method", help=f"{', '.join(_FIRST)} or {_LAST}.")]
Raw = Annotated[
    bool,
    typer.Option("--raw", help="Keep outputs of the instant, not band-limited: jumps then show as false lines."),
]
Tolerance = Annotated[float, typer.Option("--rtol", help="Relative tolerance; it refers to vibrations.")]
Verify = Annotated[
    bool, typer.Option("--verify", help="Estimate the accuracy of mesh forces by runs at the tolerance and a tenth.")
]
Long = Annotated[bool, typer.Option("--long", help="Begin a run too that is reckoned to take more than an hour.")]
Accuracy = Annotated[
    str | None,
    typer.Option(
        "--accuracy", metavar="PERCENT", show_default="none",
        help="Take the fastest method and tolerance for this error of mesh forces, e.g. 0.1%.",
    ),
]  # fmt: skip
RecordFile = Annotated[
    Path | None,
    typer.Option(
        "--record", metavar="FILE", show_default="the store's, made now if there is none",
        help="What `ltcgear accuracy -o` wrote, for --accuracy.",
    ),
]  # fmt: skip
CostEnd = Annotated[float, typer.Option("--t-end", help="Time to simulate each variant [s].")]
BookFile = Annotated[Path, typer.Option("-o", "--output", help="File to write, .html or .tex.")]
FigureFile = Annotated[
    Path | None, typer.Option("-o", "--output", help="Figure to write, .png, .svg or .pdf.", show_default="none")
]
ResultPath = Annotated[Path, typer.Argument(metavar="FILE", help="A result file, as `ltcgear simulate -o` writes it.")]
ExportFile = Annotated[Path, typer.Option("-o", "--file", help="File to write, .csv or .mat.")]
Outputs = Annotated[
    list[str] | None,
    typer.Option(
        "--output", metavar="QUANTITY[:ITEM]", show_default="all",
        help="What to take, e.g. mesh_force or mesh_force:psh.mesh; may be given again.",
    ),
]  # fmt: skip
