"""TOML parsing with bounds: a scan refuses text that would take the parser too long."""

import re
import tomllib
from typing import Any

Raw = dict[str, Any]

MOST_PARTS = 10
"""Largest number of parts of a dotted key, and of open brackets; the deepest key of a scene has seven parts."""
LONGEST_WORD = 200
"""Largest length of an unquoted key or number."""
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
    """Text that is not TOML, or exceeds the bounds."""


def parse_toml(text: str) -> Raw:
    """Return the tables of a TOML text.

    Raises
    ------
    TomlError
        If it is not TOML, or nests deeper or has longer keys than any scene.
    """
    fault = find_excess(text)
    if fault:
        raise TomlError(fault)
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise TomlError(f"not valid TOML: {error}") from error


def find_excess(text: str) -> str:
    """Say where a text exceeds the bounds, with the cure; empty if it does not.

    The time is proportional to its length. A quoted text or a comment counts as one character.
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
    """Return the line of a position in a text, in words."""
    return f"line {text.count(chr(10), 0, at) + 1}"
