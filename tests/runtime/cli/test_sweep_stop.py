"""Ctrl-C in a sweep, stage by stage: what is said of the rows is true, and the same command goes on."""

import pytest
import xarray as xr
from ltcgear.runtime import load_sweep
from ltcgear.runtime.studies.sweep import planning, sweep_file, task
from ltcgear.runtime.studies.sweep import run_sweep as sweeping

ARGUMENTS = ("sweep", "lsp", "--vary", "loads.ring.speed=5 rpm:20 rpm:4", "--t-end", "0.02", "--workers", "1")
NOTHING = "no row was there yet; the same command begins anew"
KEPT = "rows are kept in {}, the same command goes on"
WHOLE = "{} has all rows"
STAGES = {
    "build": (planning, "make_plan", 1, NOTHING),
    "compile": (planning, "prepare", 1, NOTHING),
    "heading": (sweep_file, "SweepPart", 1, NOTHING),
    "first point": (task, "simulate", 1, NOTHING),
    "third point": (task, "simulate", 3, KEPT),
    "seal": (sweep_file, "save", 1, KEPT),
    "summary": (sweeping, "tell_sweep", 1, WHOLE),
}


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The sweep that nobody stopped."""
    from ltcgear.runtime import sweep
    from ltcgear.symbolic import Template

    target = tmp_path_factory.mktemp("whole") / "a.nc"
    sweep(Template("lsp"), [ARGUMENTS[3]], target, t_end=0.02, workers=1)
    return load_sweep(target)


@pytest.mark.parametrize("stage", STAGES)
def test_what_is_said_of_rows_is_true_and_the_same_command_goes_on(run, data, tmp_path, monkeypatch, whole, stage):
    module, name, times, words = STAGES[stage]
    done, target, calls = getattr(module, name), tmp_path / "a.nc", []

    def stopped(*arguments, **options):
        calls.append(arguments)
        if len(calls) == times:
            raise KeyboardInterrupt
        return done(*arguments, **options)

    with monkeypatch.context() as pressed:
        pressed.setattr(sweeping if name == "make_plan" else module, name, stopped)
        code, out, err = run(*ARGUMENTS, "-o", target)
    where = {NOTHING: "", KEPT: tmp_path / "a.part.nc", WHOLE: target}[words]
    assert (code, out, err) == (130, "", f"ltcgear: stopped; {words.format(where)}\n")
    assert where == "" or where.exists()
    kept = {"third point": 2, "seal": 4, "summary": 4}.get(stage, 0)
    if words == KEPT:
        assert load_sweep(where).sizes["point"] == kept
    assert data(*ARGUMENTS, "-o", target)["kept"] == kept
    xr.testing.assert_identical(load_sweep(target), whole)
    assert [path.name for path in tmp_path.iterdir()] == ["a.nc"]
