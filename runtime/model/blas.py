"""BLAS threads: linear algebra in one thread while a run is set up.

The matrices of a train are small, so threads wait for each other, and a set-up takes several times as long with two.
The command line sets OPENBLAS_NUM_THREADS before NumPy is loaded; a program that imports ltcgear has loaded it long
since, and its own work may want the threads.
"""

from collections.abc import Callable
from contextlib import ContextDecorator
from ctypes import CDLL
from functools import cache
from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np
import scipy

ENDINGS = ("64_", "", "_64_", "_64")
"""How OpenBLAS names a function for whole numbers of 64 bits, and of 32."""
HEADS = ("scipy_openblas", "openblas")
FOLDERS = ("../{}.libs", ".dylibs")
"""Where wheels keep libraries of theirs, from the package's folder: Linux and Windows, macOS."""


class SingleThreaded(ContextDecorator):
    """Keeps OpenBLAS to one thread inside, for the whole process; elsewhere (MKL, Accelerate) nothing changes.

    Calls may be nested and come from several threads: the first one in notes the number, the last one out restores it.
    """

    lock, inside, before = Lock(), 0, list[int]()

    def __enter__(self) -> "SingleThreaded":
        """Note how many threads there are, and leave one."""
        kind = type(self)
        with kind.lock:
            if kind.inside == 0:
                kind.before = [get() for get, _ in _libraries()]
                _set([1] * len(kind.before))
            kind.inside += 1
        return self

    def __exit__(self, *error: object) -> None:
        """Restore how many there were."""
        kind = type(self)
        with kind.lock:
            kind.inside -= 1
            if kind.inside == 0:
                _set(kind.before)


def _set(counts: list[int]) -> None:
    """Set how many threads the libraries use."""
    for (_, set_count), count in zip(_libraries(), counts, strict=True):
        set_count(count)


@cache
def _libraries() -> list[tuple[Callable[[], int], Callable[[int], Any]]]:
    """Return the functions by which the libraries of NumPy and SciPy tell and take their number of threads."""
    found = []
    for package in (np, scipy):
        home = Path(str(package.__file__)).parent
        for path in sorted(p for f in FOLDERS for p in (home / f.format(package.__name__)).glob("*openblas*")):
            try:
                library = CDLL(str(path))
            except OSError:
                continue
            ways = [f"{head}_{{}}_num_threads{end}" for head in HEADS for end in ENDINGS]
            way = next((way for way in ways if hasattr(library, way.format("set"))), None)
            pair = None if way is None else (getattr(library, way.format("get")), getattr(library, way.format("set")))
            if pair is not None:
                found.append(pair)
    return found
