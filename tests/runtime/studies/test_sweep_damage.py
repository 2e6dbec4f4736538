"""Sweep files that are cut, changed or strange are refused in one message, or read; nothing else comes of them."""

import json
import warnings

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime import load_sweep, sweep
from ltcgear.runtime.results.checksums import SUMS
from ltcgear.runtime.results.row_file import part_of
from ltcgear.runtime.studies.sweep.summary import summarise
from ltcgear.runtime.view.tables.sweep_tables import list_tables
from ltcgear.symbolic import Template

VARY, FEW = ["loads.ring.speed=5 rpm:20 rpm:4"], {"t_end": 0.02, "workers": 1}
TIMES = 100


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """The bytes of a sealed sweep and of one that was stopped."""
    folder = tmp_path_factory.mktemp("files")

    def stop(stage, done, total, failed):
        if done == 3:
            raise KeyboardInterrupt

    sweep(Template("lsp"), VARY, folder / "sealed.nc", **FEW)
    with pytest.raises(KeyboardInterrupt):
        sweep(Template("lsp"), VARY, folder / "stopped.nc", told=stop, **FEW)
    paths = {"sealed": folder / "sealed.nc", "part": part_of(folder / "stopped.nc")}
    return {name: path.read_bytes() for name, path in paths.items()}


def damage(data, random, kind):
    """Cut a file, change some bytes, letters of its design, or a byte of its heading."""
    changed = bytearray(data)
    if kind == 0:
        return data[: random.integers(0, len(data))]
    design = max(data.find(b'"axes"'), 0)
    first, last, most = [(0, len(data), 8), (design, design + 400, 3), (0, 3000, 2)][kind - 1]
    for place in random.integers(first, min(last, len(data)), random.integers(1, most)):
        changed[place] = random.integers(32, 127) if kind == 2 else random.integers(0, 256)
    return bytes(changed)


@pytest.mark.parametrize("name", ["sealed", "part"])
def test_a_damaged_file_is_read_or_refused(files, tmp_path, name):
    random, messages = np.random.default_rng(7), []
    for k in range(TIMES):
        path = tmp_path / f"{k}.nc"  # the libraries may hold on to a file that they could not open
        path.write_bytes(damage(files[name], random, k % 4))
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                found = load_sweep(path)
                summarise(found)
                list_tables(found)
        except LtcgearError as error:
            messages.append(f"{path}: {error}")
    assert len(messages) > TIMES / 8
    assert all(text.startswith(f"{text.split(': ')[0]}: {text.split(': ')[0]}: ") for text in messages)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"axes": 3}, "its design cannot be read"),
        ({"axes": [{"key": "a"}]}, "its design cannot be read"),
        ({"points": "many"}, "its design cannot be read|no fixed points|a grid has"),
        ({"sample": "dice"}, "no such sample"),
        ({"digest": "0"}, "cannot draw again, or is damaged"),
    ],
)
def test_a_design_that_is_none_is_refused(files, tmp_path, change, reason):
    import netCDF4

    path = tmp_path / "a.nc"
    path.write_bytes(files["sealed"])
    with netCDF4.Dataset(path, "a") as file:
        file.delncattr(SUMS)  # as who means it would
        file.design = json.dumps(json.loads(file.design) | change)
    with pytest.raises(LtcgearError, match=rf"a\.nc: .*({reason})"):
        load_sweep(path)


def test_an_axis_of_more_points_than_any_is_refused_before_they_are_laid_out(files, tmp_path):
    import netCDF4

    path = tmp_path / "a.nc"
    path.write_bytes(files["sealed"])
    with netCDF4.Dataset(path, "a") as file:
        file.delncattr(SUMS)
        file.design = file.design.replace('"count": 4', '"count": 40000000000')
    with pytest.raises(LtcgearError, match="an axis of 40000000000 points"):
        load_sweep(path)


def test_a_row_whose_number_is_damaged_is_computed_again(files, tmp_path):
    target = tmp_path / "a.nc"
    part, number = part_of(target), np.array([2.0], ">f8").tobytes()
    data = files["part"]
    at = data.rindex(number)
    part.write_bytes(data[:at] + np.array([np.nan], ">f8").tobytes() + data[at + 8 :])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert load_sweep(part)["point"].values.tolist() == [0, 1]
        summary = sweep(Template("lsp"), VARY, target, **FEW)
    assert (summary["kept"], summary["computed"], summary["failed"]) == (2, 2, 0)
