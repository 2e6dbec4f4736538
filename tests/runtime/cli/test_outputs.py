"""Outputs of all commands: never over a scene or another kind of file; never two at once; full disks are told."""

import os
import subprocess
import sys
from contextlib import contextmanager
from shutil import copyfile

import numpy as np
import pytest
import xarray as xr
from ltcgear.generated.lock import Lock
from ltcgear.generated.writing import force
from ltcgear.runtime.results import row_file
from ltcgear.runtime.results.result import load
from ltcgear.runtime.results.row_file import part_of
from ltcgear.runtime.simulation import recording
from ltcgear.symbolic.scene.load import SHIPPED

RUN = ("--t-end", "0.002")
VARY = ("--vary", "loads.ring.speed=5 rpm:20 rpm:2", "--t-end", "0.01", "--workers", "1")
COMMANDS = [
    (("simulate",), ".nc"), (("simulate", "--force"), ".nc"), (("sweep", *VARY), ".nc"), (("modes",), ".csv"),
    (("modes",), ".json"), (("modes",), ".html"), (("campbell",), ".csv"), (("campbell", "--force"), ".json"),
    (("response", "--excite", "lsp.sun_planet.1"), ".json"), (("response", "--excite", "x"), ".png"),
    (("stability",), ".csv"), (("sensitivity",), ".csv"), (("sensitivity",), ".svg"), (("cost",), ".pdf"),
    (("book",), ".html"), (("book",), ".tex"), (("export-fmu",), ".fmu"),
]  # fmt: skip


@pytest.fixture(autouse=True)
def unforced():
    """Leave nothing forced behind."""
    yield
    force(False)


@pytest.mark.parametrize(("command", "suffix"), COMMANDS, ids=[f"{c[0]}{s}" for c, s in COMMANDS])
def test_no_output_goes_over_the_scene_or_another_kind_of_file(refused, tmp_path, command, suffix):
    name, *options = command
    scene, other = tmp_path / f"scene{suffix}", tmp_path / f"other{suffix}"
    text = (SHIPPED / "lsp.toml").read_text("utf-8")
    scene.write_text(text, "utf-8")
    other.write_text("title = 'mine'\n", "utf-8")
    (tmp_path / f"link{suffix}").symlink_to(scene)
    for target in (scene, tmp_path / f"link{suffix}"):
        assert "is the file that is read; give another name" in refused(name, scene, *options, "-o", target)
    if "--force" not in options:
        assert "--force to replace it" in refused(name, scene, *options, "-o", other)
    for target in (tmp_path, "", ".", "/"):
        assert "is a folder; give a file name" in refused(name, scene, *options, "-o", target)
    assert "bytes, 255 at most" in refused(name, scene, *options, "-o", tmp_path / f"{'x' * 256}{suffix}")
    assert (scene.read_text("utf-8"), other.read_text("utf-8")) == (text, "title = 'mine'\n")
    assert len(list(tmp_path.iterdir())) == 3


def test_no_output_goes_over_a_table_that_the_scene_names(refused, tmp_path):
    (tmp_path / "torque.csv").write_text("time [s], torque [N*m]\n0, 1\n1, 2\n", "utf-8")
    (tmp_path / "shaft.toml").write_text(SHAFT, "utf-8")
    for name, *options in (("modes",), ("campbell",), ("sensitivity", "--force")):
        text = refused(name, tmp_path / "shaft.toml", *options, "-o", tmp_path / "torque.csv")
        assert "torque.csv: is the file that is read; give another name" in text


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """A result, and a sweep that was killed."""
    from ltcgear.runtime import sweep
    from ltcgear.symbolic import Template

    folder = tmp_path_factory.mktemp("results")

    def stop(stage, done, total, failed):
        if (stage, done) == ("simulate", 1):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sweep(Template("lsp"), VARY[1:2], folder / "s.nc", t_end=0.01, workers=1, told=stop)
    sweep(Template("lsp"), VARY[1:2], folder / "done.nc", t_end=0.01, workers=1)
    return folder


def test_rows_of_a_sweep_are_not_lost_to_a_run(run, refused, results, tmp_path):
    copyfile(results / "s.part.nc", tmp_path / "s.part.nc")
    copyfile(results / "done.nc", tmp_path / "done.nc")
    xr.Dataset({"a": 1}).to_netcdf(tmp_path / "mine.nc")
    command = ("simulate", "psh", *RUN, "-o")
    assert "s.part.nc: rows of a sweep that is not finished; the same sweep goes on" in refused(
        *command, tmp_path / "s.nc"
    )
    assert "done.nc: holds a sweep, no result of a run; give another name" in refused(*command, tmp_path / "done.nc")
    assert "mine.nc: holds something else, no result of a run" in refused(*command, tmp_path / "mine.nc")
    assert (tmp_path / "s.part.nc").read_bytes() == (results / "s.part.nc").read_bytes()
    for name in ("s.nc", "done.nc", "mine.nc"):
        assert run(*command, tmp_path / name, "--force")[0] == 0
        assert load(tmp_path / name).summary["status"] == "done"


def test_a_run_or_sweep_is_refused_while_another_writes(refused, tmp_path):
    (tmp_path / "link.nc").symlink_to("a.nc")
    told = "another run or sweep is writing it; wait for that, or give another -o"
    with Lock(tmp_path / "a.nc"):
        for target in ("a.nc", "link.nc"):
            for forced in ((), ("--force",)):
                assert told in refused("simulate", "psh", *RUN, *forced, "-o", tmp_path / target)
                assert told in refused("sweep", "lsp", *VARY, *forced, "-o", tmp_path / target)
        assert sorted(path.name for path in tmp_path.iterdir()) == ["a.part.lock", "link.nc"]


def test_rows_that_something_else_changed_are_not_sealed(refused, tmp_path, monkeypatch):
    """As another program without a lock would."""
    seal = row_file.Part.seal

    def changed(self, heading):
        with self.path.open("r+b") as file:
            file.seek(self.begin + 8)
            file.write(b"\xff" * 8)
        seal(self, heading)

    monkeypatch.setattr(row_file.Part, "seal", changed)
    text = refused("simulate", "psh", *RUN, "-o", tmp_path / "a.nc")
    assert "a.part.nc: was changed by something else while the run went on" in text
    assert not (tmp_path / "a.nc").exists()


def test_damaged_rows_of_a_sweep_are_computed_again(data, results, tmp_path):
    whole = (results / "s.part.nc").read_bytes()
    (tmp_path / "s.part.nc").write_bytes(whole[:-400] + bytes(400))
    shown = data("sweep", "lsp", *VARY, "-o", tmp_path / "s.nc")
    assert (shown["computed"], shown["kept"]) == (2, 0)
    with xr.open_dataset(tmp_path / "s.nc") as found, xr.open_dataset(results / "done.nc") as wanted:
        assert all((found[name] == wanted[name]).all() for name in wanted.data_vars)
        assert set(found.variables) == set(wanted.variables)


@pytest.mark.parametrize("rows", [1, 2, 1000, 5500, 6000, 8000])
def test_a_result_may_hold_tables_of_any_length(data, tmp_path, rows):
    time = np.linspace(0.0, 1.0, rows + 1)
    lines = [f"{t!r}, {100 + k % 7}.5" for k, t in enumerate(time.tolist())]
    (tmp_path / "torque.csv").write_text("\n".join(["time [s], torque [N*m]", *lines]), "utf-8")
    (tmp_path / "shaft.toml").write_text(SHAFT, "utf-8")
    shown = data("simulate", tmp_path / "shaft.toml", "-o", tmp_path / "a.nc")
    found = load(tmp_path / "a.nc").dataset
    assert shown["status"] == "done"
    assert found.sizes["time"] == 11
    assert found["coupling_torque"].values.max() > 1


SHAFT = """
title = "Two rotors"
[simulation]
t_end = "10 ms"
rate = "1 kHz"
[rotors.one]
inertia = "1 kg*m^2"
[rotors.two]
inertia = "1 kg*m^2"
[couplings.shaft]
between = ["one", "two"]
stiffness = "1e5 N*m/rad"
damping_ratio = 0.05
[loads.one]
member = "one"
torque_over_time = "torque.csv"
initial_speed = "10 rpm"
[loads.two]
member = "two"
torque = "-100 N*m"
"""


# --- full disks


@contextmanager
def disk(folder, size):
    """Mount a disk of some kilobytes."""
    made = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", f"size={size}k", "tmpfs", folder], check=False, capture_output=True
    )
    if made.returncode:
        pytest.skip("disks can be mounted by root only")
    try:
        yield lambda size: subprocess.run(["mount", "-o", f"remount,size={size}k", folder], check=True)
    finally:
        subprocess.run(["umount", "--lazy", folder], check=True)


@pytest.mark.skipif(os.getuid() != 0, reason="disks can be mounted by root only")
@pytest.mark.parametrize("size", [4, 40, 64, 160, 400])
def test_a_full_disk_is_told_and_the_run_goes_on(run, tmp_path, monkeypatch, size):
    """HDF5 and NetCDF would end the process by a signal; what is free is looked at before, and may be gone then."""
    folder = tmp_path / "disk"
    folder.mkdir()
    with disk(folder, size) as resize:
        command = ("simulate", "rig-2mw", "--t-end", "0.01", "-o", folder / "a.nc")
        code, _, err = run(*command)
        assert code == 2
        assert "the disk is full: the result would take 0.4" in err
        assert not list(folder.iterdir())
        monkeypatch.setattr(recording, "check_room", lambda *given: None)
        code, _, err = run(*command)
        assert code == 2
        assert "the disk is full; make room, then " in err
        assert {path.name for path in folder.iterdir()} <= {"a.part.nc", "a.checkpoint.npz"}
        resize(4000)
        goes_on = "--resume goes on" in err
        assert run(*command, *(["--resume"] if goes_on else []))[0] == 0
        assert load(folder / "a.nc").summary["status"] == "done"
        assert [path.name for path in folder.iterdir()] == ["a.nc"]


@pytest.mark.skipif(os.getuid() != 0, reason="disks can be mounted by root only")
@pytest.mark.parametrize(
    "command",
    [("modes", "psh", "-o", "m.csv"), ("modes", "psh", "-o", "m.png"), ("sensitivity", "psh", "-o", "s.csv"),
     ("book", "psh", "-o", "b.tex"), ("generate", "psh", "-o", "c")],
)  # fmt: skip
def test_a_full_disk_leaves_no_half_file(run, tmp_path, monkeypatch, command):
    folder = tmp_path / "disk"
    folder.mkdir()
    with disk(folder, 4) as resize:
        (folder / "full").write_bytes(bytes(4096))
        monkeypatch.chdir(folder)
        code, _, err = run(*command)
        assert code == 2
        assert "make room" in err
        assert [path for path in folder.rglob("*") if path.is_file()] == [folder / "full"]
        resize(8000)
        assert run(*command)[0] == 0
        monkeypatch.chdir(tmp_path)


def test_room_for_a_result_is_reserved_before_it_is_written(tmp_path, monkeypatch):
    """What is reserved is enough, so that HDF5 meets no full disk."""
    sizes = []

    def noted(draft, dataset, more=0):
        begin(draft, dataset, more)
        sizes.append(draft.stat().st_size)

    begin = row_file.begin
    monkeypatch.setattr(row_file, "begin", noted)
    from ..models import case
    from ..simulation.test_recording import write

    for t_end in (0.001, 0.05, 0.5):
        write(case("psh"), tmp_path / "a.nc", t_end=t_end, attributes={"scene_text": "x" * 100_000})
        taken = (tmp_path / "a.nc").stat().st_size
        assert taken < sizes[-1] < 1.1 * taken + 400_000


def test_two_programs_at_once_make_one_result(tmp_path):
    """The second is refused, or comes after the first; rows are those of one."""
    command = [
        sys.executable,
        "-c",
        "from ltcgear.runtime.cli.commands import main; main()",
        "simulate",
        "psh",
        "--t-end",
        "0.3",
    ]
    programs = [
        subprocess.Popen([*command, "-o", tmp_path / "a.nc"], stderr=subprocess.PIPE, text=True) for _ in range(2)
    ]
    ends = sorted((program.communicate(timeout=120)[1], program.returncode) for program in programs)
    assert {code for _, code in ends} <= {0, 2}
    assert all("is writing it" in text or "unfinished run" in text for text, code in ends if code)
    found = load(tmp_path / "a.nc").dataset
    recording.record(*_psh(), tmp_path / "b.nc", t_end=0.3)
    assert (found["mesh_force"].values == load(tmp_path / "b.nc").dataset["mesh_force"].values).all()


def _psh():
    """Library and numbers of a stage."""
    from ..models import case

    c = case("psh")
    return c.library, c.model.values()


# --- advice works


def test_what_refusals_advise_works(run, refused, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    command = ("simulate", "psh", *RUN, "-o")
    assert "name it x.nc" in refused(*command, "x.dat")
    assert "make it first" in refused(*command, "runs/x.nc")
    (tmp_path / "runs").mkdir()
    (tmp_path / "runs" / "x.checkpoint.npz").mkdir()
    assert "x.checkpoint.npz: is a folder; give a file name" in refused(*command, "runs/x.nc")
    assert "leave out --resume" in refused(*command, "y.nc", "--resume")
    assert "give one of them" in refused(*command, "y.nc", "--resume", "--force")
    assert "--resume: say which result is to go on, -o FILE.nc" in refused("simulate", "psh", *RUN, "--resume")
    for target in ("x.nc", "runs/y.nc", "y.nc"):
        assert run(*command, target)[0] == 0


def test_an_unfinished_run_is_begun_anew_once_its_rows_are_deleted(run, refused, tmp_path):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(row_file.Part, "seal", lambda self, heading: None)
        patch.setattr(row_file.Part, "remove", lambda self: None)
        run("simulate", "psh", *RUN, "-o", tmp_path / "a.nc")
    assert part_of(tmp_path / "a.nc").exists()
    text = refused("simulate", "psh", *RUN, "-o", tmp_path / "a.nc")
    assert "to begin anew, delete it or give --force" in text
    part_of(tmp_path / "a.nc").unlink()
    assert run("simulate", "psh", *RUN, "-o", tmp_path / "a.nc")[0] == 0
    assert load(tmp_path / "a.nc").summary["status"] == "done"
