"""Machine description of a record of times."""

import os
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from ltcgear.generated import store

PACKAGES = ("ltcgear", "casadi", "numpy", "scipy", "sympy", "scikit-sundae")


def describe_machine() -> dict[str, object]:
    """Return processor, cores that may be used, load, system, compiler with its flags, and versions."""
    compiler = store.compiler()
    return {
        "processor": _processor(),
        "cores": len(os.sched_getaffinity(0)),
        "load": round(os.getloadavg()[0], 2),
        "system": f"{platform.system()} {platform.machine()}",
        "compiler": None if compiler is None else compiler.version.splitlines()[0],
        "flags": " ".join(store.flags()),
        "versions": {"python": platform.python_version()} | {name: _version(name) for name in PACKAGES},
    }


def _processor() -> str:
    """Return the processor's name."""
    try:
        lines = Path("/proc/cpuinfo").read_text("utf-8").splitlines()
    except OSError:
        return platform.processor()
    return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), platform.machine())


def _version(name: str) -> str | None:
    """Return the version of a package, None if it is not installed."""
    try:
        return version(name)
    except PackageNotFoundError:
        return None
