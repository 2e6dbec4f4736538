"""Part: the samples of a run under way on disk, readable at every moment; sealed, they are the result.

While a run goes on its rows are appended to ``NAME.part.nc``, a NetCDF file of the classic 64-bit form: its
heading is written once, rows only follow, and how many there are is written after them. HDF5 would be
broken where a run is killed while it writes. At the end rows are copied to compressed NetCDF4.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from ltcgear.generated.errors import LtcgearError

from .statistics import BLOCK, ForceSums

if TYPE_CHECKING:
    import xarray as xr


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
    rows
        Rows that the file holds already and that are to stay; None makes a new file.

    Raises
    ------
    LtcgearError
        If the file cannot be written, or does not hold the rows.
    """

    def __init__(self, target: Path, heading: "xr.Dataset", rows: int | None = None) -> None:
        import netCDF4

        self.target, self.path, self.heading, self.rows = target, part_of(target), heading, rows or 0
        self.moving = [str(name) for name in heading.variables if "time" in heading[name].dims]
        if rows is None:
            with _writing(self.path):
                plain = {name: {"_FillValue": None} for name in heading.variables}
                form: Any = {"engine": "netcdf4", "format": "NETCDF3_64BIT", "unlimited_dims": ["time"]}
                heading.to_netcdf(self.path, encoding=plain, **form)
        try:
            self.file = netCDF4.Dataset(self.path, "a")
            self.file.set_auto_mask(False)
            self.file.set_fill_off()
            found = len(self.file.dimensions["time"])
        except (OSError, RuntimeError, KeyError) as error:
            raise LtcgearError(f"{self.path}: cannot be read ({error}); simulate again without --resume") from error
        if found < self.rows or set(self.moving) - set(self.file.variables):
            self.file.close()
            raise LtcgearError(
                f"{self.path}: holds {found} samples where the checkpoint counts {self.rows}; "
                "simulate again without --resume"
            )

    def append(self, rows: "xr.Dataset") -> None:
        """Append rows; once this returns they outlast the program."""
        count = rows.sizes["time"]
        if not count:
            return
        with _writing(self.path):
            for name in self.moving:
                self.file.variables[name][self.rows : self.rows + count] = rows[name].values
            self.file.sync()
        self.rows += count

    def force_sums(self) -> ForceSums:
        """Return sums and extremes of the mesh forces over the second half of the rows."""
        forces = self.file.variables["mesh_force"]
        sums = ForceSums(forces.shape[1])
        for block in self._blocks("mesh_force", self.rows // 2):
            sums.note(block)
        return sums

    def seal(self, heading: "xr.Dataset") -> None:
        """Write the result; it appears whole or not at all.

        ``heading`` is the result without rows, with all that is known at the end.
        """
        import netCDF4

        draft = self.target.with_name(f".draft-{self.target.name}")
        try:
            with _writing(self.target):
                heading.drop_dims("time").to_netcdf(draft, engine="netcdf4")
                with netCDF4.Dataset(draft, "a") as result:
                    result.createDimension("time", self.rows)
                    for name in self.moving:
                        self._copy(name, heading, result)
                draft.replace(self.target)
        finally:
            draft.unlink(missing_ok=True)

    def close(self, keep: bool) -> None:
        """Close the file, and delete it unless it is to be kept."""
        self.file.close()
        if not keep:
            self.path.unlink(missing_ok=True)

    def _copy(self, name: str, heading: "xr.Dataset", result: Any) -> None:  # noqa: ANN401
        """Copy a variable, chunk by chunk."""
        source = heading[name]
        options: dict[str, Any] = {}
        if source.dtype.kind == "f":
            options = {"zlib": True, "complevel": 1, "shuffle": True, "fill_value": np.nan}
        shape = (min(BLOCK, self.rows), *source.shape[1:])
        copied = result.createVariable(name, source.dtype, source.dims, chunksizes=shape, **options)
        copied.setncatts(source.attrs)
        copied.set_auto_mask(False)
        copied.set_var_chunk_cache(size=source.dtype.itemsize * int(np.prod(shape)), nelems=1)
        start = 0
        for block in self._blocks(name):
            copied[start : start + len(block)] = block
            start += len(block)

    def _blocks(self, name: str, start: int = 0) -> Iterator[Any]:
        """Yield the rows of a variable from a row on, as many as are copied at once."""
        for first in range(start, self.rows, BLOCK):
            yield self.file.variables[name][first : min(first + BLOCK, self.rows)]
