"""Programs under attack: forked from one that has imported everything, so that each starts in milliseconds."""

import contextlib
import ctypes
import gc
import json
import os
import resource
import shutil
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from ltcgear.generated.errors import LtcgearError

from .outcome import HANG, REFUSED, SIGNAL, TRACEBACK, Done, Verdict, judge_message

PAUSE = 0.002
MEMORY = 4 << 30
"""Address space of an attacked program [bytes]."""
ENDS_WITH_PARENT = 1  # PR_SET_PDEATHSIG


class Program:
    """A function in a process of its own, whose texts go to files.

    Parameters
    ----------
    call
        What is run; what it returns is the exit code, None for 0.
    folder
        Where it runs.
    leads
        Whether it leads a session, so that all that it starts can be ended with it.
    """

    def __init__(self, call: Callable[[], int | None], folder: Path, leads: bool = False) -> None:
        self.began, self.leads, self.code = time.monotonic(), leads, None
        self.texts = Path(tempfile.mkdtemp(prefix="torture-"))
        parent = os.getpid()
        self.pid = os.fork()
        if self.pid == 0:
            code = 70
            try:
                ctypes.CDLL(None).prctl(ENDS_WITH_PARENT, signal.SIGKILL)
                if os.getppid() != parent:
                    os._exit(71)
                self._redirect(folder)
                code = call() or 0
            except SystemExit as stop:
                code = stop.code if isinstance(stop.code, int) else int(stop.code is not None)
            except BaseException:
                traceback.print_exc()
            finally:
                with contextlib.suppress(BaseException):
                    sys.stdout.flush()
                    sys.stderr.flush()
                os._exit(code)

    def _redirect(self, folder: Path) -> None:
        """Turn the copy of this process into a program of its own."""
        if self.leads:
            os.setsid()
        for number, name in ((1, "out"), (2, "err")):
            handle = os.open(self.texts / name, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
            os.dup2(handle, number)
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        sys.stdout, sys.stderr = (os.fdopen(n, "w", buffering=1, closefd=False) for n in (1, 2))
        os.chdir(folder)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        signal.signal(signal.SIGINT, signal.default_int_handler)

    def poll(self) -> int | None:
        """Return the exit code, None while it runs."""
        if self.code is None:
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            self.code = os.waitstatus_to_exitcode(status) if pid else None
        return self.code

    def kill(self, number: int = signal.SIGKILL) -> None:
        """Send it a signal, and all that it started where it leads."""
        if self.code is not None and not self.leads:
            return
        with contextlib.suppress(ProcessLookupError):
            (os.killpg if self.leads and number == signal.SIGKILL else os.kill)(self.pid, number)

    def finish(self, code: int | None) -> Done:
        """Return what it left, once it has ended."""
        if self.leads:
            self.kill()  # what it started and left
        texts = [(self.texts / name).read_text("utf-8", "replace") if (self.texts / name).exists() else ""
                 for name in ("out", "err")]  # fmt: skip
        shutil.rmtree(self.texts, ignore_errors=True)
        return Done(code, *texts, time.monotonic() - self.began)

    def wait(self, seconds: float) -> Done:
        """Wait for its end; it is killed where that does not come."""
        while (code := self.poll()) is None and time.monotonic() < self.began + seconds:
            time.sleep(PAUSE)
        if code is None:
            self.kill()
            os.waitpid(self.pid, 0)
            self.code = -signal.SIGKILL
        return self.finish(code)


def command(
    *arguments: object, settings: Mapping[str, float] | None = None, prepared: Callable[[], None] | None = None
) -> Callable[[], int]:
    """Return a command line as a function; ``settings`` are numbers of ``runtime.integration`` in place of its own."""

    def call() -> int:
        # As the program does itself, but for settings that come before: Ctrl-C is held back while libraries load.
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        from ltcgear.runtime.cli import commands, entry  # noqa: F401
        from ltcgear.runtime.simulation import integration

        signal.signal(signal.SIGINT, entry._stop)
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        if prepared:
            prepared()
        for name, value in (settings or {}).items():
            getattr(integration, name)
            setattr(integration, name, value)
        sys.argv = ["ltcgear", *map(str, arguments)]
        signal.signal(signal.SIGINT, signal.default_int_handler)
        entry.main()
        return 0

    return call


def run(folder: Path, *arguments: object, seconds: float = 60.0, **options: object) -> Done:
    """Run a command line in a folder, in a process of its own."""
    return Program(command(*arguments, **options), folder).wait(seconds)


@dataclass(frozen=True)
class Case:
    """An attack: its name, what it does in a folder of its own, and when it counts as hanging [s]."""

    name: str
    attack: Callable[[Path], Verdict]
    seconds: float = 60.0


@dataclass(frozen=True)
class Finding:
    """A case, its number, what it came to, what it printed, and the folder with what it left."""

    number: int
    case: Case
    verdict: Verdict
    done: Done
    folder: Path


def _judged(case: Case, folder: Path, file: Path) -> int:
    """Attack, and write what it came to into a file."""
    try:
        verdict = case.attack(folder)
    except LtcgearError as error:
        verdict = judge_message(str(error)) or Verdict(REFUSED, str(error))
    except BaseException as error:
        verdict = Verdict(TRACEBACK, f"{type(error).__name__}: {error}"[:600])
        traceback.print_exc()
    file.write_text(json.dumps(asdict(verdict)), "utf-8", "replace")
    return 0


def _verdict(file: Path, done: Done) -> Verdict:
    """Return what an attack came to."""
    if file.exists():
        return Verdict(**json.loads(file.read_text("utf-8")))
    if done.code is None:
        return Verdict(HANG, f"no end after {done.seconds:.0f} s; {done.last}")
    return Verdict(SIGNAL if done.code < 0 else TRACEBACK, f"exit code {done.code}; {done.last}")


def attack(cases: Iterable[tuple[int, Case]], workers: int = 2) -> Iterator[Finding]:
    """Run numbered cases, some at a time, each in a process and a folder of its own, which is gone afterwards."""
    gc.collect()
    gc.freeze()  # so that copies share their pages
    left, running = iter(cases), list[tuple[int, Case, Path, Program]]()
    more = True
    try:
        while more or running:
            while more and len(running) < workers:
                number, case = next(left, (0, None))
                more = case is not None
                if case is not None:
                    top = Path(tempfile.mkdtemp(prefix="torture-"))
                    (top / "work").mkdir()
                    call = lambda case=case, top=top: _judged(case, top / "work", top / "verdict")  # noqa: E731
                    running.append((number, case, top, Program(call, top / "work", leads=True)))
            for item in list(running):
                number, case, top, program = item
                late = time.monotonic() > program.began + case.seconds
                done = program.wait(0.0) if late else None
                if done is None and (code := program.poll()) is not None:
                    done = program.finish(code)
                if done is not None:
                    running.remove(item)
                    yield Finding(number, case, _verdict(top / "verdict", done), done, top / "work")
                    shutil.rmtree(top, ignore_errors=True)
            time.sleep(PAUSE)
    finally:
        for _, _, top, program in running:
            program.wait(0.0)
            shutil.rmtree(top, ignore_errors=True)
