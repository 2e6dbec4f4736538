"""What pages show, run as it stands: every command, console and program of README.md and docs, page by page."""

import tempfile
from pathlib import Path

from .outcome import RIGHT, WRONG, Verdict
from .pages import NOT_RUN, pages, read_steps, run_step
from .process import Case

SHOWN = [page for page in pages() if any(step.head not in NOT_RUN for step in read_steps(page))]
"""Pages that show anything to be run."""
COUNT = len(SHOWN)


def make_case(seed: int, number: int) -> Case:
    """Return a page as a case; there is no chance in it."""
    page = SHOWN[number % COUNT]
    return Case(f"page: {page}", lambda folder: follow(page, folder), 900.0)


def follow(page: str, folder: Path) -> Verdict:
    """Run all that a page shows, in its order."""
    steps = [step for step in read_steps(page) if step.head not in NOT_RUN]
    with tempfile.TemporaryDirectory(prefix="torture-") as home:
        for step in steps:
            if fault := run_step(step, Path(home)):
                return Verdict(WRONG, f"{step.head}: {fault}")
    return Verdict(RIGHT, f"{len(steps)} steps")
