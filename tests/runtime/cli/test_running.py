"""`ltcgear simulate` and `ltcgear cost`: what they print, write and refuse."""

import os
import signal
from contextlib import contextmanager

import pytest
from ltcgear.generated import writing
from ltcgear.runtime.cli import commands
from ltcgear.runtime.simulation import integration
from ltcgear.runtime.view.tables import printed

SHORT = ("--t-end", "0.01")


def test_cost(data, run, tmp_path):
    shown = data("cost", "psh", "--t-end", "0.02", "--set", "effects.gravity=on", "-o", tmp_path / "cost.png")
    rows = {row["effect"]: row for row in shown["variants"]}
    assert {"mesh_stiffness", "mesh_damping", "damping", "gravity"} < set(rows)
    assert shown["variants"][0]["effect"] == "all"
    expected = {"value", "without", "states", "ops", "ns_call", "seconds_per_simulated_second", "counts", "changes"}
    assert all(expected <= set(row) and row["reason"] == "" for row in rows.values())
    assert set(rows["all"]["changes"]) == {"force_rms", "force_peak", "load_share", "spectrum"}
    assert rows["gravity"]["ops"]["rhs"] < rows["all"]["ops"]["rhs"]
    assert rows["mesh_stiffness"]["counts"]["events"] == 0 < rows["all"]["counts"]["events"]
    assert abs(rows["gravity"]["changes"]["force_rms"]) < 0.1 < abs(rows["mesh_stiffness"]["changes"]["force_rms"])
    assert (tmp_path / "cost.png").stat().st_size > 10_000
    out = run("cost", "psh", "--t-end", "0.02")[1]
    assert "two-level > mean" in out
    assert max(len(line) for line in out.splitlines()) <= 80


def test_cost_tells_what_cannot_be_run(data, monkeypatch):
    from ltcgear.symbolic.scene import load

    whole = load.load_scene

    def refusing(name, changes=None):
        if "effects.damping" in (changes or {}):
            raise load.SceneError("psh: 1 defect\n  effects.damping: contradicts")
        return whole(name, changes)

    monkeypatch.setattr(load, "load_scene", refusing)
    rows = {row["effect"]: row for row in data("cost", "psh", "--t-end", "0.005")["variants"]}
    assert "contradicts" in rows["damping"]["reason"]
    assert rows["damping"]["states"] is None
    assert rows["mesh_damping"]["reason"] == ""


def test_simulate(data, tmp_path):
    target = tmp_path / "result.nc"
    shown = data("simulate", "lsp", *SHORT, "-o", target)
    expected = {"status", "method", "rtol", "simulated_s", "seconds", "real_time_factor", "counts", "energy_residual"}
    assert expected | {"forces"} <= set(shown)
    assert {"steps", "rhs", "jacobian", "events"} <= set(shown["counts"])
    assert shown["status"] == "done"
    assert abs(shown["energy_residual"]) < 1e-5
    force = shown["forces"]["lsp.sun_planet.1"]
    assert {"mean", "min", "max", "load_factor"} <= set(force)
    assert force["min"] < force["mean"] < force["max"]
    assert target.read_bytes()[1:4] == b"HDF"
    assert [path.name for path in tmp_path.iterdir()] == ["result.nc"]


def test_an_interrupted_run_goes_on_or_is_begun_anew(run, refused, tmp_path, monkeypatch):
    @contextmanager
    def stopping(title, end):
        yield lambda now: os.kill(os.getpid(), signal.SIGINT)

    command = ("simulate", "psh", *SHORT, "-o", tmp_path / "result.nc")
    for last in ("--resume", "--force"):
        with monkeypatch.context() as patch:
            patch.setattr(commands.running, "progress", stopping)
            patch.setattr(integration, "SLICE", 0.0)
            code, _, err = run(*command)
        assert code == 130
        assert err.startswith("ltcgear: interrupted at t = ")
        assert err.endswith("result.part.nc, --resume goes on\n")
        assert sorted(path.suffixes[0] for path in tmp_path.iterdir()) == [".checkpoint", ".part"]
        assert "--resume goes on with it; to begin anew, delete it or give --force" in refused(*command)
        assert run(*command, last)[0] == 0
        assert [path.name for path in tmp_path.iterdir()] == ["result.nc"]
        (tmp_path / "result.nc").unlink()


@pytest.mark.parametrize("method", ["erk", "cvodes", "adams", "idas", "rosenbrock", "sundae"])
def test_simulate_by_every_method(data, method):
    shown = data("simulate", "psh", "--t-end", "0.002", "--method", method, "--rtol", "1e-5")
    assert (shown["status"], shown["method"], shown["rtol"]) == ("done", method, 1e-5)


@pytest.mark.parametrize(
    ("factor", "text"),
    [(2.37, "2.4 times faster than real time"), (0.38, "2.6 times slower than real time"), (0.0, "stopped")],
)
def test_pace(factor, text):
    assert printed.pace(factor).startswith(text)


@pytest.fixture
def nothing_computed(monkeypatch):
    """Let any computing fail the test."""

    def computed(*arguments, **keys):
        pytest.fail("computed before the target was refused")

    monkeypatch.setattr(commands.running, "open_scene", computed)


@pytest.mark.usefixtures("nothing_computed")
def test_an_unwritable_result_is_refused_before_computing(refused, tmp_path):
    assert "does not exist" in refused("simulate", "lsp", "-o", tmp_path / "no" / "x.nc")
    assert "is a folder" in refused("simulate", "lsp", "-o", tmp_path)
    assert f"name it {tmp_path / 'x.nc'}" in refused("simulate", "lsp", "-o", tmp_path / "x.csv")
    unstarted = refused("simulate", "lsp", "--resume", "-o", tmp_path / "x.nc")
    assert f"{tmp_path / 'x.checkpoint.npz'}: not there, so there is nothing to go on from" in unstarted
    (tmp_path / "file").write_text("", encoding="utf-8")
    assert "does not exist" in refused("simulate", "lsp", "-o", tmp_path / "file" / "x.nc")


@pytest.mark.usefixtures("nothing_computed")
def test_a_folder_without_the_right_to_write_is_refused_before_computing(refused, tmp_path, monkeypatch):
    def refuse(*arguments, **keys):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(writing, "make_draft", refuse)
    assert "cannot be written" in refused("simulate", "lsp", "-o", tmp_path / "x.nc")


def test_a_run_that_stops_is_exit_code_3(run, monkeypatch, tmp_path):
    summary = {"status": "erk stopped at t = 0.1 s"}
    monkeypatch.setattr(commands.running, "run", lambda *arguments, **keys: summary)
    monkeypatch.setattr(printed, "simulated", lambda data: None)
    for command in (("simulate", "lsp"), ("paper", "-o", tmp_path)):
        code, _, err = run(*command)
        assert (code, err) == (3, "ltcgear: erk stopped at t = 0.1 s\n")


def test_a_rate_is_that_of_the_samples(data, refused, tmp_path):
    scene = data("simulate", "psh", "--t-end", "0.05", "--set", "simulation.rate=4000 Hz")
    given = data("simulate", "psh", "--t-end", "0.05", "--set", "simulation.rate=9000 Hz", "--rate", "4000")
    assert (given["rate_hz"], given["band_hz"]) == (scene["rate_hz"], scene["band_hz"]) == (4000.0, 1600.0)
    assert given["forces"] == scene["forces"]
    for wrong in ("0", "-5", "nan"):
        assert f"rate {float(wrong):g}: must be" in refused("simulate", "psh", "--rate", wrong, "-o", tmp_path / "a.nc")
    assert list(tmp_path.iterdir()) == []
