"""The shared verdict: what an attack may come to, and how what a program left behind is judged."""

import re
from dataclasses import dataclass

RIGHT, REFUSED, STOPPED, SKIPPED = "right", "refused", "stopped", "skipped"
"""Done with the right numbers; refused with one message; a long run that Ctrl-C stopped; not possible here."""
TRACEBACK, HANG, WRONG, LOST, SIGNAL = "traceback", "hang", "wrong", "lost", "signal"
"""Another exception than ltcgear's own; no end; other numbers or a silent failure; rows gone; died by a signal."""
WELL, BAD = (RIGHT, REFUSED, STOPPED, SKIPPED), (TRACEBACK, HANG, WRONG, LOST, SIGNAL)
CODES = (0, 1, 2, 3, 130)
"""Exit codes of the command line."""
CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]")
"""What a message must not send to a terminal."""


@dataclass(frozen=True)
class Verdict:
    """What an attack came to, and why."""

    kind: str
    note: str = ""

    @property
    def bad(self) -> bool:
        return self.kind in BAD


@dataclass(frozen=True)
class Done:
    """What a program left: exit code, negative for a signal, None where it did not end; its texts."""

    code: int | None
    out: str
    err: str
    seconds: float = 0.0

    @property
    def last(self) -> str:
        """The end of its messages."""
        return self.err.strip()[-600:]


def judge(done: Done, allowed: tuple[int, ...] = CODES) -> Verdict | None:
    """Return what is bad about the way a program ended; None where nothing is."""
    if done.code is None:
        return Verdict(HANG, f"no end after {done.seconds:.0f} s: {done.last}")
    if "Traceback (most recent call last)" in done.err + done.out:
        return Verdict(TRACEBACK, done.last)
    if done.code < 0:
        return Verdict(SIGNAL, f"signal {-done.code}: {done.last}")
    if done.code not in allowed:
        return Verdict(TRACEBACK, f"exit code {done.code}: {done.last}")
    return None if done.code == 0 else judge_message(done.err, done.code)


def judge_message(text: str, code: int = 2) -> Verdict | None:
    """Return what is bad about the message of a refusal; None where nothing is."""
    if not text.strip():
        return Verdict(WRONG, f"exit code {code} without a message")
    found = CONTROL.search(text)
    return Verdict(WRONG, f"control character {found[0]!r} in the message: {text[:300]!r}") if found else None
