"""A progress bar with simulated time, speed and time left; only on a terminal."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter


@contextmanager
def progress(title: str, end: float, unit: str = "s") -> Iterator[Callable[[float], None]]:
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
        yield lambda now: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    timed = unit == "s"
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn(
            "{task.completed:.3f}/{task.total:.3f} s" if timed else "{task.completed:.0f}/{task.total:.0f} " + unit
        ),
        TextColumn("{task.fields[speed]}"),
        TimeRemainingColumn(),
    )
    start = perf_counter()
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(title, total=end, speed="")

        def told(now: float) -> None:
            speed = f"{now / max(perf_counter() - start, 1e-9):.2f} s simulated a second" if timed else ""
            bar.update(task, completed=now, speed=speed)

        yield told
