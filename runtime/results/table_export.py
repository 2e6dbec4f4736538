"""Export of a result's quantities over time, as CSV or MATLAB's MAT."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from ltcgear.generated.errors import LtcgearError
from ltcgear.generated.writing import check_output, written_whole

from .result import Result
from .select import find_columns

if TYPE_CHECKING:
    import xarray as xr

Columns = dict[str, "xr.DataArray"]


def export(result: Result, path: str | Path, wanted: list[str] | None = None) -> Path:
    """Write quantities over time to a file of another form; it appears whole or not at all.

    Parameters
    ----------
    result
        What to write.
    path
        The suffix is the form: ``.csv`` has one column an item, its head ``QUANTITY:ITEM [unit]``; ``.mat`` (MATLAB 5)
        one matrix a quantity over (time, item), with the items' names and units in structs ``items`` and
        ``units``.
    wanted
        QUANTITY or QUANTITY:ITEM; all where left out, but for the states.

    Raises
    ------
    LtcgearError
        If the form or an output is not known, or the file cannot be written.
    """
    path = Path(path)
    check_export(path)
    WRITERS[path.suffix](_select(result.dataset, wanted), result.dataset, path)
    return path


def check_export(path: Path, *sources: Path) -> None:
    """Refuse a file that cannot be written, of another form, or that is the source itself."""
    check_output(path, *sources)
    if path.suffix not in WRITERS:
        raise LtcgearError(f"{path}: must end with {' or '.join(WRITERS)}; the NetCDF file itself opens in xarray")


def _select(dataset: "xr.Dataset", wanted: list[str] | None) -> Columns:
    """Return quantities over time by name, with the items that are wanted; all but the states where nothing is said."""
    moving = {str(name): data for name, data in dataset.data_vars.items() if "time" in data.dims and name != "state"}
    chosen = find_columns(dataset, wanted) if wanted else dict.fromkeys(moving)
    columns = {}
    for name, items in chosen.items():
        data = dataset[name].transpose("time", ...)
        columns[name] = data if items is None else data.sel({data.dims[1]: items})
    return columns


def _items(data: "xr.DataArray") -> list[str]:
    """Return the names of a quantity's items."""
    return [str(item) for item in data[data.dims[1]].values] if data.ndim > 1 else []


def _write_csv(columns: Columns, dataset: "xr.Dataset", path: Path) -> None:
    """Write one row a sample, numbers with all their digits."""
    import pandas as pd

    table = {"time [s]": dataset["time"].values}
    for name, data in columns.items():
        unit, items = data.attrs.get("units", "1"), _items(data)
        heads = [f"{name}:{item} [{unit}]" for item in items] or [f"{name} [{unit}]"]
        table |= dict(zip(heads, data.values.reshape(len(data), -1).T, strict=True))
    with written_whole(path) as draft:
        pd.DataFrame(table).to_csv(draft, index=False)


def _write_mat(columns: Columns, dataset: "xr.Dataset", path: Path) -> None:
    """Write one matrix a quantity."""
    from scipy.io import savemat

    matrices = {name: data.values.reshape(len(data), -1) for name, data in columns.items()}
    units = {name: data.attrs.get("units", "1") for name, data in columns.items()}
    items = {name: np.array(_items(data), dtype=object) for name, data in columns.items() if data.ndim > 1}
    beside = {"time": dataset["time"].values[:, None], "items": items or 0, "units": units | {"time": "s"}}
    with written_whole(path) as draft:
        savemat(draft, {**matrices, **beside}, long_field_names=True)


WRITERS: dict[str, Callable[[Columns, "xr.Dataset", Path], None]] = {".csv": _write_csv, ".mat": _write_mat}
"""Suffix -> what writes such a file."""
