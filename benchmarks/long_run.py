"""Long runs: mean mesh forces, memory and switchings over very many turns of the LSP ring.

Run as ``python -m benchmarks.long_run``; it takes some ten minutes and writes the tables of docs/long-run.md.
"""

from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from ltcgear.runtime.model.building import build
from ltcgear.runtime.model.equilibrium import find_equilibrium
from ltcgear.runtime.model.library import Library
from ltcgear.runtime.model.operating_point import OperatingPoint
from ltcgear.runtime.model.phase_wrapping import Clocks
from ltcgear.runtime.results.table import Table
from ltcgear.runtime.simulation.integrate import integrate
from ltcgear.runtime.simulation.output_reader import outputs_of
from ltcgear.runtime.simulation.run_settings import RunSettings
from ltcgear.runtime.simulation.trajectory import Trajectory
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.scene.load import load_scene

PAGE = Path(__file__).resolve().parents[1] / "docs" / "long-run.md"
BEGIN, END = "<!-- long run -->\n", "<!-- end -->\n"
RPM, TEETH, APART = 6000, 118, 4
"""Speed of the ring, its teeth, and turns of the ring from sample to sample (and a sixteenth of a pitch more)."""
PERIOD = 60 / RPM
SPACING = PERIOD * (APART + 1 / (16 * TEETH))
SETTLING, WINDOW = 200, 1000
CHEAP = {"effects.lateral": "off", "loads.ring.speed": f"{RPM} rpm"}
SMOOTH = CHEAP | {"effects.mesh_stiffness": "fourier"} | {
    f"stages.lsp.{mesh}.harmonics": "1" for mesh in ("sun_planet", "ring_planet")
}  # fmt: skip
TURNS, SWITCHED_TURNS = 100_000, 300
RTOL = 1e-7


@dataclass(frozen=True)
class Run:
    """A long run: forces [N] over time and meshes, what it cost, and resident memory [MB] at instants [s]."""

    forces: np.ndarray
    path: Trajectory
    seconds: float
    memory: tuple[tuple[float, float], ...]

    def means(self, turns: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the mean mesh forces [N] over the first and the last turns; 16 samples divide a pitch evenly."""
        start, count = SETTLING // APART, 16 * round(turns / APART / 16)
        return self.forces[start : start + count].mean(axis=0), self.forces[-count:].mean(axis=0)


def resident() -> float:
    """Return the memory that the process holds [MB]."""
    pages = int(Path("/proc/self/statm").read_text("ascii").split()[1])
    return pages * 4096 / 1e6


def run(settings: dict[str, str], turns: float, method: str = "erk") -> Run:
    """Simulate the LSP, one sample every four turns."""
    model = build_model(load_scene("lsp", settings))
    library = build(obtain(model))
    p, seen = library.parameters(model.values()), []
    at = find_equilibrium(library, p)
    clock = perf_counter()
    settings = RunSettings(turns * PERIOD, 1 / SPACING, method, RTOL)
    path = integrate(OperatingPoint(library, p, at), settings, lambda time: seen.append((time, resident())))
    seconds = perf_counter() - clock
    if path.status != "done":
        raise RuntimeError(path.status)
    return Run(mesh_forces(library, p, path), path, seconds, tuple(seen))


def mesh_forces(library: Library, p: Any, path: Trajectory) -> np.ndarray:  # noqa: ANN401
    """Return all mesh forces [N], shape (times, meshes)."""
    rows = [i for i, report in enumerate(library.manifest.reports) if report.quantity == "mesh_force"]
    return outputs_of(library, Clocks(library.manifest, p), path)[:, rows]


def drift(found: Run, turns: int = WINDOW) -> float:
    """Return how far the mean forces of the last turns lie from those of the first, relative, the worst mesh."""
    early, late = found.means(turns)
    return float(np.abs(late / early - 1).max())


def table(smooth: Run, switched: Run) -> str:
    """Return the tables in Markdown."""
    settled = [memory for time, memory in smooth.memory if time > 0.01 * TURNS * PERIOD]
    counts = smooth.path.counts
    steps, kept = counts.steps / (TURNS * TEETH), smooth.path.x.nbytes / 1e6
    one = (
        ("turns", TURNS),
        ("pitches", TURNS * TEETH),
        ("steps a pitch", f"{steps:.1f}"),
        (f"mean force, last {WINDOW} turns against first, worst mesh", f"{drift(smooth):.1e}"),
        ("samples kept [MB]", f"{kept:.1f}"),
        ("memory, growth over the last 99 % [MB]", f"{max(settled) - settled[0]:.1f}"),
        ("minutes", f"{smooth.seconds / 60:.1f}"),
    )
    two = (
        ("turns", SWITCHED_TURNS),
        ("switchings", switched.path.counts.events),
        ("switchings by kinematics", switched.path.expected_events),
        ("segments", switched.path.counts.segments),
        ("minutes", f"{switched.seconds / 60:.1f}"),
    )
    titles = "LSP ring, torsional, stiffness with one harmonic", "the same with jumps between two levels"
    return "\n".join(Table("", (title, ""), rows).to_markdown() for title, rows in zip(titles, (one, two), strict=True))


def main() -> None:
    """Measure, print the tables and write the page."""
    made = table(run(SMOOTH, TURNS), run(CHEAP, SWITCHED_TURNS))
    print(made)
    before, rest = PAGE.read_text("utf-8").split(BEGIN)
    PAGE.write_text(before + BEGIN + made + END + rest.split(END)[1], "utf-8")


if __name__ == "__main__":
    main()
