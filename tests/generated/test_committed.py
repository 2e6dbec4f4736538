"""The committed C is what the present equations give, byte for byte, whatever the hash seed."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from ltcgear.generated import store

from regenerate import COMMITTED, HOME, texts

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("scene", COMMITTED)
def test_committed_files_are_up_to_date(scene: str) -> None:
    for name, text in texts(scene).items():
        committed = (HOME / COMMITTED[scene] / name).read_text("utf-8")
        assert committed == text, f"generated/{COMMITTED[scene]}/{name} is stale; run `make regenerate`"


@pytest.mark.parametrize("seed", ["1", "4711"])
def test_the_hash_seed_changes_nothing(seed: str) -> None:
    code = "from regenerate import store, texts; print(store.digest(list(texts('lin-parker-3').values())))"
    environment = os.environ | {"PYTHONHASHSEED": seed, "PYTHONPATH": str(ROOT / "tests")}
    run = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    committed = [(HOME / "lin_parker_3" / name).read_text("utf-8") for name in ("model.c", "manifest.json")]
    assert run.stdout.strip() == store.digest(committed)


@pytest.mark.parametrize("folder", COMMITTED.values())
def test_committed_c_compiles_without_a_warning(folder: str, tmp_path: Path) -> None:
    compiler = store.compiler()
    if compiler is None:
        pytest.skip("no C compiler here")
    command = [compiler.path, "-std=c11", "-O0", "-fPIC", "-shared", "-Wall", "-Werror"]
    run = subprocess.run(
        [*command, str(HOME / folder / "model.c"), "-o", str(tmp_path / "model.so"), "-lm"],
        capture_output=True,
        text=True,
    )
    assert run.returncode == 0, run.stderr


def test_an_equation_changed_changes_the_c(monkeypatch: pytest.MonkeyPatch) -> None:
    from ltcgear.symbolic import lower

    lower.element_function.cache_clear()
    monkeypatch.setitem(lower.UNARY, lower.sp.atan, lower.ca.sin)
    monkeypatch.setattr("ltcgear.symbolic.checks.agree.agreement", lambda model, equations: [])
    try:
        assert texts("lin-parker-3")["model.c"] != (HOME / "lin_parker_3" / "model.c").read_text("utf-8")
    finally:
        lower.element_function.cache_clear()
