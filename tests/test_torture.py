"""A few attacks of each kind, under a seed of their own; `make torture` runs thousands (docs/torture.md)."""

import json
import os
import subprocess
import sys

import pytest

from regenerate import ROOT

SEED, PART = 7, 0.015
KINDS = ("scenes", "files", "kills", "disks", "compilers", "environments")


@pytest.fixture(scope="module")
def told(tmp_path_factory, store):
    """What a part of the attacks of each kind found, and their verdicts."""
    file = tmp_path_factory.mktemp("torture") / "told.json"
    command = [sys.executable, "-m", "tests.torture", "--seed", SEED, "--part", PART, "--store", store, "--json", file]
    for kind in KINDS:
        command += ["--only", kind]
    done = subprocess.run(
        list(map(str, command)), cwd=ROOT, check=False, timeout=600, env=os.environ | {"PYTHONPATH": ""},
        capture_output=True, text=True,
    )  # fmt: skip
    assert file.exists(), done.stderr
    return json.loads(file.read_text("utf-8"))


@pytest.mark.parametrize("kind", KINDS)
def test_attacks_find_nothing(told, kind):
    found = [f"{one['note']}\n{one['again']}" for one in told["findings"] if one["kind"] == kind]
    assert not found, "\n".join(found)
    assert sum(told["counts"][kind].values()) >= 2


def test_the_page_tells_of_every_attack():
    page = (ROOT / "docs/torture.md").read_text("utf-8")
    assert all(f"\n| {kind} | " in page for kind in (*KINDS, "commands"))
