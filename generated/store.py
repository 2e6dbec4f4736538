"""The store: generated models and compiled libraries by content key, private to the user, put atomically."""

import contextlib
import fcntl
import hashlib
import os
import shlex
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import platformdirs

from .contract import Artifact, Manifest
from .errors import CompileError, LtcgearError, MachineError

FLAGS = (
    "-std=c11", "-O3", "-march=native", "-fPIC", "-shared", "-fno-semantic-interposition",
    "-fno-math-errno", "-Wall", "-Werror",
)  # fmt: skip
"""errno, and calls through tables between a library's own functions, only cost time."""
MORE_FLAGS = "LTCGEAR_CFLAGS"
"""Environment variable with flags that come after these, and win."""
LIBRARIES = ("-lm",)
PAUSE = 0.01
SEAL = hashlib.sha256().digest_size


def root() -> Path:
    """Return the store's folder, made with access for its owner only.

    Raises
    ------
    MachineError
        If it cannot be made, or belongs to somebody else: libraries are loaded from it.
    """
    chosen = os.environ.get("LTCGEAR_CACHE")
    path = Path(chosen) if chosen else Path(platformdirs.user_cache_dir("ltcgear"))
    try:
        path.mkdir(mode=0o700, parents=True, exist_ok=True)
        status = path.stat()
    except OSError as error:
        raise MachineError(
            f"{path}: the store cannot be used: {error}; set LTCGEAR_CACHE to a folder of yours"
        ) from error
    if status.st_uid != os.getuid() or status.st_mode & 0o022:
        raise MachineError(f"{path}: others may write here; set LTCGEAR_CACHE to a folder that only you can write")
    return path


def digest(parts: Sequence[str]) -> str:
    """Return the key of some texts; each is counted with its length, so that borders matter."""
    state = hashlib.sha256()
    for part in parts:
        data = part.encode()
        state.update(f"{len(data)}:".encode())
        state.update(data)
    return state.hexdigest()


@contextlib.contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Keep other processes from changing what is in a folder; goes without where files cannot be locked."""
    handle = None
    try:
        with contextlib.suppress(OSError):
            handle = os.open(folder, os.O_RDONLY)
            fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        if handle is not None:
            os.close(handle)


def _holds(folder: Path, files: dict[str, str]) -> bool:
    """Tell whether a folder has just these files with just these texts."""
    try:
        return {path.name: path.read_bytes() for path in folder.iterdir()} == {
            name: text.encode() for name, text in files.items()
        }
    except OSError:
        return False


def put_folder(target: Path, files: dict[str, str]) -> None:
    """Write a folder, which appears with all files or not at all.

    An older folder of the same content stays untouched; one of another content, or a damaged one, is replaced.
    """
    if _holds(target, files):
        return
    target.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    draft = Path(tempfile.mkdtemp(dir=target.parent, prefix=".draft-"))
    try:
        (draft / "new").mkdir()
        for name, text in files.items():
            (draft / "new" / name).write_text(text, encoding="utf-8")
        with _alone(target.parent):
            if _holds(target, files):  # somebody else has put the same content meanwhile
                return
            with contextlib.suppress(FileNotFoundError):
                target.rename(draft / "replaced")
            try:
                (draft / "new").rename(target)
            except OSError:
                if not target.is_dir():  # likewise, where files cannot be locked
                    raise
    finally:
        shutil.rmtree(draft, ignore_errors=True)


def write_folder(target: Path, texts: dict[str, str]) -> None:
    """Write files into a folder of the user's, each one whole or not at all."""
    try:
        target.mkdir(parents=True, exist_ok=True)
        for name, text in texts.items():
            draft = target / f".draft-{os.getpid()}-{name}"
            draft.write_text(text, encoding="utf-8")
            draft.replace(target / name)
    except OSError as error:
        raise LtcgearError(f"{target}: cannot be written: {error.strerror}; give another folder") from error


def files(artifact: Artifact) -> dict[str, str]:
    """Return an artifact as file name -> text."""
    return {
        "model.c": artifact.c,
        "manifest.json": artifact.manifest.to_json(),
        "graphs.casadi": artifact.graphs,
    }


def model_folder(key: str) -> Path:
    """Return where the generated model of a key is kept."""
    return root() / "models" / key


def put(key: str, artifact: Artifact) -> None:
    """Keep a generated model under the key of what it was derived from.

    Raises
    ------
    MachineError
        If the store cannot be written.
    """
    folder = model_folder(key)
    try:
        put_folder(folder, files(artifact))
    except OSError as error:
        raise MachineError(
            f"{folder}: cannot be written: {error.strerror or error}; make room or remove it, or set LTCGEAR_CACHE"
        ) from error


def _read(folder: Path) -> Artifact:
    """Read a generated model; OSError if it cannot be read, ValueError if it is damaged."""
    c, manifest, graphs = ((folder / n).read_text("utf-8") for n in ("model.c", "manifest.json", "graphs.casadi"))
    try:
        artifact = Artifact(c, Manifest.from_json(manifest), graphs)
    except (LookupError, TypeError, AttributeError) as error:
        raise ValueError("not a manifest") from error
    if digest([c, graphs]) != artifact.manifest.key:
        raise ValueError("not the texts that the manifest was written for")
    return artifact


def get(key: str) -> Artifact | None:
    """Return the generated model of a key, None where there is none that can be read.

    A damaged one is removed, but only once it is certain that nobody was just replacing it.
    """
    folder = model_folder(key)
    try:
        return _read(folder)
    except FileNotFoundError:
        time.sleep(PAUSE)
    except (OSError, ValueError):
        pass
    with _alone(folder.parent):
        try:
            return _read(folder)
        except (FileNotFoundError, ValueError):
            shutil.rmtree(folder, ignore_errors=True)
        except OSError:  # not ours to read now, which does not mean that it is damaged
            pass
    return None


@dataclass(frozen=True)
class Compiler:
    """A C compiler: path and what it says of itself."""

    path: str
    version: str


@cache
def compiler() -> Compiler | None:
    """Return the C compiler: that of the environment variable CC, else cc, gcc or clang; None without one.

    Raises
    ------
    CompileError
        If CC names a compiler that is not there.
    """
    wanted = os.environ.get("CC")
    path = next((p for p in map(shutil.which, [wanted] if wanted else ["cc", "gcc", "clang"]) if p), None)
    if path is None:
        if wanted:
            raise CompileError(f"CC = {wanted}: no such compiler; correct CC or unset it")
        return None
    version = subprocess.run([path, "--version"], capture_output=True, text=True, check=False).stdout
    return Compiler(path, version)


def more_flags() -> tuple[str, ...]:
    """Return the flags of the environment variable LTCGEAR_CFLAGS, split as a shell does.

    Raises
    ------
    CompileError
        If a quote is not closed.
    """
    given = os.environ.get(MORE_FLAGS, "")
    try:
        return tuple(shlex.split(given))
    except ValueError as error:
        raise CompileError(f"{MORE_FLAGS} = {given}: {error}; correct it or unset it") from error


def flags() -> tuple[str, ...]:
    """Return the flags by which libraries are compiled."""
    return (*FLAGS, *more_flags())


@cache
def processor() -> str:
    """Return what tells processors apart for -march=native."""
    try:
        lines = Path("/proc/cpuinfo").read_text("utf-8").splitlines()
    except OSError:
        import platform

        return platform.processor() + platform.machine()
    return "\n".join(line for line in dict.fromkeys(lines) if line.startswith(("model name", "flags", "Features")))


def library(c: str, with_compiler: Compiler) -> Path:
    """Return the shared library of a C text, compiled on first use and again where the file has been damaged.

    Raises
    ------
    CompileError
        If the compiler refuses it; the message names the log that was kept. Or if the store cannot be written.
    """
    command = [with_compiler.path, *flags()]
    key = digest([c, with_compiler.path, with_compiler.version, *command, *LIBRARIES, processor()])
    folder = root() / "libraries"
    target = folder / f"{key}.so"
    if _sealed(target):
        return target
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        _compile(command, c, target)
    except OSError as error:
        raise CompileError(f"{target}: cannot be made: {error}; make room or set LTCGEAR_CACHE") from error
    return target


def _compile(command: list[str], c: str, target: Path) -> None:
    """Compile a C text; the library appears whole or not at all."""
    with tempfile.TemporaryDirectory(dir=target.parent, prefix=".draft-") as draft:
        source, built = Path(draft, "model.c"), Path(draft, "model.so")
        source.write_text(c, encoding="utf-8")
        run = subprocess.run(
            [*command, str(source), "-o", str(built), *LIBRARIES], capture_output=True, text=True, check=False
        )
        if run.returncode != 0:
            log = target.with_suffix(".log")
            log.write_text(f"{' '.join(run.args)}\n{run.stdout}{run.stderr}", encoding="utf-8")
            cause = f" with {MORE_FLAGS} = {' '.join(more_flags())}" if more_flags() else ""
            raise CompileError(f"{command[0]} refused the generated C{cause} (exit code {run.returncode}); log: {log}")
        _seal(built)
        built.replace(target)


def _seal(path: Path) -> None:
    """Append a file's digest to it; the loader of shared libraries does not mind."""
    seal = hashlib.sha256(path.read_bytes()).digest()
    with path.open("ab") as file:
        file.write(seal)


def _sealed(path: Path) -> bool:
    """Tell whether a file is whole: to load one that was cut can end the process by a signal, without exception."""
    try:
        data = path.read_bytes()
    except OSError:
        return False
    return hashlib.sha256(data[:-SEAL]).digest() == data[-SEAL:]
