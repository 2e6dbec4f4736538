"""Entry point of ``ltcgear``, which runs before anything that takes time is imported."""

import os
import resource
import signal
from types import FrameType
from typing import NoReturn

STOPPED = b"ltcgear: stopped; no file is half-written\n"
INTERRUPTED = 130
UNABLE = 2
LEAST_MEMORY = 256 << 20
"""Bytes of address space with which libraries load or say that they cannot; with less, some wait for ever."""


def main() -> None:
    """Run the command line; Ctrl-C and a machine without room are told in one line, also while it is imported."""
    from .streams import open_closed

    open_closed()
    _check_memory()
    before = signal.getsignal(signal.SIGINT)
    if before is signal.default_int_handler:  # else it is ignored, as in the background of a shell
        signal.signal(signal.SIGINT, _stop)
    try:
        from .commands import main as run
    except Exception as error:  # without memory an import fails by whatever comes to it first
        _leave(
            f"ltcgear: cannot be started: {str(error) or type(error).__name__}; "
            "if memory is short, lift its limit (ulimit -v), else install it again\n".encode(),
            UNABLE,
        )
    try:
        signal.signal(signal.SIGINT, before)
        run()
    except KeyboardInterrupt:
        _leave(STOPPED, INTERRUPTED)


def _check_memory() -> None:
    """Refuse a limit of memory with which nothing can be loaded."""
    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    if limit != resource.RLIM_INFINITY and limit < LEAST_MEMORY:
        _leave(
            f"ltcgear: cannot be started with {limit >> 20} MiB of memory; "
            f"lift its limit (ulimit -v) to {LEAST_MEMORY >> 10} or more\n".encode(),
            UNABLE,
        )


def _stop(number: int, frame: FrameType | None) -> NoReturn:
    """End at once: nothing has been begun."""
    _leave(STOPPED, INTERRUPTED)


def _leave(message: bytes, code: int) -> NoReturn:
    """End with a message, and without what Python does at its end."""
    try:
        os.write(2, message)
    finally:
        os._exit(code)
