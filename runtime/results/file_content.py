"""Content of a result file: variables over dimensions, and attributes, as NetCDF has them.

A run writes its file by this and netCDF4; xarray, whose datasets the Python API returns, takes longer to load than most
runs.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import xarray as xr

STORED = {"f": "f8", "i": "i4"}
"""Types of numbers in classic NetCDF, by kind."""


@dataclass(frozen=True)
class StoredVariable:
    """Values over named dimensions, with attributes."""

    dims: tuple[str, ...]
    values: NDArray[Any]
    attrs: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class FileContent:
    """Variables and attributes of a file; ``coordinates`` are the variables that label the others' items."""

    variables: dict[str, StoredVariable]
    coordinates: frozenset[str]
    attrs: dict[str, Any]

    @classmethod
    def of(cls, data: Mapping[str, Any], coordinates: Mapping[str, Any], attrs: dict[str, Any]) -> "FileContent":
        """Make it as xarray makes a dataset: of (dimensions, values, attributes), or of labels of a dimension."""
        made = {name: _variable(name, given) for name, given in (*data.items(), *coordinates.items())}
        return cls(made, frozenset(coordinates), attrs)

    def assign_attrs(self, more: Mapping[str, Any]) -> "FileContent":
        """Return the same with more attributes."""
        return replace(self, attrs={**self.attrs, **more})

    def over(self, dimension: str, moving: bool = True) -> "FileContent":
        """Return the variables over a dimension, or the others."""
        kept = {name: data for name, data in self.variables.items() if (dimension in data.dims) == moving}
        return replace(self, variables=kept)

    def to_xarray(self) -> "xr.Dataset":
        """Return an xarray Dataset."""
        import xarray as xr

        parts = {name: (data.dims, data.values, dict(data.attrs)) for name, data in self.variables.items()}
        coordinates = {name: parts.pop(name) for name in self.variables if name in self.coordinates}
        return xr.Dataset(parts, coordinates, self.attrs)

    def write(self, file: Any, along: str = "") -> None:  # noqa: ANN401
        """Define and fill all variables of an open netCDF4 file; numbers get checksums where it is NetCDF4.

        ``along`` is the dimension without end, if there is one.
        """
        whole = file.data_model == "NETCDF4"
        for name, data in self.variables.items():
            stored = data if whole else _classic(data)
            for dimension, size in zip(stored.dims, stored.values.shape, strict=True):
                if dimension not in file.dimensions:
                    file.createDimension(dimension, None if dimension == along else size)
            made = _create(file, name, stored)
            made.setncatts({**stored.attrs, **self._labels(name)})
            made[...] = stored.values.astype(object) if stored.values.dtype.kind == "U" else stored.values
        file.setncatts(self.attrs)

    def _labels(self, name: str) -> dict[str, str]:
        """Return the attribute that names the further labels of a variable's items (CF conventions)."""
        if name in self.coordinates:
            return {}
        dims = set(self.variables[name].dims)
        known = [label for label in self.variables if label in self.coordinates and label not in dims]
        found = [label for label in known if set(self.variables[label].dims) <= dims]
        return {"coordinates": " ".join(found)} if found else {}


def has_sum(values: NDArray[Any]) -> bool:
    """Say whether a variable gets a checksum (Fletcher's), so that damage of it is seen when it is read."""
    return values.ndim > 0 and values.size > 0 and values.dtype.kind in "fiu"


def _variable(name: str, given: Any) -> StoredVariable:  # noqa: ANN401
    """Return a variable of what describes it."""
    if isinstance(given, list):
        return StoredVariable((name,), np.array(given))
    dims, values, *attrs = given
    return StoredVariable((dims,) if isinstance(dims, str) else tuple(dims), np.asarray(values), *attrs)


def _create(file: Any, name: str, data: StoredVariable) -> Any:  # noqa: ANN401
    """Define a variable of a file."""
    kind = data.values.dtype.kind
    if file.data_model != "NETCDF4":
        return file.createVariable(name, data.values.dtype, data.dims)
    fill = {"fill_value": np.nan} if kind == "f" else {}
    return file.createVariable(
        name, str if kind == "U" else data.values.dtype, data.dims, fletcher32=has_sum(data.values), **fill
    )


def _classic(data: StoredVariable) -> StoredVariable:
    """Return a variable in the types of classic NetCDF: texts are characters over a dimension of their own."""
    kind = data.values.dtype.kind
    if kind not in "US":
        return replace(data, values=data.values.astype(STORED[kind]))
    texts = np.char.encode(data.values, "utf-8") if kind == "U" else data.values
    size = texts.dtype.itemsize
    letters = np.ascontiguousarray(texts).view("S1").reshape(*texts.shape, size)
    encoding = {"_Encoding": "utf-8"} if kind == "U" else {}
    return StoredVariable((*data.dims, f"string{size}"), letters, {**data.attrs, **encoding})
