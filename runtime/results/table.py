"""Tables: small immutable results for terminals, pages, JSON, CSV and Markdown."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING, Any

from ltcgear.generated.text import write_out
from ltcgear.generated.writing import write_rows

if TYPE_CHECKING:
    from pathlib import Path

    from rich.console import Console, ConsoleOptions, RenderResult

Cell = str | int | float | None
NUMBER = re.compile(r"[-+]?[\d.]+(e[-+]?\d+)?( ?%)?|-?")
"""Text that is aligned as a number."""
WIDTH = 120
"""Columns of a table that is text."""
KEPT, GAP = 12, 3
"""Width up to which a column of words is not broken; space between columns."""


@dataclass(frozen=True)
class Table:
    """A titled table with notes.

    Attributes
    ----------
    title
        What the table shows, with its source.
    columns
        Heading of each column, units in square brackets.
    rows
        Rows of cells, each as long as `columns`; None is an empty cell.
    notes
        Remarks printed below the table.

    Raises
    ------
    ValueError
        If a row is not as long as `columns`.
    """

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for number, row in enumerate(self.rows, start=1):
            if len(row) != len(self.columns):
                raise ValueError(f"row {number} of {self.title!r} has {len(row)} cells for {len(self.columns)} columns")

    @property
    def numeric(self) -> tuple[bool, ...]:
        """Say of each column whether it has no words; such are aligned on the right."""
        columns = ([row[place] for row in self.rows] for place in range(len(self.columns)))
        return tuple(any(cells) and all(map(_is_number, cells)) for cells in columns)

    def to_json(self) -> dict[str, Any]:
        """Plain lists and dictionaries, numbers at full precision, NaN as null."""
        return {
            "title": self.title,
            "columns": list(self.columns),
            "rows": [[_plain(cell) for cell in row] for row in self.rows],
            "notes": list(self.notes),
        }

    def to_markdown(self) -> str:
        """Write headings and rows for a page in Markdown, cells as they are given, a dash for nothing."""
        head, *rows = (
            ("| " + " | ".join("-" if cell is None else str(cell) for cell in line) + " |\n").replace("  |", " |")
            for line in (self.columns, *self.rows)
        )
        return "".join([head, "|---" * len(self.columns), "|\n", *rows])

    def column(self, heading: str) -> tuple[Cell, ...]:
        """Cells of one column, top to bottom.

        Raises
        ------
        ValueError
            If there is no such column.
        """
        if heading not in self.columns:
            raise ValueError(f"no column {heading!r}; there are {', '.join(self.columns)}")
        place = self.columns.index(heading)
        return tuple(row[place] for row in self.rows)

    def write_csv(self, path: Path) -> Path:
        """Write headings and rows as a CSV file, numbers at full precision, nothing for an empty cell."""
        return write_rows([self.columns, *([_plain(cell) for cell in row] for row in self.rows)], path)

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        from rich.box import SIMPLE_HEAD
        from rich.table import Table as RichTable
        from rich.text import Text

        # Text throughout: rich would read "[Hz]" in a plain string as markup.
        broken = [any("\n" in str(row[place]) for row in self.rows) for place in range(len(self.columns))]
        table = RichTable(
            title=Text(write_out(self.title)),
            title_justify="left",
            box=SIMPLE_HEAD,
            show_edge=False,
            show_header=any(self.columns),
            show_lines=any(broken),
            pad_edge=False,
        )
        widths = [self._width(place) for place in range(len(self.columns))]
        whole = sum(map(max, widths, map(len, self.columns))) + GAP * (len(widths) - 1)
        for place, (heading, numeric) in enumerate(zip(self.columns, self.numeric, strict=True)):
            # Where room is short numbers keep theirs, below headings that break; of words, long ones give way.
            short = max([widths[place], *map(len, heading.split())])
            named = place == 0 or broken[place]
            table.add_column(
                Text(write_out(heading)),
                justify="right" if numeric else "left",
                width=short if numeric and whole > options.max_width else None,
                no_wrap=not numeric and (short <= KEPT or (named and 2 * short <= options.max_width)),
                overflow="fold",
            )
        for row in self.rows:
            table.add_row(*(Text(_shown(cell)) for cell in row))
        yield table
        yield from (Text(write_out(f"- {note}", keep="\n")) for note in self.notes)

    def _width(self, place: int) -> int:
        """Width of a column's widest line, its heading left out."""
        return max((len(line) for row in self.rows for line in _shown(row[place]).split("\n")), default=0)

    def to_html(self) -> str:
        """Write the table for a notebook, text escaped."""
        cells = "".join(
            f"<tr>{''.join(_html_cell(cell, right) for cell, right in zip(row, self.numeric, strict=True))}</tr>"
            for row in self.rows
        )
        head = "".join(f"<th>{escape(heading)}</th>" for heading in self.columns)
        notes = "".join(f"<p>{escape(note)}</p>" for note in self.notes)
        return f"<table><caption>{escape(self.title)}</caption><tr>{head}</tr>{cells}</table>{notes}"

    def _repr_html_(self) -> str:
        """Show the table in a notebook."""
        return self.to_html()

    def __str__(self) -> str:
        """Write the table as a terminal shows it."""
        from rich.console import Console

        console = Console(width=WIDTH, highlight=False, color_system=None)
        with console.capture() as written:
            console.print(self)
        return "\n".join(line.rstrip() for line in written.get().splitlines())

    def print(self, console: Console | None = None) -> None:
        """Print to a console, by default standard output."""
        from .terminal import Terminal

        (console or Terminal()).print(self)


def _html_cell(cell: Cell, right: bool) -> str:
    """Write a cell of HTML; line ends stay."""
    text = escape(_shown(cell)).replace("\n", "<br>")
    return f'<td style="text-align: right">{text}</td>' if right else f'<td style="text-align: left">{text}</td>'


def _is_number(cell: Cell) -> bool:
    """Return whether a cell is a number, or nothing, also where that is written out."""
    return not isinstance(cell, str) or NUMBER.fullmatch(cell) is not None


def _plain(cell: Cell) -> Cell:
    """Cell as strict JSON allows it."""
    return None if isinstance(cell, float) and not math.isfinite(cell) else cell


def _shown(cell: Cell) -> str:
    """Cell as a reader wants it: about as many digits as the paper prints, a dash for nothing."""
    if cell is None or (isinstance(cell, float) and math.isnan(cell)):
        return "-"
    if not isinstance(cell, float):
        return write_out(str(cell), keep="\n")
    size = abs(cell)
    if size >= 1e5:
        return f"{cell:.4e}"
    if size >= 1e3:
        return f"{cell:.2f}"
    return f"{cell:.5g}" if size >= 10.0 else f"{cell:.4g}" if size >= 1.0 else f"{cell:.3g}"
