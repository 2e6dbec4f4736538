"""Memory and disk space that the samples of a run take."""

import os
import shutil
from pathlib import Path

from ltcgear.generated.errors import LtcgearError, MachineError
from ltcgear.generated.writing import follow

from ..model.library import Library
from ..results.dataset import columns_of
from ..results.samples import no_rows

MEMINFO = Path("/proc/meminfo")
LIMITS = (
    (Path("/sys/fs/cgroup"), "memory.max", "memory.current"),
    (Path("/sys/fs/cgroup/memory"), "memory.limit_in_bytes", "memory.usage_in_bytes"),
)
"""Files with the memory limit and use of a container: control groups of version 2 and 1."""
SHARE = 0.8
"""Share of what is free that a run may take."""
GIGA, MEGA = 1e9, 1e6


def bytes_in_memory(library: Library, samples: float) -> float:
    """Return what a run takes at most that keeps its samples: its rows, and the same once more while they are joined.

    A row is time, number, steps, states, levels and outputs. Once joined, the outputs are copied to their quantities,
    which is less than what the pieces took (measured on five scenes: 1.01 to 1.08 of this).
    """
    manifest = library.manifest
    row = 8 * (3 + sum(map(len, (manifest.states, manifest.levels, manifest.reports))))
    return 2 * row * samples


def bytes_on_disk(library: Library, samples: float) -> float:
    """Return what a result file takes while it is written: its part, and the file itself, which is copied from it."""
    columns = columns_of(library, no_rows(library)).values()
    sizes = [(array.shape[1] if array.ndim > 1 else 1, array.dtype) for array in columns]
    return samples * sum(count * ((8 if kind.kind == "f" else 4) + kind.itemsize) for count, kind in sizes)


def free_memory() -> float:
    """Return the memory [bytes] that a program can still have: what the system has free, and its container's limit."""
    try:
        text = MEMINFO.read_text("ascii")
        free = 1024.0 * float(text.partition("MemAvailable:")[2].split()[0])
    except (OSError, ValueError, IndexError):
        free = float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    for folder, most, used in LIMITS:
        try:
            limit, taken = (float((folder / name).read_text("ascii")) for name in (most, used))
            cached = (folder / "memory.stat").read_text("ascii").partition("inactive_file ")[2].split()[0]
        except (OSError, ValueError, IndexError):  # no control groups, or "max"
            continue
        free = min(free, limit - taken + float(cached))  # what is cached of files is given back
    return max(free, 0.0)


def check_size(library: Library, samples: float) -> None:
    """Refuse a run of more than the memory holds."""
    need, have = bytes_in_memory(library, samples), free_memory()
    if need > SHARE * have:
        raise LtcgearError(
            f"the run would take {need / GIGA:.3g} GB of {have / GIGA:.3g} GB memory that is free; lower t_end or "
            "rate, or write it to a file (simulate -o FILE.nc, or record)"
        )


def check_room(library: Library, samples: float, target: Path) -> None:
    """Refuse a result file that the disk of its folder cannot hold."""
    need, have = bytes_on_disk(library, samples), float(shutil.disk_usage(follow(target).parent).free)
    if need > have:
        raise MachineError(
            f"{target}: the disk is full: the result would take {need / MEGA:.3g} MB, and {have / MEGA:.3g} MB are "
            "free; make room, then run the same command again, or lower t_end or rate, or name a file elsewhere"
        )
