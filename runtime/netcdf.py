"""NetCDF4 files: written into room that is reserved first, since HDF5 does not survive a disk that fills up."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from ltcgear.generated.writing import written_whole

from .sums import add_sums

if TYPE_CHECKING:
    import xarray as xr

OVERHEAD, EACH = 1.05, 8_192
"""Room beyond the data: check sums and indices of chunks, and what each variable takes [bytes] (measured: 3300)."""


def save(dataset: "xr.Dataset", path: Path, retry: str = "run the same command again") -> None:
    """Write a NetCDF4 file; it appears whole or not at all.

    Parameters
    ----------
    dataset
        What is written; variables with numbers and attributes get check sums.
    path
        The file.
    retry
        What goes on after room was made on a full disk.

    Raises
    ------
    LtcgearError
        If it must not be written, or its folder is missing.
    MachineError
        If it cannot be written.
    """
    summed = add_sums(dataset)
    with written_whole(path, retry) as draft:
        begin(draft, summed)
        fill(draft, summed)


def begin(draft: Path, dataset: "xr.Dataset", more: int = 0) -> None:
    """Make a draft a NetCDF4 file without content, in which there is room.

    Parameters
    ----------
    draft
        The draft.
    dataset
        What will be written.
    more
        Bytes of rows that come besides.

    Raises
    ------
    OSError
        If there is no room.
    """
    import netCDF4

    parts = [(variable.attrs, variable.values) for variable in dataset.variables.values()]
    texts = sum(_length(*part) for part in [(dataset.attrs, np.zeros(0)), *parts])
    room = int((dataset.nbytes + more) * OVERHEAD) + 2 * texts + EACH * (len(dataset.variables) + 8)
    _reserve(draft, room)  # only then is an empty file sure to find its place
    netCDF4.Dataset(draft, "w").close()
    _reserve(draft, room)


def _reserve(path: Path, room: int) -> None:
    """Reserve room; HDF5 gives back at the end what it did not take."""
    with path.open("r+b") as file:
        os.posix_fallocate(file.fileno(), 0, room)


def fill(draft: Path, dataset: "xr.Dataset") -> None:
    """Write data into a draft that has room.

    Raises
    ------
    OSError
        If the disk fails.
    """
    summed = {name: {"fletcher32": True} for name, data in dataset.variables.items() if has_sum(data)}
    try:
        dataset.to_netcdf(draft, mode="a", engine="netcdf4", encoding=summed)
    except RuntimeError as error:  # HDF5's own
        raise OSError(str(error)) from error


def _length(attributes: Mapping[Any, Any], values: Any) -> int:  # noqa: ANN401
    """Return the bytes of all texts among attributes and values; each has a head of its own."""
    texts = [str(value).encode("utf-8", "replace") for value in attributes.values()]
    if values.dtype.kind in "OSU":
        texts += [str(value).encode("utf-8", "replace") for value in values.ravel()]
    return sum(map(len, texts)) + 32 * len(texts)


def has_sum(data: "xr.Variable") -> bool:
    """Say whether a variable gets a check sum (Fletcher's), so that damage of it is seen when it is read."""
    return data.ndim > 0 and data.size > 0 and data.dtype.kind in "fiu"
