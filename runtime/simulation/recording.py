"""Recording: a simulation whose samples go to a file while it runs, and which can be resumed."""

from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from time import perf_counter
from typing import Any, Unpack

import numpy as np
from ltcgear.generated.errors import LtcgearError
from ltcgear.generated.lock import Lock
from ltcgear.generated.writing import check_output, is_forced, remove_drafts

from ..model.equilibrium import find_equilibrium
from ..model.library import Library
from ..model.load_tables import Signals
from ..model.operating_point import OperatingPoint
from ..model.state_matrix import Equilibrium
from ..results.attributes import FORCES, GOES_ON, UNFINISHED, to_attributes
from ..results.checkpoint import AGAIN, Snapshot, checkpoint_of, describe_run, read_checkpoint, write_checkpoint
from ..results.dataset import columns_of, make_content
from ..results.file_content import FileContent
from ..results.result import RESULT, SWEEP, tell_kind
from ..results.row_file import BEGIN_ANEW, Part, part_of, read_part
from ..results.samples import Rows, no_rows
from ..results.statistics import Statistics
from .integration import Integration
from .low_pass import passing_speed
from .method_limits import check_run
from .output_reader import Reader, judge, motion_statistics
from .room import check_room
from .run_settings import RunOptions, RunSettings
from .simulate import resolve, summarise, tell_forces, verified
from .trajectory import Block, Counts, Outcome, Points

UNFIT = (KeyError, ValueError, TypeError, IndexError, AttributeError)
"""What a checkpoint raises whose arrays are not those of the run."""
BEFORE = {"counts": asdict(Counts()), "warnings": [], "seconds": {}, FORCES: {}}
"""Parts of a summary that are known at the end only."""
UNDER_WAY = f"{UNFINISHED}; `ltcgear simulate` with the same arguments and {GOES_ON}"


def check_recordable(target: Path, resume: bool, *sources: Path | str | None) -> None:
    """Refuse a result file that must not be written or cannot be resumed, before anything is computed.

    Parameters
    ----------
    target
        The result file, ``NAME.nc``.
    resume
        Resume from its checkpoint.
    sources
        Files that are read, which it must not be.

    Raises
    ------
    LtcgearError
        If it is no name for a result, holds something else than a result, or rows of an unfinished run or sweep would
        be lost. What is held is written over where that is forced.
    """
    check_output(target, *sources)
    if target.suffix != ".nc":
        raise LtcgearError(f"{target}: results are NetCDF4 files; name it {target.with_suffix('.nc')}")
    for path in (part_of(target), checkpoint_of(target)):
        check_output(path)
    if resume and is_forced():
        raise LtcgearError("--resume goes on and --force begins anew; give one of them")
    if resume:
        check_resumable(target)
    if not is_forced():
        _check_held(target, resume)


def check_resumable(target: Path) -> None:
    """Refuse to resume without a checkpoint."""
    for path in (checkpoint_of(target), part_of(target)):
        if not path.is_file():
            raise LtcgearError(f"{path}: not there, so there is nothing to go on from; leave out --resume")


def _check_held(target: Path, resume: bool) -> None:
    """Refuse to lose what a file holds that is no result, or what an unfinished run or sweep has computed."""
    held = tell_kind(target)
    if held not in ("", RESULT):
        raise LtcgearError(f"{target}: holds {held}, no result of a run; give another name, or --force to replace it")
    part = part_of(target)
    if not part.is_file():
        return
    if tell_kind(part) == SWEEP:
        raise LtcgearError(f"{part}: rows of a sweep that is not finished; the same sweep goes on with them, "
                           "or give another -o, or --force to lose them")  # fmt: skip
    rows = 0 if resume else read_part(part).rows
    if rows:
        raise LtcgearError(
            f"{part}: {rows} samples of a run that is not finished; --resume goes on with it; {BEGIN_ANEW}"
        )


def record(
    library: Library,
    values: Mapping[str, float],
    target: str | Path,
    *,
    attributes: Mapping[str, Any] | None = None,
    told: Callable[[float], None] = lambda t: None,
    resume: bool = False,
    **options: Unpack[RunOptions],
) -> dict[str, Any]:
    """Simulate from the loaded equilibrium into a NetCDF4 file.

    While it runs, samples go to ``NAME.part.nc`` and its state to ``NAME.checkpoint.npz``.
    Both outlast a killed program, and a run that Ctrl-C stopped; else they are deleted. One run or sweep at a time
    writes a file.

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
        If the file must not be written, another run is writing it, or the checkpoint is missing, damaged or of another
        run.
    MachineError
        If a file cannot be written.
    """
    target = Path(target)
    given = RunSettings(**options).checked()
    check_recordable(target, resume)
    p, tables, clock = library.parameters(values), given.tables or {}, perf_counter()
    Signals(library.manifest.signals, tables)  # refuses tables before anything is described
    run = describe_run(library, values, tables, given.identity())
    with Lock(target):
        check_recordable(target, resume)  # who held it may have left another file
        remove_drafts(target, part_of(target), checkpoint_of(target))
        kept = read_checkpoint(target, run) if resume else None
        at = _equilibrium_of(target, kept) if kept else find_equilibrium(library, p, tables=tables)
        seconds = {"equilibrium": perf_counter() - clock}
        point = OperatingPoint(library, p, at)
        settings, about = resolve(point, given)
        if not kept:
            check_room(library, settings.t_end * settings.sampling_rate, target)
        check_run(point, settings)
        integration = Integration(point, settings, passing=passing_speed(settings.sampling_rate, settings.raw))
        reader = Reader(point, settings)
        if kept:
            _restore(target, kept, integration, reader)
        recorder = Recorder(target, reader, to_attributes(attributes, BEFORE | about), kept)
        with recorder.part:
            outcome = integration.proceed(recorder.take, told, lambda: recorder.mark(run, integration.snapshot(), at))
            outcome = judge(reader, outcome)
            statistics = recorder.finish(outcome)
            forces = tell_forces(library, statistics, point.strain)
            summary = about | summarise(point, outcome, forces, reader)
            summary |= {"seconds": seconds | outcome.seconds}
            if summary["status"].startswith("interrupted"):
                return summary | {"status": f"{summary['status']}; rows are in {recorder.part.path}, {GOES_ON}"}
            if settings.verify:
                summary |= verified(point, summary, settings)
            clock = perf_counter()
            recorder.seal(to_attributes(attributes, summary), statistics)
            summary["seconds"]["write"] = perf_counter() - clock
        checkpoint_of(target).unlink(missing_ok=True)
        recorder.part.remove()
    return summary


class Recorder:
    """Evaluates outputs of samples, writes them to the part file and keeps its state for a checkpoint.

    Parameters
    ----------
    target
        See ``record``.
    reader
        What reads the outputs.
    attributes
        Attributes of the file during the run.
    kept
        Snapshot to resume from; None starts from the beginning.
    """

    def __init__(
        self, target: Path, reader: Reader, attributes: Mapping[str, Any], kept: Snapshot | None
    ) -> None:  # fmt: skip
        self.target, self.reader, self.point = target, reader, reader.point
        if kept is None:
            checkpoint_of(target).unlink(missing_ok=True)
        heading = self._heading({**attributes, "status": UNDER_WAY})
        self.part = Part(target, heading, None if kept is None else int(kept["part.rows"]))
        if kept is not None and (self.part.identity, self.part.sum) != (
            str(kept["part.identity"]),
            int(kept["part.sum"]),
        ):
            self.part.close()
            raise LtcgearError(f"{self.part.path}: its rows are not those of {checkpoint_of(target)}; {BEGIN_ANEW}")

    def take(self, block: Block, points: Points) -> None:
        """Read a block and append its rows."""
        self._append(self.reader.read(block, points))

    def mark(self, run: Mapping[str, Any], reached: Snapshot, at: Equilibrium) -> None:
        """Write a checkpoint: which run it is, where it is, what it started from, and the rows that go with it."""
        self.part.sync()
        start = {f"at.{name}": np.array(value) for name, value in asdict(at).items()}
        rows = {"part.identity": self.part.identity, "part.rows": self.part.rows, "part.sum": self.part.sum}
        kept = {name: np.array(value) for name, value in rows.items()}
        write_checkpoint(self.target, run, reached | self.reader.snapshot() | kept | start)

    def finish(self, outcome: Outcome) -> Statistics | None:
        """Append the last rows; return the statistics of the outputs."""
        self._append(self.reader.finish())
        return motion_statistics(self.reader, outcome)

    def seal(self, attributes: Mapping[str, Any], statistics: Statistics | None) -> None:
        """Write the result."""
        self.part.seal(self._heading(attributes, statistics))

    def _append(self, rows: Rows) -> None:
        self.part.append(columns_of(self.point.library, rows))

    def _heading(self, attributes: Mapping[str, Any], statistics: Statistics | None = None) -> FileContent:
        """Return the result without any row."""
        library = self.point.library
        heading = make_content(library, self.point.p, no_rows(library), statistics)
        return heading.assign_attrs(attributes)


def _restore(target: Path, kept: Snapshot, integration: Integration, reader: Reader) -> None:
    """Resume from a checkpoint."""
    try:
        integration.restore(kept)
        reader.restore(kept)
    except UNFIT as error:
        raise LtcgearError(f"{checkpoint_of(target)}: damaged ({type(error).__name__}: {error}); {AGAIN}") from error


def _equilibrium_of(target: Path, kept: Snapshot) -> Equilibrium:
    """Return the equilibrium that a run started from."""
    parts: dict[str, Any] = {name.removeprefix("at."): v for name, v in kept.items() if name.startswith("at.")}
    try:
        return Equilibrium(
            parts["x"], parts["levels"], float(parts["residual"]), int(parts["iterations"]), parts["signals"]
        )
    except UNFIT as error:
        raise LtcgearError(f"{checkpoint_of(target)}: damaged ({type(error).__name__}: {error}); {AGAIN}") from error
