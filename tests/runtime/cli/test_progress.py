"""Progress of a command on a terminal."""

import io
import sys

from ltcgear.runtime.cli.progress import progress

EVIL = "\x1b]0;owned\x07\x1b[2J\x9b31mred\u202egnp.\u2066x\x08\x7f[bold]\ud800"


def test_progress_shows_what_it_is_given_as_text(monkeypatch):
    class Screen(io.StringIO):
        def isatty(self):
            return True

    screen = Screen()
    monkeypatch.setattr(sys, "stderr", screen)
    monkeypatch.setenv("TERM", "xterm")
    with progress(f"sweep [red]{EVIL}", 2, "points") as told:
        told(1, f"note {EVIL}")
    assert "\x1b]0;" not in screen.getvalue()
    assert "\x07" not in screen.getvalue()
    assert "[red]" in screen.getvalue()
