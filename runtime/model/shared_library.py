"""Loading of shared libraries."""

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from ltcgear.generated.drafts import draft
from ltcgear.generated.errors import CompileError

Loaded = TypeVar("Loaded")
UNLOADABLE = (OSError, RuntimeError, AttributeError)


def load(make: Callable[[], Path], loader: Callable[[Path], Loaded]) -> Loaded:
    """Load a compiled library; where that fails, delete it, compile it once more and load that.

    Parameters
    ----------
    make
        Returns where the library is, compiled if it is not there.
    loader
        Loads it; an error of ``UNLOADABLE`` where that fails.

    Raises
    ------
    CompileError
        If the library that was just compiled cannot be loaded either.
    """
    path = make()
    try:
        return loader(path)
    except UNLOADABLE:
        pass  # leave the handler: its traceback may hold parts of the library
    try:
        path.unlink(missing_ok=True)
        path = make()
        # What was once loaded from a path stands for that path until the process ends: load from another.
        with draft(path.parent) as folder:
            return loader(Path(shutil.copy(path, folder)))
    except UNLOADABLE as error:
        raise CompileError(
            f"{path}: cannot be loaded, not even compiled afresh; if programs may not run from there (noexec), "
            f"set LTCGEAR_CACHE to another folder; the loader says: {error}"
        ) from error
