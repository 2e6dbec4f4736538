"""Tables of pairs, in the scene itself or in a CSV file beside it, in SI."""

import csv
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

from pydantic import GetCoreSchemaHandler, ValidationInfo
from pydantic_core import core_schema

from . import units
from .ranges import RANGES, check_range
from .source_files import UnreadableError, read_bytes

Pairs = tuple[tuple[float, float], ...]
Reader = Callable[[object], float]

MOST_ROWS = 100_000
LARGEST_FILE = 10_000_000
MOST_TOLD = 5
"""Largest number of reported faults per table; the rest are counted."""
HEADING = re.compile(r"[^\[\]]*\S\s*\[([^\[\]]*)\]\s*")
PLAIN = ("", "1", "-")
"""How a header may write the unit of a plain number."""
FOLDER, FILES = "folder", "files"
"""Keys of pydantic's validation context: the folder of the scene file, and tables already read."""
Files = dict[tuple[str, str, str], Pairs]
"""Tables by name of the file and units of its columns."""


@dataclass(frozen=True)
class Series:
    """Marker of a field that is a table of pairs, its first column strictly ascending, kept in SI.

    A scene writes it as a list of pairs of texts with units, or as the name of a CSV file whose one header
    line names both columns with their units in brackets. A relative name is looked up in the folder that the
    validation context gives, else in the current one.

    Attributes
    ----------
    first, second
        SI units of the columns; ``""`` is a plain number.
    """

    first: str
    second: str

    def read(self, value: object, info: ValidationInfo) -> Pairs:
        """Read the table.

        Raises
        ------
        ValueError
            If the table is invalid; each line of the message gives row, reason and cure.
        """
        if isinstance(value, str):
            return self._kept_file(value, info.context or {})
        if not isinstance(value, list | tuple):
            raise ValueError(f"must be a list of pairs or the name of a CSV file, not {value!r:.60}; {self._example()}")
        rows = [(f"row {i}", row) for i, row in enumerate(value, start=1)]
        return _pairs(rows, (_in_unit(self.first), _in_unit(self.second)), self._example())

    def write(self, pairs: Pairs) -> list[list[str]]:
        """Return the table as a scene writes it."""
        return [[f"{a!r} {self.first}".strip(), f"{b!r} {self.second}".strip()] for a, b in pairs]

    def __get_pydantic_core_schema__(self, source: object, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        """Tell pydantic how to read and write the field."""
        write = core_schema.plain_serializer_function_ser_schema(self.write)
        return core_schema.with_info_plain_validator_function(self.read, serialization=write)

    def _example(self) -> str:
        """Say how a table is written."""
        zero, one = ([f"{n} {unit}".strip() for unit in (self.first, self.second)] for n in (0, 1))
        return f'write it like [["{zero[0]}", "{zero[1]}"], ["{one[0]}", "{one[1]}"]]'

    def _kept_file(self, name: str, context: Mapping[str, Any]) -> Pairs:
        """Read a CSV file, or return it from the cache."""
        files: Files | None = context.get(FILES)
        key = (name, self.first, self.second)
        if files is not None and key in files:
            return files[key]
        pairs = self._file(name, context.get(FOLDER, Path()))
        if files is not None:
            files[key] = pairs
        return pairs

    def _file(self, name: str, folder: Path) -> Pairs:
        """Read a CSV file."""
        shown = f"{name!r:.80}"
        reader = csv.reader(_text(folder / name, shown, self._example()).splitlines(), strict=True)
        try:
            lines = [(f"{shown} line {reader.line_num}", row) for row in reader if any(cell.strip() for cell in row)]
        except csv.Error as error:
            where = f"{shown} line {reader.line_num}"
            raise ValueError(f"{where}: is not CSV, {error}; separate columns by commas") from None
        first, second = self._factors(shown, lines[0][1] if lines else [])
        return _pairs(lines[1:], (_times(first, self.first), _times(second, self.second)), "write it like 0.5,1.2")

    def _factors(self, shown: str, header: Sequence[str]) -> list[float]:
        """Return the factors from the columns under a header to SI."""
        cure = f'begin the file with a line like "first [{self.first}],second [{self.second}]"'
        found = [HEADING.fullmatch(cell) for cell in header]
        if len(header) != 2 or not all(found):
            raise ValueError(f"{shown}: the header must name two columns with their units in brackets; {cure}")
        factors = []
        for given, unit in zip([match[1].strip() for match in found if match], (self.first, self.second), strict=True):
            try:
                factors.append(1.0 if not unit and given in PLAIN else units.parse(f"1 {given}", unit))
            except ValueError:
                due = f"a unit of {unit}" if unit else "a plain number, []"
                raise ValueError(f"{shown}: a column is in [{given:.40}], where {due} is due; {cure}") from None
        return factors


def _pairs(rows: Sequence[tuple[str, object]], read: tuple[Reader, Reader], example: str) -> Pairs:
    """Convert labelled rows, each number by its column's reader, and check their number and order."""
    if not 2 <= len(rows) <= MOST_ROWS:
        raise ValueError(f"has {len(rows)} row{'s' * (len(rows) != 1)}, must have 2 to {MOST_ROWS}; {example}")
    pairs: list[tuple[float, float]] = []
    faults: list[str] = []
    for label, row in rows:
        try:
            if not isinstance(row, list | tuple) or len(row) != 2:
                raise ValueError(f"must have two columns, not {row!r:.60}; {example}")
            pairs.append((read[0](row[0]), read[1](row[1])))
        except ValueError as error:
            faults.append(f"{label}: {error}")
    if not faults:
        faults = [
            f"{label}: the first column must ascend, but {here[0]:.12g} follows {before[0]:.12g} (in SI); "
            "sort the rows, and keep one of each"
            for (label, _), (before, here) in zip(rows[1:], pairwise(pairs), strict=True)
            if not here[0] > before[0]
        ]
    if faults:
        more = [f"and {len(faults) - MOST_TOLD} rows more with faults"] * (len(faults) > MOST_TOLD)
        raise ValueError("\n".join([*faults[:MOST_TOLD], *more]))
    return tuple(pairs)


def _in_unit(unit: str) -> Reader:
    """Return the reader of numbers in a scene: text with a unit, or a plain number for the unit ``""``."""
    return (lambda value: _within(units.parse(value, unit), unit, value)) if unit else _plain


def _times(factor: float, unit: str) -> Reader:
    """Return the reader of numbers in a CSV file."""
    return lambda text: _within(_plain(text, factor), unit, text)


def _within(number: float, unit: str, value: object) -> float:
    """Return a number if it is in the range of its unit."""
    if unit:
        check_range(number, unit, f"{value!r:.60}", RANGES[unit], positive=False)
    return number


def _plain(value: object, factor: float = 1.0) -> float:
    """Read a number without a unit, a text too."""
    text = repr(value) if isinstance(value, int | float) and not isinstance(value, bool) else value
    match = units.NUMBER.fullmatch(text) if isinstance(text, str) and len(text) <= 80 else None
    if match is None or match[2]:
        raise ValueError(f"{value!r:.60} is not a plain number; write it like 0.5 or -1.2e3")
    number = float(match[1]) * factor
    if number != 0.0 and not units.SMALLEST <= abs(number) <= units.LARGEST:
        raise ValueError(f"{value!r:.60} is out of all bounds ({units.SMALLEST:g} to {units.LARGEST:g} in SI)")
    return number


def _text(path: Path, shown: str, example: str) -> str:
    """Return the text of a CSV file; messages call it ``shown``."""
    try:
        data = read_bytes(path, LARGEST_FILE)
        if len(data) > LARGEST_FILE:
            raise ValueError(f"{shown}: is above {LARGEST_FILE // 1_000_000} MB; take fewer rows")
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError(f"{shown}: is not text in UTF-8; save it as CSV in UTF-8") from None
    except UnreadableError as error:
        raise ValueError(f"{shown}: {error}") from None
    except (FileNotFoundError, NotADirectoryError):
        cure = f"give the name of a CSV file beside the scene, or {example}"
        raise ValueError(f"{shown}: no such file; {cure}") from None
    except OSError as error:
        raise ValueError(f"{shown}: cannot be read: {error.strerror}; check its name and rights") from None
