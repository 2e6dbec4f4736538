"""Standard output and error, which may be full, closed or unable to show a character."""

import contextlib
import errno
import io
import os
import sys
from collections.abc import Iterator
from typing import Any, TextIO, cast


class Outlet:
    """A standard stream; where it takes nothing more, the program goes on without it.

    What a command computes, the files that it writes and its exit code do not depend on who reads what it prints.

    Parameters
    ----------
    stream
        The stream itself; None where the program was begun without it.

    Attributes
    ----------
    fault
        What kept it from being written; None also where a reader went away, as ``head`` does.
    """

    def __init__(self, stream: TextIO | None) -> None:
        self.stream, self.fault = stream or io.StringIO(), cast(OSError | None, None)
        self.closed_before = stream is None
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401
        """Return what the stream has."""
        return getattr(self.stream, name)

    def write(self, text: str) -> int:
        """Write a text."""
        with self._going_on():
            self.stream.write(text)
        if self.closed_before and text:
            self.fault = OSError(errno.EBADF, "it is closed")
        return len(text)

    def flush(self) -> None:
        """Write what waits."""
        with self._going_on():
            self.stream.flush()

    @contextlib.contextmanager
    def _going_on(self) -> Iterator[None]:
        """Let what comes later, and what waits, go nowhere once the stream takes nothing more."""
        try:
            yield
        except OSError as error:
            if not isinstance(error, BrokenPipeError):
                self.fault = self.fault or error
            with contextlib.suppress(OSError):
                nowhere = os.open(os.devnull, os.O_WRONLY)
                os.dup2(nowhere, self.stream.fileno())
                os.close(nowhere)


@contextlib.contextmanager
def outlets() -> Iterator[Outlet]:
    """Let standard output and error be such streams; standard output is handed out."""
    output, error = (Outlet(stream) for stream in (sys.stdout, sys.stderr))
    with contextlib.redirect_stdout(cast(TextIO, output)), contextlib.redirect_stderr(cast(TextIO, error)):
        try:
            yield output
        finally:
            error.flush()


def open_closed() -> None:
    """Open what of the standard files is closed: the next file to be opened would take its place, and what is printed.

    Python has begun without such a stream, so what is printed to it is told to be lost.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest number that is free
