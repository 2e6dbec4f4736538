"""Terminal output: the one way by which text reaches the standard streams."""

import sys
from typing import Any

from ltcgear.generated.text import write_out
from rich.console import Console
from rich.markup import escape
from rich.text import Text

NARROWEST, WIDEST = 40, 1000
"""Columns below which tables would lose their cells; above which lines would only be padded."""


class Terminal(Console):
    """A console on which no text of a scene or a file can act: what cannot be shown is written out.

    Parameters
    ----------
    stderr
        Whether it writes to standard error.
    """

    def __init__(self, stderr: bool = False) -> None:
        super().__init__(highlight=False, stderr=stderr)
        self.width = min(max(self.width, NARROWEST), WIDEST)

    def render_str(self, text: str, **options: Any) -> Text:  # noqa: ANN401
        """Read markup; line ends stay, all else that cannot be shown is written out."""
        return super().render_str(write_out(text, keep="\n"), **options)


def plain(text: str) -> str:
    """Return a text of a scene or a file escaped for markup, on one line."""
    return escape(write_out(text))


def paragraph(text: str) -> str:
    """Return a message of ltcgear's own escaped for markup; its line ends are kept."""
    return escape(write_out(text, keep="\n"))


def say(text: str) -> None:
    """Print a line."""
    print(write_out(text))


def tell(text: str) -> None:
    """Print a message on standard error; its own line ends stay."""
    print(f"ltcgear: {write_out(text, keep=chr(10))}", file=sys.stderr)
