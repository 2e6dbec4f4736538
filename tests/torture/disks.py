"""Attack by full disks: what does not fit is told in one message, nothing is half-written, and with room it goes on."""

import ctypes
import os
import shutil
from functools import cache
from pathlib import Path

import numpy as np
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime import load, load_sweep

from .files import LONG, MADE, RESULT, SWEEP, SWEPT, originals, same
from .outcome import LOST, REFUSED, RIGHT, SKIPPED, TRACEBACK, WRONG, Done, Verdict, judge
from .process import Case, Program, run

SIZES = np.unique(np.geomspace(1, 1000, 26).round().astype(int)) * 4096
"""Room on the disks [bytes], 4 kB to 4 MB."""
ROOMY = 1 << 28
NEW_MOUNTS, NEW_USER, REMOUNT, PRIVATE = 0x20000, 0x10000000, 32, 1 << 14 | 1 << 18  # CLONE_NEWNS, _NEWUSER, MS_
TOLD = ("no space left", "full", "make room")
OFTEN = {"MARK_SECONDS": 0.0, "SLICE": 0.01}


def _mount(path: Path, size: int, flags: int = 0) -> None:
    """Mount a disk of its own that lives in memory, or give it another size."""
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.mount(b"none", bytes(path), b"tmpfs", flags, f"size={size}".encode()):
        raise OSError(ctypes.get_errno(), "mount")


def _alone() -> None:
    """See mounts of one's own, which end with this process; as the user who is root there, where one is not root."""
    libc, user, group = ctypes.CDLL(None, use_errno=True), os.getuid(), os.getgid()
    if libc.unshare(NEW_MOUNTS | (NEW_USER if user else 0)):
        raise OSError(ctypes.get_errno(), "unshare")
    if user:
        Path("/proc/self/setgroups").write_text("deny")
        Path("/proc/self/uid_map").write_text(f"0 {user} 1")
        Path("/proc/self/gid_map").write_text(f"0 {group} 1")
    if libc.mount(b"none", b"/", None, PRIVATE, None):
        raise OSError(ctypes.get_errno(), "mount")


@cache
def possible() -> str:
    """Say why no disk can be mounted here; "" where it can."""

    def tried() -> int:
        try:
            _alone()
            _mount(Path("/mnt"), 4096)
        except OSError as error:
            print(error)
            return 1
        return 0

    done = Program(tried, Path("/")).wait(20)
    return "" if done.code == 0 else f"no disk can be mounted here ({done.out.strip() or done.err.strip()})"


def prepare() -> None:
    """Make what the commands read."""
    originals()
    possible()


WAYS = ("simulate", "record", "sweep", "report", "figures", "export", "generate", "book", "store", "temporary")
STEPS = 6
COUNT = STEPS * len(WAYS)


def make_case(seed: int, number: int) -> Case:
    """Return an attack by a full disk: every way meets sizes from small to large, all ways together every size."""
    kind, step = number % len(WAYS), number // len(WAYS)
    place = step * len(SIZES) // STEPS + kind + int(np.random.default_rng([seed, number]).integers(3))
    size = int(SIZES[place % len(SIZES)])
    return Case(f"disk: {WAYS[kind]} on {size // 1024} kB", lambda folder: _attack(folder, WAYS[kind], size), 180.0)


def _attack(folder: Path, way: str, size: int) -> Verdict:
    """Run a command whose files go to a small disk; then make room and run it again."""
    if possible():
        return Verdict(SKIPPED, possible())
    _alone()
    disk = folder / "disk"
    disk.mkdir()
    for name in (RESULT, "going.part.nc", "going.checkpoint.npz"):
        shutil.copy(originals() / name, folder / name)
    _mount(disk, size)
    disk.chmod(0o700)
    arguments, again, options = _command(way, folder, disk)
    before = {path.name for path in disk.iterdir()}
    done = run(folder, *arguments, **options)
    bad = judge(done) or _told(done) or _half(done, disk, before)
    if bad:
        return bad
    if done.code == 0:
        return _right(way, disk) or Verdict(RIGHT, f"{size // 1024} kB are enough")
    _mount(disk, ROOMY, REMOUNT)
    checkpoint = (disk / "a.checkpoint.npz").exists()
    done = run(folder, *arguments, *(again if checkpoint else ()), **options)
    if bad := judge(done):
        return bad
    if done.code:
        return Verdict(
            LOST, f"with room, it does not go on ({'checkpoint there' if checkpoint else 'none'}): {done.last}"
        )
    return _right(way, disk) or Verdict(REFUSED, "and went on with room")


def _command(way: str, folder: Path, disk: Path) -> tuple[list[object], list[str], dict[str, object]]:
    """Return a command, what it takes to go on, and how it is run."""
    options: dict[str, object] = {}
    commands: dict[str, list[object]] = {
        "simulate": [*MADE, "-o", disk / "a.nc"], "record": [*LONG, "-o", disk / "a.nc"],
        "sweep": [*SWEEP, "-o", disk / "a.nc"], "report": ["report", folder / RESULT, "-o", disk / "a.html"],
        "figures": ["analyse", folder / RESULT, "-o", disk / "figures"],
        "export": ["export", folder / RESULT, "-o", disk / "a.csv"], "generate": ["generate", "psh", "-o", disk / "c"],
        "book": ["book", "psh", "-o", disk / "a.html"], "store": ["simulate", "psh", "--t-end", "0.01"],
        "temporary": ["export-fmu", "psh", "-o", folder / "a.fmu"],
    }  # fmt: skip
    if way == "record":
        options["settings"] = OFTEN
    if way in ("store", "temporary"):
        name = {"store": "LTCGEAR_CACHE", "temporary": "TMPDIR"}[way]
        options["prepared"] = lambda: os.environ.update({name: str(disk)})
    return commands[way], ["--resume"] if way in ("simulate", "record") else [], options


def _told(done: Done) -> Verdict | None:
    """Say where a failure does not tell that the disk is full."""
    if done.code and not any(text in done.err.lower() for text in TOLD):
        return Verdict(WRONG, f"does not tell that the disk is full: {done.last}")
    return None


def _half(done: Done, disk: Path, before: set[str]) -> Verdict | None:
    """Look for what was left half-written."""
    left = {path.relative_to(disk).as_posix() for path in disk.rglob("*") if path.is_file()} - before
    drafts = sorted(name for name in left if "draft" in name)
    if drafts:
        return Verdict(WRONG, f"drafts were left: {drafts}")
    if done.code and any(name in left for name in ("a.html", "a.csv", "a.fmu")):
        return Verdict(WRONG, f"exit code {done.code}, but a file was written: {sorted(left)}")
    if done.code and "a.nc" in left:
        try:
            load(disk / "a.nc")
        except LtcgearError as error:
            return Verdict(WRONG, f"half a result: {error}")
    return None


def _right(way: str, disk: Path) -> Verdict | None:
    """Compare what was written in the end with what is right."""
    wanted = {"simulate": RESULT, "record": "whole.nc", "sweep": SWEPT}.get(way)
    if wanted is None:
        return None
    reader = load_sweep if way == "sweep" else lambda path: load(path).dataset
    try:
        found = reader(disk / "a.nc")
    except LtcgearError as error:
        return Verdict(TRACEBACK, f"done, but cannot be read: {error}")
    difference = same(found, reader(originals() / wanted), timed=False)
    return Verdict(WRONG, f"other {difference}") if difference else None
