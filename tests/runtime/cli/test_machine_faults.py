"""Faults of the machine: each is one message with its cure."""

import re

import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.cli.machine_faults import find_fault
from ltcgear.runtime.view.tables import printed


@pytest.mark.parametrize(
    ("error", "told"),
    [
        (MemoryError(), "out of memory; ask for less at once"),
        (MemoryError("Unable to allocate 7 GiB"), "out of memory: Unable to allocate 7 GiB; ask for less"),
        (RuntimeError("std::bad_alloc"), r"out of memory: std::bad_alloc; .*\(ulimit -v\)"),
        (OSError(12, "Cannot allocate memory"), "out of memory: "),
        (ImportError("a.so: failed to map segment from shared object"), "out of memory: a.so"),
        (FileNotFoundError(2, "No usable temporary directory found in ['/tmp']"), "set TMPDIR to a folder that can"),
        (OSError(28, "No space left on device", "/tmp/x"), "/tmp/x: No space left on device; make room there"),
        (PermissionError(13, "Permission denied", "/x"), "/x: Permission denied; make it readable and writable"),
    ],
)
def test_what_a_machine_lacks_is_one_message(monkeypatch, run, error, told):
    def lacking(**given):
        raise error

    monkeypatch.setattr(printed, "show", lambda as_json, data, people: lacking())
    code, out, err = run("scenes")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert re.match(f"ltcgear: .*{told}", err)


def test_other_errors_are_not_hidden(monkeypatch):
    assert find_fault(RuntimeError("by us")) is None
    assert find_fault(LtcgearError("by us")) is None


def test_a_temporary_folder_can_be_chosen_as_advised(tmp_path, monkeypatch):
    import tempfile

    monkeypatch.setattr(tempfile, "tempdir", None)
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    assert tempfile.gettempdir() == str(tmp_path)
