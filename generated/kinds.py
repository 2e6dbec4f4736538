"""File types by their first bytes, so that no file is replaced by one of another type."""

import csv
from collections.abc import Callable
from itertools import islice
from pathlib import Path

SEEN = 65536
"""Bytes by which a file is known."""
LINES = 20
"""Lines by which a table is known."""
MARK = b"ltcgear"
"""Stands in all pages and books that ltcgear writes, so that nobody else's is taken for one."""


def _begins(*signs: bytes) -> Callable[[bytes], bool]:
    """Return what knows a kind by how its files begin."""
    return lambda head: head.startswith(signs)


def _is_page(head: bytes) -> bool:
    """Tell a page of ltcgear's."""
    return head.lstrip().lower().startswith((b"<!doctype html", b"<html")) and MARK in head


def _is_drawing(head: bytes) -> bool:
    """Tell an SVG."""
    return head.lstrip().startswith((b"<?xml", b"<svg")) and b"<svg" in head


def _is_book(head: bytes) -> bool:
    """Tell a book of ltcgear's in LaTeX."""
    return b"\\documentclass" in head and MARK in head


def _is_table(head: bytes) -> bool:
    """Tell a CSV: lines of equally many cells, two at least."""
    try:
        text = head.decode("utf-8", "strict" if len(head) < SEEN else "ignore")
        lines = text.splitlines()
        rows = list(csv.reader(islice(lines[:-1] if len(head) >= SEEN else lines, LINES), strict=True))
    except (UnicodeDecodeError, csv.Error):
        return False
    return len({len(row) for row in rows}) == 1 and len(rows[0]) > 1


KINDS: dict[str, tuple[str, Callable[[bytes], bool]]] = {
    ".nc": ("a NetCDF file", _begins(b"\x89HDF\r\n\x1a\n", b"CDF")),
    ".csv": ("a table", _is_table),
    ".json": ("JSON", lambda head: head.lstrip()[:1] in (b"{", b"[")),
    ".mat": ("a MAT file", _begins(b"MATLAB 5.0")),
    ".npz": ("a checkpoint", _begins(b"PK\x03\x04")),
    ".fmu": ("an FMU", _begins(b"PK\x03\x04")),
    ".png": ("a PNG", _begins(b"\x89PNG\r\n\x1a\n")),
    ".pdf": ("a PDF", _begins(b"%PDF-")),
    ".svg": ("an SVG", _is_drawing),
    ".html": ("a page of ltcgear's", _is_page),
    ".htm": ("a page of ltcgear's", _is_page),
    ".tex": ("a book of ltcgear's", _is_book),
}
"""Suffix -> what files of that name hold, and what knows them by their first bytes."""


def find_other_kind(path: Path) -> str:
    """Say what a file that is there is not, though its name says so; "" where it is, is empty, or is not there.

    Raises
    ------
    OSError
        If it cannot be read.
    """
    if path.suffix not in KINDS:
        return ""
    try:
        with path.open("rb") as file:
            head = file.read(SEEN)
    except FileNotFoundError:
        return ""
    what, knows = KINDS[path.suffix]
    return "" if not head or knows(head) else what
