"""Commands on result files: export."""

from typing import Any

from .. import present
from ..options import AsJson, ExportFile, Force, Outputs, ResultPath
from ..terminal import say
from .app import app


@app.command()
def export(
    file: ResultPath, output: ExportFile, outputs: Outputs = None, force: Force = False, as_json: AsJson = False
) -> None:
    """Write quantities of a result over time for other programs: CSV, or MATLAB's MAT."""
    from ..exports import check_export
    from ..exports import export as export_result
    from ..results import load

    check_export(output, file)
    export_result(load(file), output, outputs)
    data: dict[str, Any] = {"files": [str(output)]}
    present.show(as_json, data, lambda shown: say(f"wrote {output}"))
