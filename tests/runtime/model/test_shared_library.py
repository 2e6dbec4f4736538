"""Loading compiled libraries: a damaged one is compiled once more, one that cannot be loaded is told.

What was loaded stays loaded until a process ends, and a library that was cut may end it: each case has its own process.
"""

import hashlib
import os
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest
from ltcgear import runtime, symbolic
from ltcgear.generated import store
from ltcgear.generated.errors import CompileError
from ltcgear.runtime.model.shared_library import load
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.scene.load import make_scene

SETUP = """
import numpy as np
from ltcgear.generated import store
from ltcgear.generated.errors import CompileError
from ltcgear.runtime.model.function import Kernel
from ltcgear.runtime.model.building import build
from ltcgear.runtime.simulation.smooth_arc import Frame
from ltcgear.runtime.simulation.methods.registry import ROSENBROCK
from ltcgear.runtime.simulation.methods.stepper import SegmentProblem

made = store.get("one")
p = np.ones(len(made.manifest.parameters))
folder = store.root() / "libraries"
compiled, real = [], store._compile
store._compile = lambda command, c, target: (compiled.append(target), real(command, c, target))


def whole(library):
    n = len(library.manifest.states)
    frame = Frame(np.zeros(n), np.ones(n))
    stepper = ROSENBROCK.make(SegmentProblem(library, p, 1e-6, frame, np.array([1.0]), None))
    arc = stepper.advance(np.zeros(n), 1e-3, np.zeros(n), np.zeros(len(library.manifest.levels)))
    z = arc.z[1:]
    assert np.isfinite(z).all() and stepper.counts.steps > 0
    return z


def rate(library):
    n = len(library.manifest.states)
    return Kernel(library.functions["rhs"])(np.zeros(n), np.zeros(0), p)[0].copy()


def paths():
    return set(folder.glob("*.so"))
"""

# The libraries of this store are made by one process, damaged by `with_damage` and used by another.
MAKE = """
library = build(made)
whole(library)
(other,) = paths() - {library.path}
print(library.path, other)
"""
USE = """
library = build(made)
values = rate(library), whole(library)
assert library.path.exists()
assert np.isfinite(np.concatenate([v.ravel() for v in values])).all()
print(len(compiled), len(paths()), len(list(folder.iterdir())))
"""


def python(code, home, **environment):
    run = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(SETUP) + textwrap.dedent(code)],
        env={**os.environ, "LTCGEAR_CACHE": str(home), **environment},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    return run.stdout.strip()


def sealed(data):
    return data + hashlib.sha256(data).digest()


@pytest.fixture(scope="module")
def artifact():
    raw = {"title": "one", "rotors": {"a": {"inertia": "2 kg*m^2"}}}
    raw["loads"] = {"motor": {"member": "a", "torque": "1 N*m", "initial_speed": "1 rad/s"}}
    return obtain(build_model(make_scene(raw)))


@pytest.fixture(scope="module")
def stored(tmp_path_factory, artifact):
    """A store with the library of a model and that of its whole integrator."""
    home = tmp_path_factory.mktemp("store")
    store.put_folder(home / "models" / "one", store.files(artifact))
    libraries = [Path(line) for line in python(MAKE, home).split()]
    return home, libraries, [path.read_bytes() for path in libraries]


@pytest.fixture(params=[0, 1], ids=["model", "integrator"])
def damaged(request, stored):
    """Damage one of the two libraries; returns the store."""
    home, paths, datas = stored

    def with_damage(change):
        for i, (path, data) in enumerate(zip(paths, datas, strict=True)):
            path.write_bytes(change(data, datas[1 - i]) if i == request.param else data)
        return home

    return with_damage


DAMAGES = {
    "empty": lambda data, other: b"",
    "header only": lambda data, other: data[:64],
    "half": lambda data, other: data[: len(data) // 2],
    "all but the end": lambda data, other: data[:-1],
    "whole, but no library": lambda data, other: sealed(b"no library"),
    "whole, but another library": lambda data, other: other,
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_library_is_compiled_once_more(damaged, damage):
    home = damaged(DAMAGES[damage])
    assert python(USE, home) == "1 2 2"
    assert python(USE, home) == "0 2 2"  # and was mended for good


def test_a_library_that_stays_loaded_does_not_stand_for_the_new_one(damaged):
    """The loader knows a path that it has loaded once, whatever is there now."""
    home = damaged(lambda data, other: other)
    hold = "import ctypes\nheld = [ctypes.CDLL(str(path)) for path in sorted(paths())]\n"
    assert python(hold + USE, home) == "1 2 2"


@pytest.mark.parametrize("part", ["model", "integrator"])
def test_a_library_that_cannot_be_loaded_is_told(tmp_path, artifact, part):
    home, cc = tmp_path / "store", tmp_path / "cc"
    home.mkdir(mode=0o700)
    store.put_folder(home / "models" / "one", store.files(artifact))
    wrong = "*" if part == "model" else "*ltcgear_read*"
    cc.write_text(
        textwrap.dedent(
            f"""\
            #!/bin/sh
            case "$*" in *--version*) echo strange; exit 0;; esac
            for last; do case "$previous" in -o) out=$last;; esac; previous=$last; done
            for c; do case "$c" in *.c) source=$c;; esac; done
            case "$(cat "$source")" in {wrong})
                echo 'int f(void); int (*g)(void) = f;' | cc -shared -fPIC -xc - -o "$out"
                exit;;
            esac
            exec cc "$@"
            """
        )
    )
    cc.chmod(0o755)
    code = """
    try:
        whole(build(made))
    except CompileError as error:
        assert error.exit_code == 3
        print(len(compiled), error)
    assert not [path for path in folder.iterdir() if path.suffix != ".so"]
    """
    text = python(code, home, CC=str(cc))
    assert text.startswith("2 " if part == "model" else "3 ")
    assert f"{home}/libraries/" in text
    assert ".so: cannot be loaded, not even compiled afresh" in text
    assert "the loader says: " in text
    assert "undefined symbol: f" in text


# --- the helper alone


def test_a_library_that_loads_is_made_once(tmp_path):
    made = []
    assert load(lambda: made.append(1) or tmp_path / "a.so", lambda path: path) == tmp_path / "a.so"
    assert made == [1]


@pytest.mark.parametrize("error", [OSError, RuntimeError, AttributeError])
def test_the_second_attempt_loads_the_new_file_from_another_path(tmp_path, error):
    target, seen = tmp_path / "a.so", []

    def make():
        if not target.exists():
            target.write_text("new")
        return target

    def loader(path):
        seen.append(path)
        if path.read_text() == "old":
            raise error("no")
        return path.read_text()

    target.write_text("old")
    assert load(make, loader) == "new"
    assert len(set(seen)) == 2
    assert list(tmp_path.iterdir()) == [target]


def test_there_are_two_attempts_and_no_more(tmp_path):
    target, seen = tmp_path / "a.so", []

    def loader(path):
        seen.append(path)
        raise OSError("the loader's words")

    with pytest.raises(CompileError, match=r"a\.so: cannot be loaded.*the loader's words"):
        load(lambda: target.write_text("x") and target, loader)
    assert len(seen) == 2
    assert list(tmp_path.iterdir()) == [target]


def test_what_the_compiler_refuses_is_told_as_such():
    def make():
        raise CompileError("refused")

    with pytest.raises(CompileError, match=r"^refused$"):
        load(make, lambda path: path)


@pytest.mark.parametrize("package", [runtime, symbolic])
def test_every_public_name_is_there(package):
    for name in package.__all__:
        assert callable(getattr(package, name))
    with pytest.raises(AttributeError, match="nothing"):
        _ = package.nothing
