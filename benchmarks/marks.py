"""Marks: the places on pages of docs/ between which a benchmark puts its tables."""

from pathlib import Path

BEGIN, END = "<!-- {} -->\n", "<!-- end {} -->\n"


def put(page: Path, parts: dict[str, str]) -> None:
    """Put tables between their marks on a page, by name."""
    text = page.read_text("utf-8")
    for name, part in parts.items():
        before, rest = text.split(BEGIN.format(name))
        text = before + BEGIN.format(name) + part + END.format(name) + rest.split(END.format(name))[1]
    page.write_text(text, "utf-8")


def take(page: Path, name: str) -> str:
    """Return what stands between the marks of a name."""
    return page.read_text("utf-8").split(BEGIN.format(name))[1].split(END.format(name))[0]
