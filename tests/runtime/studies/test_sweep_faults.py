"""The machine's faults stop a sweep and are no rows: what was computed is kept, and the same call goes on."""

import re

import pytest
import xarray as xr
from ltcgear.generated import store as models
from ltcgear.generated.errors import CompileError, LtcgearError, MachineError, SolverError
from ltcgear.runtime import load_sweep, simulate, sweep
from ltcgear.runtime.results.row_file import part_of
from ltcgear.runtime.simulation import method_limits
from ltcgear.runtime.studies.sweep import planning, run_sweep, task
from ltcgear.symbolic import Template

VARY = ["loads.ring.speed=5 rpm:20 rpm:4"]
FEW = {"t_end": 0.02, "workers": 1}
FAULTS = {
    "compiler": CompileError("no compiler"),
    "store": MachineError("/store: cannot be written"),
    "folder": FileNotFoundError(2, "No usable temporary directory found"),
    "memory": MemoryError(),
    "memory of C++": SolverError("erk stopped at t = 0.01 s (rtol 1e-06): std::bad_alloc"),
    "memory of a run": "stopped at t = 0.01 s: std::bad_alloc",
}


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The sweep without any fault."""
    target = tmp_path_factory.mktemp("whole") / "a.nc"
    sweep(Template("lsp"), VARY, target, **FEW)
    return load_sweep(target)


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_of_the_machine_stops_the_sweep_and_is_no_row(tmp_path, monkeypatch, whole, name):
    fault, runs, target = FAULTS[name], [], tmp_path / "a.nc"

    def failing(*arguments, **options):
        runs.append(options)
        result = simulate(*arguments, **options)
        if len(runs) < 3:
            return result
        if isinstance(fault, str):
            return type(result)(result.dataset, result.summary | {"status": fault})
        raise fault

    with monkeypatch.context() as broken:
        broken.setattr(task, "simulate", failing)
        with pytest.raises(MachineError) as caught:
            sweep(Template("lsp"), VARY, target, **FEW)
    message = str(caught.value)
    assert message.startswith("point 2 (loads.ring.speed=15 rpm): ")
    assert (str(fault) or "MemoryError, out of memory") in message
    assert "run the same command again to go on, or leave a point out with --skip; 2 of 4 rows are kept" in message
    assert len(runs) == 3
    assert [path.name for path in tmp_path.iterdir()] == ["a.part.nc"]
    assert sweep(Template("lsp"), VARY, target, **FEW)["computed"] == 2
    xr.testing.assert_identical(load_sweep(target), whole)


class Homeless(Template):
    """A maker that finds no folder for its files in a worker."""

    def make(self, changes):
        if changes.get("loads.ring.speed") == "10 rpm" and task._PLANS:
            raise FileNotFoundError(2, "No usable temporary directory found")
        return super().make(changes)


def test_a_fault_in_another_process_stops_the_sweep_too(tmp_path):
    with pytest.raises(MachineError, match=r"^point 1 .*FileNotFoundError: .*No usable temporary directory.*--skip; "):
        sweep(Homeless("lsp"), VARY, tmp_path / "a.nc", **{**FEW, "workers": 2})
    assert not (tmp_path / "a.nc").exists()


def test_a_machine_without_a_compiler_is_told_before_anything_is_computed(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("CC", raising=False)
    models.compiler.cache_clear()
    try:
        with pytest.raises(CompileError, match="C compiler"):
            sweep(Template("lsp"), VARY, tmp_path / "a.nc", method="erk", **FEW)
    finally:
        models.compiler.cache_clear()
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("where", ["find_rate", "Run"])
def test_no_stage_before_the_runs_swallows_a_fault(tmp_path, monkeypatch, where):
    def failing(*arguments, **options):
        raise MachineError("/store: the store cannot be used")

    scene = tmp_path / "mine.toml"
    scene.write_text(re.sub(r"(?m)^rate = .*$", "", Template("lsp").text))
    monkeypatch.setattr(planning, where, failing)
    with pytest.raises(MachineError, match="the store cannot be used"):
        sweep(Template(scene), VARY, tmp_path / "a.nc", **FEW)
    assert [path.name for path in tmp_path.iterdir()] == ["mine.toml"]


def test_a_late_variant_that_the_machine_cannot_build_is_no_row(tmp_path, monkeypatch):
    def failing(*arguments):
        raise CompileError("no room for the library")

    late = run_sweep.PointOutcome(0, task.UNBUILT)
    monkeypatch.setattr(run_sweep, "compute_points", lambda plan, points, pool: [late] if 0 in points else [])
    monkeypatch.setattr(run_sweep, "_build_late", failing)
    with pytest.raises(CompileError, match=r"no room for the library; .*run the same command again.*0 of 4 rows"):
        sweep(Template("lsp"), VARY, tmp_path / "a.nc", **FEW)


# --- points that failed are computed again


def fail_at(monkeypatch, *speeds):
    def failing(library, values, **options):
        if any(abs(abs(values["reference.speed"]) - speed * 3.14159265 / 30) < 1e-6 for speed in speeds):
            raise SolverError("no equilibrium")
        return simulate(library, values, **options)

    monkeypatch.setattr(task, "simulate", failing)


def failed(target):
    return [str(status) != "done" for status in load_sweep(target)["status"].values]


def test_failed_points_are_computed_again_where_one_asks_for_it(tmp_path, monkeypatch, whole):
    target = tmp_path / "a.nc"
    with monkeypatch.context() as broken:
        fail_at(broken, 5, 15)
        assert sweep(Template("lsp"), VARY, target, **FEW)["failed"] == 2
    assert sweep(Template("lsp"), VARY, target, **FEW)["computed"] == 0
    with monkeypatch.context() as broken:
        fail_at(broken, 15)
        summary = sweep(Template("lsp"), VARY, target, retry=True, **FEW)
    assert (summary["computed"], summary["kept"], summary["failed"]) == (2, 2, 1)
    assert failed(target) == [False, False, True, False]
    assert sweep(Template("lsp"), VARY, target, retry=True, **FEW)["computed"] == 1
    xr.testing.assert_identical(load_sweep(target), whole)
    assert sweep(Template("lsp"), VARY, target, retry=True, **FEW)["computed"] == 0
    assert [path.name for path in tmp_path.iterdir()] == ["a.nc"]


def test_runs_of_hours_are_points_that_fail_until_they_are_asked_for(tmp_path, monkeypatch, whole):
    monkeypatch.setattr(method_limits, "LONGEST", 1e-9)
    summary = sweep(Template("lsp"), VARY, tmp_path / "a.nc", **FEW)
    assert summary["failed"] == 4
    assert "--long, or long=True in Python, begins it all the same" in str(
        load_sweep(tmp_path / "a.nc")["status"].values
    )
    assert sweep(Template("lsp"), VARY, tmp_path / "a.nc", retry=True, long=True, **FEW)["failed"] == 0
    assert load_sweep(tmp_path / "a.nc").identical(whole)


def test_a_retry_that_is_stopped_loses_nothing(tmp_path, monkeypatch, whole):
    def stop(stage, done, total, failed):
        if stage == "simulate":
            raise KeyboardInterrupt

    target = tmp_path / "a.nc"
    with monkeypatch.context() as broken:
        fail_at(broken, 5, 15)
        sweep(Template("lsp"), VARY, target, **FEW)
    with pytest.raises(KeyboardInterrupt):
        sweep(Template("lsp"), VARY, target, retry=True, told=stop, **FEW)
    assert [path.name for path in tmp_path.iterdir()] == ["a.part.nc"]
    assert failed(part_of(target)) == [False, False, True, False]
    assert sweep(Template("lsp"), VARY, target, retry=True, **FEW)["computed"] == 1
    xr.testing.assert_identical(load_sweep(target), whole)


def test_a_point_that_there_is_not_cannot_be_left_out(tmp_path):
    with pytest.raises(LtcgearError, match="--skip 4: no such point; they are numbered from 0 to 3"):
        sweep(Template("lsp"), VARY, tmp_path / "a.nc", skip=[4], **FEW)
