"""Progress bar with simulated time, speed and time left; only on a terminal."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import Protocol

from ltcgear.generated.text import write_out


class Told(Protocol):
    """To be called with what is reached, and a note that is shown beside it."""

    def __call__(self, now: float, note: str = "") -> None:
        """Show it."""


@contextmanager
def progress(title: str, end: float, unit: str = "s") -> Iterator[Told]:
    """Show the progress of a simulation on stderr.

    Parameters
    ----------
    title
        What is running.
    end
        Time to be simulated [s], or how many of another ``unit`` there are.
    unit
        What is counted.

    Yields
    ------
    callable
        To be called with the simulated time.
    """
    if not sys.stderr.isatty():
        yield lambda now, note="": None
        return
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    from ..results.terminal import Terminal

    timed = unit == "s"
    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn(
            "{task.completed:.3f}/{task.total:.3f} s" if timed else "{task.completed:.0f}/{task.total:.0f} " + unit
        ),
        TextColumn("{task.fields[speed]}", markup=False),
        TimeRemainingColumn(),
    )
    start = perf_counter()
    with Progress(*columns, console=Terminal(stderr=True), transient=True) as bar:
        task = bar.add_task(write_out(title), total=end, speed="")

        def told(now: float, note: str = "") -> None:
            speed = f"{now / max(perf_counter() - start, 1e-9):.2f} s simulated a second" if timed else write_out(note)
            bar.update(task, completed=now, speed=speed)

        yield told
