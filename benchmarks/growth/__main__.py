"""Measure, print, and write docs/growth.md and docs/data/growth.json."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from ltcgear.generated import folders
from ltcgear.runtime.results.table import Table

from .measure import apart

DOCS = Path(__file__).parents[2] / "docs"
PAGE, DATA = DOCS / "growth.md", DOCS / "data" / "growth.json"
BEGIN, END = "<!-- table -->\n", "<!-- end of table -->\n"
PLANETS, STAGES = (3, 6, 9, 12), (1, 2, 4, 8)
SWEEPS = (("planets", tuple((n, 1) for n in PLANETS)), ("stages", tuple((3, m) for m in STAGES)))
COLUMNS = {
    "planets": "planets", "stages": "stages", "states": "states", "operations": "operations",
    "jacobian": "of the Jacobian", "bytes": "bytes of C", "derive": "derive s", "compile": "compile s",
    "ns": "ns a call", "simulate": "s a simulated s", "memory": "memory MB",
}  # fmt: skip
FITTED = tuple(COLUMNS)[3:]


def exponent(rows: Sequence[dict[str, Any]], over: str, key: str) -> float:
    """Fit key = a over^b by least squares of the logarithms and return b."""
    sizes, values = (np.log([row[name] for row in rows]) for name in (over, key))
    return float(np.polyfit(sizes, values, 1)[0])


def page_table(data: dict[str, list[dict[str, Any]]]) -> str:
    """Write what was measured, and the exponents fitted to it, as Markdown."""
    lines: list[tuple[str, ...]] = []
    for over, _ in SWEEPS:
        for row in data[over]:
            lines.append(tuple(f"{row[key]:.4g}" if key in FITTED else str(row[key]) for key in COLUMNS))
        fits = (f"{exponent(data[over], over, key):.2f}" for key in FITTED)
        lines.append((f"exponent over {over}", "", "", *fits))
    return Table("", tuple(COLUMNS.values()), tuple(lines)).to_markdown()


def main() -> None:
    """Measure all trains and write the page."""
    data = {over: [apart(*size) for size in sizes] for over, sizes in SWEEPS}
    table = page_table(data)
    print(table)
    page = PAGE.read_text("utf-8")
    head, tail = page[: page.index(BEGIN) + len(BEGIN)], page[page.index(END) :]
    folders.write_folder(DATA.parent, {DATA.name: json.dumps(data, indent=1) + "\n"})
    folders.write_folder(DOCS, {PAGE.name: f"{head}{table}{tail}"})
    print(f"wrote {PAGE} and {DATA}")


if __name__ == "__main__":
    main()
