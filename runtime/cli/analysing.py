"""Command analyse: what a result shows."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from ltcgear.generated.errors import LtcgearError
from ltcgear.generated.writing import make_folder

from ..api.restoring import restore_modes
from ..view.tables import printed
from .app import app
from .options import AsJson, Force, ResultPath
from .progress import progress

if TYPE_CHECKING:
    import xarray as xr

    from ..analysis.survey import Survey
    from ..linear.modes import Mode

FORMATS = ("png", "svg", "pdf")
From = Annotated[
    float | None, typer.Option("--from", help="First instant [s].", show_default="the middle of the record")
]
To = Annotated[float | None, typer.Option("--to", help="Last instant [s].", show_default="the end")]
Outputs = Annotated[
    list[str] | None,
    typer.Option("--output", metavar="QUANTITY:ITEM", show_default="the first mesh of each group",
                 help="Output whose lines are named, e.g. acceleration:lsp.sun."),
]  # fmt: skip
Shaft = Annotated[
    str | None,
    typer.Option("--shaft", metavar="ROTOR", help="Rotor whose turns orders count.",
                 show_default="fastest of the output's stage"),
]  # fmt: skip
Band = Annotated[
    str | None,
    typer.Option("--band", metavar="LOW:HIGH", help="Band of the envelope [Hz].",
                 show_default="about the strongest harmonic of the output's mesh"),
]  # fmt: skip
Window = Annotated[str, typer.Option("--window", help="hann, flattop, blackmanharris or boxcar.")]
Resolution = Annotated[
    float | None,
    typer.Option("--resolution", help="Bins of the waterfall [Hz].", show_default="16 over its length"),
]
Lines = Annotated[int, typer.Option("--lines", min=1, max=100, help="Lines named for each output.")]
Named = Annotated[bool, typer.Option("--modes/--no-modes", help="Name lines by modes of the scene in the file too.")]
Folder = Annotated[
    Path | None,
    typer.Option("-o", "--folder", metavar="FOLDER", help="Folder for figures and CSV tables.", show_default="none"),
]
Format = Annotated[str, typer.Option("--format", help="Format of the figures: png, svg or pdf.")]


@app.command()
def analyse(
    file: ResultPath, start: From = None, stop: To = None, output: Outputs = None, shaft: Shaft = None,
    band: Band = None, window: Window = "hann", resolution: Resolution = None, lines: Lines = 12, modes: Named = True,
    folder: Folder = None, form: Format = "png", force: Force = False, as_json: AsJson = False,
) -> None:  # fmt: skip
    """Tell what a result shows: named lines, load shares, factors, transmission error, cycles, bearings, orbits."""
    from ..analysis.survey import Options
    from ..analysis.survey import analyse as survey
    from ..results.result import load
    from ..view.tables.analysis_tables import list_tables

    edges = _read_band(band)
    if form not in FORMATS:
        raise LtcgearError(f"--format {form}: must be one of {', '.join(FORMATS)}")
    if folder is not None:
        make_folder(folder)
    dataset = load(file).dataset
    options = Options(start, stop, tuple(output or ()), shaft, edges, window, resolution, lines)
    notes = list(_state(dataset))
    known = _modes(dataset, notes) if modes else ()
    found = survey(dataset, options, known)
    tables = list_tables(found)
    notes += found.notes
    files = [] if folder is None else _write(found, tables, folder, form)
    data: dict[str, Any] = {
        "file": str(file), "scene": dataset.attrs.get("scene"), "from_s": found.start_s, "to_s": found.stop_s,
        "notes": notes, "tables": {name: table.to_json() for name, table in tables.items()},
        "files": [str(path) for path in files],
    }  # fmt: skip
    printed.show(as_json, data, lambda shown: printed.analysed(shown, list(tables.values()), files))


def _read_band(text: str | None) -> tuple[float, float] | None:
    """Read LOW:HIGH [Hz]."""
    if text is None:
        return None
    low, _, high = text.partition(":")
    try:
        return float(low), float(high)
    except ValueError as error:
        raise LtcgearError(f"--band {text}: write LOW:HIGH in Hz, for example 500:1500") from error


def _state(dataset: "xr.Dataset") -> list[str]:
    """Say that a run did not reach its end."""
    status = str(dataset.attrs.get("status", "done"))
    return [] if status == "done" else [f"the run did not reach its end ({status}): this is what there is of it"]


def _modes(dataset: "xr.Dataset", notes: list[str]) -> "tuple[Mode, ...]":
    """Return the modes of the scene in the file; where there are none, this is noted."""
    found = restore_modes(str(dataset.attrs.get("scene_json", "")))
    if found.linear is None:
        notes.append(f"{found.why}: lines are named by meshes and shafts only")
    return found.modes


def _write(found: "Survey", tables: dict[str, Any], folder: Path, form: str) -> list[Path]:
    """Write tables and figures."""
    from ..view.figures.gallery import draw_survey
    from ..view.plots import save_figure

    files = [table.write_csv(folder / _file(name, "csv")) for name, table in tables.items()]
    with progress(f"draw to {folder}", 1, "") as told:
        for name, figure in draw_survey(found):
            files.append(save_figure(figure, folder / _file(name, form)))
            told(0)
    return files


def _file(name: str, suffix: str) -> str:
    """Return the name of a file; names of items come from the result and must not lead to another folder."""
    return f"{name.replace('/', '-')}.{suffix}"
