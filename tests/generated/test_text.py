"""Text of others on a terminal: control characters are written out."""

from ltcgear.generated.text import LONGEST, shorten, write_out

EVIL = "\x1b]0;owned\x07\x1b[2J\x9b31mred\u202egnp.\u2066x\x08\x7f[bold]\ud800"


def test_what_a_terminal_would_obey_is_written_out():
    shown = write_out(f"a\n{EVIL}µ°")
    assert shown.isprintable()
    assert shown.startswith(r"a\n\x1b]0;owned\x07")
    assert r"\u202e" in shown
    assert shown.endswith("µ°")
    assert write_out("a\n\x1b", keep="\n") == "a\n\\x1b"
    assert len(shorten("x" * 10_000)) <= LONGEST + 5
