"""The hard cases: what every method makes of them.

Run as ``python -m benchmarks.hard_cases``, it runs the long form and writes the tables of docs/hard-cases.md and its
figure. With the name of a JSON file, as ``ltcgear selftest --json`` prints it, nothing is run.
"""

import json
import os
import sys
from pathlib import Path
from typing import Any

from ltcgear.runtime.cli.testing import open_bench
from ltcgear.runtime.simulation.methods.registry import METHODS
from ltcgear.runtime.studies.selftest.cases import CASES
from ltcgear.runtime.studies.selftest.suite import run_suite
from ltcgear.runtime.view.tables.selftest_tables import draw_matrix, methods_of, reasons, row_of

PAGE = Path(__file__).resolve().parents[1] / "docs" / "hard-cases.md"
FIGURE = PAGE.parent / "images" / "hard-cases.png"
BEGIN, END = "<!-- hard cases -->\n", "<!-- end -->\n"


def table(data: dict[str, Any]) -> str:
    """Return the tables in Markdown: what each case must show, verdicts, then every number."""
    methods = methods_of(data)
    text = (
        f"{'Long' if data['full'] else 'Short'} form:\n\n| case | what is hard | what passes | "
        + " | ".join(methods)
        + " |\n"
    )
    text += "|---" * (3 + len(methods)) + "|\n"
    for case in data["cases"]:
        verdicts = " | ".join(result["verdict"] for result in row_of(case, methods))
        text += f"| {case['name']} | {case['title']} | {case['passes']} | {verdicts} |\n"
    text += "\n" + numbers(data)
    return text + "".join(f"\n- {reason}" for reason in reasons(data)) + "\n"


def numbers(data: dict[str, Any]) -> str:
    """Return the table of all findings: value for each method, and the limit."""
    methods = methods_of(data)
    text = "| case | finding | " + " | ".join(methods) + " | limit |\n" + "|---" * (3 + len(methods)) + "|\n"
    for case in data["cases"]:
        results = row_of(case, methods)
        for what, limit in _findings(results):
            values = " | ".join(_value(result, what, limit) for result in results)
            text += f"| {case['name']} | {what} | {values} | {limit:.2g} |\n"
        spent = " | ".join(f"{result['seconds']:.2g}" for result in results)
        text += f"| {case['name']} | seconds | {spent} | |\n"
    return text


def _findings(results: list[dict[str, Any]]) -> dict[tuple[str, float], None]:
    """Return the findings of any method with their limits, in order."""
    return {(finding["what"], finding["limit"]): None for result in results for finding in result["findings"]}


def _value(result: dict[str, Any], what: str, limit: float) -> str:
    """Return one number of a result, or a dash where the method did not get there."""
    found = (item for item in result["findings"] if (item["what"], item["limit"]) == (what, limit))
    values = [item["value"] for item in found]
    return "-" if not values else "nan" if values[0] is None else f"{values[0]:.2g}"


def main() -> None:
    """Run the long form, or read it, and write page and figure."""
    if len(sys.argv) > 1:
        data = json.loads(Path(sys.argv[1]).read_text("utf-8"))
    else:
        workers = len(os.sched_getaffinity(0))
        told = lambda done: print(f"{done:.0f} runs done", flush=True)  # noqa: E731
        data = run_suite(CASES, list(METHODS), open_bench, full=True, workers=workers, told=told)
    before, rest = PAGE.read_text("utf-8").split(BEGIN)
    PAGE.write_text(before + BEGIN + table(data) + END + rest.split(END)[1], "utf-8")
    draw_matrix(data, FIGURE)


if __name__ == "__main__":
    main()
