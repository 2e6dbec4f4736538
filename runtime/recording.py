"""Recording: a simulation whose samples go to a file while it runs, so that memory stays flat and it can go on."""

from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np
from ltcgear.generated.errors import LtcgearError

from .attributes import GOES_ON, UNFINISHED, to_attributes
from .averages import Statistics
from .band import passing_speed
from .checkpoint import checkpoint_of, describe_run, read_checkpoint, write_checkpoint
from .choice import Choice, choose
from .dataset import columns_of, make_dataset
from .equilibrium import Equilibrium, Vector, find_equilibrium
from .integration import Integration, Outcome
from .library import Library
from .march import Snapshot
from .part import Part, part_of
from .reading import Reader, Rows, judge, motion_statistics, no_rows
from .results import check_target
from .room import check_room
from .sampling import Block, Points
from .signals import Pairs, Signals
from .simulation import (
    AUTO,
    DEFAULT_METHOD,
    DEFAULT_RTOL,
    check_options,
    list_settings,
    static_strain,
    summarise,
    take_rate,
    tell_forces,
    verified,
)

if TYPE_CHECKING:
    import xarray as xr

UNDER_WAY = f"{UNFINISHED}; `ltcgear simulate` with the same arguments and {GOES_ON}"


def check_resumable(target: Path) -> None:
    """Refuse to go on where nothing was left to go on from, before anything is computed."""
    for path in (checkpoint_of(target), part_of(target)):
        if not path.is_file():
            raise LtcgearError(f"{path}: not there, so there is nothing to go on from; leave out --resume")


def record(
    library: Library,
    values: Mapping[str, float],
    target: str | Path,
    *,
    t_end: float,
    rate: float | None = None,
    method: str = DEFAULT_METHOD,
    rtol: float = DEFAULT_RTOL,
    raw: bool = False,
    attributes: Mapping[str, Any] | None = None,
    told: Callable[[float], None] = lambda t: None,
    tables: Mapping[str, Pairs] | None = None,
    resume: bool = False,
    verify: bool = False,
    long: bool = False,
) -> dict[str, Any]:
    """Simulate from the loaded equilibrium into a NetCDF4 file.

    While it runs, samples go to ``NAME.part.nc`` and all that it takes to go on to ``NAME.checkpoint.npz``.
    Both outlast a killed program, and a run that Ctrl-C stopped; else they are deleted.

    Parameters that are not listed are those of ``simulate``.

    Parameters
    ----------
    target
        The result file, ``NAME.nc``.
    resume
        Go on from the checkpoint; the result is to the last bit that of a run that was never stopped (with ``sundae``,
        whose history is not kept, to the tolerance).

    Returns
    -------
    dict
        The summary, as ``simulate`` gives it.

    Raises
    ------
    SolverError
        If there is no equilibrium to start from. A failure later on is ``status`` in the summary.
    LtcgearError
        If a file cannot be written, or the checkpoint is missing, damaged or of another run.
    """
    target = Path(target)
    check_options(method, rtol, t_end, rate)
    check_target(target)
    settings = {"t_end": t_end, "rate": rate, "method": method, "rtol": rtol}
    p, clock = library.parameters(values), perf_counter()
    Signals(library.manifest.signals, tables or {})  # refuses tables before anything is described
    run = describe_run(library, values, tables or {}, settings | {"raw": raw})
    if resume:
        check_resumable(target)
    kept = read_checkpoint(target, run) if resume else None
    at = _equilibrium_of(kept) if kept else find_equilibrium(library, p, tables=tables)
    seconds = {"equilibrium": perf_counter() - clock}
    choice = choose(library, at, p, rtol, tables, t_end) if method == AUTO else Choice(method, None)
    sampling = take_rate(library, at, p, t_end, rate, tables)
    if not kept:
        check_room(library, t_end * sampling.rate, target)
    about = list_settings(library, choice, rtol, sampling, raw)
    options: dict[str, Any] = settings | {"rate": sampling.rate, "method": choice.method, "tables": tables}
    integration = Integration(library, p, at, passing=passing_speed(sampling.rate, raw), long=long, **options)
    reader = Reader(library, p, sampling.rate, t_end, raw)
    recorder = Recorder(library, p, target, reader, to_attributes(attributes, about), kept)
    if kept:
        integration.restore(kept)
    start = {f"at.{name}": np.array(value) for name, value in asdict(at).items()}
    with recorder.part:
        outcome = integration.proceed(
            recorder.take,
            told,
            lambda: write_checkpoint(target, run, integration.snapshot() | recorder.snapshot() | start),
        )
        heading = recorder.finish(outcome := judge(reader, outcome))
        summary = (
            about
            | summarise(library, p, at, outcome, tell_forces(heading, static_strain(library, p, at)), reader)
            | {"seconds": seconds | outcome.seconds}
        )
        if verify:
            summary |= verified(library, p, at, summary, **options)
        stopped = outcome.status.startswith("interrupted")
        if stopped:
            summary["status"] += f"; {GOES_ON}"
        clock = perf_counter()
        recorder.seal(to_attributes(attributes, summary), heading)
        summary["seconds"]["write"] = perf_counter() - clock
    if not stopped:
        checkpoint_of(target).unlink()
        part_of(target).unlink()
    return summary


class Recorder:
    """Reads outputs of samples and writes them to a part; remembers what it needs to go on.

    Parameters
    ----------
    library, p, target
        See ``record``.
    reader
        What reads the outputs.
    attributes
        What the file tells about itself while the run goes on.
    kept
        Snapshot to go on from; None begins anew.
    """

    def __init__(
        self, library: Library, p: Vector, target: Path, reader: Reader, attributes: Mapping[str, Any],
        kept: Snapshot | None,
    ) -> None:  # fmt: skip
        self.library, self.p, self.target, self.reader = library, p, target, reader
        if kept is None:
            checkpoint_of(target).unlink(missing_ok=True)
        else:
            self.reader.restore(kept)
        heading = self._heading({**attributes, "status": UNDER_WAY})
        self.part = Part(target, heading, None if kept is None else int(kept["part.rows"]))

    def take(self, block: Block, points: Points) -> None:
        """Read a block and append its rows."""
        self._append(self.reader.read(block, points))

    def snapshot(self) -> Snapshot:
        """Return all that it needs to go on."""
        return self.reader.snapshot() | {"part.rows": np.array(self.part.rows)}

    def finish(self, outcome: Outcome) -> "xr.Dataset":
        """Append the last rows; return the result without any row, with the statistics of the outputs."""
        self._append(self.reader.finish())
        return self._heading({}, motion_statistics(self.reader, outcome))

    def seal(self, attributes: Mapping[str, Any], heading: "xr.Dataset") -> None:
        """Write the result."""
        self.part.seal(heading.assign_attrs(attributes))

    def _append(self, rows: Rows) -> None:
        self.part.append(columns_of(self.library, rows))

    def _heading(self, attributes: Mapping[str, Any], statistics: Statistics | None = None) -> "xr.Dataset":
        """Return the result without any row."""
        heading = make_dataset(self.library, self.p, no_rows(self.library), statistics)
        return heading.assign_attrs(attributes)


def _equilibrium_of(kept: Snapshot) -> Equilibrium:
    """Return the equilibrium that a run started from."""
    parts: dict[str, Any] = {name.removeprefix("at."): v for name, v in kept.items() if name.startswith("at.")}
    return Equilibrium(
        parts["x"], parts["levels"], float(parts["residual"]), int(parts["iterations"]), parts["signals"]
    )
