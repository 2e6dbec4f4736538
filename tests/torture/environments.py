"""Attack by environments: variables, streams, limits and folders that programs rarely meet."""

import json
import os
import resource
import shutil
import stat
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache, partial
from pathlib import Path

from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime import load

from .files import MADE, RESULT, originals, same
from .outcome import LOST, REFUSED, RIGHT, SKIPPED, WRONG, Verdict, judge
from .process import Case, run
from .typed import start

MEGABYTE = 1 << 20
GONE = 'mkdir x && cd x && rmdir ../x && exec "$0" "$@"'
SIMULATE, REPORT, MODES, SCENES = (
    (*MADE, "-o", "a.nc"),
    ("report", RESULT, "-o", "a.html"),
    ("modes", "psh", "--json"),
    ("scenes",),
)
HELP, PAPER = ("--help",), ("check", "psh", "--json")


def _limit(kind: int, value: int) -> None:
    resource.setrlimit(kind, (value, value))


def _memory(megabytes: int) -> None:
    _limit(resource.RLIMIT_AS, megabytes * MEGABYTE)


def _mask(bits: int) -> None:
    os.umask(bits)


@dataclass(frozen=True)
class Environment:
    """Variables, what the shell does with the streams, limits, and what is done to the folder before.

    ``must`` says that the command must be done, since nothing that it needs is missing.
    """

    settings: dict[str, str | None] = field(default_factory=dict)
    redirect: str = ""
    limits: Callable[[], None] | None = None
    before: Callable[[Path], None] | None = None
    commands: tuple[tuple[str, ...], ...] = (SIMULATE,)
    must: bool = False
    private: bool = False
    launcher: tuple[str, ...] = ()


def _sealed(folder: Path) -> None:
    """Make the folder one that cannot be written; root may all the same."""
    folder.chmod(0o500)


def _as_nobody() -> None:
    """Give up root's rights, so that permissions count."""
    if os.getuid() == 0:
        os.setgroups([])
        os.setgid(65534)
        os.setuid(65534)


def _shadow(folder: Path) -> None:
    """Put modules with the names of libraries where the program is started."""
    for name in ("numpy", "json", "casadi", "ltcgear", "random", "typing"):
        (folder / f"{name}.py").write_text("raise SystemExit('the wrong module')\n")


def _settings(folder: Path) -> None:
    """Make settings of matplotlib's own, which no figure can follow."""
    (folder / "rc").write_text("text.usetex: True\nfont.size: big\n")


def _scene_named(name: str, folder: Path) -> None:
    (folder / name).mkdir()


ENVIRONMENTS = {
    "no HOME": Environment({"HOME": None}, must=True),
    "HOME missing, no store": Environment({"HOME": "/nowhere", "LTCGEAR_CACHE": None, "XDG_CACHE_HOME": None}),
    "HOME is a file": Environment({"HOME": "/etc/passwd", "LTCGEAR_CACHE": None, "XDG_CACHE_HOME": None}),
    "empty HOME": Environment({"HOME": "", "LTCGEAR_CACHE": None, "XDG_CACHE_HOME": None}),
    "TMPDIR missing": Environment({"TMPDIR": "/nowhere"}, must=True),
    "TMPDIR a file": Environment({"TMPDIR": "/etc/passwd"}, must=True, commands=(SIMULATE, REPORT)),
    "store a file": Environment({"LTCGEAR_CACHE": "/etc/passwd"}),
    "store below a file": Environment({"LTCGEAR_CACHE": "/etc/passwd/store"}),
    "store on proc": Environment({"LTCGEAR_CACHE": "/proc/store"}),
    "store with strange names": Environment({"LTCGEAR_CACHE": "störe \x1b[31m 'x' $(id)"}),
    "store that all may write": Environment(
        {"LTCGEAR_CACHE": "store"}, before=lambda folder: ((folder / "store").mkdir(), (folder / "store").chmod(0o777))
    ),
    "store relative": Environment({"LTCGEAR_CACHE": "store"}, must=True),
    "store a link to nowhere": Environment(
        {"LTCGEAR_CACHE": "store"}, before=lambda folder: (folder / "store").symlink_to("nowhere/at/all")
    ),
    "store a very long name": Environment({"LTCGEAR_CACHE": "s" * 5000}),
    "MPLBACKEND nonsense": Environment({"MPLBACKEND": "nonsense"}, must=True, commands=(SIMULATE, REPORT)),
    "MPLBACKEND of windows": Environment({"MPLBACKEND": "TkAgg", "DISPLAY": None}, must=True, commands=(REPORT,)),
    "MPLCONFIGDIR a file": Environment({"MPLCONFIGDIR": "/etc/passwd"}, must=True, commands=(REPORT,)),
    "matplotlibrc nonsense": Environment(
        {"MATPLOTLIBRC": "rc"}, before=_settings, commands=(REPORT,)
    ),
    "LANG=C": Environment({"LANG": "C", "LC_ALL": "C"}, must=True, commands=(SIMULATE, SCENES, MODES, REPORT)),
    "LANG of no language": Environment({"LC_ALL": "xx_YY.KOI99"}, must=True, commands=(SIMULATE, REPORT)),
    "LC_NUMERIC with a comma": Environment({"LC_ALL": "de_DE.UTF-8"}, must=True, commands=(SIMULATE, REPORT)),
    "texts in ASCII": Environment(
        {"PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0", "LC_ALL": "C"}, must=True,
        commands=(SIMULATE, SCENES, PAPER, ("info", "rig-2mw", "--sources"), ("effects",)),
    ),
    "texts in Latin 1": Environment({"PYTHONIOENCODING": "latin-1"}, must=True, commands=(SCENES, SIMULATE)),
    "stdout full": Environment(redirect="> /dev/full", commands=(SCENES, MODES, SIMULATE, HELP)),
    "stderr full": Environment(redirect="2> /dev/full", commands=(SCENES, SIMULATE, ("info", "nothing"))),
    "stdout closed": Environment(redirect=">&-", commands=(SCENES, SIMULATE, MODES)),
    "stderr closed": Environment(redirect="2>&-", commands=(SCENES, SIMULATE, ("info", "nothing"))),
    "stdin closed": Environment(redirect="<&-", must=True, commands=(SCENES, SIMULATE)),
    "all closed": Environment(redirect="<&- >&- 2>&-", commands=(SCENES, SIMULATE)),
    "reader gone": Environment(redirect="| true", commands=(SCENES, ("modes", "rig-2mw", "--json"), ("effects",))),
    "COLUMNS=1": Environment({"COLUMNS": "1", "LINES": "1"}, must=True, commands=(SCENES, SIMULATE, HELP)),
    "COLUMNS nonsense": Environment({"COLUMNS": "-7", "TERM": "nonsense"}, must=True, commands=(SCENES, HELP)),
    "TERM=dumb": Environment({"TERM": "dumb", "NO_COLOR": "1"}, must=True, commands=(SCENES, SIMULATE)),
    "colours forced": Environment({"FORCE_COLOR": "1", "CLICOLOR_FORCE": "1"}, must=True, commands=(SCENES, HELP)),
    "memory of 300 MB": Environment(limits=partial(_memory, 300), commands=(SIMULATE, SCENES)),
    "memory of 600 MB": Environment(limits=partial(_memory, 600), commands=(SIMULATE, REPORT)),
    "12 files open": Environment(limits=partial(_limit, resource.RLIMIT_NOFILE, 12), commands=(SIMULATE, REPORT)),
    "files of 100 kB": Environment(limits=partial(_limit, resource.RLIMIT_FSIZE, 100_000), commands=(SIMULATE, REPORT)),
    "small stack": Environment(limits=partial(_limit, resource.RLIMIT_STACK, 256 * 1024), commands=(SIMULATE, MODES)),
    "no core, no locks": Environment(limits=partial(_limit, resource.RLIMIT_MEMLOCK, 0), must=True),
    "umask 077": Environment(limits=partial(_mask, 0o077), must=True, private=True, commands=(SIMULATE, REPORT)),
    "umask 777": Environment(limits=partial(_mask, 0o777), commands=(SIMULATE,)),
    "folder that cannot be written": Environment(
        {"LTCGEAR_CACHE": None, "XDG_CACHE_HOME": "/nowhere"}, before=_sealed, limits=_as_nobody,
        commands=(SIMULATE, SCENES),
    ),
    "folder that is gone": Environment(launcher=("/bin/sh", "-c", GONE),
                                       commands=(SIMULATE, SCENES)),
    "folder with modules of libraries' names": Environment(before=_shadow, must=True, commands=(SCENES, SIMULATE)),
    "folder named like a scene": Environment(before=partial(_scene_named, "psh"), must=True),
    "PYTHONOPTIMIZE=2": Environment({"PYTHONOPTIMIZE": "2"}, must=True, commands=(SIMULATE, HELP, MODES)),
    "warnings are errors": Environment({"PYTHONWARNINGS": "error"}, must=True, commands=(SIMULATE, SCENES, REPORT)),
    "PYTHONSAFEPATH": Environment({"PYTHONSAFEPATH": "1", "PYTHONDONTWRITEBYTECODE": "1"}, must=True),
    "hash seed": Environment({"PYTHONHASHSEED": "4242"}, must=True),
    "debug allocators": Environment({"PYTHONMALLOC": "debug", "PYTHONDEVMODE": "1"}, must=True),
    "no threads": Environment({"OMP_NUM_THREADS": "0", "OPENBLAS_NUM_THREADS": "-3"}, must=True),
    "many threads": Environment({"OMP_NUM_THREADS": "99999", "OPENBLAS_NUM_THREADS": "64"}, must=True),
    "no PATH": Environment({"PATH": ""}),
    "HDF5 locks": Environment({"HDF5_USE_FILE_LOCKING": "nonsense"}, commands=(SIMULATE, REPORT)),
    "no time zone": Environment({"TZ": "Nowhere/At_All", "SOURCE_DATE_EPOCH": "0"}, must=True),
    "nobody": Environment({"LTCGEAR_CACHE": None, "HOME": "/", "USER": None, "LOGNAME": None}, limits=_as_nobody,
                          before=lambda folder: folder.chmod(0o777)),
    "LTCGEAR_CFLAGS nonsense": Environment({"LTCGEAR_CFLAGS": "--no-such-flag"}),
    "LTCGEAR_CFLAGS open quote": Environment({"LTCGEAR_CFLAGS": "'"}),
}  # fmt: skip
"""What the environment is -> the environment."""
NAMES = tuple(ENVIRONMENTS)
COUNT = len(NAMES)


@cache
def _right() -> dict[str, dict[str, float]]:
    done = run(originals(), *MODES)
    assert done.code == 0, done.err
    return json.loads(done.out)


def prepare() -> None:
    """Make what is compared with."""
    originals()
    _right()


def make_case(seed: int, number: int) -> Case:
    """Return an attack by an environment."""
    name = NAMES[number % COUNT]
    return Case(f"environment: {name}", lambda folder: _attack(folder, ENVIRONMENTS[name]), 300.0)


def _attack(folder: Path, environment: Environment) -> Verdict:
    """Run commands in an environment."""
    shutil.copy(originals() / RESULT, folder / RESULT)
    folder.parent.chmod(0o755)
    if environment.before:
        environment.before(folder)
    verdict = Verdict(RIGHT)
    for command in environment.commands:
        verdict = _run(folder, environment, command)
        if verdict.bad:
            return Verdict(verdict.kind, f"{' '.join(command)}: {verdict.note}")
    return verdict


def _run(folder: Path, environment: Environment, command: tuple[str, ...]) -> Verdict:
    """Run one command."""
    launcher = (*environment.launcher, str(Path(sys.executable).with_name("ltcgear"))) if environment.launcher else ()
    done = start(folder, *command, environment=environment.settings, redirect=environment.redirect,
                 limits=environment.limits, launcher=launcher, seconds=90)  # fmt: skip
    if done.code == 126:
        return Verdict(SKIPPED, "who has no rights may not even start the program here")
    silent = any(part in environment.redirect for part in ("2>", ">&- 2", "| true"))
    bad = judge(done)
    if bad and not (silent and "without a message" in bad.note):
        return bad
    if done.code and (environment.must and command != ("info", "nothing")):
        return Verdict(WRONG, f"nothing is missing, but it ends with {done.code}: {done.last}")
    drafts = [path.name for path in folder.rglob(".draft-*")] if os.access(folder, os.R_OK) else []
    if drafts:
        return Verdict(WRONG, f"left: {drafts}")
    if done.code:
        return Verdict(REFUSED, done.last)
    return _looked(folder, environment, command, done.out)


def _looked(folder: Path, environment: Environment, command: tuple[str, ...], out: str) -> Verdict:
    """Look at what a command that was done has left."""
    if environment.redirect.startswith(("> /dev/full", ">&-")) and command != SIMULATE:
        return Verdict(WRONG, "exit code 0, but nothing could be printed")
    if environment.private:
        open_files = [
            path.name
            for path in folder.iterdir()
            if path.name != RESULT and path.stat().st_mode & (stat.S_IRWXG | stat.S_IRWXO)
        ]
        if open_files:
            return Verdict(WRONG, f"others may read {open_files}")
    if command == MODES and not environment.redirect:
        found = [mode["frequency_hz"] for mode in json.loads(out)["modes"]]
        wanted = [mode["frequency_hz"] for mode in _right()["modes"]]
        if any(abs(a - b) > 1e-9 * abs(b) + 1e-6 for a, b in zip(found, wanted, strict=True)):
            return Verdict(WRONG, "other frequencies")
    if command == SIMULATE and not environment.launcher:
        return _simulated(folder / "a.nc")
    return Verdict(RIGHT)


def _simulated(path: Path) -> Verdict:
    """Compare a result with that of an ordinary environment; threads may round otherwise."""
    try:
        found = load(path).dataset
    except LtcgearError as error:
        return Verdict(LOST, f"done, but the result cannot be read: {error}")
    difference = same(found, load(originals() / RESULT).dataset, timed=False)
    path.unlink()
    return Verdict(WRONG, f"other {difference}") if difference else Verdict(RIGHT, "equal")
