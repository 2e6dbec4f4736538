"""C compiler: which one, its flags, and runs of it with a time limit."""

import contextlib
import errno
import math
import os
import selectors
import shlex
import shutil
import signal
import subprocess
import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import IO, cast

from .errors import CompileError
from .text import shorten

CHOICE = "CC"
"""Environment variable with the compiler, and arguments that come first."""
MORE_FLAGS = "LTCGEAR_CFLAGS"
"""Environment variable with flags that come after ltcgear's own, and win."""
LIMIT = "LTCGEAR_COMPILE_SECONDS"
"""Environment variable with the seconds after which a compiler is ended, in place of those by the length of the C."""
USUAL = ("cc", "gcc", "clang")
BASE_SECONDS, SECONDS_A_BYTE = 300.0, 1e-3
"""About a hundred times what a compiler takes, see docs/growth.md."""
ASKING_SECONDS = 60.0
"""How long a compiler may take to say which it is."""
LOOK = 0.1
"""Seconds between two looks at whether a compiler has ended that says nothing."""
LONGEST_WAIT = 1e6
"""Seconds beyond which a limit is none: what the system can wait for at once."""
MOST_OUTPUT = 1 << 20
"""Bytes of a compiler's output that are kept."""
NO_SPACE = "No space left on device"


@dataclass(frozen=True)
class Compiler:
    """A C compiler: path, what it says of itself, and arguments that come before all others (``gcc`` of ccache)."""

    path: str
    version: str
    arguments: tuple[str, ...] = ()

    @property
    def command(self) -> tuple[str, ...]:
        """Return how a call of it begins."""
        return (self.path, *self.arguments)

    @property
    def name(self) -> str:
        """Return what messages call it."""
        return shorten(shlex.join(self.command))


@dataclass(frozen=True)
class Ended:
    """A run of a program that has ended: exit code, negative for a signal, and what it printed."""

    code: int
    text: str

    @property
    def how(self) -> str:
        """Say how it ended, with the line that tells why."""
        return f"{self._code()}{': ' if self._reason() else ''}{self._reason()}"

    def _code(self) -> str:
        """Write the exit code, or the signal."""
        if self.code >= 0:
            return f"exit code {self.code}"
        with contextlib.suppress(ValueError):
            return f"ended by {signal.Signals(-self.code).name}"
        return f"ended by signal {-self.code}"

    def _reason(self) -> str:
        """Return the line that names the error, else the last one."""
        lines = [line.strip() for line in self.text.splitlines() if line.strip()]
        return shorten(next((line for line in lines if "error" in line), lines[-1] if lines else ""))


@cache
def compiler() -> Compiler | None:
    """Return the C compiler: that of the environment variable CC, else cc, gcc or clang; None without one.

    Raises
    ------
    CompileError
        If CC names a compiler that is not there or cannot be run.
    """
    wanted = os.environ.get(CHOICE, "").strip()
    if not wanted:
        path = next(filter(None, map(_find, USUAL)), None)
        return None if path is None else _ask(path, ())
    # A path with a space in it is a program too.
    name, *arguments = [wanted] if _find(wanted) else split(CHOICE, wanted)
    path = _find(name)
    if path is None:
        raise CompileError(
            f"{CHOICE} = {shorten(wanted)}: no such compiler, or not a program that may be run; "
            f"correct {CHOICE} or unset it"
        )
    return _ask(path, tuple(arguments))


def _find(name: str) -> str | None:
    """Return the path of a program, whichever folder it is started from; None if there is none."""
    with contextlib.suppress(ValueError):  # a name that cannot be one
        path = shutil.which(name)
        return None if path is None else str(Path(path).absolute())
    return None


def _ask(path: str, arguments: tuple[str, ...]) -> Compiler:
    """Ask a compiler which it is."""
    ended = run_compiler((path, *arguments, "--version"), min(ASKING_SECONDS, seconds_for(0)))
    return Compiler(path, ended.text, arguments)


def split(variable: str, given: str) -> list[str]:
    """Split what an environment variable holds as a shell does.

    Raises
    ------
    CompileError
        If a quote is not closed.
    """
    try:
        return shlex.split(given)
    except ValueError as error:
        raise CompileError(f"{variable} = {shorten(given)}: {error}; correct it or unset it") from error


def more_flags() -> tuple[str, ...]:
    """Return the flags of the environment variable LTCGEAR_CFLAGS.

    Raises
    ------
    CompileError
        If a quote is not closed.
    """
    return tuple(split(MORE_FLAGS, os.environ.get(MORE_FLAGS, "")))


def seconds_for(size: int) -> float:
    """Return how long a compiler may take for C of some bytes [s].

    Raises
    ------
    CompileError
        If the environment variable LTCGEAR_COMPILE_SECONDS holds no positive number.
    """
    given = os.environ.get(LIMIT, "").strip()
    try:
        seconds = float(given) if given else BASE_SECONDS + SECONDS_A_BYTE * size
    except ValueError:
        seconds = math.nan
    if not seconds > 0.0:
        raise CompileError(
            f"{LIMIT} = {shorten(given)}: must be a positive number of seconds, or inf; correct or unset it"
        )
    return seconds


def run_compiler(command: Sequence[str], seconds: float, folder: Path | None = None) -> Ended:
    """Run a compiler to its end, without input; it and all that it starts are ended after some seconds.

    Parameters
    ----------
    command
        Program and arguments.
    seconds
        How long it may take.
    folder
        Where it runs and keeps its temporary files, a folder of its own.

    Raises
    ------
    CompileError
        If it cannot be run, or does not end.
    OSError
        If it had no room to write.
    """
    environment = os.environ | ({"TMPDIR": str(folder)} if folder else {})
    try:
        process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, cwd=folder,
            env=environment, process_group=0,
        )  # fmt: skip
    except (OSError, ValueError) as error:
        why = error.strerror if isinstance(error, OSError) else error
        raise CompileError(
            f"{shorten(command[0])}: cannot be run: {why}; correct {CHOICE}, or install gcc or clang"
        ) from error
    with process:
        try:
            ended = _wait(process, seconds)
        except BaseException as error:  # Ctrl-C too: the group is not that of the terminal
            _end(process)
            if not isinstance(error, TimeoutError | subprocess.TimeoutExpired):
                raise
            raise CompileError(
                f"{shorten(command[0])} did not end within {seconds:g} s and was ended; "
                f"if it only needs longer, set {LIMIT} to more seconds, else correct {CHOICE}"
            ) from None
    if ended.code != 0 and NO_SPACE in ended.text:
        raise OSError(errno.ENOSPC, NO_SPACE)
    return ended


def _wait(process: "subprocess.Popen[bytes]", seconds: float) -> Ended:
    """Read what a program prints, of much the beginning, until it ends; a child that outlives it is not waited for."""
    end, said = time.monotonic() + min(seconds, LONGEST_WAIT), bytearray()
    with selectors.DefaultSelector() as selector:
        key = selector.register(cast(IO[bytes], process.stdout), selectors.EVENT_READ)
        while True:
            left = end - time.monotonic()
            if left <= 0:
                raise TimeoutError
            if selector.select(min(left, LOOK)):
                chunk = os.read(key.fd, 1 << 16)
                if not chunk:
                    break
                said += chunk[: MOST_OUTPUT - len(said)]
            elif process.poll() is not None:
                break
    code = process.wait(max(end - time.monotonic(), 0.1))
    _end(process)
    return Ended(code, said.decode("utf-8", "replace"))


def _end(process: "subprocess.Popen[bytes]") -> None:
    """End a program and all that it has started."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
