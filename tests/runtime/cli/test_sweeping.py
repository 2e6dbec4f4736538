"""The command `ltcgear sweep`: tables and JSON, exit codes, Ctrl-C, refusals."""

import os
import signal
import subprocess
import sys
from time import monotonic, sleep

import pytest
from ltcgear.generated.errors import SolverError
from ltcgear.runtime import load_sweep
from ltcgear.runtime.results.row_file import part_of
from ltcgear.runtime.studies.sweep import task

SPEEDS = ("--vary", "loads.ring.speed=5 rpm:20 rpm:4", "--t-end", "0.02", "--workers", "1")


def test_a_sweep_prints_its_tables_and_then_is_finished(run, data, tmp_path):
    target = tmp_path / "a.nc"
    code, out, err = run("sweep", "lsp", *SPEEDS, "-o", target, "--figures", tmp_path / "figures")
    assert (code, err) == (0, "")
    assert "\nload_factor: load factor: largest over" in out
    assert f"4 points computed; 0 failed; {target}" in out
    assert {path.suffix for path in (tmp_path / "figures").iterdir()} == {".svg"}
    shown = data("sweep", "lsp", *SPEEDS, "-o", target)
    assert (shown["points"], shown["computed"], shown["kept"], shown["failed"]) == (4, 0, 4, 0)
    assert set(shown["seconds"]) == {"prepare", "simulate"}
    assert shown["metrics"]["load_factor"]["items"]["lsp.sun_planet.1"]["max"] > 1
    assert "finished before, nothing computed, 4 were there" in run("sweep", "lsp", *SPEEDS, "-o", target)[1]


def test_places_in_lists_are_set_and_varied(data, tmp_path):
    errors = "stages.lsp.position_errors"
    settings = ["effects.planet_position_error=on", f"{errors}=[{{planet=1}}]", f"{errors}.0.radial=10 um"]
    changes = [text for setting in settings for text in ("--set", setting)]
    vary = ("--vary", f"{errors}.0.tangential=0 um:20 um", "--sample", "normal", "--points", "4", "--seed", "7")
    end = ("--t-end", "0.02", "--workers", "1", "--metric", "load_share")
    shown = data("sweep", "lsp", *changes, *vary, *end, "-o", tmp_path / "a.nc")
    assert list(shown["metrics"]) == ["load_share", "mesh_load_factor"]
    assert shown["metrics"]["mesh_load_factor"]["items"]["lsp.sun_planet"]["std"] > 1e-3


def test_failed_points_are_told_and_all_of_them_are_an_error(run, refused, tmp_path, monkeypatch):
    def failing(*arguments, **options):
        raise SolverError("no equilibrium was found")

    monkeypatch.setattr(task, "simulate", failing)
    code, out, err = run("sweep", "lsp", *SPEEDS, "-o", tmp_path / "a.nc")
    assert code == 3
    assert "failed, 4 of 4: no equilibrium was found" in out
    assert "all 4 points failed" in err


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("--vary", "loads.ring.sped=5 rpm:20 rpm:4"), 'did you mean "speed"'),
        (("--vary", "loads.ring.speed=20 rpm:5 rpm:4"), "the range is empty"),
        (("--vary", "loads.ring.speed=5 rpm:inf rpm:4"), "is not finite"),
        (("--vary", "loads.ring.speed=5 rpm:20 rpm"), "how many points"),
        ((*SPEEDS, "--metric", "forcs"), "no such metric"),
        ((*SPEEDS, "--sample", "dice"), "no such sample"),
        ((*SPEEDS, "--set", "stages.lsp.position_errors.0.radial=1 um"), "is no list yet, so it has no place 0"),
    ],
)
def test_what_is_wrong_is_refused(refused, tmp_path, arguments, reason):
    assert reason in refused("sweep", "lsp", *arguments, "-o", tmp_path / "a.nc")
    assert not list(tmp_path.iterdir())


def test_a_file_or_folder_that_cannot_be_is_refused(refused, data, tmp_path):
    assert "does not exist" in refused("sweep", "lsp", *SPEEDS, "-o", tmp_path / "none" / "a.nc")
    data("simulate", "lsp", "--t-end", "0.02", "-o", tmp_path / "run.nc")
    assert "not a sweep; give another -o" in refused("sweep", "lsp", *SPEEDS, "-o", tmp_path / "run.nc")


def test_a_missing_package_is_told(refused, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "joblib", None)
    assert "pip install 'ltcgear[sweep]'" in refused("sweep", "lsp", *SPEEDS, "-o", tmp_path / "a.nc")


def test_ctrl_c_keeps_rows_and_the_same_command_goes_on(data, tmp_path):
    target = tmp_path / "a.nc"
    vary = ("--vary", "loads.ring.speed=5 rpm:20 rpm:200", "--t-end", "0.05", "--workers", "2")
    command = [sys.executable, "-c", "from ltcgear.runtime.cli import commands; commands.main()", "sweep", "lsp", *vary]
    program = subprocess.Popen(
        [*command, "-o", target], start_new_session=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    part, end = part_of(target), monotonic() + 60
    while not (part.exists() and part.read_bytes()[4:8] > bytes([0, 0, 0, 5])) and monotonic() < end:
        sleep(0.005)
    os.killpg(program.pid, signal.SIGINT)
    out, err = program.communicate(timeout=60)
    assert (program.returncode, out) == (130, "")
    assert err == f"ltcgear: stopped; rows are kept in {part}, the same command goes on\n"
    kept = load_sweep(part).sizes["point"]
    assert 5 < kept < 200
    shown = data("sweep", "lsp", *vary, "-o", target)
    assert (shown["kept"], shown["computed"], shown["failed"]) == (kept, 200 - kept, 0)


def test_a_point_is_left_out_and_failed_ones_are_computed_again(run, data, tmp_path):
    target = tmp_path / "a.nc"
    shown = data("sweep", "lsp", *SPEEDS, "--skip", "1", "--skip", "3", "-o", target)
    assert (shown["computed"], shown["failed"], shown["reasons"]) == (2, 2, {"left out by --skip": 2})
    assert "2 points computed, 2 were there; 0 failed" in run("sweep", "lsp", *SPEEDS, "--retry", "-o", target)[1]
    code, _, err = run("sweep", "lsp", *SPEEDS, "--skip", "9", "-o", tmp_path / "b.nc")
    assert (code, err) == (2, "ltcgear: --skip 9: no such point; they are numbered from 0 to 3\n")
