"""Part: the samples of a run under way on disk, readable at every moment; sealed, they are the result.

While a run goes on its rows are appended to ``NAME.part.nc``, a NetCDF file of the classic form with 64-bit
offsets: a heading that is written once, then one record a row, all variables after each other in big-endian
numbers of 4 or 8 bytes, so without padding (NetCDF Classic Format Specification). How many records there are
stands in bytes 4 to 8 and is written after them, so that a killed run leaves a whole file; HDF5 would be
broken where it is killed while it writes. At the end rows are copied to NetCDF4, not compressed:
the last digits of an integration are noise, so a fifth of the room is all that packing would save, for more time than
the run itself takes.
"""

from collections.abc import Hashable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

import numpy as np
from ltcgear.generated.errors import LtcgearError
from numpy.typing import NDArray

from .results import has_sum
from .statistics import BLOCK, ForceSums

if TYPE_CHECKING:
    import xarray as xr


MARK = -1.7281924756351e-306
"""A time that no run knows; it stands in a new file's only record until the first row takes its place."""


def part_of(target: Path) -> Path:
    """Return where the rows of a result under way are."""
    return target.with_suffix(".part.nc")


@contextmanager
def _writing(path: Path) -> Iterator[None]:
    """Say what cannot be written, and that the run is not lost."""
    try:
        yield
    except (OSError, RuntimeError) as error:
        reason = getattr(error, "strerror", None) or error
        raise LtcgearError(f"{path}: cannot be written: {reason}; make room, then --resume goes on") from error


class Part:
    """Rows of a run under way, in a file.

    Parameters
    ----------
    target
        The result that the rows will be.
    heading
        The result without any row.
    kept
        Rows that the file holds already and that are to stay, and where they begin [bytes]; None makes a new file.

    Raises
    ------
    LtcgearError
        If the file cannot be written, or does not hold the rows.
    """

    def __init__(self, target: Path, heading: "xr.Dataset", kept: tuple[int, int] | None = None) -> None:
        self.target, self.path = target, part_of(target)
        if kept is None:
            with _writing(self.path):
                _write_heading(self.path, heading)
        self.record, found = self._layout()
        self.rows, self.begin = kept or (0, self._first_record())
        if found < self.rows or set(self.record.names or ()) != {
            str(n) for n in heading.variables if _moves(heading, n)
        }:
            raise LtcgearError(
                f"{self.path}: holds {found} samples where the checkpoint counts {self.rows}; "
                "simulate again without --resume"
            )
        with _writing(self.path):
            self.file = self.path.open("r+b", buffering=0)
            self._count(self.rows)

    def _layout(self) -> tuple[np.dtype[np.void], int]:
        """Return what a record is made of, in the file's order, and how many there are."""
        import netCDF4

        try:
            with netCDF4.Dataset(self.path) as file:
                moving = [v for v in file.variables.values() if v.dimensions[:1] == ("time",)]
                record = np.dtype([(v.name, v.dtype.newbyteorder(">"), v.shape[1:]) for v in moving])
                return record, len(file.dimensions["time"])
        except (OSError, RuntimeError, KeyError) as error:
            raise LtcgearError(f"{self.path}: cannot be read ({error}); simulate again without --resume") from error

    def _first_record(self) -> int:
        """Return where the records begin [bytes], by the mark that the first one bears: files may be padded."""
        whole, mark = self.path.read_bytes(), np.array(MARK, ">f8").tobytes()
        if whole.count(mark) != 1:
            raise LtcgearError(f"{self.path}: holds its mark {whole.count(mark)} times; simulate without -o")
        fields: Mapping[str, Any] = self.record.fields or {}
        return whole.index(mark) - int(fields["time"][1])

    def __enter__(self) -> "Part":
        """Use the file."""
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        """Close it."""
        self.file.close()

    def append(self, columns: Mapping[str, NDArray[Any]]) -> None:
        """Append rows, given by variable; once this returns they outlast the program."""
        records = np.empty(len(columns["time"]), self.record)
        for name in self.record.names or ():
            records[name] = columns[name]
        with _writing(self.path):
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

    def force_sums(self) -> ForceSums:
        """Return sums and extremes of the mesh forces over the second half of the rows."""
        sums = ForceSums(self.record["mesh_force"].shape[0])
        for records in self._blocks(self.rows // 2):
            sums.note(records["mesh_force"].astype(np.float64))
        return sums

    def seal(self, heading: "xr.Dataset") -> None:
        """Write the result; it appears whole or not at all.

        ``heading`` is the result without rows, with all that is known at the end.
        """
        import netCDF4

        draft = self.target.with_name(f".draft-{self.target.name}")
        try:
            with _writing(self.target):
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


def _moves(heading: "xr.Dataset", name: Hashable) -> bool:
    """Say whether a variable changes over time."""
    return "time" in heading[name].dims


def _write_heading(path: Path, heading: "xr.Dataset") -> None:
    """Write a part's heading and the room of one record."""
    one = heading.reindex(time=[MARK], fill_value=0)
    kinds = {"f": np.float64, "i": np.int32}
    wide = {name: one[name].astype(kinds[heading[name].dtype.kind]) for name in heading if _moves(heading, name)}
    one = one.assign(wide).assign_attrs(heading.attrs)
    plain = {name: {"_FillValue": None} for name in heading.variables}
    form: Any = {"engine": "netcdf4", "format": "NETCDF3_64BIT", "unlimited_dims": ["time"]}
    one.to_netcdf(path, encoding=plain, **form)
