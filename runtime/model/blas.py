"""BLAS threads: linear algebra in one thread while a run is set up.

The matrices of a train are small, so threads wait for each other, and a set-up takes several times as long with two.
The command line sets OPENBLAS_NUM_THREADS before NumPy is loaded; a program that imports ltcgear has already loaded it
and may need the threads for its own work.
"""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from threading import RLock

import scipy
from threadpoolctl import ThreadpoolController

_ALONE = RLock()


@contextmanager
def single_threaded() -> Iterator[None]:
    """Keep BLAS to one thread inside, for the whole process; also a decorator.

    Calls may be nested. Threads enter one after another: each restores the number that it found.
    """
    with _ALONE, _libraries("scipy.linalg" in sys.modules).limit(limits=1, user_api="blas"):
        yield


@cache
def _libraries(scipy_loaded: bool) -> ThreadpoolController:
    """Return the loaded BLAS libraries; finding them takes milliseconds, setting their threads microseconds.

    SciPy has its own BLAS besides NumPy's, and only loaded libraries are found. If the environment sets one thread, a
    BLAS loaded later has one too.
    """
    if not scipy_loaded and os.environ.get("OPENBLAS_NUM_THREADS") != "1":
        _ = scipy.linalg
    return ThreadpoolController()
