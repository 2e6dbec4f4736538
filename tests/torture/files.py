"""Attack by files: damaged results, parts, checkpoints and sweeps are refused, or read as what they were."""

import io
import re
import shutil
import tempfile
import time
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime import load, load_sweep

from .mutations import TEXTS, damage
from .outcome import REFUSED, RIGHT, WRONG, Done, Verdict, judge
from .process import Case, Program, command, run

COUNT = 510
ALWAYS = {"MARK_SECONDS": 0.0, "SLICE": 0.0}
"""A checkpoint after every segment."""
RESULT, OTHER, GOING, SWEPT, SWEEPING = "result.nc", "other.nc", "going.nc", "swept.nc", "sweeping.nc"
MADE = ("simulate", "psh", "--t-end", "0.1")
LONG = ("simulate", "psh", "--t-end", "1", "--set", "simulation.rate=1 kHz")
SWEEP = ("sweep", "psh", "--vary", "loads.input.speed=-900 rpm:-300 rpm:12", "--t-end", "0.02", "--workers", "1")
VALUES: tuple[Any, ...] = (
    *(text for text in TEXTS if len(text) < 1000),
    7,
    -1.5,
    np.array([1.0, 2.0]),
    float("nan"),
    "{}",
)

WORDS = ("title", "scene", "why", "why_rate", "engine")
"""Attributes that hold no number of the run."""


def rows_in(part: Path) -> int:
    """Return how many rows the heading of a part counts."""
    with part.open("rb") as file:
        return int.from_bytes(file.read(8)[4:], "big")


@cache
def originals() -> Path:
    """Return a folder with whole files, and such that a killed run and a killed sweep left."""
    folder = Path(tempfile.mkdtemp(prefix="torture-"))
    for arguments, name in ((MADE, RESULT), ((*MADE, "--rtol", "1e-5"), OTHER), (LONG, "whole.nc"), (SWEEP, SWEPT)):
        done = run(folder, *arguments, "-o", name)
        assert done.code == 0, done.err
    program = Program(command(*LONG, "-o", GOING, settings=ALWAYS), folder)
    _kill_at(program, folder / "going.part.nc", 200)
    program = Program(command(*SWEEP, "-o", SWEEPING), folder)
    _kill_at(program, folder / "sweeping.part.nc", 4)
    assert (folder / "going.checkpoint.npz").exists()
    return folder


def _kill_at(program: Program, part: Path, rows: int) -> None:
    """Kill a program once a part has some rows."""
    end = time.monotonic() + 60
    while (not part.exists() or rows_in(part) < rows) and program.poll() is None and time.monotonic() < end:
        time.sleep(0.0005)
    assert program.wait(0.0).code in (None, -9)
    assert part.exists(), part


def prepare() -> None:
    """Make the whole files."""
    originals()


def make_case(seed: int, number: int) -> Case:
    """Return an attack by a damaged file."""
    generator = np.random.default_rng([seed, number])
    ways = [_read, _read, _read, _read, _swept, _resumed, _resumed, _gone_on, _shown, _exported]
    way = ways[int(generator.integers(len(ways)))]
    return Case(f"file: {way.__name__.strip('_')}", lambda folder: way(folder, generator))


def _damaged(folder: Path, name: str, generator: np.random.Generator) -> Path:
    """Put a damaged copy of a file into a folder."""
    (given := folder / "given").mkdir(exist_ok=True)
    path, draw = folder / name, generator.random()
    shutil.copy(originals() / name, path)
    if draw < 0.25 and path.suffix == ".nc":
        _change_attribute(path, generator)
    elif draw < 0.25:
        _change_array(path, generator)
    elif draw < 0.3:
        others = sorted(other for other in originals().iterdir() if other.name != name)
        shutil.copy(others[int(generator.integers(len(others)))], path)
    else:
        data = path.read_bytes()
        path.write_bytes(damage(data, generator))
    shutil.copy(path, given / name)
    return path


def _change_attribute(path: Path, generator: np.random.Generator) -> None:
    """Replace or delete attributes of a NetCDF file, or of one of its variables."""
    import netCDF4

    with netCDF4.Dataset(path, "a") as file:
        holder = file
        if generator.random() < 0.4:
            holder = file.variables[str(generator.choice(sorted(file.variables)))]
        names = [*holder.ncattrs(), "_FillValue_", "scale_factor", "add_offset", "units", "valid_range"]
        name = str(generator.choice(names))
        try:
            if name in holder.ncattrs() and generator.random() < 0.3:
                holder.delncattr(name)
            else:
                holder.setncattr(name, VALUES[int(generator.integers(len(VALUES)))])
        except (AttributeError, ValueError, RuntimeError):  # that one cannot be changed
            file.setncattr("sheet", "[]")


def _change_array(path: Path, generator: np.random.Generator) -> None:
    """Replace an array of a checkpoint by one of another shape, type or content."""
    with np.load(path) as file:
        arrays = dict(file)
    name = str(generator.choice(sorted(arrays)))
    old = arrays[name]
    arrays[name] = [
        np.zeros(0), np.full(old.shape, np.nan), np.full(3, "x"), np.concatenate([old.ravel(), old.ravel()]),
        np.array(2**62), np.array([{}], dtype=object), -np.ones(old.shape),
    ][int(generator.integers(7))]  # fmt: skip
    if generator.random() < 0.2:
        del arrays[name]
    kept = io.BytesIO()
    np.savez(kept, **arrays)
    path.write_bytes(kept.getvalue())


# --- what the damaged files are fed to


def same(one: xr.Dataset, two: xr.Dataset, timed: bool = True) -> str:
    """Say how two datasets differ in their numbers; "" where they do not. Seconds may differ unless ``timed``."""
    if set(one.variables) != set(two.variables):
        return f"variables {set(one.variables) ^ set(two.variables)}"
    for name in one.variables:
        here, there = one[name], two[name]
        equal = here.values.tobytes() == there.values.tobytes() if here.dtype.kind == "f" else here.equals(there)
        if here.dims != there.dims or here.dtype != there.dtype or not equal:
            return f"variable {name}"
    untimed = () if timed else ("seconds", "real_time_factor", "changes", "created", "history")
    names = [str(name) for name in two.attrs if name not in (*untimed, *WORDS)]
    different = [name for name in names if _numbers(one.attrs.get(name)) != _numbers(two.attrs.get(name))]
    return f"attributes {different}" if different else ""


def _numbers(value: Any) -> list[str]:
    """Return the numbers that an attribute holds, also as text."""
    return re.findall(r"\d+", str(value)) if not isinstance(value, np.ndarray) else [str(value.tolist())]


@cache
def _original(name: str) -> xr.Dataset:
    return load(originals() / name).dataset if name in (RESULT, OTHER, "whole.nc") else load_sweep(originals() / name)


def _are_rows_of(dataset: xr.Dataset, name: str) -> bool:
    """Say whether a part holds numbers of a file, as far as it goes."""
    whole, along = _original(name), "point" if "point" in dataset.dims else "time"
    if not set(dataset[along].values) <= set(whole[along].values):
        return False
    rows = whole.sel({along: dataset[along].values})
    moving = [v for v in dataset.data_vars if along in dataset[v].dims and dataset[v].dtype.kind in "fi"]
    return all(v in rows and np.array_equal(rows[v].values, dataset[v].values, equal_nan=True) for v in moving)


def _compared(dataset: xr.Dataset, names: tuple[str, ...], timed: bool = True) -> Verdict:
    """Compare what was accepted with the files that it may be."""
    unfinished = str(dataset.attrs.get("status", "")).startswith("not finished")
    if unfinished and any(_are_rows_of(dataset, name) for name in names):
        return Verdict(RIGHT, "rows of a part, which says that it is one")
    differences = [same(dataset, _original(name), timed) for name in names]
    return Verdict(RIGHT, "as it was") if "" in differences else Verdict(WRONG, f"accepted with other {differences[0]}")


def _made(reader: Any, path: Path) -> Any:
    """Read what was just written, which cannot be refused."""
    try:
        return reader(path).dataset if reader is load else reader(path)
    except LtcgearError as error:
        raise AssertionError(f"done, but the result cannot be read: {error}") from error


def _read(folder: Path, generator: np.random.Generator) -> Verdict:
    """Load a result."""
    return _compared(load(_damaged(folder, RESULT, generator)).dataset, (RESULT, OTHER, "whole.nc"))


def _swept(folder: Path, generator: np.random.Generator) -> Verdict:
    """Load a sweep."""
    return _compared(load_sweep(_damaged(folder, SWEPT, generator)), (SWEPT,))


def _ended(done: Done) -> Verdict:
    return judge(done) or Verdict(REFUSED if done.code else RIGHT, done.last)


def _resumed(folder: Path, generator: np.random.Generator) -> Verdict:
    """Go on with a run whose part or checkpoint is damaged."""
    names = ["going.part.nc", "going.checkpoint.npz"]
    for name in names:
        shutil.copy(originals() / name, folder / name)
    before = sorted(file.name for file in folder.iterdir())
    _damaged(folder, names[int(generator.integers(2))], generator)
    done = run(folder, *LONG, "-o", GOING, "--resume", settings={"SLICE": 0.0})
    if (verdict := judge(done)) or done.code:
        left = sorted(file.name for file in folder.iterdir())
        return verdict or Verdict(*((REFUSED, done.last) if set(before) <= set(left) else ("lost", f"left: {left}")))
    return _compared(_made(load, folder / GOING), ("whole.nc",), timed=False)


def _gone_on(folder: Path, generator: np.random.Generator) -> Verdict:
    """Go on with a sweep whose rows are damaged."""
    _damaged(folder, "sweeping.part.nc", generator)
    done = run(folder, *SWEEP, "-o", SWEEPING)
    if (verdict := judge(done)) or done.code:
        return verdict or Verdict(REFUSED, done.last)
    return _compared(_made(load_sweep, folder / SWEEPING), (SWEPT,), timed=False)


def _shown(folder: Path, generator: np.random.Generator) -> Verdict:
    """Analyse a result or write its report, where it is read at all."""
    path = _damaged(folder, RESULT, generator)
    load(path)
    _original(RESULT)
    if generator.random() < 0.5:
        return _ended(run(folder, "report", path.name, "-o", "page.html"))
    return _ended(run(folder, "analyse", path.name, "-o", "figures", "--format", "svg"))


def _exported(folder: Path, generator: np.random.Generator) -> Verdict:
    """Export a result."""
    path = _damaged(folder, RESULT, generator)
    return _ended(run(folder, "export", path.name, "-o", f"out.{['csv', 'mat'][int(generator.integers(2))]}"))
