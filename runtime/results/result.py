"""Result of a simulation under the names that engineers use, and its file."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from ltcgear.generated.errors import LtcgearError

from .attributes import read_summary
from .checksums import SUMS
from .file_schema import FORM, find_fault
from .netcdf import open_file, save

if TYPE_CHECKING:
    import xarray as xr

GROUPS = ("mesh", "pin", "bearing", "coupling", "support", "rotor", "member", "load", "drive")
"""Kinds of items that quantities are given for; each is an attribute of a Result."""
OWN = ("dataset", "summary", "parameters", "statistics")
"""What a Result has besides."""
ANGLE = "angle"
RESULT, SWEEP, OTHER = "a result", "a sweep", "something else"
"""What a NetCDF file holds."""


class Item:
    """One mesh, bearing, rotor, ... of a result: its quantities are attributes, xarray.DataArray over time.

    Names are those of the dataset's variables without the group: ``mesh_force`` of a mesh is ``force``. A rotor has
    its ``angle`` [rad] besides, whole turns included.
    """

    def __init__(self, name: str, quantities: "Mapping[str, xr.DataArray]") -> None:
        self._name, self._quantities = name, quantities

    def __getattr__(self, name: str) -> "xr.DataArray":
        if name.startswith("_"):  # asked for by copy and pickle before there are any quantities
            raise AttributeError(name)
        if name not in self._quantities:
            raise AttributeError(f"{self._name} has no {name!r}; it has {', '.join(self._quantities)}")
        return self._quantities[name]

    def __dir__(self) -> list[str]:
        return list(self._quantities)

    def __repr__(self) -> str:
        return f"{self._name}: {', '.join(self._quantities)}"


class Group(Mapping[str, Item]):
    """All items of a kind by name."""

    def __init__(self, kind: str, dataset: "xr.Dataset") -> None:
        self._kind, self._dataset = kind, dataset
        self._columns = dict(_columns(kind, dataset))
        names = (dataset[variable].indexes[dimension] for variable, dimension in self._columns.values())
        self._names = list(dict.fromkeys(str(name) for index in names for name in index))

    def __getitem__(self, name: str) -> Item:
        if name not in self._names:
            raise KeyError(_no_item(self._kind, name, self._names))
        found = {
            short: self._dataset[variable].sel({dimension: name})
            for short, (variable, dimension) in self._columns.items()
            if name in self._dataset.indexes[dimension]
        }
        if self._kind == "rotor" and {"twist", "speed_ratio"} <= set(found):
            found[ANGLE] = _angle(self._dataset, found)
        return Item(name, found)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __repr__(self) -> str:
        return f"{self._kind}: {', '.join(self._names) or 'none'}"


def _columns(kind: str, dataset: "xr.Dataset") -> Iterator[tuple[str, tuple[str, str]]]:
    """Yield short name, variable and dimension of what is given for items of a kind."""
    for variable, data in dataset.data_vars.items():
        for dimension in map(str, data.dims):
            if dimension in (kind, f"{variable}_{kind}", f"switched_{kind}"):
                yield str(variable).removeprefix(f"{kind}_"), (str(variable), dimension)


def _no_item(kind: str, name: object, names: list[str]) -> str:
    """Say that there is no such item, and which is near."""
    near = get_close_matches(str(name), names, 1)
    cure = f"did you mean {near[0]!r}?" if near else f"there are {', '.join(names) or 'none'}"
    return f"no {kind} {name!r}; {cure}"


def _angle(dataset: "xr.Dataset", rotor: "Mapping[str, xr.DataArray]") -> "xr.DataArray":
    """Return a rotor's angle: that of the rigid motion, and its own against that."""
    angle = rotor["speed_ratio"] * dataset["reference_angle"] + rotor["twist"]
    return angle.assign_attrs(units="rad", long_name="angle, whole turns included")


@dataclass(frozen=True)
class Result:
    """A simulation: its data, and its summary.

    ``result.mesh["lsp.sun_planet.1"].force`` is a force over time; ``pin``, ``bearing``, ``coupling``, ``support``,
    ``rotor``, ``member``, ``load`` and ``drive`` have items in the same way.

    Attributes
    ----------
    dataset
        All quantities with units and long names.
    summary
        How the run went, as ``ltcgear simulate --json`` prints it.
    """

    dataset: "xr.Dataset"
    summary: dict[str, Any]
    _groups: dict[str, Group] = field(default_factory=dict, init=False, repr=False, compare=False)

    def __getattr__(self, name: str) -> Group:
        if name not in GROUPS:
            raise AttributeError(f"a result has no {name!r}; it has {', '.join((*OWN, *GROUPS))}")
        if name not in self._groups:
            self._groups[name] = Group(name, self.dataset)
        return self._groups[name]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *GROUPS]

    @property
    def parameters(self) -> dict[str, float]:
        """The model's parameters in SI, by name."""
        names, values = self.dataset["parameter"].values, self.dataset["parameter_value"].values
        return dict(zip(map(str, names), values.tolist(), strict=True))

    @property
    def statistics(self) -> dict[str, dict[str, float]]:
        """Mean, RMS, standard deviation and extremes of all outputs along the motion, by QUANTITY:ITEM.

        They are those of the second half of the run (see ``averages``), in the outputs' units; none if it did not
        reach its end.
        """
        if "statistics" not in self.dataset:
            return {}
        found = self.dataset["statistics"]
        names, rows = (list(map(str, found[name].values)) for name in ("statistic", "output"))
        return {
            row: dict(zip(names, values, strict=True))
            for row, values in zip(rows, found.values.T.tolist(), strict=True)
        }

    def save(self, path: str | Path) -> None:
        """Write a NetCDF4 file, which ``load`` and plain xarray read."""
        save(self.dataset, Path(path))


def load(path: str | Path) -> Result:
    """Read a result file into memory.

    Raises
    ------
    LtcgearError
        If it is missing, damaged, not a result of ltcgear, or of another form.
    """
    path = Path(path)
    if not path.is_file():
        raise LtcgearError(f"{path}: no such result file; `ltcgear simulate SCENE -o {path}` writes one")
    try:
        with open_file(path) as opened:
            dataset = opened.load()
    except Exception as error:  # damaged files raise whatever the libraries stumble over
        raise LtcgearError(f"{path}: not a readable NetCDF4 file ({error}); simulate again") from error
    _check_form(path, dataset)
    dataset.attrs.pop(SUMS, None)
    return Result(dataset, read_summary(dataset.attrs))


def tell_kind(path: Path) -> str:
    """Say what a NetCDF file holds: ``RESULT``, ``SWEEP``, ``OTHER``; "" where none is there or it is empty."""
    if not path.is_file() or not path.stat().st_size:
        return ""
    try:
        with open_file(path, decode=False) as opened:
            attributes = dict(opened.attrs)
    except Exception:  # damaged files raise whatever the libraries stumble over
        return OTHER
    return SWEEP if "sweep_format" in attributes else RESULT if "ltcgear" in attributes else OTHER


def _check_form(path: Path, dataset: "xr.Dataset") -> None:
    """Refuse a file that is no result, or one of another form."""
    if "sweep_format" in dataset.attrs:
        raise LtcgearError(f"{path}: a sweep, not the result of one run; ltcgear.runtime.load_sweep reads it")
    version, form = dataset.attrs.get("ltcgear"), dataset.attrs.get("result_format", 0)
    if version is None:
        raise LtcgearError(f"{path}: not a result of ltcgear; give a file that `ltcgear simulate -o` wrote")
    if not isinstance(form, (int, np.integer)):
        raise LtcgearError(f"{path}: damaged: attribute result_format is no whole number; simulate again")
    if form != FORM:
        raise LtcgearError(
            f"{path}: has form {form}, of ltcgear {version}, {'older' if form < FORM else 'newer'} than form {FORM}, "
            "which this one reads; simulate again, or read it with xarray"
        )
    fault = find_fault(dataset)
    if fault:
        raise LtcgearError(f"{path}: damaged: {fault}; simulate again")
