"""Scenes as plain C, built by the system's compiler: programs, and libraries to call function by function."""

import ctypes
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from ltcgear.generated import folders, store
from ltcgear.runtime.export.plain_c.data import PlainRun, write_data
from ltcgear.runtime.export.plain_c.kit import write_kit

from .models import Case

UNUSED = ("-Wno-unused-parameter",)  # CasADi's functions have arguments that they do not use
STRICT = ("-std=c11", "-Wall", "-Wextra", "-Werror")
SANITIZERS = ("-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-pthread")
TAKER = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.c_void_p, ctypes.c_double, ctypes.POINTER(ctypes.c_double), ctypes.POINTER(ctypes.c_double)
)


def write(found: Case, folder: Path) -> Path:
    """Write all that plain C needs."""
    simulation = found.scene.simulation if found.scene else None
    t_end, rate = (simulation.t_end, simulation.rate) if simulation else (0.01, 8192.0)
    data = write_data(found.library, found.model.name, PlainRun(found.model.values(), found.model.tables, t_end, rate))
    folders.write_folder(folder, write_kit() | {"data.c": data, "model.c": found.library.artifact.c})
    return folder


def compiled(folder: Path, name: str, *flags: str, main: str | None = "main.c", kit: str | None = "ltcgear.c") -> Path:
    """Compile a folder's C, each file once; any warning is an error. Optimising the equations would take long."""
    compiler = store.compiler()
    if compiler is None:
        pytest.skip("no C compiler here")
    objects = []
    for source in filter(None, ("model.c", "data.c", kit, main)):
        objects.append(folder / f"{store.digest(flags)[:8]}-{source}.o")
        level = ("-O0", *UNUSED) if source == "model.c" else ("-O1",)
        if not objects[-1].exists():
            call(compiler.path, *STRICT, *level, *flags, "-c", folder / source, "-o", objects[-1])
    call(compiler.path, *flags, *objects, "-o", folder / name, "-lm")
    return folder / name


def can_sanitize(folder: Path) -> bool:
    """Tell whether the compiler comes with its sanitizers."""
    compiler, source = store.compiler(), folder / "nothing.c"
    source.write_text("int main(void) { return 0; }\n", "utf-8")
    command = [compiler.path if compiler else "cc", *SANITIZERS, str(source), "-o", str(folder / "nothing")]
    return compiler is not None and subprocess.run(command, capture_output=True, check=False).returncode == 0


def call(*command: str | Path) -> None:
    """Run a compiler, which may say nothing."""
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def program(folder: Path, *flags: str) -> Path:
    """Build the example."""
    return compiled(folder, "gearbox", *flags)


def library(found: Case, folder: Path) -> "Plain":
    """Build a library of a case."""
    return Plain(compiled(write(found, folder), "gearbox.so", "-fPIC", "-shared", main=None))


def execute(path: Path, *arguments: str, code: int = 0) -> tuple[str, str]:
    """Run a program where no Python, no CasADi and nothing else of this environment can be found."""
    bare = {name: os.environ[name] for name in ("ASAN_OPTIONS", "LSAN_OPTIONS") if name in os.environ}
    done = subprocess.run([str(path), *arguments], env=bare, cwd="/", capture_output=True, text=True, check=False)
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout, done.stderr


def forces(out: str) -> dict[str, np.ndarray]:
    """Mesh -> mean, root mean square, least and most force [N], load factor, as the example prints them."""
    rows = [line.split() for line in out.splitlines()[2:]]
    return {row[0]: np.array(row[1:], dtype=float) for row in rows}


class Plain:
    """The library of one scene, with the names of its header."""

    def __init__(self, path: Path) -> None:
        self.code = code = ctypes.CDLL(str(path))
        handle, real, whole = ctypes.c_void_p, ctypes.c_double, ctypes.c_longlong
        self.model = ctypes.addressof(ctypes.c_char.in_dll(code, "ltcgear_scene"))
        for name, result, arguments in (
            ("create", handle, (handle, real)), ("destroy", None, (handle,)), ("set", int, (handle, whole, real)),
            ("get", real, (handle, whole)), ("start", int, (handle, real)), ("advance", int, (handle, real)),
            ("steer", int, (handle, whole, real, real, real)), ("time", real, (handle,)),
            ("state", None, (handle, handle)), ("read", int, (handle, handle)), ("size", ctypes.c_size_t, (handle,)),
            ("save", None, (handle, handle)), ("restore", int, (handle, handle)), ("steps", whole, (handle,)),
            ("switchings", whole, (handle,)), ("record", int, (handle, real, real, TAKER, handle)),
            ("reason", ctypes.c_char_p, (ctypes.c_int,)), ("measure", int, (handle, real, handle)),
            ("measure_steady", int, (handle, real, real, handle)),
        ):  # fmt: skip
            function = getattr(code, f"ltcgear_{name}")
            function.argtypes, function.restype = arguments, ctypes.c_int if result is int else result
            setattr(self, name, function)

    def reasoned(self, status: int) -> str:
        """What a status means."""
        return str(self.reason(status).decode())


class One:
    """One run of a library."""

    def __init__(self, plain: Plain, found: Case, rtol: float = 1e-6) -> None:
        self.plain, self.found = plain, found
        self.names = [name for name, _ in found.library.manifest.parameters]
        self.handle = plain.create(plain.model, rtol)
        assert self.handle

    def __getattr__(self, name: str):
        return lambda *given: getattr(self.plain, name)(self.handle, *given)

    def put(self, **values: float) -> "One":
        for name, value in values.items():
            assert self.set(self.names.index(name.replace("__", ".")), value) == 0
        return self

    def begun(self, time: float = 0.0) -> "One":
        status = self.start(time)
        assert status == 0, self.plain.reasoned(status)
        return self

    @property
    def x(self) -> np.ndarray:
        x = np.zeros(len(self.found.library.manifest.states))
        self.state(x.ctypes.data)
        return x

    @property
    def y(self) -> np.ndarray:
        y = np.zeros(len(self.found.library.manifest.reports))
        assert self.read(y.ctypes.data) == 0
        return y

    def measured(self, until: float, start: float | None = None) -> np.ndarray:
        """Statistics of all mesh forces, as ``ltcgear_statistics`` has them, shape (meshes, 4)."""
        meshes = sum(report.quantity == "mesh_force" for report in self.found.library.manifest.reports)
        of = np.full((meshes, 4), np.nan)
        given = (until, of.ctypes.data)
        status = self.measure(*given) if start is None else self.measure_steady(start, *given)
        assert status == 0, self.plain.reasoned(status)
        return of

    def saved(self) -> bytes:
        room = ctypes.create_string_buffer(self.size())
        self.save(room)
        return room.raw

    def close(self) -> None:
        self.destroy()
