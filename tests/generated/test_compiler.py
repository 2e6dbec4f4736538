"""Compilers as they are met: with arguments, that hang, babble, make nothing or cannot be run."""

import ctypes
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from ltcgear.generated import drafts, store
from ltcgear.generated.contract import Artifact
from ltcgear.generated.errors import CompileError, MachineError
from ltcgear.runtime.export.fmu import binary

C = "double answer(void) { return 42.0; }\n"


@pytest.fixture
def choose(tmp_path, monkeypatch):
    """Make a program of a shell's lines and choose it by CC; it answers --version unless its lines do."""

    def choice(lines, *arguments, mode=0o755, head="#!/bin/sh", name="my-cc"):
        program = tmp_path / name
        program.write_bytes(f'{head}\n[ "$1" = --version ] && {{ echo mine; exit; }}\n'.encode() + lines.encode())
        program.chmod(mode)
        monkeypatch.setenv("CC", " ".join([str(program), *arguments]))
        store.compiler.cache_clear()
        return program

    yield choice
    store.compiler.cache_clear()


def build(text=C):
    return store.library(text, store.compiler())


def left_in(folder):
    return [path.name for path in folder.rglob(".draft-*")]


# --- which compiler


def test_a_compiler_may_have_arguments(home, choose, compiler):
    choose(f'echo "$@" >> "$0.calls"; shift; exec {compiler.path} "$@"', "-m64")
    program = Path(os.environ["CC"].split()[0])
    program.write_text(f'#!/bin/sh\necho "$@" >> "$0.calls"\nexec {compiler.path} "$@"\n')
    found = store.compiler()
    assert found.command == (str(program), "-m64")
    plain = store.library(C, store.Compiler(found.path, found.version))
    path = build()
    assert path != plain  # the key takes all of it
    calls = program.with_name("my-cc.calls").read_text().splitlines()
    assert calls[0] == "-m64 --version"
    assert calls[-1].startswith("-m64 -std=c11 ")
    function = ctypes.CDLL(str(path)).answer
    function.restype = ctypes.c_double
    assert function() == 42.0


def test_an_fmu_is_made_by_a_compiler_with_arguments(home, choose, compiler):
    choose(f'[ "$1" = gcc ] || exit 7; shift; exec {compiler.path} "$@"', "gcc")
    assert binary.compile_fmu({"a.c": "int fmi2Answer(void) { return 42; }\n"}, False).startswith(b"\x7fELF")
    assert left_in(home) == []


def test_a_compiler_s_path_may_hold_a_space(home, choose, compiler, tmp_path):
    (tmp_path / "my compilers").mkdir()
    program = choose(f'exec {compiler.path} "$@"', name="my compilers/cc")
    assert store.compiler().command == (str(program),)
    assert build().is_file()


def test_a_compiler_is_found_from_wherever_it_is_called(home, choose, compiler, tmp_path, monkeypatch):
    program = choose(f'exec {compiler.path} "$@"')
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("CC", f"./{program.name}")
    store.compiler.cache_clear()
    assert binary.compile_fmu({"a.c": "int fmi2Answer(void) { return 42; }\n"}, False).startswith(b"\x7fELF")


def test_quotes_of_cc_that_do_not_close_are_told(choose, monkeypatch):
    choose("")
    monkeypatch.setenv("CC", "gcc '-m64")
    with pytest.raises(CompileError, match=r"CC = gcc '-m64: No closing quotation; correct it or unset it"):
        store.compiler()


@pytest.mark.parametrize("kind", ["folder", "no right", "no program", "not there", "bytes"])
def test_what_is_no_program_is_told(choose, monkeypatch, tmp_path, kind):
    program = choose("")
    if kind == "folder":
        monkeypatch.setenv("CC", str(tmp_path))
    elif kind == "no right":
        program.chmod(0o644)
    elif kind == "no program":
        program.write_bytes(b"\x00nothing that runs")
    else:
        program.unlink()
    if kind == "bytes":
        monkeypatch.setenv("CC", os.fsdecode(b"/nowhere/\xff\x1b[31mcc"))
    with pytest.raises(CompileError, match=r"no such compiler|cannot be run: Exec format error") as told:
        store.compiler()
    assert "correct CC" in str(told.value)
    assert str(told.value).isprintable()


# --- what a compiler does


def test_a_compiler_that_does_not_end_is_ended(home, choose, monkeypatch):
    program = choose('sleep 60 & echo $! > "$0.child"; sleep 60')
    monkeypatch.setenv("LTCGEAR_COMPILE_SECONDS", "0.3")
    begin = time.monotonic()
    with pytest.raises(CompileError, match=r"did not end within 0.3 s and was ended; .*LTCGEAR_COMPILE_SECONDS"):
        build()
    assert time.monotonic() - begin < 20
    assert left_in(home) == []
    assert list((home / "libraries").iterdir()) == []
    assert not runs(int(program.with_name("my-cc.child").read_text()))


def test_a_child_that_outlives_its_compiler_is_ended(home, choose, compiler):
    program = choose(f'sleep 600 & echo $! > "$0.child"; exec {compiler.path} "$@"')
    begin = time.monotonic()
    assert build().is_file()
    assert time.monotonic() - begin < 60
    assert not runs(int(program.with_name("my-cc.child").read_text()))


def runs(process):
    """Tell whether a process runs; one that was killed and that nobody has asked for does not."""
    for _ in range(100):
        try:
            state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
        except FileNotFoundError:
            return False
        if state == "Z":
            return False
        time.sleep(0.02)
    return True


def test_the_limit_in_the_message_is_the_cure(home, choose, compiler, monkeypatch):
    choose(f'sleep 0.5; exec {compiler.path} "$@"')
    monkeypatch.setenv("LTCGEAR_COMPILE_SECONDS", "0.1")
    with pytest.raises(CompileError, match="LTCGEAR_COMPILE_SECONDS"):
        build()
    monkeypatch.setenv("LTCGEAR_COMPILE_SECONDS", "inf")
    assert build().is_file()


def test_a_compiler_that_does_not_say_which_it_is(choose, monkeypatch):
    program = choose("")
    program.write_text("#!/bin/sh\nexec sleep 60\n")
    monkeypatch.setenv("LTCGEAR_COMPILE_SECONDS", "0.2")
    with pytest.raises(CompileError, match="did not end within"):
        store.compiler()


@pytest.mark.parametrize("given", ["soon", "0", "-1", "nan"])
def test_a_limit_that_is_none_is_told(home, compiler, monkeypatch, given):
    monkeypatch.setenv("LTCGEAR_COMPILE_SECONDS", given)
    with pytest.raises(CompileError, match=f"LTCGEAR_COMPILE_SECONDS = {given}: must be a positive number"):
        store.library(C, compiler)


def test_the_usual_limit_grows_with_the_text():
    from ltcgear.generated.compiler import seconds_for

    assert seconds_for(10_000_000) - seconds_for(0) == pytest.approx(10_000)
    assert seconds_for(0) >= 60


def test_what_is_no_text_is_kept_and_told(home, choose):
    choose(r"printf 'caf\351 \033[31m error: no\n' >&2; exit 1")
    with pytest.raises(CompileError, match=r"exit code 1: caf.*\\x1b\[31m error: no\); log: ") as told:
        build()
    assert str(told.value).isprintable()
    assert "error: no" in Path(str(told.value).rsplit("log: ", 1)[1]).read_text("utf-8")


def test_much_that_is_said_is_cut(home, choose, compiler):
    choose(f'head -c 8000000 /dev/zero; {compiler.path} "$@"; head -c 8000000 /dev/zero >&2; exit 1')
    with pytest.raises(CompileError) as told:
        build()
    assert len(str(told.value)) < 2000
    assert Path(str(told.value).rsplit("log: ", 1)[1]).stat().st_size < 2_000_000


def test_a_compiler_that_asks_gets_no_answer(home, choose, compiler):
    choose(f'cat > /dev/null; exec {compiler.path} "$@"')
    assert build().is_file()


@pytest.mark.parametrize("does", ["nothing", "an empty file", "text", "half"])
def test_success_without_a_library_is_told(home, choose, compiler, does):
    out = 'for out; do [ "$last" = -o ] && break; last=$out; done\n'
    choose(
        {
            "nothing": "exit 0",
            "an empty file": out + ': > "$out"',
            "text": out + 'echo library > "$out"',
            "half": f'{compiler.path} "$@" || exit 1\n' + out + 'truncate -s 8000 "$out"',
        }[does]
    )
    with pytest.raises(CompileError, match="reported no error and made no whole library; correct CC or unset it"):
        build()
    assert list((home / "libraries").iterdir()) == []
    with pytest.raises(CompileError, match="reported no error and made no whole library; correct CC or unset it"):
        binary.compile_fmu({"a.c": C}, False)


def test_a_compiler_that_is_killed_is_told(home, choose):
    choose("kill -KILL $$")
    with pytest.raises(CompileError, match=r"refused the generated C \(ended by SIGKILL\)"):
        build()


def test_a_compiler_without_room_is_no_refusal(home, choose):
    choose('echo "fatal error: error writing to x.s: No space left on device" >&2; exit 1')
    with pytest.raises(MachineError, match=r"No space left on device; make room there, or set LTCGEAR_CACHE") as told:
        build()
    assert not isinstance(told.value, CompileError)


def test_a_compiler_keeps_its_own_files_in_the_store(home, choose, compiler, monkeypatch):
    program = choose(f'echo "$TMPDIR" > "$0.place"; exec {compiler.path} "$@"')
    monkeypatch.setenv("TMPDIR", "/nowhere")
    build()
    assert Path(program.with_name("my-cc.place").read_text()).is_relative_to(home / "libraries")


# --- drafts


def test_drafts_that_were_left_are_removed(home, compiler):
    store.library(C, compiler)
    folder = home / "libraries"
    for name in (".draft-left", ".draft-used", ".draft-new"):
        (folder / name).mkdir()
        (folder / name / "model.c").write_text("")
    day = time.time() - 1.5 * drafts.LEFT
    for name in (".draft-left", ".draft-used"):
        os.utime(folder / name, (day, day))
    with subprocess.Popen(
        [sys.executable, "-c", f"import fcntl, os, sys\nf = os.open({str(folder / '.draft-used')!r}, 0)\n"
         "fcntl.flock(f, fcntl.LOCK_EX)\nprint(flush=True)\nsys.stdin.read()"],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE,
    ) as other:  # fmt: skip
        other.stdout.readline()
        store.library(C + "\n", compiler)
        assert sorted(left_in(folder)) == [".draft-new", ".draft-used"]
        other.stdin.close()


def test_a_killed_compile_leaves_a_draft_that_is_swept_up(home, choose, compiler):
    choose("exec sleep 60")
    code = f"from ltcgear.generated import store\nstore.library({C!r}, store.compiler())"
    with subprocess.Popen([sys.executable, "-c", code]) as program:
        found = []
        while not found and program.poll() is None:
            found = list(home.glob("libraries/.draft-*/model.c"))
            time.sleep(0.02)
        program.send_signal(signal.SIGKILL)
    assert len(left_in(home)) == 1
    past = time.time() - 2 * drafts.LEFT
    os.utime(found[0].parent, (past, past))
    store.library(C, compiler)
    assert left_in(home) == []


# --- where the store is


def test_a_store_that_is_a_file_is_told(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("LTCGEAR_CACHE", str(tmp_path / "file"))
    with pytest.raises(MachineError, match=r"the store cannot be used: is no folder; set LTCGEAR_CACHE"):
        store.root()


def test_a_store_beside_the_working_folder_stays_there(tmp_path, monkeypatch, compiler):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("LTCGEAR_CACHE", "my store")
    path = store.library(C, compiler)
    assert path.is_relative_to(tmp_path / "my store")
    monkeypatch.chdir("/")
    assert ctypes.CDLL(str(path)).answer


def test_a_store_whose_name_is_no_text_is_told(tmp_path, monkeypatch):
    monkeypatch.setenv("LTCGEAR_CACHE", os.fsdecode(os.fsencode(tmp_path) + b"/caf\xe9"))
    with pytest.raises(MachineError, match=r"caf\\udce9: its name is no text .*; set LTCGEAR_CACHE"):
        store.root()


def test_an_empty_choice_is_none(tmp_path, monkeypatch):
    monkeypatch.setenv("LTCGEAR_CACHE", "")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert store.root() == tmp_path / "ltcgear"


def test_a_user_without_a_home_is_told(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("LTCGEAR_CACHE")
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(store.platformdirs, "user_cache_dir", lambda name: f"~/.cache/{name}")
    with pytest.raises(MachineError, match=r"no home folder for the store; set LTCGEAR_CACHE"):
        store.root()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("number", "cure"), [(30, "let it be written"), (28, "make room there")])
def test_a_store_that_takes_nothing_is_told_by_its_name(home, compiler, monkeypatch, number, cure):
    path = store.library(C, compiler)

    def refuse(**where):
        raise OSError(number, os.strerror(number), str(where["dir"]))

    monkeypatch.setattr(drafts.tempfile, "mkdtemp", refuse)
    assert store.library(C, compiler) == path  # what is there is used
    makers = [
        lambda: store.library(C + " ", compiler),
        lambda: store.put("key", Artifact(C, None, "")),
        lambda: binary.compile_fmu({"a.c": C}, False),
    ]
    monkeypatch.setattr(store, "files", lambda artifact: {"model.c": artifact.c})
    for make in makers:
        told = f"{home}.*: cannot be put into the store: {os.strerror(number)}; {cure}, or set LTCGEAR_CACHE"
        with pytest.raises(MachineError, match=told) as refused:
            make()
        assert not isinstance(refused.value, CompileError)
