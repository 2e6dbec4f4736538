"""TOML parsing with bounds: text that would take a parser too long is refused by a scan before it runs."""

import re
import tomllib
from typing import Any

Raw = dict[str, Any]

MOST_PARTS = 10
"""Parts of a dotted key, and brackets open at the same time; the deepest key of a scene has seven parts."""
LONGEST_WORD = 200
"""Characters of a key or number without quotes."""
TEXTS = re.compile(  # an open one ends with the line or the file, so that every character is looked at once
    r'"""(?:\\.|"{1,2}(?!")|[^"\\])*+"{0,5}'
    r"|'''(?:'{1,2}(?!')|[^'])*+'{0,5}"
    r'|"(?:\\.|[^"\\\n])*+"?'
    r"|'[^'\n]*+'?"
    r"|\#[^\n]*+",
    re.DOTALL,
)
WORDS = re.compile(r"[\w+'-]++")
SPACES = re.compile(r"[^\S\n]++")
LONG_WORD = re.compile(rf"[\w+-]{{{LONGEST_WORD + 1}}}")
DEEP_KEY = re.compile(rf"(?:w?\.){{{MOST_PARTS}}}")
BRACKETS = re.compile(r"[\[\]{}]")


class TomlError(ValueError):
    """Text that is no TOML, or goes beyond all bounds."""


def parse_toml(text: str) -> Raw:
    """Return the tables of a TOML text.

    Raises
    ------
    TomlError
        If it is no TOML, or nests deeper or has longer keys than any scene.
    """
    fault = find_excess(text)
    if fault:
        raise TomlError(fault)
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise TomlError(f"not valid TOML: {error}") from error


def find_excess(text: str) -> str:
    """Say where a text goes beyond the bounds, with the cure; nothing where it does not.

    The time is in proportion to its length. A text in quotes or a comment counts as one letter.
    """
    bare = TEXTS.sub(lambda found: "'" + "\n" * found[0].count("\n"), text)
    long = LONG_WORD.search(bare)
    if long:
        return f"{_line(bare, long.start())}: a key or number has more than {LONGEST_WORD} characters; shorten it"
    bare = WORDS.sub("w", SPACES.sub("", bare))
    deep = DEEP_KEY.search(bare)
    if deep:
        what = f"a dotted key has more than {MOST_PARTS} parts; no key of a scene has"
        return f"{_line(bare, deep.start())}: nested too deeply, {what}"
    depth = 0
    for found in BRACKETS.finditer(bare):
        depth = depth + 1 if found[0] in "[{" else max(depth - 1, 0)
        if depth > MOST_PARTS:
            what = f"more than {MOST_PARTS} brackets are open; close them, no value of a scene needs as many"
            return f"{_line(bare, found.start())}: nested too deeply, {what}"
    return ""


def _line(text: str, at: int) -> str:
    """Name the line of a place in a text."""
    return f"line {text.count(chr(10), 0, at) + 1}"
