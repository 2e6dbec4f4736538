"""Tests under other arithmetic on one machine: other instructions, functions of libm, kernels of OpenBLAS and NumPy.

Run as ``python -m benchmarks.arithmetic``, or ``make arithmetic``; it takes some ten minutes and writes the table of
docs/arithmetic.md. With tests as arguments (what pytest takes) only these are run, and nothing is written. What the
processor lacks is left out and told.
"""

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter

from ltcgear.generated import store
from ltcgear.runtime.studies.accuracy.machine import describe_machine
from numpy._core._multiarray_umath import __cpu_dispatch__

from .marks import put

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "arithmetic.md"
EXAMPLE = "docs/gallery/plot_8_own_solver.py"
QUICK = (
    "tests/test_pages.py::test_accuracy", "tests/runtime/model/test_ties.py",
    "tests/runtime/studies/test_record.py::test_numbers_are_told_by_what_a_scene_gives",
    "tests/runtime/simulation/test_integrate.py::test_a_sample_on_a_jump_is_the_one_before_it",
)  # fmt: skip
"""What is run as a test too, in seconds."""
SENSITIVE = (
    *QUICK, "tests/generated/test_committed.py::test_committed_files_are_up_to_date",
    "tests/test_pages.py::test_stiffness",
    "tests/test_pages.py::test_modes_of_the_rig_are_those_of_the_page",
    "tests/test_pages.py::test_resonances_of_the_rig", "tests/test_pages.py::test_sensitivities",
    "tests/test_pages.py::test_friction_has_the_closed_forms",
    "tests/runtime/export/test_plain.py::test_loads_over_time_and_backlash",
    "tests/runtime/export/test_plain.py::test_the_rig_has_the_mesh_forces_of_simulate",
    "tests/runtime/export/test_plain.py::test_pieces_make_the_same_motion", "tests/runtime/simulation/test_regimes.py",
    "tests/runtime/studies/test_sweep_design.py",
)  # fmt: skip
"""Tests of what could hang on last bits: keys, pages, orders by size, jumps, rattling, committed numbers."""
OLD_LIBM = "glibc.cpu.hwcaps=" + ",".join(
    f"-{feature}{used}" for used in ("", "_Usable") for feature in ("AVX2", "FMA", "FMA4")
)
"""Takes the variants for processors without these from libm; glibc before 2.33 calls them otherwise."""
OLD_NUMPY = " ".join(__cpu_dispatch__)
"""Leaves of NumPy's loops those for any processor."""


@dataclass(frozen=True)
class Arithmetic:
    """Environment variables that choose how numbers are computed, and what of a processor that takes."""

    name: str
    settings: Mapping[str, str] = field(default_factory=dict)
    needs: tuple[str, ...] = ()

    @property
    def lacks(self) -> list[str]:
        """Return what this processor has not."""
        known = store.processor().split()
        return [feature for feature in self.needs if feature not in known]


V2, V3, V4 = ("ssse3", "sse4_2", "popcnt"), ("avx2", "fma", "bmi2"), ("avx512f", "avx512bw", "avx512vl")


def _compiled(flags: str, *needs: str) -> Arithmetic:
    return Arithmetic(f"C: `{flags}`", {store.MORE_FLAGS: flags}, needs)


def _kernels(core: str, *needs: str) -> Arithmetic:
    return Arithmetic(f"OpenBLAS: {core}", {"OPENBLAS_CORETYPE": core}, needs)


ALL = Arithmetic(
    "all of the oldest",
    {
        store.MORE_FLAGS: "-march=x86-64-v2", "GLIBC_TUNABLES": OLD_LIBM, "OPENBLAS_CORETYPE": "Nehalem",
        "NPY_DISABLE_CPU_FEATURES": OLD_NUMPY,
    },
    V2,
)  # fmt: skip
ARITHMETICS = (
    Arithmetic("as it comes"),
    _compiled("-ffp-contract=fast"),
    _compiled("-march=x86-64"),
    _compiled("-march=x86-64-v2", *V2),
    _compiled("-march=x86-64-v3", *V3),
    _compiled("-march=x86-64-v3 -ffp-contract=fast", *V3),
    _compiled("-march=x86-64-v4", *V4),
    _compiled("-march=x86-64-v4 -ffp-contract=fast", *V4),
    Arithmetic("libm without FMA", {"GLIBC_TUNABLES": OLD_LIBM}, ("fma",)),
    _kernels("Prescott"),
    _kernels("Nehalem", *V2),
    _kernels("Sandybridge", "avx"),
    _kernels("Haswell", *V3),
    _kernels("SkylakeX", *V4),
    Arithmetic("NumPy without SIMD", {"NPY_DISABLE_CPU_FEATURES": OLD_NUMPY}),
    ALL,
)
PROBE = """
import ctypes, hashlib, json, math
import numpy as np
from ltcgear.generated import store
C = "double probe(double a, double b, double c) { return a * b + c; }"
found = np.random.default_rng(1).uniform(0.1, 3, (3, 4000))
probe = ctypes.CDLL(str(store.library(C, store.compiler()))).probe
probe.restype, probe.argtypes = ctypes.c_double, [ctypes.c_double] * 3
told = {
    "libm": [math.sin(v) + math.exp(v) for v in found[0]],
    "NumPy": (np.sin(found) + np.exp(found)).ravel().tolist(),
    "OpenBLAS": np.linalg.lstsq(found[:, :30].T, found[0, :30], rcond=None)[0].tolist()
    + (found[:, :900].reshape(90, 30) @ found[:, 900:1800].reshape(30, 90)).ravel().tolist(),
    "C": [probe(a, b, -a * b) for a, b, _ in found.T.tolist()],
}
print(json.dumps({k: hashlib.sha256(np.array(v).tobytes()).hexdigest() for k, v in told.items()}))
"""


def environment(arithmetic: Arithmetic, kept: str) -> dict[str, str]:
    """Return the environment of a run; ``kept`` is a folder for what all runs share, which keys tell apart."""
    clean = {
        name: value for name, value in os.environ.items() if name not in ALL.settings and not name.startswith("PYTEST_")
    }
    places = {"LTCGEAR_CACHE": kept, "LTCGEAR_TEST_STORE": kept, "MPLBACKEND": "Agg", "OPENBLAS_NUM_THREADS": "1"}
    return clean | places | dict(arithmetic.settings)


def probe(arithmetic: Arithmetic, kept: str) -> dict[str, str]:
    """Return digests of what libm, NumPy, OpenBLAS and compiled C compute; they tell what a setting changes."""
    command = [sys.executable, "-c", PROBE]
    done = subprocess.run(command, env=environment(arithmetic, kept), capture_output=True, text=True, check=True)
    return dict(json.loads(done.stdout))


def run_tests(arithmetic: Arithmetic, kept: str, tests: Sequence[str]) -> tuple[int, str]:
    """Run tests in a process of their own; return its exit code and what it prints."""
    command = [sys.executable, "-m", "pytest", "-q", "--no-header", "-p", "no:cacheprovider", "-n", "auto", *tests]
    return _run(command, environment(arithmetic, kept))


def _run(command: Sequence[str], settings: Mapping[str, str]) -> tuple[int, str]:
    done = subprocess.run(
        command, cwd=ROOT, env=settings, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False
    )
    return done.returncode, done.stdout


def measure(arithmetic: Arithmetic, kept: str, tests: Sequence[str], first: Mapping[str, str]) -> tuple[str, bool]:
    """Run all there is under one arithmetic; return its row, and whether all went well."""
    if arithmetic.lacks:
        return f"| {arithmetic.name} | not run: the processor lacks {', '.join(arithmetic.lacks)} | - | - |\n", True
    other = [name for name, digest in probe(arithmetic, kept).items() if digest != first[name]]
    code, told = run_tests(arithmetic, kept, tests)
    failed, example = _run([sys.executable, EXAMPLE], environment(arithmetic, kept))
    if code or failed:
        print(told[-6000:] if code else example[-2000:])
    counts = told.strip().splitlines()[-1].partition(" in ")[0] if told.strip() else "nothing"
    row = f"| {arithmetic.name} | {', '.join(other) or 'none'} | {counts} | {'failed' if failed else 'passed'} |\n"
    return row, not code and not failed


def main() -> int:
    """Run everything, print the table, and write it to its page."""
    tests = sys.argv[1:] or list(SENSITIVE)
    machine = describe_machine()
    table = "| arithmetic | other last bits in | tests | own-solver example |\n|---|---|---|---|\n"
    print(f"{machine['processor']}, {machine['compiler']}\n\n{table}", end="", flush=True)
    well = True
    with tempfile.TemporaryDirectory(prefix="ltcgear-") as kept:
        first = probe(ARITHMETICS[0], kept)
        for arithmetic in ARITHMETICS:
            clock = perf_counter()
            row, passed = measure(arithmetic, kept, tests, first)
            print(row, end="", flush=True)
            print(f"{perf_counter() - clock:.0f} s", file=sys.stderr)
            table, well = table + row, well and passed
    if well and not sys.argv[1:]:
        about = f"\n{machine['processor']}; {machine['compiler']}; {machine['system']}.\n"
        put(PAGE, {"arithmetic": table + about})
    return 0 if well else 1


if __name__ == "__main__":
    sys.exit(main())
