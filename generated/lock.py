"""Lock of an output: one program at a time writes it; the lock ends with the program."""

import fcntl
import os
from pathlib import Path
from types import TracebackType

from .errors import LtcgearError
from .writing import follow, told


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
        self.target, self.path = target, lock_of(target)
        self.file = self._open()
        while not self._is_there():  # who held it removed it in between
            os.close(self.file)
            self.file = self._open()

    def _open(self) -> int:
        """Make the file and lock it, where files can be locked; never through a link."""
        with told(self.path):
            file = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666)
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            os.close(file)
            raise LtcgearError(
                f"{self.target}: another run or sweep is writing it; wait for that, or give another -o"
            ) from error
        except OSError:
            pass
        return file

    def _is_there(self) -> bool:
        """Say whether the locked file is the one that others would find."""
        try:
            return os.path.samestat(os.fstat(self.file), self.path.lstat())
        except FileNotFoundError:
            return False

    def release(self) -> None:
        """Let others write."""
        self.path.unlink(missing_ok=True)
        os.close(self.file)

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
