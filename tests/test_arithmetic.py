"""Other arithmetic: what is promised holds with other variants of libm, OpenBLAS, NumPy and other compiler's flags."""

import re
from dataclasses import replace
from importlib import import_module

import pytest
from ltcgear.generated import store

from regenerate import ROOT


@pytest.fixture(scope="module")
def arithmetic():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(ROOT)
        return import_module("benchmarks.arithmetic")


def test_sensitive_tests_pass_under_another_arithmetic(arithmetic, tmp_path_factory):
    if arithmetic.ALL.lacks or store.compiler() is None:
        pytest.skip("no such processor, or no compiler")
    kept = tmp_path_factory.mktemp("kept")
    kept.chmod(0o700)
    first = arithmetic.probe(arithmetic.ARITHMETICS[0], str(kept))
    other = arithmetic.probe(arithmetic.ALL, str(kept))
    assert set(first) == {"libm", "NumPy", "OpenBLAS", "C"}
    if "fma" in store.processor().split():
        assert first["libm"] != other["libm"]
        assert first["OpenBLAS"] != other["OpenBLAS"]
    code, told = arithmetic.run_tests(arithmetic.ALL, str(kept), [*arithmetic.QUICK, "-n", "0"])
    assert code == 0, told
    assert int(re.search(r"(\d+) passed", told)[1]) > 10


def test_what_a_processor_lacks_is_left_out_and_told(arithmetic):
    strange = replace(arithmetic.ALL, needs=("no-such-instruction",))
    row, passed = arithmetic.measure(strange, "nowhere", (), {})
    assert passed
    assert "the processor lacks no-such-instruction" in row


def test_the_page_tells_of_every_arithmetic(arithmetic):
    table = import_module("benchmarks.marks").take(arithmetic.PAGE, "arithmetic")
    rows = [line.split(" | ") for line in table.splitlines() if line.startswith("| ")][1:]
    assert [row[0].removeprefix("| ") for row in rows] == [each.name for each in arithmetic.ARITHMETICS]
    assert all("passed" in row[2] and "failed" not in row[2] for row in rows if "not run" not in row[1])
