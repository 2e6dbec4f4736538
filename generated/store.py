"""Store of generated models and compiled libraries by content key, private to the user."""

import contextlib
import fcntl
import hashlib
import os
import shlex
import shutil
import struct
import time
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path

import platformdirs

from .compiler import MORE_FLAGS as MORE_FLAGS
from .compiler import Compiler as Compiler
from .compiler import Ended, more_flags, run_compiler, seconds_for
from .compiler import compiler as compiler
from .contract import Artifact, Manifest
from .drafts import draft, tell_fault
from .errors import CompileError, MachineError
from .text import shorten
from .writing import told

FLAGS = (
    "-std=c11", "-O3", "-march=native", "-fPIC", "-shared", "-fno-semantic-interposition",
    "-fno-math-errno", "-Wall", "-Werror",
)  # fmt: skip
"""errno, and calls through tables between a library's own functions, only cost time."""
FOLDER = "LTCGEAR_CACHE"
"""Environment variable with the store's folder."""
LIBRARIES = ("-lm",)
PAUSE = 0.01
ELF = struct.Struct("<40xQ10xHH2x")
"""The head of a shared library: where its table of sections is, which is the last of it, their size and count."""
SEAL = hashlib.sha256().digest_size


def root() -> Path:
    """Return the store's folder, made with access for its owner only.

    Raises
    ------
    MachineError
        If it cannot be made, or belongs to somebody else: libraries are loaded from it.
    """
    chosen = os.environ.get(FOLDER)
    path = Path(chosen or platformdirs.user_cache_dir("ltcgear"))
    if not (chosen or path.is_absolute()):
        raise MachineError(f"this user has no home folder for the store; set {FOLDER} to a folder of yours")
    name = shorten(str(path))
    try:
        path = path.absolute()  # one folder, also where the working folder changes
        str(path).encode()
        path.mkdir(mode=0o700, parents=True, exist_ok=True)
        status = path.stat()
    except UnicodeEncodeError:
        raise MachineError(
            f"{name}: its name is no text in UTF-8 or in this locale; set {FOLDER} to another folder of yours"
        ) from None
    except OSError as error:
        why = "is no folder" if isinstance(error, FileExistsError | NotADirectoryError) else error.strerror or error
        raise MachineError(f"{name}: the store cannot be used: {why}; set {FOLDER} to a folder of yours") from error
    if status.st_uid != os.getuid() or status.st_mode & 0o022:
        raise MachineError(f"{name}: others may write here; set {FOLDER} to a folder that only you can write")
    return path


def digest(parts: Sequence[str]) -> str:
    """Return the key of some texts; each is counted with its length, so that borders matter."""
    state = hashlib.sha256()
    for part in parts:
        data = part.encode("utf-8", "surrogateescape")
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
    with draft(target.parent) as folder:
        new = folder / "new"
        new.mkdir()
        for name, text in files.items():
            (new / name).write_text(text, encoding="utf-8")
        with _alone(target.parent):
            if _holds(target, files):  # somebody else has put the same content meanwhile
                return
            with contextlib.suppress(FileNotFoundError):
                target.rename(folder / "replaced")
            try:
                new.rename(target)
            except OSError:
                if not target.is_dir():  # likewise, where files cannot be locked
                    raise


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
    with told(folder, tell=tell_fault):
        put_folder(folder, files(artifact))


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
        If the compiler refuses it or does not end; the message names the log that was kept.
    MachineError
        If the store cannot be written.
    """
    command = [*with_compiler.command, *flags()]
    key = digest([c, with_compiler.path, with_compiler.version, *command, *LIBRARIES, processor()])
    folder = root() / "libraries"
    target = folder / f"{key}.so"
    if not _sealed(target):
        with told(target, tell=tell_fault):
            _compile(with_compiler, c, target)
    return target


def _compile(with_compiler: Compiler, c: str, target: Path) -> None:
    """Compile a C text; the library appears whole or not at all."""
    with draft(target.parent) as folder:
        source, built = folder / "model.c", folder / "model.so"
        source.write_text(c, encoding="utf-8")
        command = [*with_compiler.command, *flags(), str(source), "-o", str(built), *LIBRARIES]
        ended = run_compiler(command, seconds_for(len(c)), folder)
        if ended.code != 0:
            cause = f" with {MORE_FLAGS} = {shorten(shlex.join(more_flags()))}" if more_flags() else ""
            log = _keep_log(target.with_suffix(".log"), shlex.join(command), ended)
            raise CompileError(f"{with_compiler.name} refused the generated C{cause} ({ended.how}){log}")
        check_library(built, with_compiler)
        _seal(built)
        built.replace(target)


def _keep_log(log: Path, command: str, ended: Ended) -> str:
    """Keep what a compiler said, and return where; nothing where there is no room for it."""
    try:
        log.write_bytes(f"{command}\n{ended.text}".encode("utf-8", "surrogateescape"))
    except OSError:
        return ""
    return f"; log: {log}"


def check_library(path: Path, made_by: Compiler) -> None:
    """Refuse what a compiler made without an error and is no whole shared library: to load it could end the process.

    Raises
    ------
    CompileError
        If the file is missing, or ends before its table of sections.
    """
    data = path.read_bytes() if path.is_file() else b""
    whole = len(data) >= ELF.size and data[:5] == b"\x7fELF\x02"
    if whole:
        table, size, count = ELF.unpack_from(data)
        whole = table + size * count <= len(data)
    if not whole:
        raise CompileError(f"{made_by.name} reported no error and made no whole library; correct CC or unset it")


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
