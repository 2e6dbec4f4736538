"""Lock of an output: one program at a time writes it; the lock ends with the program."""

import errno
from pathlib import Path
from types import TracebackType

from filelock import FileLock, Timeout

from .errors import LtcgearError
from .writing import follow, told

GRACE = 0.05
"""Seconds in which the file is tried again: who held it may just be removing it."""
NO_LOCKS = (errno.ENOSYS, errno.ENOLCK, errno.EOPNOTSUPP)
"""Errors of file systems on which files cannot be locked."""


class Lock:
    """The right to write an output, held from the start until it is released; a context that releases it.

    Parameters
    ----------
    target
        The output, of whatever kind: all that write it over time lock the same file beside it, ``NAME.part.lock``. That
        has no content and is removed at the end; one that a killed program left is locked like any other.

    Raises
    ------
    LtcgearError
        If another program holds it.
    MachineError
        If the file cannot be made.
    """

    def __init__(self, target: Path) -> None:
        self.path = lock_of(target)
        self._held = FileLock(
            self.path, timeout=GRACE, poll_interval=GRACE / 10, thread_local=False, fallback_to_soft=False
        )
        with told(self.path):
            try:
                self._held.acquire()
            except Timeout as error:
                raise LtcgearError(
                    f"{target}: another run or sweep is writing it; wait for that, or give another -o"
                ) from error
            except OSError as error:
                if error.errno not in NO_LOCKS:
                    raise

    def release(self) -> None:
        """Let others write."""
        self.path.unlink(missing_ok=True)  # while it is held: a file that others have locked stays
        self._held.release()

    def __enter__(self) -> "Lock":
        """Hold it."""
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        """Release it."""
        self.release()


def lock_of(target: Path) -> Path:
    """Return what is locked while an output is written."""
    real = follow(target)
    return real.with_name(f"{real.stem}.part.lock")
