"""Attack by compilers: such that are missing, lie, hang, chatter or die; none ends in a traceback or other numbers."""

import json
import os
import shutil
import signal
import subprocess
import time
from functools import cache
from pathlib import Path

from .outcome import HANG, REFUSED, RIGHT, WRONG, Verdict, judge
from .process import Case, run
from .typed import PROGRAM, start

CLOSE = 1e-9
ARGUMENTS = ("simulate", "psh", "--t-end", "0.01", "--json")
REAL = 'exec cc "$@"'
OUTPUT = 'for a; do [ "$p" = -o ] && o=$a; p=$a; done'
"""Finds what the compiler is to write."""
VERSION = 'if [ "$1" = --version ]; then echo "cc 12"; exit 0; fi'
SCRIPTS = {
    "fails": "exit 1",
    "does nothing": "exit 0",
    "says nothing of itself": f'[ "$1" = --version ] && exit 0\n{REAL}',
    "fails to say what it is": f'[ "$1" = --version ] && exit 1\n{REAL}',
    "prints bytes": f"head -c 3000 /dev/urandom\n{REAL}",
    "prints bytes and fails": f"{VERSION}\nhead -c 3000 /dev/urandom >&2\nexit 1",
    "prints 100 MB": f"{VERSION}\nhead -c 100000000 /dev/zero\n{REAL}",
    "prints 100 MB and fails": f"{VERSION}\nyes error | head -c 100000000 >&2\nexit 1",
    "prints escape sequences": f"{VERSION}\nprintf '\\033[31mred\\033[2J' >&2\nexit 1",
    "writes garbage": f"{VERSION}\n{OUTPUT}\nhead -c 9000 /dev/urandom > $o",
    "writes nothing into its file": f"{VERSION}\n{OUTPUT}\n: > $o",
    "writes text": f"{VERSION}\n{OUTPUT}\necho hello > $o",
    "writes half a library": f'{VERSION}\n{OUTPUT}\ncc "$@" && head -c 3000 $o > $o.x && mv $o.x $o',
    "writes another library": f"{VERSION}\n{OUTPUT}\necho 'int f(void){{return 1;}}' > x.c; cc -shared -fPIC x.c -o $o",
    "writes for another machine": f'{VERSION}\n{OUTPUT}\ncc "$@"; printf "\\267" | dd of=$o bs=1 seek=18 conv=notrunc',
    "writes a folder": f"{VERSION}\n{OUTPUT}\nmkdir $o",
    "writes and fails": f'{VERSION}\ncc "$@"\nexit 3',
    "writes what may not be read": f'{VERSION}\n{OUTPUT}\ncc "$@"; chmod 000 $o',
    "dies": f"{VERSION}\nkill -SEGV $$",
    "is killed": f"{VERSION}\nkill -9 $$",
    "dies saying what it is": "kill -SEGV $$",
    "leaves a child": f"{VERSION}\nsleep 300 &\n{REAL}",
    "leaves a child and fails": f"{VERSION}\nsleep 300 &\nexit 1",
    "is slow": f"sleep 2\n{REAL}",
    "warns": f"{VERSION}\necho warning >&2\n{REAL}",
    "reads its standard input": f"{VERSION}\ncat > /dev/null\n{REAL}",
    "deletes its source": f'{VERSION}\ncc "$@"; for a; do case $a in *.c) rm $a;; esac; done',
    "hangs saying what it is": "sleep 300",
    "hangs": f"{VERSION}\nsleep 300",
    "waits in vain": f"{VERSION}\ntail -f /dev/null",
}
"""What a compiler does -> the script that does it."""
NAMES = {
    "missing": "/nowhere/cc", "folder": ".", "empty": "", "blank": " ", "with arguments": "cc -pipe",
    "behind another": "env cc", "two words": "no such compiler", "quote left open": "cc '", "a space in its path": None,
    "not executable": None, "a link to itself": None, "no interpreter": None, "text that is no script": None,
    "a line break": "cc\nls", "escape sequence": "\x1b[31mcc", "very long": "c" * 5000, "an option": "--version",
    "a command": "cc; touch pwned", "a substitution": "$(touch pwned)", "the real one": "cc",
}  # fmt: skip
"""What CC says; None is made in the folder."""
CASES = (*SCRIPTS, *NAMES)
COUNT = len(CASES)
ALLOWED = {"LTCGEAR_COMPILE_SECONDS": "5"}
"""How long compilers may take that hang; one has no bound of its own, and is ended by Ctrl-C."""
BOUND = 25.0
"""Seconds after which that is pressed, which must end the program."""


@cache
def forces() -> dict[str, dict[str, float]]:
    """Return the mesh forces that a sound compiler leads to."""
    done = run(Path.cwd(), *ARGUMENTS)
    assert done.code == 0, done.err
    return json.loads(done.out)["forces"]


def prepare() -> None:
    """Simulate with a sound compiler."""
    forces()


def make_case(seed: int, number: int) -> Case:
    """Return an attack by a compiler."""
    name = CASES[number % COUNT]
    return Case(f"compiler: {name}", lambda folder: _attack(folder, name), 150.0)


def _make(folder: Path, name: str) -> str:
    """Make a compiler; return what CC says."""
    path = folder / "bin" / "my cc" if "space" in name else folder / "bin" / "mycc"
    path.parent.mkdir()
    if name in SCRIPTS:
        path.write_text(f"#!/bin/sh\n{SCRIPTS[name]}\n")
        path.chmod(0o755)
        return str(path)
    if NAMES[name] is not None:
        return NAMES[name]
    if name == "a link to itself":
        path.symlink_to(path)
        return str(path)
    path.write_text(
        {"no interpreter": "#!/nowhere/sh\n", "text that is no script": "\x7fELF"}.get(name, f"#!/bin/sh\n{REAL}\n")
    )
    path.chmod(0o644 if name == "not executable" else 0o755)
    return str(path)


def _store(folder: Path) -> Path:
    """Return a store that knows the models, and nothing compiled."""
    store = folder / "store"
    store.mkdir(mode=0o700)
    shutil.copytree(Path(os.environ["LTCGEAR_CACHE"]) / "models", store / "models")
    return store


def _attack(folder: Path, name: str) -> Verdict:
    """Simulate with a compiler."""
    environment = {"CC": _make(folder, name), "LTCGEAR_CACHE": str(_store(folder))}
    if name in ("hangs", "hangs saying what it is"):
        environment |= ALLOWED
    if name == "waits in vain":
        return _hanging(folder, environment)
    done = start(folder, *ARGUMENTS, environment=environment, seconds=90)
    if (folder / "pwned").exists():
        return Verdict(WRONG, "what CC says was run by a shell")
    if bad := judge(done):
        return bad
    drafts = [path.name for path in (folder / "store").rglob(".draft-*")]
    if drafts:
        return Verdict(WRONG, f"left in the store: {drafts}")
    logs = [path for path in (folder / "store").rglob("*.log") if path.stat().st_size > 1e7]
    if logs:
        return Verdict(WRONG, f"a log of {logs[0].stat().st_size / 1e6:.0f} MB was kept")
    if done.code:
        return Verdict(REFUSED, done.last)
    return _equal(json.loads(done.out)["forces"])


def _equal(found: dict[str, dict[str, float]]) -> Verdict:
    """Compare mesh forces with the right ones."""
    for mesh, wanted in forces().items():
        if abs(found[mesh]["mean"] - wanted["mean"]) > CLOSE * abs(wanted["mean"]):
            return Verdict(WRONG, f"{mesh}: mean force {found[mesh]['mean']}, with a sound compiler {wanted['mean']}")
    return Verdict(RIGHT, "the right forces")


def _hanging(folder: Path, environment: dict[str, str]) -> Verdict:
    """Wait for a compiler that never ends: it is given up, or Ctrl-C ends the program and what it started."""
    with subprocess.Popen(
        [PROGRAM, *ARGUMENTS], cwd=folder, env=os.environ | environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        stdin=subprocess.DEVNULL, text=True, start_new_session=True,
    ) as program:  # fmt: skip
        began = time.monotonic()
        while program.poll() is None and time.monotonic() < began + BOUND:
            time.sleep(0.05)
        waited = program.poll() is None
        os.killpg(program.pid, signal.SIGINT) if waited else None
        try:
            _, err = program.communicate(timeout=20)
        except subprocess.TimeoutExpired:
            os.killpg(program.pid, signal.SIGKILL)
            return Verdict(HANG, "Ctrl-C does not end it")
    if "Traceback" in err:
        return Verdict("traceback", err[-600:])
    return (
        Verdict(REFUSED, err.strip()[-300:])
        if program.returncode in (2, 3, 130)
        else Verdict(WRONG, f"{program.returncode}: {err}")
    )
