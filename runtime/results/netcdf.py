"""NetCDF4 files: written and read so that HDF5 survives full disks and damage.

Room is reserved before HDF5 writes, since it does not survive a disk that fills up. After its own end each file bears
the checksum of all its bytes, which HDF5 leaves alone: damage is seen before the library follows it, perhaps without
end. A file without checksum (older, or edited by other software) is first read by a separate process.
"""

import os
import subprocess
import sys
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from ltcgear.generated.writing import written_whole

from .checksums import list_sums
from .file_content import FileContent, has_sum

if TYPE_CHECKING:
    import xarray as xr

OVERHEAD, EACH = 1.05, 8_192
"""Room beyond the data: checksums and indices of chunks, and what each variable takes [bytes] (measured: 3300)."""
HDF5 = b"\x89HDF\r\n\x1a\n"
"""First bytes of a NetCDF4 file."""
MARK, DIGITS = b"\nltcgear crc32 ", 8
"""Marker after a file's own end, and the digits of the checksum behind it."""
READ_ALL = """
import sys, netCDF4
with netCDF4.Dataset(sys.argv[1]) as file:
    for data in (file, *file.variables.values()):
        for name in data.ncattrs():
            data.getncattr(name)
    for data in file.variables.values():
        data[...]
"""
PATIENCE, SPEED = 20.0, 20e6
"""Time limit for reading a file [s], to which its size over a speed [bytes/s] is added."""


def save(dataset: "xr.Dataset", path: Path, retry: str = "run the same command again") -> None:
    """Write a NetCDF4 file; it appears whole or not at all.

    Parameters
    ----------
    dataset
        What is written; variables with numbers and attributes get checksums.
    path
        The file.
    retry
        What continues once a full disk has room.

    Raises
    ------
    LtcgearError
        If it must not be written, or its folder is missing.
    MachineError
        If it cannot be written.
    """
    summed = dataset.assign_attrs(list_sums(dataset))
    with written_whole(path, retry) as draft:
        begin(draft, summed)
        fill(draft, summed)
        sign(draft)


def sign(draft: Path) -> None:
    """Append the checksum of all bytes of a file that HDF5 has closed.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    found = _sum_up(draft, draft.stat().st_size)
    with draft.open("ab") as file:
        file.write(MARK + found)


def open_file(path: Path, decode: bool = True) -> "xr.Dataset":
    """Open a NetCDF file, unless it is damaged.

    Parameters
    ----------
    path
        The file, NetCDF4 or classic.
    decode
        Whether numbers are scaled and missing ones put to NaN, as attributes say.

    Raises
    ------
    OSError
        If it is damaged.
    Exception
        Any error of the libraries for an invalid file.
    """
    import xarray as xr

    _check_whole(path)
    return xr.open_dataset(path, engine="netcdf4", decode_cf=decode)


def _check_whole(path: Path) -> None:
    """Refuse an HDF5 file whose bytes are not those that were written, or that cannot be read."""
    length = len(MARK) + DIGITS
    with path.open("rb") as file:
        if file.read(len(HDF5)) != HDF5:
            return
        size = max(file.seek(0, os.SEEK_END) - length, 0)
        file.seek(size)
        end = file.read(length)
    if not end.startswith(MARK):
        _read_apart(path)
    elif end.removeprefix(MARK) != _sum_up(path, size):
        raise OSError("damaged: its bytes are not those that were written")


def _sum_up(path: Path, size: int) -> bytes:
    """Return the checksum (CRC-32) of a file's first bytes."""
    found = 0
    with path.open("rb") as file:
        while size > 0 and (block := file.read(min(size, 1 << 20))):
            found, size = zlib.crc32(block, found), size - len(block)
    return f"{found:0{DIGITS}x}".encode()


def _read_apart(path: Path) -> None:
    """Read a file in a separate process, and refuse it where that dies or does not end."""
    try:
        done = subprocess.run(
            [sys.executable, "-P", "-c", READ_ALL, str(path)],
            stdin=subprocess.DEVNULL, capture_output=True, check=False, timeout=PATIENCE + path.stat().st_size / SPEED,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        raise OSError("damaged: HDF5 does not come to an end with it") from None
    if done.returncode < 0:
        raise OSError(f"damaged: HDF5 dies of it, by signal {-done.returncode}")


def begin(draft: Path, dataset: "FileContent | xr.Dataset", more: int = 0) -> None:
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
    size = sum(values.nbytes for _, values in parts) + more
    room = int(size * OVERHEAD) + 2 * texts + EACH * (len(parts) + 8)
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
    summed = {name: {"fletcher32": True} for name, data in dataset.variables.items() if has_sum(data.values)}
    try:
        dataset.to_netcdf(draft, mode="a", engine="netcdf4", encoding=summed)
    except RuntimeError as error:  # HDF5's own
        raise OSError(str(error)) from error


def _length(attributes: Mapping[Any, Any], values: Any) -> int:  # noqa: ANN401
    """Return the bytes of all texts among attributes and values; each has its own header."""
    texts = [str(value).encode("utf-8", "replace") for value in attributes.values()]
    if values.dtype.kind in "OSU":
        texts += [str(value).encode("utf-8", "replace") for value in values.ravel()]
    return sum(map(len, texts)) + 32 * len(texts)
