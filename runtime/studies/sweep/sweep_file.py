"""Sweep file: rows on disk, readable while the sweep runs; at the end NetCDF4.

Rows are records of classic NetCDF, ``NAME.part.nc`` (see ``row_file``), in the order in which they come. When all
are there they are sorted by point into ``NAME.nc``. Both tell of which sweep they are, so that another is not taken
for it.
"""

import json
import zlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

import numpy as np
from ltcgear.generated.errors import LtcgearError
from ltcgear.generated.lock import Lock
from ltcgear.generated.writing import check_output, is_forced, remove_drafts
from numpy.typing import NDArray

from ...results.attributes import UNFINISHED
from ...results.checkpoint import tell_differences
from ...results.checksums import SUMS, find_changed
from ...results.file_content import FileContent
from ...results.netcdf import open_file, save
from ...results.row_file import IDENTITY, Part, part_of, read_part
from .design import Design
from .sweep_reading import DONE, WARNINGS, is_done
from .task import PointOutcome

if TYPE_CHECKING:
    import xarray as xr

FORMAT = 2
"""Version of the file format; it increases when older files can no longer be resumed."""
READ = (1, FORMAT)
"""Forms that are read; the first kept no warnings."""
LONGEST = 400
"""Bytes of a reason that are kept."""
TEXTS = {"status": LONGEST, WARNINGS: 1000}
"""Columns of text, and how many bytes of each are kept."""
LEFT_OUT = "and {} more warnings, for which the row has no room"
KIND, ABOUT = "sweep_format", "sweep"
"""Attributes with the format version of a sweep's file and the identity of the sweep."""
GO_ON = "run the same command again to go on"
CURE = "give another -o, or delete it"
CHECK = "check"
"""Variable of a part with each row's checksum."""


class SweepPart(Part):
    """Rows of a running sweep; each has a checksum, since they are read one by one."""

    goes_on = GO_ON

    def _sign(self, records: NDArray[np.void]) -> None:
        """Put the checksum into each row."""
        records[CHECK] = _sum_up(records, self.identity)


def _sum_up(records: NDArray[np.void], identity: str) -> NDArray[np.int32]:
    """Return the checksums of rows whose own is 0, those of their part only."""
    begin = zlib.crc32(identity.encode())
    data = records.view(np.uint8).reshape(len(records), records.dtype.itemsize)
    return np.array([zlib.crc32(row.data, begin) for row in data], np.uint32).view(np.int32)


class Store:
    """The file of a sweep; rows are added in any order, and sealed when all are there.

    It is locked from the first reading to the end.

    Attributes
    ----------
    done, failed
        Points that are there, and how many of them are reasons in place of numbers.

    Parameters
    ----------
    target
        The file, ``NAME.nc``.
    design, form
        Points, and a row without numbers.
    about
        The settings that identify the sweep, by name.
    attributes
        Further attributes of the file.
    retry
        Whether points that failed are missing, to be computed again.

    Raises
    ------
    LtcgearError
        If the file, or its part, is of another sweep or no sweep, damaged, not whole, cannot be written, or is being
        written.
    """

    def __init__(
        self, target: Path, design: Design, form: "xr.Dataset", about: Mapping[str, Any], attributes: Mapping[str, Any],
        retry: bool = False,
    ) -> None:  # fmt: skip
        check_store(target)
        self.target, self.design, self.form, self.retry = target, design, form, retry
        self.attributes = {**attributes, KIND: FORMAT, ABOUT: json.dumps(about), "design": json.dumps(design.to_json())}
        self.part: SweepPart | None = None
        self.done: set[int] = set()
        self.failed = 0
        self.lock = Lock(target)
        try:
            self._begin(about)
        except BaseException:
            self.lock.release()
            raise

    def _begin(self, about: Mapping[str, Any]) -> None:
        """Read the existing rows, and open the part for the missing ones."""
        path = part_of(self.target)
        remove_drafts(self.target, path)
        if is_forced():
            path.unlink(missing_ok=True)
        elif self.target.exists():
            sealed = _check_sweep(self.target, about)
            if sealed.sizes["point"] != self.design.size:
                raise LtcgearError(
                    f"{self.target}: holds {sealed.sizes['point']} of the sweep's {self.design.size} points; delete "
                    "it, and the same command computes all"
                )
            self._note(sealed)
            if self.missing():
                self._open_again(sealed)
            else:
                path.unlink(missing_ok=True)
            return
        kept = _check_sweep(path, about) if path.exists() else None
        self.part = SweepPart(self.target, self._heading(), None if kept is None else kept.sizes["point"], "point")
        if kept is not None:
            self._note(_arrange(_leave_damage(path, kept), self.design))

    def _open_again(self, sealed: "xr.Dataset") -> None:
        """Turn a sealed file into a part of the same rows, which takes its place once it has all."""
        self.part = SweepPart(self.target, self._heading(), None, "point")
        for outcome in _outcomes(sealed, self.form):
            self._append(self.part, outcome)
        self.target.unlink()

    def _note(self, rows: "xr.Dataset") -> None:
        """Note the points that are there, and how many of them failed; with ``retry`` these are not there."""
        failed = {int(point) for point in rows["point"].values[~is_done(rows)]}
        self.done = {int(point) for point in rows["point"].values} - (failed if self.retry else set())
        self.failed = 0 if self.retry else len(failed)

    def _heading(self) -> FileContent:
        """Return the file's content without any row."""
        data: dict[str, Any] = {name: ("point", np.zeros(0, f"S{size}")) for name, size in TEXTS.items()}
        data[CHECK] = ("point", np.zeros(0, np.int32))
        for name, variable in self.form.data_vars.items():
            data[str(name)] = (("point", *variable.dims), np.zeros((0, *variable.shape)), variable.attrs)
        coordinates = {str(name): (data.dims, data.values, data.attrs) for name, data in self.form.coords.items()}
        under_way = {"status": f"{UNFINISHED}; {GO_ON}"}
        return FileContent.of(data, {"point": ("point", np.zeros(0)), **coordinates}, {**self.attributes, **under_way})

    def __enter__(self) -> "Store":
        """Use the file."""
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        """Close it, and let others write it."""
        if self.part is not None:
            self.part.close()
        self.lock.release()

    def missing(self) -> list[int]:
        """Return the points that are not there."""
        return [point for point in range(self.design.size) if point not in self.done]

    def add(self, outcome: PointOutcome) -> None:
        """Add a row; once this returns it outlasts the program."""
        if self.part is None or outcome.point in self.done:
            return
        self._append(self.part, outcome)
        self.done.add(outcome.point)
        self.failed += outcome.values is None

    def _append(self, part: SweepPart, outcome: PointOutcome) -> None:
        """Append a row to the part; of several of a point the last one counts."""
        columns: dict[str, NDArray[Any]] = {"point": np.array([outcome.point], float), CHECK: np.zeros(1, np.int32)}
        texts = {"status": _cut(outcome.status), WARNINGS: _join(outcome.warnings)}
        columns |= {
            name: np.array([texts[name]], f"S{size}").view("S1").reshape(1, size) for name, size in TEXTS.items()
        }
        start = 0
        for name, variable in self.form.data_vars.items():
            values = np.nan if outcome.values is None else outcome.values[start : start + variable.size]
            columns[str(name)] = np.broadcast_to(values, variable.size).reshape(1, *variable.shape)
            start += variable.size
        part.append(columns)

    def seal(self) -> None:
        """Write the file of all rows, sorted by point; it appears whole or not at all.

        Raises
        ------
        LtcgearError
            If points are missing.
        """
        if self.part is None:
            return
        rows = _arrange(_leave_damage(self.part.path, _open(self.part.path)), self.design)
        if not np.array_equal(rows["point"].values, np.arange(self.design.size)):
            there = len(np.unique(rows["point"].values))
            raise LtcgearError(f"{self.part.path}: holds {there} of the sweep's {self.design.size} points; {GO_ON}")
        rows.attrs = {**self.attributes, "status": DONE}
        for variable in rows.variables.values():
            variable.encoding = {}
        save(rows, self.target, GO_ON)
        self.part.remove()


def check_store(target: Path) -> None:
    """Refuse a file that cannot be a sweep's, before anything is computed."""
    check_output(target)
    if target.suffix != ".nc":
        raise LtcgearError(f"{target}: sweeps are NetCDF4 files; name it {target.with_suffix('.nc')}")
    check_output(part_of(target))
    for path in (target, part_of(target)):
        if path.exists() and not is_forced():
            _open(path)
    if part_of(target).exists() and not is_forced():
        read_part(part_of(target))


def load_sweep(path: str | Path) -> "xr.Dataset":
    """Read a sweep into memory: rows over ``point``, with the axes' values as coordinates.

    Parameters
    ----------
    path
        The file, or its part ``NAME.part.nc``, which has the rows that are there so far.

    Raises
    ------
    LtcgearError
        If it is missing, damaged or not a sweep.
    """
    path = Path(path)
    if not path.is_file():
        part = part_of(path)
        hint = f"the sweep is under way, {part} has its rows so far" if part.is_file() else "`ltcgear sweep` writes one"
        raise LtcgearError(f"{path}: no such file; {hint}")
    found = _open(path)
    try:
        design = Design.from_json(found.attrs["design"])
    except LtcgearError as error:
        raise LtcgearError(f"{path}: {error}") from error
    if str(found.attrs.get("status", "")).startswith(UNFINISHED):
        return _arrange(_leave_damage(path, found), design)
    if missing := {axis.key for axis in design.axes} - set(found.coords):
        raise LtcgearError(f"{path}: has no values of {min(missing)}, so it is damaged")
    return found


def _open(path: Path) -> "xr.Dataset":
    """Read a file into memory, and refuse what is no sweep."""
    try:
        with open_file(path) as opened:
            found = opened.load()
    except Exception as error:  # damaged files raise whatever the libraries stumble over
        raise LtcgearError(f"{path}: not a readable NetCDF file ({error}); {CURE}") from error
    if changed := find_changed(found):
        raise LtcgearError(f"{path}: damaged: attribute {changed} is not what was written; {CURE}")
    found.attrs.pop(SUMS, None)
    if not {KIND, ABOUT, "design"} <= set(found.attrs) or "point" not in found.dims or "status" not in found:
        raise LtcgearError(f"{path}: not a sweep; {CURE}")
    if found.attrs[KIND] not in READ:
        raise LtcgearError(f"{path}: a sweep of form {found.attrs[KIND]}, which is not {FORMAT}; {CURE}")
    return found


def _leave_damage(path: Path, rows: "xr.Dataset") -> "xr.Dataset":
    """Return the rows of a part that are those that were written; the others are computed again."""
    layout = read_part(path)
    records = np.fromfile(path, layout.record, rows.sizes["point"], offset=layout.begin)
    plain = records.copy()
    plain[CHECK] = 0
    sound = _sum_up(plain, layout.texts[IDENTITY]) == records[CHECK]
    return rows.isel(point=np.pad(sound, (0, rows.sizes["point"] - len(sound))))


def _check_sweep(path: Path, about: Mapping[str, Any]) -> "xr.Dataset":
    """Return what a file holds, and refuse that of another sweep."""
    found = _open(path)
    if found.attrs[KIND] != FORMAT:
        raise LtcgearError(
            f"{path}: a sweep of form {found.attrs[KIND]}, which is read but not gone on with ({FORMAT} is); {CURE}"
        )
    try:
        differences = tell_differences(json.loads(found.attrs[ABOUT]), about)
    except (ValueError, AttributeError) as error:
        raise LtcgearError(f"{path}: damaged ({error}); {CURE}") from error
    if differences:
        raise LtcgearError(f"{path}: of another sweep: {differences}; {CURE}")
    return found


def _arrange(rows: "xr.Dataset", design: Design) -> "xr.Dataset":
    """Return the rows of a part sorted by point, the last of each, with what the axes are there."""
    rows = rows.isel(point=np.isin(rows["point"].values, np.arange(design.size)))  # others are damaged
    points = rows["point"].values.astype(np.int64)
    at, last = np.unique(points[::-1], return_index=True)
    rows = rows.assign_coords(point=points).isel(point=points.size - 1 - last)
    for name in [name for name in TEXTS if name in rows]:
        texts = [bytes(text).decode("utf-8", "replace") for text in rows[name].values]
        rows = rows.assign({name: ("point", np.array(texts, dtype=object))})
    rows = rows.drop_vars(CHECK, errors="ignore")
    rows.attrs.pop(IDENTITY, None)
    axes = {name: (over, values[at], told) for name, (over, values, told) in design.coordinates().items()}
    return rows.assign_coords(axes)


def _outcomes(rows: "xr.Dataset", form: "xr.Dataset") -> Iterator[PointOutcome]:
    """Yield what came of the points of a sealed file."""
    done = is_done(rows)
    numbers = [rows[name].transpose("point", ...).values for name in form.data_vars]
    for k, point in enumerate(rows["point"].values):
        values = np.concatenate([np.ravel(variable[k]) for variable in numbers]) if done[k] else None
        told = tuple(str(rows[WARNINGS].values[k]).splitlines())
        yield PointOutcome(int(point), str(rows["status"].values[k]), values, told)


def _cut(text: str, longest: int = LONGEST) -> bytes:
    """Return a text on one line, cut to what a row holds."""
    return " ".join(text.split()).encode()[:longest].decode("utf-8", "ignore").encode()


def _join(warnings: Sequence[str]) -> bytes:
    """Return warnings, one a line, as many as a row holds, and how many it does not."""
    lines = [_cut(text) for text in warnings]
    for left in range(len(lines) + 1):
        more = [LEFT_OUT.format(left).encode()] if left else []
        joined = b"\n".join([*lines[: len(lines) - left], *more])
        if len(joined) <= TEXTS[WARNINGS]:
            break
    return joined
