"""Output folders: files written whole; files that a user has edited are not replaced."""

import hashlib
from pathlib import Path

from .errors import LtcgearError
from .writing import check_output, is_forced, make_folder, told, write_text

SUMS = "SHA256SUMS"
"""File with the digests of what was written, as ``sha256sum --check`` reads it."""


def write_folder(folder: Path, texts: dict[str, str]) -> None:
    """Write files into a folder of the user's, each one whole or not at all.

    Parameters
    ----------
    folder
        The folder; it is made where it is not there.
    texts
        File name -> text.

    Raises
    ------
    LtcgearError
        If a file must not be written.
    MachineError
        If one cannot be written.
    """
    make_folder(folder)
    for name, text in texts.items():
        write_text(text, folder / name)


def write_unchanged(folder: Path, texts: dict[str, str]) -> None:
    """Write files into a folder of the user's, in place of those that nobody has changed since they were written.

    What was written is noted in ``SHA256SUMS``.

    Parameters
    ----------
    folder, texts
        As for ``write_folder``.

    Raises
    ------
    LtcgearError
        If a file is there that was changed or is not ltcgear's, unless it is forced; nothing is written then.
    MachineError
        If a file cannot be read or written.
    """
    make_folder(folder)
    for name in (*texts, SUMS):
        check_output(folder / name)
    known, wanted = _read_sums(folder), {name: _digest(text.encode()) for name, text in texts.items()}
    with told(folder):
        there = {name: _digest((folder / name).read_bytes()) for name in texts if (folder / name).exists()}
    changed = [name for name, found in there.items() if found not in (known.get(name), wanted[name])]
    if changed and not is_forced():
        raise LtcgearError(
            f"{folder}: {', '.join(changed)} would be replaced, which ltcgear did not write or which was changed "
            "since; give another folder, or --force to replace"
        )
    lines = [f"{digest}  {name}\n" for name, digest in sorted((known | wanted).items())]
    write_folder(folder, texts | {SUMS: "".join(lines)})


def _digest(data: bytes) -> str:
    """Return the digest of a file's content."""
    return hashlib.sha256(data).hexdigest()


def _read_sums(folder: Path) -> dict[str, str]:
    """Return the digests of what was written, by file; none where they cannot be read."""
    try:
        lines = (folder / SUMS).read_text("utf-8").splitlines()
    except (OSError, ValueError):
        return {}
    found = (line.partition("  ") for line in lines)
    return {name: digest for digest, gap, name in found if gap and "/" not in name and (folder / name).exists()}
