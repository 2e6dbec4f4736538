"""Input files and pipes: read once, bounded in size and time."""

import os
import select
import stat
from pathlib import Path
from time import monotonic, sleep

ABSENT, SILENT = 10.0, 60.0
"""Time limits [s] of a pipe without a writer, and of a writer that sends nothing."""
CHUNK, PAUSE = 65536, 0.02


class UnreadableError(ValueError):
    """Source that is neither a file nor a pipe."""


def read_bytes(path: Path, most: int) -> bytes:
    """Return the bytes of a file or pipe; reading stops soon after ``most`` bytes.

    Raises
    ------
    OSError
        If it cannot be read.
    UnreadableError
        If it is a folder, a device or a socket, or a pipe into which nobody writes.
    """
    try:
        mode = path.stat().st_mode
    except ValueError:  # a zero byte, or half of a surrogate pair
        raise FileNotFoundError from None
    if stat.S_ISDIR(mode):
        raise UnreadableError("is a folder; give a file")
    if stat.S_ISFIFO(mode):
        return _drain(path, most)
    if not stat.S_ISREG(mode):
        raise UnreadableError("is a device or a socket; give a file or a pipe")
    with path.open("rb") as file:
        return file.read(most + 1)


def of_process(path: Path) -> bool:
    """Tell whether a path is a file descriptor of the process: redirected input, ``<(...)``."""
    return path.as_posix().startswith(("/dev/", "/proc/"))


def _drain(path: Path, most: int) -> bytes:
    """Read a pipe to its end; it is opened without blocking, so that the wait for a writer can time out."""
    named = Path(os.path.realpath(path)).exists()  # what is not can get no writer any more
    data, deadline = b"", monotonic() + ABSENT * named
    pipe = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    try:
        while len(data) <= most:
            try:
                chunk = os.read(pipe, CHUNK)
            except BlockingIOError:  # it has a writer, who has sent nothing yet
                deadline = 0.0
                if not select.select([pipe], [], [], SILENT)[0]:
                    raise UnreadableError(
                        f"is a pipe whose writer sent nothing for {SILENT:g} s; write a file first"
                    ) from None
                continue
            data += chunk
            if chunk:
                deadline = 0.0
            elif monotonic() > deadline:
                break
            else:
                sleep(PAUSE)
    finally:
        os.close(pipe)
    if not data and named and deadline:
        raise UnreadableError(
            f"is a pipe into which nobody wrote for {ABSENT:g} s; start its writer first, or give a file"
        )
    return data
