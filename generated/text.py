"""Foreign text (scenes, result files, compilers) made safe for terminals and messages."""

LONGEST = 600
"""Characters of a text in a message; of a longer one the beginning and the end are shown."""


def write_out(text: str, keep: str = "") -> str:
    """Write out what cannot be shown: control characters, bytes that are no text, marks that turn the direction.

    A terminal would obey them: an escape sequence can hide what a command says, or say something else.

    Parameters
    ----------
    text
        Any text.
    keep
        Characters that stay as they are, for example line ends of ltcgear's own.
    """
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() or c in keep else repr(c)[1:-1] for c in text)


def shorten(text: str) -> str:
    """Write out what cannot be shown, on one line of bounded length."""
    shown = write_out(text)
    half = LONGEST // 2
    return shown if len(shown) <= LONGEST else f"{shown[:half]} ... {shown[-half:]}"
