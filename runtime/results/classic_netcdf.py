"""Classic NetCDF: header made in memory, and its layout read back.

The form is that of the NetCDF Classic Format Specification with 64-bit offsets: a header with dimensions, attributes
and variables, each with the place of its data; then the data that do not move; then one record after another.
"""

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from math import prod
from typing import Any, BinaryIO

import numpy as np

from .file_content import FileContent

MAGIC = b"CDF\x02"
COUNT = slice(4, 8)
"""Position of the number of records."""
TYPES = {1: "i1", 2: "S1", 3: ">i2", 4: ">i4", 5: ">f4", 6: ">f8"}
MOST = 100_000
"""Items that a list of a header may have: more is damage."""
BROKEN = (struct.error, UnicodeDecodeError, ValueError, KeyError, IndexError, OverflowError, MemoryError)
"""What a damaged header raises."""


@dataclass(frozen=True)
class Layout:
    """Where records are, and what they are made of.

    Attributes
    ----------
    along
        Dimension of the records.
    begin
        Bytes before the first record.
    rows
        Number of records that the header counts.
    record
        A record's variables in their order.
    texts
        Attributes that are text.
    """

    along: str
    begin: int
    rows: int
    record: "np.dtype[np.void]"
    texts: dict[str, str]


def make_heading(content: FileContent, along: str) -> bytes:
    """Return a file without any record, whose variables over ``along`` move with the records.

    Parameters
    ----------
    content
        Its content, without any row.
    along
        Dimension of the rows.
    """
    import netCDF4

    file = netCDF4.Dataset("heading", "w", format="NETCDF3_64BIT_OFFSET", memory=1 << 16)
    content.write(file, along)
    whole = bytes(file.close())
    return whole[: _Header(whole).layout().begin]


def read_layout(file: BinaryIO, size: int) -> Layout:
    """Read the header of a file of some bytes.

    Raises
    ------
    ValueError
        If it is no such file, or damaged; or another of ``BROKEN``.
    """
    return _Header(file.read(min(size, 64_000_000))).layout()


class _Header:
    """A header that is read from its beginning."""

    def __init__(self, data: bytes) -> None:
        if data[:4] != MAGIC:
            raise ValueError("not a classic NetCDF file with 64-bit offsets")
        self.data, self.at = data, 4
        self.rows = self._number()

    def layout(self) -> Layout:
        """Read all of it."""
        dimensions = [(self._name(), self._number()) for _ in range(self._list(10))]
        texts = dict(self._attributes())
        moving = [variable for variable in self._variables(dimensions) if variable is not None]
        if not moving:
            raise ValueError("no variable moves")
        begin, names = min(at for _, _, at in moving), [name for name, _, _ in moving]
        formats, offsets = [form for _, form, _ in moving], [at - begin for _, _, at in moving]
        sizes = [at + -(-np.dtype(form).itemsize // 4) * 4 for at, form in zip(offsets, formats, strict=True)]
        record = np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": max(sizes)})
        return Layout(next(name for name, length in dimensions if not length), begin, self.rows, record, texts)

    def _number(self, form: str = ">I") -> int:
        """Read a number."""
        (value,) = struct.unpack_from(form, self.data, self.at)
        self.at += struct.calcsize(form)
        return int(value)

    def _list(self, tag: int) -> int:
        """Read the beginning of a list; return how many items it has."""
        found, count = self._number(), self._number()
        if found not in (0, tag) or count > MOST or (found == 0 and count):
            raise ValueError("damaged header")
        return count

    def _take(self, size: int) -> bytes:
        """Read bytes, and what fills them up to a multiple of four."""
        taken = self.data[self.at : self.at + size]
        if len(taken) < size:
            raise ValueError("damaged header")
        self.at += -(-size // 4) * 4
        return taken

    def _name(self) -> str:
        """Read a name."""
        return self._take(self._number()).decode()

    def _attributes(self) -> Iterator[tuple[str, str]]:
        """Read attributes; yield those that are text."""
        for _ in range(self._list(12)):
            name, kind, count = self._name(), self._number(), self._number()
            values = self._take(count * np.dtype(TYPES[kind]).itemsize)
            if kind == 2:
                yield name, values.decode()

    def _variables(self, dimensions: list[tuple[str, int]]) -> Iterator[tuple[str, Any, int] | None]:
        """Read variables; yield name, form and place of those that move with the records, None for the others."""
        for _ in range(self._list(11)):
            name, count = self._name(), self._number()
            sizes = [dimensions[self._number()][1] for _ in range(min(count, MOST))]
            list(self._attributes())
            kind, _, begin = self._number(), self._number(), self._number(">Q")
            if prod(sizes[1:]) > 2**31:
                raise ValueError("damaged header")
            yield (name, np.dtype((TYPES[kind], tuple(sizes[1:]))), begin) if sizes and not sizes[0] else None
