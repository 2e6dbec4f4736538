"""A few attacks of each kind, under a seed of their own; `make torture` runs thousands (docs/torture.md)."""

import json
import os
import subprocess
import sys

import pytest

from regenerate import ROOT

SEED = 7
PARTS = {"scenes": 0.03, "files": 0.03, "kills": 0.07, "disks": 0.06, "compilers": 0.1, "environments": 0.07}
"""Part of the cases of each kind."""


@pytest.fixture(scope="module")
def findings(tmp_path_factory, store):
    """What the attacks of a kind found, and their verdicts."""

    def runner(kind):
        told = tmp_path_factory.mktemp("torture") / "told.json"
        command = [sys.executable, "-m", "tests.torture", "--only", kind, "--seed", str(SEED), "--json", str(told)]
        done = subprocess.run(
            [*command, "--part", str(PARTS[kind]), "--store", str(store)], cwd=ROOT, check=False, timeout=600,
            env=os.environ | {"PYTHONPATH": ""}, capture_output=True, text=True,
        )  # fmt: skip
        assert told.exists(), done.stderr
        return json.loads(told.read_text("utf-8"))

    return runner


@pytest.mark.parametrize("kind", PARTS)
def test_attacks_find_nothing(findings, kind):
    found = findings(kind)
    assert not found["findings"], "\n".join(f"{one['note']}\n{one['again']}" for one in found["findings"])
    assert sum(found["counts"][kind].values()) >= 3
