"""What the commands load: packages that take long to import come only where they are needed."""

import subprocess
import sys

import pytest

SCIPY = ["scipy.linalg", "scipy.signal", "scipy.sparse"]
HEAVY = ["casadi", "matplotlib", "netCDF4", "numpy", "pandas", "pint", "pydantic", *SCIPY, "sympy", "xarray"]
SCENE = {"numpy", "pint", "pydantic"}
"""What reading a scene takes."""


def loaded(*arguments):
    """Return which heavy packages a command has loaded when it ends."""
    code = (
        "import sys; from ltcgear.runtime.cli.entry import main\n"
        "try: main()\n"
        "except SystemExit as stop: assert not stop.code, stop.code\n"
        f"print('\\nloaded', *(name for name in {HEAVY} if name in sys.modules))"
    )
    command = [sys.executable, "-c", code, *map(str, arguments)]
    run = subprocess.run(command, capture_output=True, text=True, check=True)
    return set(run.stdout.rpartition("loaded")[2].split())


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    """Return a result file, which also puts the model into the store."""
    path = tmp_path_factory.mktemp("start") / "psh.nc"
    loaded("simulate", "psh", "--t-end", "0.01", "-o", path)
    return path


def test_simulate_from_the_store_loads_what_it_computes_with(result):
    found = loaded("simulate", "psh", "--t-end", "0.01", "--force", "-o", result)
    assert found == SCENE | {"casadi", "netCDF4"}


@pytest.mark.parametrize(
    ("command", "packages"),
    [
        ("--help", set()),
        ("simulate --help", {"pydantic"}),
        ("scenes", SCENE),
        ("info psh", SCENE),
        ("modes psh", SCENE | {"casadi", "scipy.linalg", "scipy.sparse"}),
    ],
)
def test_commands_load_what_they_need(command, packages, result):
    assert loaded(*command.split()) == packages
