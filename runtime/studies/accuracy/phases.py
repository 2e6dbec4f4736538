"""Start-up times of a simulation, with and without the store."""

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter
from typing import Any

PROGRAM = "from ltcgear.runtime.cli.commands import main; main()"
PHASES = {
    "derive": ("load", "derive"),
    "check": ("check",),
    "emit": ("emit",),
    "compile": ("compile", "prepare"),
    "equilibrium": ("equilibrium",),
    "integrate": ("integrate",),
    "write": ("outputs", "write"),
}
"""Phases, and the stages of ``simulate`` that each is made of; the rest of the time goes to starting Python."""


def measure_phases(arguments: Sequence[str], t_end: float, method: str, rtol: float) -> dict[str, Any]:
    """Simulate into a file in a fresh store, then once more from it.

    Parameters
    ----------
    arguments
        The scene, and its changes as the command line takes them.
    t_end, method, rtol
        As for ``simulate``.

    Returns
    -------
    dict
        ``cold`` and ``warm``: seconds by phase (see ``PHASES``), ``start`` and ``total``; ``reason`` if one fails.
    """
    options = ["--t-end", repr(t_end), "--method", method, "--rtol", repr(rtol), "--json"]
    with tempfile.TemporaryDirectory(prefix="ltcgear-") as folder:
        command = [sys.executable, "-c", PROGRAM, "simulate", *arguments, *options, "-o", str(Path(folder, "run.nc"))]
        environment = os.environ | {"LTCGEAR_CACHE": str(Path(folder, "store"))}
        try:
            return {name: _run(command, environment) for name in ("cold", "warm")} | {"reason": None}
        except subprocess.CalledProcessError as error:
            return {"cold": None, "warm": None, "reason": error.stderr.strip()[-500:]}


def _run(command: list[str], environment: dict[str, str]) -> dict[str, float]:
    """Run a command and return its seconds by phase."""
    clock = perf_counter()
    run = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    total = perf_counter() - clock
    return sum_phases(json.loads(run.stdout)["seconds"], total)


def sum_phases(seconds: dict[str, float], total: float) -> dict[str, float]:
    """Return the seconds of each phase; what no stage accounts for is ``start``."""
    phases = {phase: sum(seconds.get(stage, 0.0) for stage in stages) for phase, stages in PHASES.items()}
    return {"start": total - sum(phases.values()), **phases, "total": total}
