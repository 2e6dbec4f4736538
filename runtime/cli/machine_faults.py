"""Faults of memory, disk and folders, which libraries raise as whatever error they have."""

import errno
import tempfile

NO_MEMORY = ("bad_alloc", "Unable to allocate", "annot allocate memory", "failed to map segment", "out of memory")
"""What CasADi, NumPy, the loader and HDF5 say where memory is short."""
FULL = (errno.ENOSPC, errno.EDQUOT)


def find_fault(error: BaseException) -> str | None:
    """Return what is wrong with the machine and what to do about it; None for an error of another kind."""
    said = " ".join(str(error).split())
    if isinstance(error, MemoryError) or any(words in said for words in NO_MEMORY):
        return (
            f"out of memory{f': {said}' if said else ''}; ask for less at once (a shorter run, fewer points or "
            "workers), or lift the limit of memory (ulimit -v)"
        )
    if not isinstance(error, OSError):
        return None
    if "No usable temporary directory" in said:
        return f"{said}; make room in one of these, or set TMPDIR to a folder that can be written"
    what = f"{error.filename}: {error.strerror}" if error.filename else error.strerror or said or type(error).__name__
    if error.errno in FULL:
        return f"{what}; make room there" + _temporary(error)
    return f"{what}; make it readable and writable, or give another"


def _temporary(error: OSError) -> str:
    """Say how to leave a folder of temporary files that is full."""
    inside = tempfile.tempdir is not None and str(error.filename).startswith(tempfile.tempdir)
    return ", or set TMPDIR to a folder with room" if inside or not error.filename else ""
