"""NetCDF4 files bear a check sum of all their bytes, so that HDF5 never follows damage."""

import time

import netCDF4
import numpy as np
import pytest
import xarray as xr
from ltcgear.runtime.results import netcdf
from ltcgear.runtime.results.netcdf import MARK, open_file, save


@pytest.fixture
def file(tmp_path):
    """Return a file as ltcgear writes them."""
    data = xr.Dataset({"force": ("time", np.arange(5000.0), {"units": "N"})}, attrs={"title": "a stage"})
    save(data, path := tmp_path / "a.nc")
    return path


def test_every_damaged_byte_is_seen(file):
    whole, generator = file.read_bytes(), np.random.default_rng(0)
    end = len(whole) - len(MARK) - netcdf.DIGITS
    for place in generator.integers(8, end, 100):
        file.write_bytes(whole[:place] + bytes([whole[place] ^ 1]) + whole[place + 1 :])
        with pytest.raises(OSError, match="its bytes are not those that were written"):
            open_file(file)


def test_other_software_reads_the_file_with_its_check_sum(file):
    assert MARK in file.read_bytes()[-len(MARK) - netcdf.DIGITS :]
    for engine in ("netcdf4", "h5netcdf"):
        if engine in xr.backends.list_engines():
            with xr.open_dataset(file, engine=engine) as opened:
                assert opened["force"].values[-1] == 4999.0


def test_an_edited_file_is_read_in_a_process_of_its_own_first(file, monkeypatch):
    with netCDF4.Dataset(file, "a") as opened:
        opened.setncattr("note", "mine")
    assert MARK not in file.read_bytes()
    with open_file(file) as opened:
        assert (opened.attrs["note"], opened["force"].values[-1]) == ("mine", 4999.0)
    monkeypatch.setattr(netcdf, "READ_ALL", "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)")
    with pytest.raises(OSError, match="HDF5 dies of it, by signal 11"):
        open_file(file)
    monkeypatch.setattr(netcdf, "READ_ALL", "while True: pass")
    monkeypatch.setattr(netcdf, "PATIENCE", 0.5)
    begin = time.monotonic()
    with pytest.raises(OSError, match="does not come to an end"):
        open_file(file)
    assert time.monotonic() - begin < 60


def test_reading_apart_takes_in_every_attribute_and_number(file, tmp_path, monkeypatch):
    with netCDF4.Dataset(file, "a") as opened:
        opened.setncattr("note", "mine")
    traced = netcdf.READ_ALL.replace("data.getncattr(name)", "print(data.getncattr(name))")
    traced = traced.replace("data[...]", "print(data[...].sum())")
    seen = []
    original = netcdf.subprocess.run
    monkeypatch.setattr(netcdf, "READ_ALL", traced)
    monkeypatch.setattr(netcdf.subprocess, "run", lambda *args, **kw: seen.append(original(*args, **kw)) or seen[-1])
    open_file(file).close()
    text = seen[0].stdout.decode()
    assert {"mine", "a stage", "N"} <= set(text.split("\n"))
    assert str(np.arange(5000.0).sum()) in text
