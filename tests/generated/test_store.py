"""The store: keys that cover everything, folders that appear whole, compilers that fail loudly."""

import ctypes
import pickle
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from ltcgear.generated import store
from ltcgear.generated.contract import (
    FORMAT,
    PHYSICAL,
    Artifact,
    Clock,
    Connection,
    Manifest,
    Report,
    RigidBody,
    Signal,
    Signature,
    State,
)
from ltcgear.generated.errors import CompileError, MachineError

C = "double answer(void) { return 42.0; }\n"
KEY = "0123abcd"
BROKEN = "double answer(void) { return nonsense; }\n"


@pytest.fixture
def fresh_compiler():
    """Let `compiler` look again, before and after."""
    store.compiler.cache_clear()
    yield
    store.compiler.cache_clear()


@pytest.fixture
def runs(monkeypatch):
    """The commands that are run."""
    seen, real = [], store.run_compiler

    def run(command, *limits):
        seen.append(command)
        return real(command, *limits)

    monkeypatch.setattr(store, "run_compiler", run)
    return seen


GRAPHS = "graphs of any kind, µ, long enough to be cut in the middle and still be text"


def artifact():
    signature = Signature((("x", 2, 1), ("p", 1, 1)), (("xdot", 2, 1),), 2, 7)
    manifest = Manifest(
        store.digest([C, GRAPHS]), "rest", (State("a.u", "rad", "a", "u", "a.inertia", "deviation"),), ("m.1",),
        (("a.inertia", "kg*m^2"),),
        (Report("speed", "a", "rad/s", "rotor"),), {"rhs": signature}, "3.8.2",
        (Signal("reference.acceleration", "rad/s^2", "loads.m.speed_over_time", True, "loads.m.acceleration"),),
        ("hold.m.1",), (Clock("m.1.phase", "m.teeth_1", "a.speed_ratio", "", ("m.tooth_error_0.teeth",), "m.1"),),
        (RigidBody("a", "m", "input", "m.carrier", ("a.x_0", "a.y_0"), "a.speed_ratio", "", "a.inertia", "m.r_1"),),
        (Connection("m.1.back", "m", "mesh", "m.1.back", ("a", "b"), ("m.k",), "m.c", "hold.m.1.back", -1, True),),
        {"a.inertia": PHYSICAL},
    )  # fmt: skip
    return Artifact(C, manifest, GRAPHS)


# --- keys


def test_borders_between_parts_matter():
    assert store.digest(["ab", "c"]) != store.digest(["a", "bc"])
    assert store.digest(["ab"]) != store.digest(["a", "b"])
    assert store.digest(["", "a"]) != store.digest(["a", ""])
    assert store.digest(["a", ""]) != store.digest(["a"])
    assert store.digest(["1:a"]) != store.digest(["1", "a"])
    assert store.digest(["µ"]) != store.digest(["u"])


def test_a_digest_is_the_same_every_time():
    assert store.digest(["a", "b"]) == store.digest(["a", "b"])
    assert re.fullmatch("[0-9a-f]{64}", store.digest([]))


def test_every_part_of_a_library_s_key_counts(home, monkeypatch, compiler, runs):
    first = store.library(C, compiler)
    others = [
        store.library(C + "\n", compiler),
        store.library(C, store.Compiler(compiler.path, compiler.version + "+")),
    ]
    with monkeypatch.context() as patch:
        patch.setattr(store, "FLAGS", (*store.FLAGS, "-fno-trapping-math"))
        others.append(store.library(C, compiler))
    with monkeypatch.context() as patch:
        patch.setenv("LTCGEAR_CFLAGS", "-ffp-contract=fast -D'A=1 + 1'")
        assert store.flags() == (*store.FLAGS, "-ffp-contract=fast", "-DA=1 + 1")
        others.append(store.library(C, compiler))
    with monkeypatch.context() as patch:
        patch.setattr(store, "LIBRARIES", ("-lm", "-lc"))
        others.append(store.library(C, compiler))
    with monkeypatch.context() as patch:
        patch.setattr(store, "processor", lambda: "another")
        others.append(store.library(C, compiler))
    link = home / "cc"
    link.symlink_to(compiler.path)
    others.append(store.library(C, store.Compiler(str(link), compiler.version)))
    assert len({first, *others}) == 8 == len(runs)


@pytest.mark.parametrize(("flags", "told"), [("-DA='1", "No closing quotation"), ("-fno-such-flag", "refused")])
def test_flags_that_cannot_be_are_told(home, monkeypatch, compiler, flags, told):
    monkeypatch.setenv("LTCGEAR_CFLAGS", flags)
    with pytest.raises(CompileError, match=f"{told}") as refused:
        store.library(C, compiler)
    assert f"LTCGEAR_CFLAGS = {flags}" in str(refused.value)


def test_every_part_of_a_model_s_key_counts(monkeypatch):
    from ltcgear.symbolic.assembly import build_model
    from ltcgear.symbolic.emit import pipeline
    from ltcgear.symbolic.scene.load import load_scene

    def key(*changes):
        return pipeline.content_key(build_model(load_scene("psh", dict(changes))))

    plain = key()
    assert key() == plain
    # Numbers are parameters: the C of another stiffness is the same C.
    assert key(("stages.psh.input.bearing.stiffness", '"1e9 N/m"'), ("title", "another")) == plain
    others = {
        key(("effects.gravity", "on")),
        key(("effects.mesh_law", "paper")),
        key(("effects.damping", "off")),
        key(("stages.psh.input.drag", '"1 N*m*s/rad"')),
    }
    monkeypatch.setattr(pipeline, "_sources", lambda: "other equations")
    pipeline._surroundings.cache_clear()
    others.add(key())
    pipeline._surroundings.cache_clear()
    assert len(others | {plain}) == 6


def test_the_sources_of_the_equations_are_in_the_key():
    from ltcgear.symbolic.emit import pipeline

    home, text = Path(pipeline.__file__).parents[1], pipeline._sources()
    paths = sorted(home.rglob("*.py"))
    assert len(paths) > 80
    for path in paths:
        assert path.read_text("utf-8") in text


# --- models in the store


def test_what_is_put_is_got(home):
    made = artifact()
    assert store.get(KEY) is None
    store.put(KEY, made)
    assert store.get(KEY) == made
    folder = home / "models" / KEY
    assert sorted(path.name for path in folder.iterdir()) == sorted(store.files(made))
    store.put(KEY, made)
    assert store.get(KEY) == made


def test_nothing_is_left_beside_a_model(home):
    store.put(KEY, artifact())
    store.put(KEY, artifact())
    assert [path.name for path in (home / "models").iterdir()] == [KEY]


def test_a_folder_appears_whole_or_not_at_all(tmp_path, monkeypatch):
    real = Path.write_text

    def write(path, *args, **options):
        if path.name == "two":
            raise OSError("the disk is full")
        return real(path, *args, **options)

    monkeypatch.setattr(Path, "write_text", write)
    with pytest.raises(OSError, match="the disk is full"):
        store.put_folder(tmp_path / "target", {"one": "1", "two": "2"})
    assert list(tmp_path.iterdir()) == []


def test_a_folder_put_again_takes_the_place_of_the_older_one(tmp_path):
    store.put_folder(tmp_path / "target", {"one": "theirs"})
    store.put_folder(tmp_path / "target", {"one": "ours"})
    assert (tmp_path / "target" / "one").read_text() == "ours"
    assert len(list(tmp_path.iterdir())) == 1


DAMAGES = {
    "missing": Path.unlink,
    "not text": lambda path: path.write_bytes(b"\xff\xfe\x00"),
    "cut": lambda path: path.write_text(path.read_text()[:30]),
    "empty": lambda path: path.write_text(""),
    "a list": lambda path: path.write_text("[]"),
    "a lost entry": lambda path: path.write_text(path.read_text().replace('"reference"', '"preference"')),
    "a strange entry": lambda path: path.write_text(path.read_text().replace('"axis": "u"', '"axle": "u"')),
}


@pytest.mark.parametrize(
    ("name", "damage"),
    [
        *(("manifest.json", damage) for damage in DAMAGES),
        *(
            (name, damage)
            for name in ("model.c", "graphs.casadi")
            for damage in ("missing", "not text", "cut", "empty")
        ),
    ],
)
def test_a_damaged_model_is_dropped_and_made_again(home, name, damage):
    made = artifact()
    store.put(KEY, made)
    DAMAGES[damage](home / "models" / KEY / name)
    assert store.get(KEY) is None
    assert not (home / "models" / KEY).exists()
    store.put(KEY, made)
    assert store.get(KEY) == made


def test_the_same_content_put_again_stays_untouched(home):
    store.put(KEY, artifact())
    folder = home / "models" / KEY
    before = folder.stat().st_ino, {path.name: path.stat().st_ino for path in folder.iterdir()}
    store.put(KEY, artifact())
    assert (folder.stat().st_ino, {path.name: path.stat().st_ino for path in folder.iterdir()}) == before


@pytest.mark.parametrize("damage", ["missing", "not text", "cut", "empty"])
@pytest.mark.parametrize("name", ["model.c", "manifest.json", "graphs.casadi"])
def test_a_damaged_model_is_replaced_by_put(home, name, damage):
    made = artifact()
    store.put(KEY, made)
    DAMAGES[damage](home / "models" / KEY / name)
    store.put(KEY, made)
    assert store.get(KEY) == made
    assert [path.name for path in (home / "models").iterdir()] == [KEY]


def test_a_model_away_for_a_moment_is_found(home, monkeypatch):
    made = artifact()
    store.put(KEY, made)
    folder = home / "models" / KEY
    folder.rename(home / "away")
    monkeypatch.setattr(store.time, "sleep", lambda seconds: (home / "away").rename(folder))
    assert store.get(KEY) == made
    assert folder.is_dir()


def test_a_model_that_may_not_be_read_is_a_miss_and_kept(home, monkeypatch):
    made = artifact()
    store.put(KEY, made)

    def refuse(path, *args, **options):
        raise PermissionError(13, "Permission denied", str(path))

    with monkeypatch.context() as patch:
        patch.setattr(Path, "read_text", refuse)
        assert store.get(KEY) is None
    assert store.get(KEY) == made


def test_a_store_that_cannot_be_written_is_told(home):
    home.mkdir(mode=0o700)
    (home / "models").write_text("")
    assert store.get(KEY) is None
    with pytest.raises(MachineError, match=r"cannot be put into the store: .*set LTCGEAR_CACHE"):
        store.put(KEY, artifact())


def test_without_locks_the_store_still_works(home, monkeypatch):
    def refuse(handle, operation):
        raise OSError(9, "Bad file descriptor")

    monkeypatch.setattr(store.fcntl, "flock", refuse)
    made = artifact()
    store.put(KEY, made)
    store.put(KEY, replace(made, manifest=replace(made.manifest, reference="speed")))
    assert store.get(KEY).manifest.reference == "speed"
    (home / "models" / KEY / "model.c").write_text("")
    assert store.get(KEY) is None
    assert not (home / "models" / KEY).exists()


HAMMER = """
import pickle, sys, time
from ltcgear.generated import store
made = [pickle.loads(bytes.fromhex(text)) for text in sys.argv[2:]]
print(flush=True)
sys.stdin.readline()  # all begin at once
end, turns, missed = time.monotonic() + 1.0, 0, 0
while time.monotonic() < end:
    turns += 1
    if sys.argv[1] == "put":
        store.put("KEY", made[turns % len(made)])
    else:
        missed += store.get("KEY") not in made
print(turns, missed)
"""


@pytest.mark.parametrize("contents", [1, 2])
def test_many_processes_at_one_key_never_miss(home, contents):
    made = [artifact(), replace(artifact(), c=C + C.replace("answer", "other"))][:contents]
    made = [replace(a, manifest=replace(a.manifest, key=store.digest([a.c, a.graphs]))) for a in made]
    store.put("KEY", made[0])
    texts = [pickle.dumps(a).hex() for a in made]
    workers = [
        subprocess.Popen(
            [sys.executable, "-c", HAMMER, role, *texts], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        for role in ("put", "put", "get", "get")
    ]
    for worker in workers:
        assert worker.stdout.readline() == "\n"
    for worker in workers:
        worker.stdin.write("\n")
        worker.stdin.flush()
    counts = [tuple(map(int, worker.communicate(timeout=20)[0].split())) for worker in workers]
    assert [worker.returncode for worker in workers] == [0] * 4
    assert min(turns for turns, _ in counts) > 10
    assert sum(missed for _, missed in counts) == 0
    assert store.get("KEY") in made
    assert [path.name for path in (home / "models").iterdir()] == ["KEY"]


def test_a_manifest_of_another_format_is_not_read(home):
    store.put(KEY, artifact())
    path = home / "models" / KEY / "manifest.json"
    path.write_text(path.read_text().replace(f'"format": {FORMAT}', f'"format": {FORMAT + 1}'))
    assert store.get(KEY) is None


def test_a_manifest_survives_its_text():
    manifest = artifact().manifest
    assert Manifest.from_json(manifest.to_json()) == manifest


# --- compiling


def test_a_library_is_compiled_once(home, compiler, runs):
    path = store.library(C, compiler)
    assert len(runs) == 1
    assert store.library(C, compiler) == path
    assert len(runs) == 1
    function = ctypes.CDLL(str(path)).answer
    function.restype = ctypes.c_double
    assert function() == 42.0
    assert [p.name for p in (home / "libraries").iterdir()] == [path.name]


@pytest.mark.parametrize("damage", ["cut", "longer", "empty", "zeros", "missing", "a bit"])
def test_a_damaged_library_is_compiled_again(home, compiler, runs, damage):
    path = store.library(C, compiler)
    data = path.read_bytes()
    middle = len(data) // 2
    damages = {
        "cut": data[:middle],
        "longer": data + b"\0",
        "empty": b"",
        "zeros": bytes(len(data)),
        "a bit": data[:middle] + bytes([data[middle] ^ 1]) + data[middle + 1 :],
    }
    path.unlink()
    if damage in damages:
        path.write_bytes(damages[damage])
    assert store.library(C, compiler) == path
    assert len(runs) == 2
    function = ctypes.CDLL(str(path)).answer
    function.restype = ctypes.c_double
    assert function() == 42.0


def test_a_folder_for_libraries_that_cannot_be_made_is_told(home, compiler):
    home.mkdir(mode=0o700)
    (home / "libraries").write_text("")
    with pytest.raises(MachineError, match=r"libraries/.*\.so: cannot be put into the store: .*set LTCGEAR_CACHE"):
        store.library(C, compiler)


def test_a_model_is_compiled_once(home, runs):
    from ltcgear.runtime.model.building import build
    from ltcgear.symbolic.assembly import build_model
    from ltcgear.symbolic.emit.pipeline import generate
    from ltcgear.symbolic.scene.load import make_scene

    raw = {"title": "one", "rotors": {"a": {"inertia": "2 kg*m^2"}}}
    raw["loads"] = {"motor": {"member": "a", "torque": "1 N*m", "initial_speed": "1 rad/s"}}
    made = generate(build_model(make_scene(raw)))
    assert build(made).path == build(made).path
    assert len([command for command in runs if "-shared" in command]) == 1


def test_a_refused_text_leaves_a_log(home, compiler):
    with pytest.raises(CompileError) as caught:
        store.library(BROKEN, compiler)
    message = str(caught.value)
    log = Path(message.rsplit("log: ", 1)[1])
    assert compiler.path in message
    assert "exit code 1" in message
    assert log.parent == home / "libraries"
    text = log.read_text()
    assert "nonsense" in text
    assert "-O3" in text
    assert not list((home / "libraries").glob("*.so"))
    assert caught.value.exit_code == 3


def test_warnings_are_errors(home, compiler):
    with pytest.raises(CompileError):
        store.library("int f(void) { int x; return x; }\n", compiler)


def test_a_compiler_that_is_not_there(monkeypatch, fresh_compiler):
    monkeypatch.setenv("CC", "/nowhere/cc")
    with pytest.raises(CompileError, match="CC = /nowhere/cc: no such compiler"):
        store.compiler()


def test_a_compiler_by_name(monkeypatch, fresh_compiler, compiler):
    monkeypatch.setenv("CC", Path(compiler.path).name)
    store.compiler.cache_clear()
    assert store.compiler().path == compiler.path
    assert store.compiler().version


def test_no_compiler_is_no_error(monkeypatch, fresh_compiler, tmp_path):
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert store.compiler() is None


# --- whose folder it is


def test_the_store_is_private(home):
    assert store.root() == home
    assert home.stat().st_mode & 0o077 == 0


@pytest.mark.parametrize("mode", [0o720, 0o702, 0o777])
def test_a_folder_others_may_write_is_refused(home, mode):
    home.mkdir()
    home.chmod(mode)
    with pytest.raises(MachineError, match="others may write here; set LTCGEAR_CACHE"):
        store.root()
    with pytest.raises(MachineError, match="others may write here"):
        store.put(KEY, artifact())


def test_a_folder_of_somebody_else_is_refused(home, monkeypatch):
    store.root()
    monkeypatch.setattr(store.os, "getuid", lambda: home.stat().st_uid + 1)
    with pytest.raises(MachineError, match="others may write here"):
        store.root()


def test_a_store_that_cannot_be_made_is_told(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("LTCGEAR_CACHE", str(tmp_path / "file" / "store"))
    with pytest.raises(MachineError, match=r"the store cannot be used: .*set LTCGEAR_CACHE"):
        store.root()


def test_without_a_choice_the_store_is_the_user_s_cache(monkeypatch, tmp_path):
    monkeypatch.delenv("LTCGEAR_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME" if sys.platform == "linux" else "HOME", str(tmp_path))
    assert tmp_path in store.root().parents
