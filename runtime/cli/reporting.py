"""Command report: a result as a page."""

from pathlib import Path
from typing import Annotated

import typer
from ltcgear.generated.errors import LtcgearError
from ltcgear.generated.writing import check_output

from ..api.restoring import find_background
from ..results.terminal import say
from ..view.tables import printed
from .app import app
from .options import AsJson, Force, ResultPath

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
    file: ResultPath,
    output: PageFile = None,
    at: At = None,
    modes: Modes = True,
    force: Force = False,
    as_json: AsJson = False,
) -> None:
    """Write a result as one page of HTML: stages in motion, figures, tables, the scene. It needs no network."""
    from ..results.result import load
    from ..view.report.page import check_templates, write_report

    target = file.with_name(f"{file.stem}.html") if output is None and file.name else output or file
    check_output(target, file)
    if target.suffix not in (".html", ".htm"):
        raise LtcgearError(f"{target}: a report is a page of HTML; name it {target.with_suffix('.html')}")
    check_templates()
    result = load(file)
    write_report(result, target, find_background(result, modes), at)
    data = {"result": str(file), "file": str(target), "bytes": target.stat().st_size}
    printed.show(as_json, data, lambda shown: say(f"wrote {shown['file']} ({shown['bytes'] / 1e6:.1f} MB)"))
