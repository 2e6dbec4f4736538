"""The committed C is what the present equations give, byte for byte (data but for rounding), whatever the hash seed."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from ltcgear.generated import folders, store
from ltcgear.runtime.export.plain_c.kit import write_kit

from regenerate import COMMITTED, HOME, computed, fixed, keep, same, texts

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("scene", COMMITTED)
def test_committed_files_are_up_to_date(scene: str) -> None:
    for name, text in texts(scene).items():
        committed = (HOME / COMMITTED[scene] / name).read_text("utf-8")
        assert fixed(committed) == fixed(text), f"generated/{COMMITTED[scene]}/{name} is stale; run `make regenerate`"
        assert same(committed, text), f"generated/{COMMITTED[scene]}/{name}: other numbers; run `make regenerate`"


def test_numbers_are_the_same_but_for_rounding() -> None:
    text = (HOME / "rig_2mw" / "data.c").read_text("utf-8")
    values, start = computed(text)
    assert (len(values), len(start)) == (164, 83)
    speed, torque = f"\n  {float(values[0])!r},", "-10600.0,"
    assert speed in text
    assert torque in text
    assert same(text, text.replace(speed, f"\n  {float(values[0]) * (1 + 1e-15)!r},"))
    assert keep(HOME / "rig_2mw", {"data.c": text.replace(torque, "-10600.000000000002,")}) == {}
    assert not same(text, text.replace(torque, "-10600.001,"))
    assert not same(text, text.replace('"motor.inertia"', '"motor.mass"'))


@pytest.mark.parametrize("seed", ["1", "4711"])
def test_the_hash_seed_changes_nothing(seed: str) -> None:
    code = (
        "from regenerate import *; from ltcgear.runtime.export.plain_c.kit import write_kit; "
        "print(store.digest([fixed(t) for t in (texts('lin-parker-3') | write_kit()).values()]))"
    )
    environment = os.environ | {"PYTHONHASHSEED": seed, "PYTHONPATH": str(ROOT / "tests")}
    run = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    committed = [(HOME / "lin_parker_3" / name).read_text("utf-8") for name in ("model.c", "manifest.json", "data.c")]
    assert run.stdout.strip() == store.digest([fixed(text) for text in [*committed, *write_kit().values()]])


@pytest.mark.parametrize("folder", COMMITTED.values())
def test_committed_c_compiles_without_a_warning_with_the_kit(folder: str, tmp_path: Path) -> None:
    compiler = store.compiler()
    if compiler is None:
        pytest.skip("no C compiler here")
    folders.write_folder(tmp_path, write_kit())
    sources = [*sorted((HOME / folder).glob("*.c")), tmp_path / "ltcgear.c", tmp_path / "main.c"]
    flags = [flag for flag in store.FLAGS if flag != "-shared"]
    command = [*compiler.command, *flags, f"-I{tmp_path}", *map(str, sources)]
    run = subprocess.run([*command, "-o", str(tmp_path / "gearbox"), "-lm"], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr


def test_an_equation_changed_changes_the_c(monkeypatch: pytest.MonkeyPatch) -> None:
    from ltcgear.symbolic.mechanics import lower

    lower.element_function.cache_clear()
    monkeypatch.setitem(lower.UNARY, lower.sp.atan, lower.ca.sin)
    monkeypatch.setattr("ltcgear.symbolic.checks.agree.agreement", lambda model, equations: [])
    try:
        assert texts("lin-parker-3")["model.c"] != (HOME / "lin_parker_3" / "model.c").read_text("utf-8")
    finally:
        lower.element_function.cache_clear()
