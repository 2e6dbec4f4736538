"""One sweep writes a file at a time, and only one that is whole is finished."""

import fcntl

import pytest
from ltcgear.generated import lock
from ltcgear.generated.errors import LtcgearError, SolverError
from ltcgear.runtime import load_sweep, sweep
from ltcgear.runtime.results.result import save
from ltcgear.runtime.results.row_file import part_of
from ltcgear.runtime.studies.sweep import run_sweep as sweeping
from ltcgear.runtime.studies.sweep import sweep_file, task
from ltcgear.symbolic import Template

VARY = ("loads.ring.speed=5 rpm:20 rpm", "loads.sun.torque=1e5 N*m:3e5 N*m")
FEW = {"sample": "lhs", "points": 6, "t_end": 0.02, "workers": 1}


def test_two_sweeps_do_not_write_one_file(tmp_path):
    target, tried = tmp_path / "a.nc", []

    def again(stage, done, total, failed):
        if stage == "simulate" and not tried:
            tried.append(done)
            with pytest.raises(LtcgearError, match="another run or sweep is writing it"):
                sweep(Template("lsp"), VARY, target, **FEW)

    sweep(Template("lsp"), VARY, target, told=again, **FEW)
    assert tried


@pytest.fixture
def opened(monkeypatch):
    """What stores are opened with."""
    arguments = []

    class Noted(sweep_file.Store):
        def __init__(self, *given):
            arguments[:] = given
            super().__init__(*given)

    monkeypatch.setattr(sweeping, "Store", Noted)
    return arguments


def test_a_sweep_that_is_refused_shortens_no_file(tmp_path, monkeypatch, opened):
    """The second looks when four rows are there, and opens the file when there are six."""
    target, refused, read = tmp_path / "a.nc", [], sweep_file._open

    def late(path):
        return read(path).isel(point=slice(4))

    def again(stage, done, total, failed):
        if (stage, done) == ("simulate", 6):
            with monkeypatch.context() as patch:
                patch.setattr(sweep_file, "_open", late)
                with pytest.raises(LtcgearError, match="another run or sweep is writing it"):
                    sweep_file.Store(*opened)
            refused.append(int.from_bytes(part_of(target).read_bytes()[4:8], "big"))

    sweep(Template("lsp"), VARY, target, told=again, **FEW)
    assert refused == [6]
    assert load_sweep(target)["point"].values.tolist() == [0, 1, 2, 3, 4, 5]
    assert [path.name for path in tmp_path.iterdir()] == ["a.nc"]


def test_nothing_is_written_without_the_lock_and_a_stale_one_is_none(tmp_path):
    target, held = tmp_path / "a.nc", lock.lock_of(tmp_path / "a.nc")
    with held.open("ab") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        with pytest.raises(LtcgearError, match=r"a\.nc: another run or sweep is writing it; wait"):
            sweep(Template("lsp"), VARY, target, **FEW)
        assert list(tmp_path.iterdir()) == [held]
    assert sweep(Template("lsp"), VARY, target, **FEW)["computed"] == 6
    assert list(tmp_path.iterdir()) == [target]


def test_a_lock_that_was_removed_meanwhile_is_none(tmp_path, monkeypatch):
    path, flock, opened = tmp_path / "lock", fcntl.flock, []
    first = [lock.Lock(path)]

    def slow(file, how):
        if how & fcntl.LOCK_EX:
            opened.append(file)
        if len(opened) == 1 and first:
            first.pop().release()  # after the file was opened, before it is locked
        flock(file, how)

    monkeypatch.setattr(fcntl, "flock", slow)
    second = lock.Lock(path)
    assert len(opened) == 2
    with pytest.raises(LtcgearError, match="is writing it"):
        lock.Lock(path)
    second.release()
    assert not lock.lock_of(path).exists()


def test_a_file_without_all_points_is_not_finished(tmp_path, monkeypatch, opened):
    """Nor sealed; reasons that were kept are counted on."""
    target, told = tmp_path / "a.nc", []

    def stop(stage, done, total, failed):
        if done == 3:
            raise KeyboardInterrupt

    def failing(*arguments, **options):
        raise SolverError("no equilibrium was found")

    with monkeypatch.context() as patch:
        patch.setattr(task, "simulate", failing)
        with pytest.raises(KeyboardInterrupt):
            sweep(Template("lsp"), VARY, target, told=stop, **FEW)
    with (
        sweep_file.Store(*opened) as kept,
        pytest.raises(LtcgearError, match=r"a\.part\.nc: holds 3 of the sweep's 6 points; run the same"),
    ):
        kept.seal()
    assert not target.exists()
    sweep(Template("lsp"), VARY, target, told=lambda *now: told.append(now), **FEW)
    assert next(now for now in told if now[0] == "simulate") == ("simulate", 4, 6, 3)
    save(load_sweep(target).isel(point=slice(4)), target)
    with pytest.raises(LtcgearError, match=r"a\.nc: holds 4 of the sweep's 6 points; delete it"):
        sweep(Template("lsp"), VARY, target, **FEW)
