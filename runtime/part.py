"""Part: the samples of a run under way on disk, readable at every moment; sealed, they are the result.

While a run goes on its rows are appended to ``NAME.part.nc``, a NetCDF file of the classic form with 64-bit
offsets: a heading that is written once, then one record a row, all variables after each other in big-endian
numbers of 4 or 8 bytes, so without padding (NetCDF Classic Format Specification). How many records there are
stands in bytes 4 to 8 and is written after them, so that a killed run leaves a whole file; HDF5 would be
broken where it is killed while it writes. At the end rows are copied to NetCDF4, not compressed:
the last digits of an integration are noise, so a fifth of the room is all that packing would save, for more time than
the run itself takes.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

import numpy as np
from ltcgear.generated.errors import LtcgearError
from numpy.typing import NDArray

from .results import has_sum

if TYPE_CHECKING:
    import xarray as xr


BLOCK = 1024
"""Rows that are copied at once."""
MARK = -1.7281924756351e-306
"""A time that no run knows; by it a new file's records are found."""
BEGIN, PLACE = "records_begin", -3.9471520846213e-306
"""Attribute that tells where the records begin [bytes], and what stands there until that is known."""


def part_of(target: Path) -> Path:
    """Return where the rows of a result under way are."""
    return target.with_suffix(".part.nc")


class Part:
    """Rows of a run under way, in a file.

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
        If the file cannot be written, or does not hold the rows.
    """

    goes_on, again = "--resume goes on", "simulate again without --resume"
    """How one goes on where room was made, and what is to be done where the file is of no use."""

    def __init__(self, target: Path, heading: "xr.Dataset", kept: int | None = None, along: str = "time") -> None:
        self.target, self.path, self.along = target, part_of(target), along
        if kept is None:
            with self._writing(self.path):
                _write_heading(self.path, heading, along)
        self.record, found, self.begin = self._layout()
        self.rows = kept or 0
        if found < self.rows or set(self.record.names or ()) != set(_moving(heading, along)):
            raise LtcgearError(
                f"{self.path}: holds {found} samples where the checkpoint counts {self.rows}; {self.again}"
            )
        with self._writing(self.path):
            self.file = self.path.open("r+b", buffering=0)
            self._count(self.rows)

    @contextmanager
    def _writing(self, path: Path) -> Iterator[None]:
        """Say what cannot be written, and that the rows are not lost."""
        try:
            yield
        except (OSError, RuntimeError) as error:
            reason = getattr(error, "strerror", None) or error
            raise LtcgearError(f"{path}: cannot be written: {reason}; make room, then {self.goes_on}") from error

    def _layout(self) -> tuple[np.dtype[np.void], int, int]:
        """Return what a record is made of, in the file's order, how many there are, and where they begin [bytes]."""
        import netCDF4

        try:
            with netCDF4.Dataset(self.path) as file:
                moving = [v for v in file.variables.values() if v.dimensions[:1] == (self.along,)]
                record = np.dtype([(v.name, v.dtype.newbyteorder(">"), v.shape[1:]) for v in moving])
                return record, len(file.dimensions[self.along]), int(file.getncattr(BEGIN))
        except (OSError, RuntimeError, KeyError, AttributeError) as error:
            raise LtcgearError(f"{self.path}: cannot be read ({error}); {self.again}") from error

    def __enter__(self) -> "Part":
        """Use the file."""
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        """Close it."""
        self.file.close()

    def append(self, columns: Mapping[str, NDArray[Any]]) -> None:
        """Append rows, given by variable; once this returns they outlast the program."""
        records = np.empty(len(columns[self.along]), self.record)
        for name in self.record.names or ():
            records[name] = columns[name]
        with self._writing(self.path):
            self._put(self.begin + self.rows * self.record.itemsize, records.view(np.uint8).data)
            self._count(self.rows + len(records))
        self.rows += len(records)

    def _count(self, rows: int) -> None:
        """Write how many rows there are."""
        self._put(4, rows.to_bytes(4, "big"))

    def _put(self, place: int, data: bytes | memoryview) -> None:
        """Write bytes at a place."""
        self.file.seek(place)
        left = memoryview(data)
        while left:
            left = left[self.file.write(left) :]

    def seal(self, heading: "xr.Dataset") -> None:
        """Write the result; it appears whole or not at all.

        ``heading`` is the result without rows, with all that is known at the end.
        """
        import netCDF4

        draft = self.target.with_name(f".draft-{self.target.name}")
        try:
            with self._writing(self.target):
                fixed = heading.drop_dims("time")
                fixed.encoding = {}
                summed = {name: {"fletcher32": True} for name, data in fixed.variables.items() if has_sum(data)}
                fixed.to_netcdf(draft, engine="netcdf4", encoding=summed)
                with netCDF4.Dataset(draft, "a") as result:
                    result.createDimension("time", self.rows)
                    self._copy(heading, result)
                draft.replace(self.target)
        finally:
            draft.unlink(missing_ok=True)

    def _copy(self, heading: "xr.Dataset", result: Any) -> None:  # noqa: ANN401
        """Copy all rows, block by block."""
        copies = {}
        result.set_fill_off()
        for name in self.record.names or ():
            source = heading[name]
            options: dict[str, Any] = {"fill_value": np.nan} if source.dtype.kind == "f" else {}
            if self.rows:
                options |= {"fletcher32": True, "chunksizes": (min(BLOCK, self.rows), *source.shape[1:])}
            copied = result.createVariable(name, source.dtype, source.dims, **options)
            copied.setncatts(source.attrs)
            copied.set_auto_mask(False)
            copies[name] = copied
        start = 0
        for records in self._blocks():
            for name, copied in copies.items():
                copied[start : start + len(records)] = records[name].astype(copied.dtype)
            start += len(records)

    def _blocks(self, start: int = 0) -> Iterator[NDArray[np.void]]:
        """Yield the rows from a row on, as many as are copied at once."""
        for first in range(start, self.rows, BLOCK):
            place, count = self.begin + first * self.record.itemsize, min(BLOCK, self.rows - first)
            yield np.fromfile(self.path, self.record, count, offset=place)


def _moving(heading: "xr.Dataset", along: str) -> list[str]:
    """Return the variables that change from row to row."""
    return [str(name) for name, variable in heading.variables.items() if along in variable.dims]


def _write_heading(path: Path, heading: "xr.Dataset", along: str) -> None:
    """Write a part without any row; it appears whole or not at all."""
    one = heading.reindex({along: [MARK]}, fill_value=0)
    kinds: dict[str, Any] = {"f": np.float64, "i": np.int32}
    moving = {name: heading[name].dtype for name in _moving(heading, along) if name in heading.data_vars}
    wide = {name: one[name].astype(kinds.get(dtype.kind, dtype)) for name, dtype in moving.items()}
    one = one.assign(wide).assign_attrs({**heading.attrs, BEGIN: PLACE})
    plain = {name: {"_FillValue": None} for name in heading.variables}
    form: Any = {"engine": "netcdf4", "format": "NETCDF3_64BIT", "unlimited_dims": [along]}
    draft = path.with_name(f".draft-{path.name}")
    try:
        one.to_netcdf(draft, encoding=plain, **form)
        draft.write_bytes(_without_rows(draft, along))
        draft.replace(path)
    finally:
        draft.unlink(missing_ok=True)


def _without_rows(path: Path, along: str) -> bytes:
    """Return a file of one record as one of none, which tells where its records begin: files may be padded."""
    import netCDF4

    with netCDF4.Dataset(path) as file:
        sizes = [(v.name, v.dtype.itemsize * int(np.prod(v.shape[1:]))) for v in file.variables.values()
                 if v.dimensions[:1] == (along,)]  # fmt: skip
    before = sum(size for _, size in sizes[: [name for name, _ in sizes].index(along)])
    whole = path.read_bytes()
    marks = [np.array(value, ">f8").tobytes() for value in (PLACE, MARK)]
    for mark in marks:
        if whole.count(mark) != 1:
            raise LtcgearError(
                f"{path}: holds its mark {whole.count(mark)} times; change any number of the scene a little, "
                "or leave out -o where there is one run"
            )
    begin = np.array(whole.index(marks[1]) - before, ">f8").tobytes()
    return whole[:4] + bytes(4) + whole[8:].replace(marks[0], begin)
