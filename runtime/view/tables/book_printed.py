"""Terminal output of ``ltcgear book``."""

from typing import Any

from ...results.table import Table
from ...results.terminal import Terminal

Data = dict[str, Any]


def book(data: Data) -> None:
    """Print what a book holds."""
    rows = tuple((item["title"], len(item["sections"]), item["equations"]) for item in data["chapters"])
    checks, paper = data["checks"], data["paper"]
    told = ", ".join(f"{count} {verdict}" for verdict, count in paper.items())
    notes = (
        f"checks: {checks['passed']} passed, {checks['failed']} failed",
        f"the paper's printed equations: {told}",
        f"{data['file']}, {data['bytes'] / 1e3:.0f} kB; key {data['key']}",
    )
    title = f"Equation book of {data['scene']}: {data['equations']} equations"
    Terminal().print(Table(title, ("chapter", "sections", "equations"), rows, notes))
