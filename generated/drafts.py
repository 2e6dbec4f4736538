"""Temporary folders of the store: locked while in use, removed after a crash."""

import contextlib
import fcntl
import os
import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from .text import shorten
from .writing import FULL

PREFIX = ".draft-"
LEFT, LEFT_UNLOCKED = 3600.0, 86400.0
"""Age [s] from which a draft without a lock was left by a killed program; where files cannot be locked."""


@contextmanager
def draft(parent: Path) -> Iterator[Path]:
    """Make a folder for a draft, locked as long as it is used and removed at the end; those left behind are removed.

    Raises
    ------
    OSError
        If it cannot be made.
    """
    parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    _sweep(parent)
    folder = Path(tempfile.mkdtemp(dir=parent, prefix=PREFIX))
    handle = None
    try:
        with contextlib.suppress(OSError):
            handle = os.open(folder, os.O_RDONLY)
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        if handle is not None:
            os.close(handle)


def _sweep(parent: Path) -> None:
    """Remove drafts that are certainly nobody's."""
    with contextlib.suppress(OSError), os.scandir(parent) as found:
        for path in [Path(entry.path) for entry in found if entry.name.startswith(PREFIX)]:
            with contextlib.suppress(OSError):
                if _is_left(path):
                    shutil.rmtree(path, ignore_errors=True)


def _is_left(path: Path) -> bool:
    """Tell whether a draft is old, and locked by nobody."""
    age = time.time() - path.lstat().st_mtime
    if age < LEFT:
        return False
    handle = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_DIRECTORY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return age > LEFT_UNLOCKED
    finally:
        os.close(handle)
    return True


def tell_fault(path: Path, error: OSError, retry: str) -> str:
    """Say what keeps something from being put into the store, and what to do."""
    cure = "make room there" if error.errno in FULL else "let it be written"
    return (
        f"{shorten(str(path))}: cannot be put into the store: {error.strerror or error}; "
        f"{cure}, or set LTCGEAR_CACHE to another folder of yours, then {retry}"
    )
