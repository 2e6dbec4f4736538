"""Command export: result files for other programs."""

from typing import Any

from ..results.terminal import say
from ..view.tables import printed
from .app import app
from .options import AsJson, ExportFile, Force, Outputs, ResultPath


@app.command()
def export(
    file: ResultPath, output: ExportFile, outputs: Outputs = None, force: Force = False, as_json: AsJson = False
) -> None:
    """Write quantities of a result over time for other programs: CSV, or MATLAB's MAT."""
    from ..results.result import load
    from ..results.table_export import check_export
    from ..results.table_export import export as export_result

    check_export(output, file)
    export_result(load(file), output, outputs)
    data: dict[str, Any] = {"files": [str(output)]}
    printed.show(as_json, data, lambda shown: say(f"wrote {output}"))
