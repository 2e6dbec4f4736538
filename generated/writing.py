"""Output files: what may be overwritten, and files that are written whole or not at all.

An output never goes over a file that is read, nor over another kind of file, unless that is asked for (``--force``).
It is written to a draft beside it, made exclusively under a name that nobody can guess, which takes its place once it
is whole. A link is written through: the file that it names is replaced, the link stays.
"""

import contextlib
import csv
import errno
import hashlib
import os
import re
import secrets
import stat
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any

from .errors import LtcgearError, MachineError
from .kinds import find_other_kind

DRAFT, OURS = ".draft-", re.compile(r"\.draft-[0-9a-f]{8}-[0-9a-f]{16}(\..*)?")
"""How names of drafts begin, and what they are: a sign of the file, and what nobody can guess."""
ABANDONED = 3600.0
"""Seconds after which a draft that nobody writes to was left by a killed program."""
LONGEST_NAME = 255
"""Bytes of a file's name."""
FULL = {
    errno.ENOSPC: "the disk is full",
    errno.EDQUOT: "your share of the disk is used up",
    errno.EFBIG: "files may not be so large",
}
"""Error -> why there is no room."""
_forced: ContextVar[bool] = ContextVar("forced", default=False)


def force(wanted: bool = True) -> None:
    """Let outputs go over whatever is there from now on, or no longer."""
    _forced.set(wanted)


def is_forced() -> bool:
    """Say whether outputs may go over whatever is there."""
    return _forced.get()


def follow(path: Path) -> Path:
    """Return the file that is written where a path is given: what a link names."""
    return Path(os.path.realpath(path)) if path.is_symlink() else path


def check_output(path: Path, *sources: Path | str | None) -> None:
    """Refuse an output file that cannot or must not be written, before anything is computed.

    Parameters
    ----------
    path
        The file.
    sources
        Files that are read, which it must not be.

    Raises
    ------
    LtcgearError
        If it has no name that files can have, is no file, is one that is read, or holds another kind of file.
    MachineError
        If its folder cannot be written.
    """
    check_name(path)
    real = follow(path)
    with told(path):
        mode = _mode_of(real)
        if mode is not None and stat.S_ISDIR(mode):
            raise LtcgearError(f"{path}: is a folder; give a file name")
        if mode is not None and not stat.S_ISREG(mode):
            raise LtcgearError(f"{path}: is no file that can be replaced, but a device or a pipe; give a file name")
        for source in sources:
            if mode is not None and source is not None and _is_same(real, Path(source)):
                raise LtcgearError(f"{path}: is the file that is read; give another name")
        _check_folder(path, real.parent)
        other = "" if is_forced() else find_other_kind(real)
    if other:
        raise LtcgearError(f"{path}: holds something else than {other}; give another name, or --force to replace it")


def check_name(path: Path) -> None:
    """Refuse a name that no file can have: none, one that is too long, or one that is not UTF-8."""
    if not path.name or path.name == "..":
        raise LtcgearError(f"{str(path)!r}: is a folder; give a file name")
    try:
        length = len(str(path).encode() and path.name.encode())
    except UnicodeEncodeError:
        raise LtcgearError(f"{str(path)!r:.300}: is not UTF-8, as the names of outputs must be; give another") from None
    if not str(path).isprintable():
        raise LtcgearError(f"{str(path)!r:.300}: has characters that cannot be shown; give another name")
    if length > LONGEST_NAME:
        raise LtcgearError(f"{path.name[:60]}...: the name has {length} bytes, {LONGEST_NAME} at most; shorten it")


def _mode_of(path: Path) -> int | None:
    """Return what a path is, None where nothing is there."""
    try:
        return path.stat().st_mode
    except (FileNotFoundError, NotADirectoryError):
        return None


def _is_same(one: Path, two: Path) -> bool:
    """Say whether two paths are one file; what is not there, or no path at all, is none."""
    with contextlib.suppress(OSError, ValueError):
        return one.samefile(two)
    return False


def _check_folder(path: Path, folder: Path) -> None:
    """Refuse a folder that is missing or that cannot be written."""
    if not folder.is_dir():
        raise LtcgearError(f"{path}: the folder {folder.resolve()} does not exist; make it first")
    draft = make_draft(path)
    draft.unlink()


def tell_fault(path: Path, error: OSError, retry: str) -> str:
    """Say what keeps a file from being written, and what to do."""
    if error.errno in FULL:
        return f"{path}: cannot be written: {FULL[error.errno]}; make room, then {retry}"
    reason = error.strerror or str(error) or type(error).__name__
    return f"{path}: cannot be written: {reason}; see to that or give another name, then {retry}"


@contextmanager
def told(
    path: Path, retry: str = "run the same command again", tell: Callable[[Path, OSError, str], str] = tell_fault
) -> Iterator[None]:
    """Tell in one message what keeps a file from being written; ``retry`` goes on once that is mended.

    Raises
    ------
    MachineError
        In place of an OSError.
    """
    try:
        yield
    except OSError as error:
        raise MachineError(tell(path, error, retry)) from error


def make_draft(path: Path) -> Path:
    """Make the draft of a file, beside it: a new and empty file, never through a link, with the rights it shall have.

    Raises
    ------
    OSError
        If it cannot be made.
    """
    real = follow(path)
    draft = real.with_name(f"{_name_draft(real)}{secrets.token_hex(8)}{real.suffix[:16]}")
    handle = os.open(draft, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666)
    with contextlib.suppress(OSError):  # a file that is replaced keeps its rights; a new one has those of the umask
        os.fchmod(handle, stat.S_IMODE(real.stat().st_mode))
    os.close(handle)
    return draft


@contextmanager
def written_whole(path: Path, retry: str = "run the same command again") -> Iterator[Path]:
    """Give a draft to write to, which takes the place of a file once it is whole; the file appears whole or not at all.

    Parameters
    ----------
    path
        The file.
    retry
        What goes on once a fault was mended.

    Raises
    ------
    LtcgearError
        If it must not be written (see ``check_output``).
    MachineError
        If it cannot be written.
    """
    check_output(path)
    with told(path, retry=retry):
        real = follow(path)
        _sweep_up(real.parent)
        draft = make_draft(path)
        try:
            yield draft
            _put(draft, real)
        finally:
            draft.unlink(missing_ok=True)


def write_text(text: str, path: Path) -> Path:
    """Write a text in UTF-8; the file appears whole or not at all.

    Raises
    ------
    LtcgearError
        If it must not or cannot be written.
    """
    with written_whole(path) as draft:
        draft.write_text(text, encoding="utf-8", newline="")
    return path


def write_rows(rows: Iterable[Iterable[Any]], path: Path, **options: Any) -> Path:  # noqa: ANN401
    """Write rows as CSV; the file appears whole or not at all.

    Parameters
    ----------
    rows
        Rows of cells, the headings first.
    path
        The file.
    options
        Those of ``csv.writer``.

    Raises
    ------
    LtcgearError
        If it must not or cannot be written.
    """
    with written_whole(path) as draft, draft.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, **options).writerows(rows)
    return path


def _put(draft: Path, real: Path) -> None:
    """Let a draft take the place of a file, once it is on the disk: a power cut leaves the one or the other."""
    handle = os.open(draft, os.O_RDONLY | os.O_NOFOLLOW)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
    draft.replace(real)


def _name_draft(real: Path) -> str:
    """Return how the names of a file's drafts begin."""
    return f"{DRAFT}{hashlib.sha256(real.name.encode()).hexdigest()[:8]}-"


def remove_drafts(*paths: Path) -> None:
    """Remove drafts of files that nobody else writes now: killed programs left them."""
    for real in map(follow, paths):
        for draft in real.parent.glob(f"{_name_draft(real)}*"):
            with contextlib.suppress(OSError):
                draft.unlink()


def _sweep_up(folder: Path) -> None:
    """Remove drafts of this user's that nobody has written to for long: killed programs left them."""
    for draft in folder.glob(f"{DRAFT}*"):
        with contextlib.suppress(OSError):
            state = draft.lstat()
            ours = stat.S_ISREG(state.st_mode) and state.st_uid == os.getuid()
            if ours and OURS.fullmatch(draft.name) and time.time() - state.st_mtime > ABANDONED:
                draft.unlink()


def make_folder(path: Path) -> None:
    """Make a folder for outputs.

    Raises
    ------
    LtcgearError
        If it has a name that none can have, or is a file.
    MachineError
        If it cannot be made.
    """
    try:
        str(path).encode()
    except UnicodeEncodeError:
        raise LtcgearError(f"{str(path)!r:.300}: is not UTF-8, as the names of outputs must be; give another") from None
    try:
        path.mkdir(parents=True, exist_ok=True)
    except (FileExistsError, NotADirectoryError) as error:
        raise LtcgearError(f"{path}: is a file; give a folder") from error
    except OSError as error:
        raise MachineError(
            f"{path}: cannot be made: {error.strerror or error}; give another folder, or make room"
        ) from error
