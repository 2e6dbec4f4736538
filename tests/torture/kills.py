"""Attack by kills: a run or a sweep that is killed at any moment goes on to the very numbers of one that was not."""

import signal
import subprocess
import sys
import tempfile
import time
from functools import cache
from pathlib import Path

import numpy as np
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime import load, load_sweep

from .files import SWEEP, rows_in, same
from .outcome import HANG, LOST, RIGHT, WRONG, Done, Verdict, judge
from .process import Case, Program, command, run

COUNT = 56
RUN = ("simulate", "psh", "--t-end", "12", "--set", "simulation.rate=1 kHz")
OFTEN = {"MARK_SECONDS": 0.02, "SLICE": 0.01}
"""Checkpoints fifty times a second in place of one in two seconds."""
KILLS = (signal.SIGKILL, signal.SIGKILL, signal.SIGKILL, signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
MOST = 4
"""Kills of one run."""
LEFT = ("a.part.nc", "a.checkpoint.npz")


@cache
def whole() -> tuple[Path, dict[str, float]]:
    """Return a folder with a whole run and a whole sweep, and the seconds that they took."""
    folder = Path(tempfile.mkdtemp(prefix="torture-"))
    seconds = {}
    for name, arguments in (("run", RUN), ("sweep", SWEEP)):
        done = run(folder, *arguments, "-o", f"{name}.nc")
        assert done.code == 0, done.err
        seconds[name] = done.seconds
    clock = time.monotonic()
    subprocess.run(
        [sys.executable, "-m", "ltcgear.runtime.cli.commands", "--version"], check=False, capture_output=True
    )
    return folder, seconds | {"start": time.monotonic() - clock}


def prepare() -> None:
    """Make what was never killed."""
    whole()


def make_case(seed: int, number: int) -> Case:
    """Return an attack by kills."""
    generator = np.random.default_rng([seed, number])
    way = [_run, _run, _run, _run, _run, _program, _sweep, _two][number % 8]
    return Case(f"kill: {way.__name__.strip('_')}", lambda folder: way(folder, generator), 180.0)


def _moment(generator: np.random.Generator, seconds: float) -> tuple[float, signal.Signals]:
    """Draw when [s] and by which signal a program is killed."""
    return float(generator.uniform(0.0, seconds)), KILLS[int(generator.integers(len(KILLS)))]


def _slain(program: Program, moment: float, number: signal.Signals) -> Done:
    """Send a signal at a moment; what is only asked to stop has 20 s for it."""
    while program.poll() is None and time.monotonic() < program.began + moment:
        time.sleep(0.001)
    program.kill(number)
    return program.wait(moment + 20)


def _went_on(folder: Path, arguments: tuple[str, ...], **options: object) -> tuple[Done, Verdict | None]:
    """Go on with a run by what it left: with --resume where a checkpoint is there, from the start where none is."""
    there = (folder / LEFT[1]).exists()
    ways = ["--resume"] if there else ["", "--force"]
    for way in ways:
        done = run(folder, *arguments, *([way] if way else []), **options)
        if done.code == 0:
            return done, None
    bad = judge(done)
    return done, bad or Verdict(LOST, f"{'a checkpoint was there' if there else 'no checkpoint'}; {done.last}")


def _judge_killed(done: Done) -> Verdict | None:
    """Judge a program that was killed: by the signal it may have died, or stopped with its exit code."""
    if done.code is None:
        return Verdict(HANG, "did not stop within 20 s of a signal")
    return None if done.code < 0 and "Traceback" not in done.err else judge(done)


def _run(folder: Path, generator: np.random.Generator) -> Verdict:
    """Kill a simulation again and again, then let it end."""
    arguments = (*RUN, "-o", "a.nc")
    for _ in range(int(generator.integers(1, MOST + 1))):
        resume = ["--resume"] if all((folder / name).exists() for name in LEFT) else []
        before = rows_in(folder / LEFT[0]) if resume else 0
        program = Program(command(*arguments, *resume, settings=OFTEN), folder)
        done = _slain(program, *_moment(generator, 1.2 * whole()[1]["run"]))
        bad = _judge_killed(done)
        if bad:
            return bad
        if done.code == 2:
            return Verdict(LOST, f"refused to go on ({'with' if resume else 'without'} --resume): {done.last}")
        if (folder / "a.nc").exists() and not (folder / LEFT[1]).exists():
            return _equal(folder / "a.nc")
        if resume and not all((folder / name).exists() for name in LEFT):
            return Verdict(LOST, f"{before} rows were there, now {sorted(file.name for file in folder.iterdir())}")
    _, bad = _went_on(folder, arguments)
    return bad or _equal(folder / "a.nc")


def _program(folder: Path, generator: np.random.Generator) -> Verdict:
    """Kill the program as it is typed, with the checkpoints of its own, then let it end."""
    arguments = [Path(sys.executable).with_name("ltcgear"), *RUN, "--t-end", "60", "-o", "a.nc"]
    with subprocess.Popen(arguments, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as program:
        time.sleep(whole()[1]["start"] + float(generator.uniform(0.0, 4.0)))
        program.kill()
    _, bad = _went_on(folder, (*RUN, "--t-end", "60", "-o", "a.nc"))
    if bad:
        return bad
    with np.errstate(all="ignore"):
        times = load(folder / "a.nc").dataset["time"].values
    return Verdict(RIGHT, "resumed") if times.size == 60_001 else Verdict(LOST, f"{times.size} rows of 60001")


def _equal(path: Path) -> Verdict:
    """Compare a run with the one that was never killed, and look whether anything else was left."""
    try:
        found = load(path).dataset
    except LtcgearError as error:
        return Verdict(LOST, f"the result cannot be read: {error}")
    difference = same(found, load(whole()[0] / "run.nc").dataset, timed=False)
    left = sorted(file.name for file in path.parent.iterdir())
    if difference:
        return Verdict(WRONG, f"other {difference} than the run that was not killed")
    return Verdict(RIGHT, "equal") if left == ["a.nc"] else Verdict(WRONG, f"left beside the result: {left}")


def _sweep(folder: Path, generator: np.random.Generator) -> Verdict:
    """Kill a sweep again and again, then let it end."""
    arguments = (*SWEEP, "-o", "a.nc")
    for _ in range(int(generator.integers(1, MOST + 1))):
        before = rows_in(folder / LEFT[0]) if (folder / LEFT[0]).exists() else 0
        done = _slain(Program(command(*arguments), folder), *_moment(generator, 1.1 * whole()[1]["sweep"]))
        if bad := _judge_killed(done):
            return bad
        if done.code == 2:
            return Verdict(LOST, f"refused to go on: {done.last}")
        if not (folder / "a.nc").exists() and before and rows_in(folder / LEFT[0]) < before:
            return Verdict(LOST, f"{rows_in(folder / LEFT[0])} rows where {before} were")
    done = run(folder, *arguments)
    if bad := judge(done):
        return bad
    if done.code:
        return Verdict(LOST, done.last)
    difference = same(load_sweep(folder / "a.nc"), load_sweep(whole()[0] / "sweep.nc"), timed=False)
    return Verdict(WRONG, f"other {difference}") if difference else Verdict(RIGHT, "equal")


def _two(folder: Path, generator: np.random.Generator) -> Verdict:
    """Start a second simulation with the same -o: one of the two is refused, the other is whole."""
    arguments = (*RUN, "-o", "a.nc")
    first = Program(command(*arguments, settings=OFTEN), folder)
    time.sleep(float(generator.uniform(0.0, 0.8 * whole()[1]["run"])))
    more = ["--resume"] if generator.random() < 0.3 and (folder / LEFT[1]).exists() else []
    alive = first.poll() is None
    second = run(folder, *arguments, *more, settings=OFTEN)
    done = first.wait(120)
    if bad := judge(done) or judge(second):
        return bad
    if alive and (done.code == 0) == (second.code == 0) and done.seconds > second.seconds:
        return Verdict(WRONG, f"two runs wrote one file: exit codes {done.code} and {second.code}; {second.last}")
    return _equal(folder / "a.nc") if 0 in (done.code, second.code) else Verdict(LOST, f"none was done: {done.last}")
