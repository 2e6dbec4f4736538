"""Row file of a run under way: its samples on disk, readable at every moment; sealed, they are the result.

During a run its rows are appended to ``NAME.part.nc``, classic NetCDF (see ``classic_netcdf``): a heading that is
written once, then one record a row. How many records there are is written after them, so that a killed run leaves a
whole file; HDF5 would be broken where it is killed while it writes. The header has an identity that no other part has
and its checksum; a running checksum over the rows shows whether they are as written. At the end rows are copied to
NetCDF4, not compressed: the last digits of an integration are noise, so a fifth of the room is all that packing would
save, for more time than the run itself takes.
"""

import os
import secrets
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from ltcgear.generated.errors import LtcgearError
from ltcgear.generated.writing import follow, told, written_whole
from numpy.typing import NDArray

from .checksums import list_sums
from .classic_netcdf import BROKEN, COUNT, Layout, make_heading, read_layout
from .file_content import FileContent, StoredVariable
from .netcdf import begin, sign

BLOCK = 1024
"""Rows copied in one block."""
IDENTITY, NO_SUM = "identity", "0" * 8
"""Attribute with a name that no other part has and the checksum of the heading, and what stands for that meanwhile."""
BEGIN_ANEW = "to begin anew, delete it or give --force"


def part_of(target: Path) -> Path:
    """Return where the rows of a result under way are."""
    real = follow(target)
    return real.with_name(f"{real.stem}.part.nc")


class Part:
    """Rows of a run under way, in a file.

    Attributes
    ----------
    identity
        A name that no other part has, and the checksum of the heading.
    rows, sum
        How many rows there are, and their checksum (CRC-32).

    Parameters
    ----------
    target
        The result that the rows will be.
    heading
        The result without any row.
    kept
        Rows that the file holds already and that are to stay; None makes a new file.
    along
        Dimension of the rows: the variables over it change from row to row.

    Raises
    ------
    LtcgearError
        If the file does not hold the rows.
    MachineError
        If it cannot be written.
    """

    goes_on = "--resume goes on"
    """Advice on how to resume once there is room."""

    def __init__(self, target: Path, heading: FileContent, kept: int | None = None, along: str = "time") -> None:
        self.target, self.path, self.along = target, part_of(target), along
        if kept is None:
            self._make(heading)
        layout = read_part(self.path)
        if layout.rows < (kept or 0) or set(layout.record.names or ()) != set(_moving(heading, along)):
            raise LtcgearError(
                f"{self.path}: holds {layout.rows} samples where the checkpoint counts {kept}; {BEGIN_ANEW}"
            )
        self.record, self.begin, self.identity = layout.record, layout.begin, layout.texts[IDENTITY]
        self.rows, self.sum = kept or 0, 0
        with self._told():
            self.file = open_part(self.path, os.O_RDWR)
        for records in self.blocks():
            self.sum = zlib.crc32(records.view(np.uint8).data, self.sum)
        self._count(self.rows)

    def _told(self) -> Any:  # noqa: ANN401
        """Say what keeps the file from being written, and that the rows are not lost."""
        return told(self.path, retry=self.goes_on)

    def _make(self, heading: FileContent) -> None:
        """Write a part without any row; it appears whole or not at all."""
        name = secrets.token_hex(16)
        data = make_heading(heading.assign_attrs({IDENTITY: f"{name}:{NO_SUM}"}), self.along)
        place = data.index(name.encode()) + len(name) + 1
        found = f"{zlib.crc32(data):08x}".encode()
        with written_whole(self.path) as draft:
            draft.write_bytes(data[:place] + found + data[place + len(found) :])

    def __enter__(self) -> "Part":
        """Use the file."""
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        """Close it."""
        self.close()

    def close(self) -> None:
        """Close the file."""
        if self.file >= 0:
            os.close(self.file)
            self.file = -1

    def append(self, columns: Mapping[str, NDArray[Any]]) -> None:
        """Append rows, given by variable; once this returns they outlast the program."""
        records = np.zeros(len(columns[self.along]), self.record)
        for name in self.record.names or ():
            records[name] = columns[name]
        self._sign(records)
        data = records.view(np.uint8).data
        with self._told():
            self._put(self.begin + self.rows * self.record.itemsize, data)
        self.sum = zlib.crc32(data, self.sum)
        self.rows += len(records)
        self._count(self.rows)

    def _sign(self, records: NDArray[np.void]) -> None:
        """Set the attributes of the rows."""

    def sync(self) -> None:
        """Wait until all rows are on the disk, where a power cut leaves them."""
        with self._told():
            os.fsync(self.file)

    def remove(self) -> None:
        """Delete the file."""
        self.close()
        self.path.unlink(missing_ok=True)

    def _count(self, rows: int) -> None:
        """Write how many rows there are."""
        with self._told():
            self._put(COUNT.start, rows.to_bytes(4, "big"))

    def _put(self, place: int, data: bytes | memoryview) -> None:
        """Write bytes at a place."""
        left = memoryview(data).cast("B")
        while left:
            written = os.pwrite(self.file, left, place)
            left, place = left[written:], place + written

    def seal(self, heading: FileContent) -> None:
        """Write the result; it appears whole or not at all.

        ``heading`` is the result without rows, with all that is known at the end.

        Raises
        ------
        LtcgearError
            If the rows are not those that were appended: something else has written to the file.
        """
        import netCDF4

        heading = heading.assign_attrs(list_sums(heading))
        with written_whole(self.target, self.goes_on) as draft:
            begin(draft, heading, self.rows * self.record.itemsize)
            try:
                with netCDF4.Dataset(draft, "a") as result:
                    heading.over(self.along, moving=False).write(result)
                    result.createDimension(self.along, self.rows)
                    found = self._copy(heading.variables, result)
            except RuntimeError as error:  # HDF5's own
                raise OSError(str(error)) from error
            if found != self.sum:
                raise LtcgearError(
                    f"{self.path}: was changed by something else while the run went on; delete it and simulate again"
                )
            sign(draft)

    def _copy(self, heading: Mapping[str, StoredVariable], result: Any) -> int:  # noqa: ANN401
        """Copy all rows, block by block; return their checksum."""
        copies = {}
        result.set_fill_off()
        for name in self.record.names or ():
            source = heading[name]
            form = source.values.dtype
            options: dict[str, Any] = {"fill_value": np.nan} if form.kind == "f" else {}
            if self.rows:
                options |= {"fletcher32": True, "chunksizes": (min(BLOCK, self.rows), *source.values.shape[1:])}
            copied = result.createVariable(name, form, source.dims, **options)
            copied.setncatts(source.attrs)
            copied.set_auto_mask(False)
            copies[name] = copied
        start = found = 0
        for records in self.blocks():
            found = zlib.crc32(records.view(np.uint8).data, found)
            for name, copied in copies.items():
                copied[start : start + len(records)] = records[name].astype(copied.dtype)
            start += len(records)
        return found

    def blocks(self) -> Iterator[NDArray[np.void]]:
        """Yield the rows, in blocks."""
        for first in range(0, self.rows, BLOCK):
            place, count = self.begin + first * self.record.itemsize, min(BLOCK, self.rows - first)
            data = os.pread(self.file, count * self.record.itemsize, place)
            if len(data) < count * self.record.itemsize:
                raise LtcgearError(f"{self.path}: is cut short; {BEGIN_ANEW}")
            yield np.frombuffer(data, self.record)


def open_part(path: Path, mode: int) -> int:
    """Open a part, never through a link; return its handle."""
    return os.open(path, mode | os.O_NOFOLLOW | os.O_CLOEXEC)


def read_part(path: Path) -> Layout:
    """Read the heading of a part, and check that it is whole.

    Raises
    ------
    LtcgearError
        If it cannot be read, is no part, or its heading is not the one that was written.
    """
    try:
        handle = open_part(path, os.O_RDONLY | os.O_NONBLOCK)
        with os.fdopen(handle, "rb") as file:
            layout = read_layout(file, os.fstat(handle).st_size)
            data = os.pread(handle, layout.begin, 0)
        name, _, kept = layout.texts[IDENTITY].partition(":")
        place = data.index(name.encode()) + len(name) + 1
        plain = data[: COUNT.start] + bytes(4) + data[COUNT.stop : place] + NO_SUM.encode() + data[place + len(kept) :]
    except (OSError, *BROKEN) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error) or type(error).__name__
        raise LtcgearError(f"{path}: cannot be read as the part of a run ({reason}); {BEGIN_ANEW}") from error
    if kept != f"{zlib.crc32(plain):08x}":
        raise LtcgearError(f"{path}: its heading is damaged; {BEGIN_ANEW}")
    return layout


def _moving(heading: FileContent, along: str) -> list[str]:
    """Return the variables that change from row to row."""
    return list(heading.over(along).variables)
