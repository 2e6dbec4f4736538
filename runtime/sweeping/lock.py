"""Lock: one program at a time writes a file; a lock ends with the program that holds it, however that ends."""

import fcntl
import os
from pathlib import Path
from typing import BinaryIO

from ltcgear.generated.errors import LtcgearError


class Lock:
    """The right to write a file, held from the start until it is released.

    Parameters
    ----------
    path
        The file that is locked, which has no content; it is removed at the end. One that a killed program left is
        locked like any other.
    busy
        What to say where another program holds it.

    Raises
    ------
    LtcgearError
        If another program holds it, or the file cannot be made.
    """

    def __init__(self, path: Path, busy: str) -> None:
        self.path = path
        self.file = self._open(busy)
        while not self._is_there():  # who held it removed it in between
            self.file.close()
            self.file = self._open(busy)

    def _open(self, busy: str) -> BinaryIO:
        """Make the file and lock it, where files can be locked."""
        try:
            file = self.path.open("ab")
        except OSError as error:
            raise LtcgearError(f"{self.path}: cannot be written: {error.strerror or error}") from error
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            file.close()
            raise LtcgearError(busy) from error
        except OSError:
            pass
        return file

    def _is_there(self) -> bool:
        """Say whether the locked file is the one that others would find."""
        try:
            return os.path.samestat(os.fstat(self.file.fileno()), self.path.stat())
        except FileNotFoundError:
            return False

    def release(self) -> None:
        """Let others write."""
        self.path.unlink(missing_ok=True)
        self.file.close()
