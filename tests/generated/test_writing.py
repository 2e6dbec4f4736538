"""Output files: what may be written where; files that appear whole or not at all; drafts that nobody can guess."""

import errno
import fcntl
import os
import stat
import subprocess
import sys
import time

import pytest
from ltcgear.generated import writing
from ltcgear.generated.errors import LtcgearError, MachineError
from ltcgear.generated.folders import write_folder, write_unchanged
from ltcgear.generated.kinds import KINDS, find_other_kind
from ltcgear.generated.lock import Lock, lock_of
from ltcgear.generated.writing import check_output, follow, force, make_folder, written_whole

SCENE = 'title = "winch, two rotors"\n\n[loads.motor]\nspeed = { value = "10 rpm", source = "printed: 3" }\n'


@pytest.fixture(autouse=True)
def unforced():
    """Leave nothing forced behind."""
    yield
    force(False)


# --- the rule


@pytest.mark.parametrize("suffix", KINDS)
def test_nothing_goes_over_another_kind_of_file(tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    path.write_text(SCENE, "utf-8")
    for write in (check_output, lambda path: written_whole(path).__enter__()):
        with pytest.raises(LtcgearError, match=r"holds something else than .*--force to replace it"):
            write(path)
    assert path.read_text("utf-8") == SCENE
    force()
    check_output(path)
    with written_whole(path) as draft:
        draft.write_text("other", "utf-8")
    assert path.read_text("utf-8") == "other"


@pytest.mark.parametrize(
    ("suffix", "data"),
    [
        (".csv", b"a,b\n1,2\n"), (".csv", b'"a,b",c\r\n1,"2\n3"\r\n'), (".csv", b"a,b\n" + b"1,2\n" * 40_000),
        (".json", b' {"a": 1}'), (".json", b"[1]"), (".html", b"<!DOCTYPE html><title>ltcgear report</title>"),
        (".svg", b'<?xml version="1.0"?>\n<svg xmlns="x"/>'), (".nc", b"CDF\x02"), (".pdf", b"%PDF-1.4"),
        (".c", b"int a;"),
    ],
)  # fmt: skip
def test_files_of_the_kind_are_replaced(tmp_path, suffix, data):
    path = tmp_path / f"a{suffix}"
    path.write_bytes(data)
    check_output(path)
    path.write_bytes(b"")
    check_output(path)


@pytest.mark.parametrize(
    ("suffix", "data"),
    [
        (".html", b"<!doctype html><title>mine</title>"), (".csv", b"alone\n"), (".csv", b"a,b\n1\n"),
        (".csv", b"\xff\xfe,\n"), (".tex", b"\\documentclass{article}"), (".nc", b"\x89HDF"),
    ],
)  # fmt: skip
def test_files_of_another_kind_are_known(tmp_path, suffix, data):
    path = tmp_path / f"a{suffix}"
    path.write_bytes(data)
    assert find_other_kind(path) == KINDS[suffix][0]


def test_nothing_goes_over_what_is_read(tmp_path):
    path, link = tmp_path / "a.csv", tmp_path / "b.csv"
    path.write_bytes(b"a,b\n1,2\n")
    link.symlink_to(path)
    os.link(path, tmp_path / "c.csv")
    force()
    for target in (path, link, tmp_path / "c.csv"):
        with pytest.raises(LtcgearError, match="is the file that is read; give another name"):
            check_output(target, None, "no such", path)
    check_output(path, tmp_path, "x\0y")


@pytest.mark.parametrize("name", ["", ".", "..", "/", "x/.."])
def test_a_folder_is_no_output(name):
    with pytest.raises(LtcgearError, match="is a folder; give a file name"):
        check_output(writing.Path(name))


def test_names_that_no_file_can_have_are_refused(tmp_path):
    for name, told in ((f"{'x' * 252}.csv", "256 bytes, 255 at most"), ("a\udcff.csv", "not UTF-8"),
                       ("a\x1b[2J.csv", "cannot be shown")):  # fmt: skip
        with pytest.raises(LtcgearError, match=told):
            check_output(tmp_path / name)
    with pytest.raises(LtcgearError, match="not UTF-8"):
        make_folder(tmp_path / "a\udcff")
    with pytest.raises(LtcgearError, match=r"the folder .* does not exist; make it first"):
        check_output(tmp_path / "no" / "x.csv")
    check_output(tmp_path / f"{'x' * 251}.csv")
    assert not list(tmp_path.iterdir())


def test_devices_and_pipes_are_no_outputs(tmp_path):
    os.mkfifo(tmp_path / "x.csv")
    (tmp_path / "y.csv").symlink_to("/dev/null")
    for name in ("x.csv", "y.csv"):
        with pytest.raises(LtcgearError, match="a device or a pipe; give a file name"):
            check_output(tmp_path / name)


# --- whole or not at all


def test_a_link_is_written_through(tmp_path):
    (tmp_path / "folder").mkdir()
    link, real = tmp_path / "a.csv", tmp_path / "folder" / "b.csv"
    link.symlink_to("folder/b.csv")
    for text in ("a,b\n1,2\n", "a,b\n3,4\n"):
        with written_whole(link) as draft:
            draft.write_text(text, "utf-8")
        assert (link.is_symlink(), real.read_text("utf-8")) == (True, text)
    assert lock_of(link) == lock_of(follow(link)) == tmp_path / "folder" / "b.part.lock"


def test_drafts_are_new_files_that_nobody_can_guess(tmp_path):
    drafts = {writing.make_draft(tmp_path / "a.csv") for _ in range(3)}
    assert len(drafts) == 3
    assert all(writing.OURS.fullmatch(draft.name) for draft in drafts)
    victim = tmp_path / "victim"
    victim.write_text("kept", "utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(writing.secrets, "token_hex", lambda size: "0" * 16)
        (tmp_path / writing.make_draft(tmp_path / "b.csv").name).unlink()
        draft = tmp_path / f"{writing._name_draft(tmp_path / 'b.csv')}{'0' * 16}.csv"
        draft.symlink_to(victim)
        with pytest.raises(MachineError, match="cannot be written: File exists"), written_whole(tmp_path / "b.csv"):
            pass
    assert victim.read_text("utf-8") == "kept"


def test_the_umask_is_kept_and_so_are_the_rights_of_what_is_replaced(tmp_path):
    before = os.umask(0o077)
    try:
        with written_whole(tmp_path / "a.csv") as draft:
            draft.write_text("a,b\n", "utf-8")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "a.csv").stat().st_mode) == 0o600
    (tmp_path / "a.csv").chmod(0o640)
    with written_whole(tmp_path / "a.csv") as draft:
        draft.write_text("c,d\n", "utf-8")
    assert stat.S_IMODE((tmp_path / "a.csv").stat().st_mode) == 0o640


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EROFS])
def test_what_keeps_a_file_from_being_written_is_told(tmp_path, number):
    path = tmp_path / "a.csv"
    path.write_bytes(b"a,b\n1,2\n")

    def fail():
        with written_whole(path, "--resume goes on") as draft:
            draft.write_text("half")
            raise OSError(number, os.strerror(number))

    with pytest.raises(MachineError) as caught:
        fail()
    told = f"{path}: cannot be written: {writing.FULL.get(number, os.strerror(number))}; "
    assert str(caught.value).startswith(told)
    assert str(caught.value).endswith("make room, then --resume goes on" if number in writing.FULL else "goes on")
    assert [(p.name, p.read_bytes()) for p in tmp_path.iterdir()] == [("a.csv", b"a,b\n1,2\n")]


def test_drafts_of_killed_programs_are_removed_and_nothing_else(tmp_path):
    names = [".draft-0123abcd-0123456789abcdef.csv", ".draft-mine", ".draft-0123abcd-fedcba9876543210"]
    for name in names:
        (tmp_path / name).touch()
    for name in names[:2]:
        os.utime(tmp_path / name, (time.time() - 2 * writing.ABANDONED,) * 2)
    young = writing.make_draft(tmp_path / "b.csv")
    with written_whole(tmp_path / "a.csv") as draft:
        draft.write_text("a,b\n", "utf-8")
    assert {p.name for p in tmp_path.iterdir()} == {"a.csv", young.name, *names[1:]}
    writing.remove_drafts(tmp_path / "b.csv")  # as one does who holds the lock
    assert {p.name for p in tmp_path.iterdir()} == {"a.csv", *names[1:]}


# --- folders


def test_files_of_the_user_are_written_whole(tmp_path):
    write_folder(tmp_path / "a" / "b", {"x.c": "1", "y.c": "2"})
    write_folder(tmp_path / "a" / "b", {"x.c": "3"})
    assert {p.name: p.read_text() for p in (tmp_path / "a" / "b").iterdir()} == {"x.c": "3", "y.c": "2"}
    (tmp_path / "file").write_text("")
    with pytest.raises(LtcgearError, match="is a file; give a folder"):
        write_folder(tmp_path / "file" / "b", {"x.c": "1"})


def test_what_was_changed_in_a_folder_is_not_replaced(tmp_path):
    texts = {"main.c": "int a;\n", "model.c": "int b;\n"}
    write_unchanged(tmp_path, texts)
    write_unchanged(tmp_path, texts | {"model.c": "int c;\n"})
    assert subprocess.run(["sha256sum", "--check", "SHA256SUMS"], cwd=tmp_path, check=False).returncode == 0
    (tmp_path / "main.c").write_text("int mine;\n", "utf-8")
    with pytest.raises(LtcgearError, match=r"main\.c would be replaced, .* --force to replace"):
        write_unchanged(tmp_path, {name: f"{text}\n" for name, text in texts.items()})
    assert [(tmp_path / name).read_text("utf-8") for name in texts] == ["int mine;\n", "int c;\n"]
    write_unchanged(tmp_path, {"model.c": "int d;\n"})  # what else is there does not matter
    force()
    write_unchanged(tmp_path, texts)
    assert [(tmp_path / name).read_text("utf-8") for name in texts] == list(texts.values())
    force(False)
    write_unchanged(tmp_path, {"main.c": "int e;\n"})
    assert (tmp_path / "main.c").read_text("utf-8") == "int e;\n"


# --- the lock


def test_one_program_at_a_time_writes(tmp_path):
    with Lock(tmp_path / "a.nc") as held, pytest.raises(LtcgearError, match=r"a\.nc: another run or sweep is writing"):
        Lock(tmp_path / "a.nc")
    assert not held.path.exists()
    with Lock(tmp_path / "a.nc"), Lock(tmp_path / "b.nc"):
        assert sorted(path.name for path in tmp_path.iterdir()) == ["a.part.lock", "b.part.lock"]


@pytest.mark.parametrize("fault", [errno.ENOSYS, errno.ENOLCK, errno.EOPNOTSUPP])
def test_outputs_are_written_where_files_cannot_be_locked(tmp_path, monkeypatch, fault):
    def missing(file, how):
        raise OSError(fault, os.strerror(fault))

    monkeypatch.setattr(fcntl, "flock", missing)
    with Lock(tmp_path / "a.nc"):
        assert lock_of(tmp_path / "a.nc").exists()
    assert list(tmp_path.iterdir()) == []


def test_a_lock_ends_with_the_program(tmp_path):
    code = (
        "import os, sys; from pathlib import Path; from ltcgear.generated.lock import Lock;"
        "held = Lock(Path(sys.argv[1])); os.kill(os.getpid(), 9)"
    )
    assert subprocess.run([sys.executable, "-c", code, str(tmp_path / "a.nc")], check=False).returncode == -9
    assert lock_of(tmp_path / "a.nc").exists()
    with Lock(tmp_path / "a.nc"):
        pass
    assert list(tmp_path.iterdir()) == []


def test_a_lock_is_not_made_through_a_link(tmp_path):
    lock_of(tmp_path / "a.nc").symlink_to(tmp_path / "victim")
    with pytest.raises(MachineError, match=r"a\.part\.lock: cannot be written"):
        Lock(tmp_path / "a.nc")
    assert not (tmp_path / "victim").exists()
