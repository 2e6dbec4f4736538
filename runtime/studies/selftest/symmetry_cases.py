"""Hard cases about symmetry: equal planets, repeated eigenvalues."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from ...linear.modes import Mode, find_modes
from ...linear.system import linearise
from ...model.members import train_of
from ...model.rows import over_time
from .case import Finding, HardCase, Open

SMALL_PLANETS = {
    "stages.gear.sun.base_radius": "60 mm",
    "stages.gear.planet.base_radius": "20 mm",
    "stages.gear.ring.base_radius": "100 mm",
    "stages.gear.center_distance": "88 mm",
}
"""Radii that leave room for seven planets."""
SINGLE, DOUBLE, PLANET = 5, 6, 3
"""Elastic modes of a planetary gear whose central members have three freedoms each (Lin and Parker 1999): rotational
ones, each once; translational ones, each twice; planet modes, each N - 3 times."""


def _spread(modes: list[Mode], kind: str, times: int) -> float:
    """Return the largest relative difference between modes of a class that are one; infinite where they do not pair."""
    found = np.array([mode.frequency_hz for mode in modes if mode.kind == kind])
    if times == 0 or len(found) % times:
        return 0.0 if times == len(found) == 0 else float("inf")
    groups = found.reshape(-1, times)
    return float((np.ptp(groups, axis=1) / groups[:, 0]).max())


def _planets(open_: Open, method: str, full: bool) -> Iterator[Finding]:
    """Count the modes of gears with 3 to 7 planets, class by class."""
    wrong, spread, disorder = 0, 0.0, 0
    for n in range(3, 8):
        bench = open_("lin-parker-4", SMALL_PLANETS | {"stages.gear.planets": str(n)})
        modes = find_modes(linearise(bench.point))
        due = Counter(rigid=1, rotational=SINGLE, translational=2 * DOUBLE, planet=PLANET * (n - 3))
        wrong += (Counter(mode.kind for mode in modes) - due).total() + (3 * (3 + n) != len(modes))
        spread = max(spread, _spread(modes, "translational", 2), _spread(modes, "planet", n - 3))
        places = [mode.frequency_hz for mode in modes]
        disorder += places != sorted(places)
    yield Finding("modes of another class or number than Lin and Parker's, 3 to 7 planets", wrong, 0)
    yield Finding("largest relative difference within repeated frequencies", spread, 1e-9)
    yield Finding("lists out of order", disorder, 0)


STAGES = {"lsp": "lsp.sun.u", "hsp": "hsp.sun.u"}
"""Stages with a fixed and with a turning carrier, and what is turned at the start."""


def _equal(open_: Open, method: str, full: bool) -> Iterator[Finding]:
    """Turn the sun a little at the start: the planets of a stage all feel the same, for ever."""
    for scene, pushed in STAGES.items():
        bench = open_(scene, {"effects.mesh_stiffness": "mean"})
        names = [state.name for state in bench.library.manifest.states]
        x = bench.at.x.copy()
        x[names.index(pushed)] += 1e-5
        options: dict[str, Any] = {"t_end": 0.5 if full else 0.05, "rate": 8192.0, "rtol": 1e-8}
        path = bench.run(method, at=replace(bench.at, x=x), **options)
        outputs = over_time(bench.library, "outputs", path.x, path.s, bench.p)
        train = train_of(bench.library.manifest)
        for mesh in ("sun_planet", "ring_planet"):
            group = f"{scene}.{mesh}"
            rows = [
                i
                for i, report in enumerate(bench.library.manifest.reports)
                if report.quantity == "mesh_force" and train.group(report.item) == group
            ]
            forces = outputs[:, rows]
            spread = float(np.ptp(forces, axis=1).max() / forces[:, 0].std())
            yield Finding(f"{group}: spread of {len(rows)} planets over the force's standard deviation", spread, 1e-6)


CASES: tuple[HardCase, ...] = (
    HardCase(
        "planet-modes", "Repeated eigenvalues: 3 to 7 equal planets",
        "classes and multiplicities of Lin and Parker 1999, in order", _planets, integrates=False,
    ),
    HardCase(
        "equal-planets", "Exact symmetry: equal planets after a push at the sun",
        "mesh forces of all planets are the same to rounding", _equal,
    ),
)  # fmt: skip
