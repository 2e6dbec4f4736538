"""Jumps of stiffness: thousands a second, many at one instant, on output times, none at all."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from ...simulation.matrix_exponential import Exact
from .case import Bench, Finding, HardCase, Open
from .case_reading import TIGHTEST, against_exact, mesh_forces, off

TORSIONAL = {"effects.lateral": "off"}


def _exact(bench: Bench) -> Exact:
    """Return the exact motion from the equilibrium on."""
    return Exact(bench.point)


def check_jumps(open_: Open, method: str, full: bool) -> Iterator[Finding]:
    """Simulate the torsional rig at the tightest tolerance."""
    bench = open_("rig-2mw", TORSIONAL)
    path = bench.run(method, t_end=0.5 if full else 0.02, rate=8192.0, rtol=TIGHTEST)
    yield from against_exact(bench, _exact(bench), path)


# --- planets in phase

BACKWARDS = {"loads.sun.speed": "-1500 rpm", "loads.carrier.torque": "400 N*m"}
SPEED, RAMP = 50 * np.pi, 0.01
"""Speed of the sun [rad/s] and the time [s] it takes to turn back."""


def check_in_phase(open_: Open, method: str, full: bool) -> Iterator[Finding]:
    """Turn four planets in phase forwards and backwards, then there and back."""
    for way, changes in (("forwards", {}), ("backwards", BACKWARDS)):
        bench = open_("hard-in-phase", changes)
        path = bench.run(method, t_end=0.7 if full else 0.02, rate=8192.0, rtol=TIGHTEST)
        for finding in against_exact(bench, _exact(bench), path):
            yield replace(finding, what=f"{way}: {finding.what}")
        forces = mesh_forces(bench, path)
        planets = max(off(forces[:, [i]], forces[:, [i % 2]]) for i in range(2, forces.shape[1]))
        yield Finding(f"{way}: planets apart, over std of force", planets, 1e-9)
    yield from _there_and_back(open_, method, 0.7 if full else 0.1)


def _there_and_back(open_: Open, method: str, half: float) -> Iterator[Finding]:
    """Turn back and count the jumps on the way out and on the way home."""
    stop, end = half + RAMP / 2, 2 * half + RAMP - 0.0005
    rows = f'[["{half} s", "{SPEED} rad/s"], ["{half + RAMP} s", "{-SPEED} rad/s"]]'
    bench = open_("hard-in-phase", {"loads.sun": f'{{ member = "gear.sun", speed_over_time = {rows} }}'})
    path = bench.run(method, t_end=end, rate=2000.0, rtol=1e-6)
    # 24 teeth against the carrier, whose speed is a quarter of the sun's.
    pitches = np.array([0.0, half + RAMP / 4, end - stop - RAMP / 4]) * 0.75 * 24 * SPEED / (2 * np.pi)
    out, home = pitches[1], pitches[1] - pitches[2]
    wanted = sum(4 * (_borders(out, border) + _borders(out, border) - _borders(home, border)) for border in BORDERS)
    yield Finding("there and back: jumps lost or doubled", abs(path.counts.events - wanted), 0)


BORDERS = (0.0, 0.4, 0.0, 0.4)
"""Switchings of the sun's and the ring's meshes [pitches of the sun's]: 0.6 + 0.4 and 0.6 + 0 ahead are 0 and 0.4."""


def _borders(tau: float, border: float) -> int:
    """Return the number of switching points between 0, which does not count, and a phase."""
    return int(np.floor(tau - border) - np.floor(-border))


# --- jumps on output times

SAMPLED = TORSIONAL | {
    "stages.psh.input.teeth": "60",
    "loads.input.speed": "-60 rpm",
    "stages.psh.mesh.contact_ratio": "1.5",
}
"""Sixty teeth a second in halves of single and double contact: a jump every 120th of a second."""
RATE = 1200.0
BESIDE = 1e-5
"""What jumps may change that come a billionth of a pitch sooner or later; the exact solutions differ by 2e-6."""


def check_on_output(open_: Open, method: str, full: bool) -> Iterator[Finding]:
    """Sample at the jumps themselves, and with the jumps a billionth of a pitch before and behind the samples."""
    end = 5.0 if full else 0.1
    bench = open_("psh", SAMPLED)
    path = bench.run(method, t_end=end, rate=RATE, rtol=TIGHTEST)
    yield from against_exact(bench, _exact(bench), path)
    yield Finding("samples missing", abs(len(path.time) - round(end * RATE) - 1), 0)
    for phase in ("1e-9", "-1e-9"):
        beside = open_("psh", SAMPLED | {"stages.psh.mesh.phase": phase})
        other = beside.run(method, at=bench.at, t_end=end, rate=RATE, rtol=TIGHTEST)
        yield Finding(f"jumps {phase} pitches beside: states, off over std", _states_off(other.x, path.x), BESIDE)


def _states_off(found: np.ndarray, wanted: np.ndarray) -> float:
    """Return the largest difference of moving states over their standard deviation."""
    moving = wanted.std(axis=0) > 0
    return off(found[:, moving], wanted[:, moving])


# --- whole contact ratios


def check_whole(open_: Open, method: str, full: bool) -> Iterator[Finding]:
    """Simulate pairs that are always in single or always in double contact, and their neighbours."""
    single: Mapping[str, str] = TORSIONAL | {"stages.psh.mesh.double_factor": "1.5"}
    for ratio, beside in (("1", "1.0000011"), ("2", "1.9999989")):
        one, other = (open_("psh", {**single, "stages.psh.mesh.contact_ratio": value}) for value in (ratio, beside))
        start = one.at
        paths = [
            bench.run(method, at=replace(start, levels=bench.at.levels), t_end=0.5 if full else 0.05, rate=8192.0,
                      rtol=1e-9)
            for bench in (one, other)
        ]  # fmt: skip
        yield Finding(f"contact ratio {ratio}: jumps", paths[0].counts.events, 0)
        forces = [mesh_forces(bench, path) for bench, path in zip((one, other), paths, strict=True)]
        mean = float(np.abs(forces[0]).mean())
        apart = float(np.median(np.abs(forces[0] - forces[1]))) / mean
        yield Finding(f"contact ratio {ratio}: mesh force off that of {beside}, over mean", apart, 1e-5)


CASES = (
    HardCase(
        "jumps",
        "Stiffness jumps, more than two thousand a second",
        "The torsional rig's jumps, states and mesh forces are those of the exact solution by matrix exponentials",
        check_jumps,
    ),
    HardCase(
        "in-phase",
        "Four planets in phase: eight meshes jump at one instant",
        "No jump is lost or doubled, forwards, backwards, there and back; the exact solution; all planets alike",
        check_in_phase,
    ),
    HardCase(
        "on-output",
        "Jumps exactly on output times",
        "No sample, no jump is lost or doubled; the exact solution; the same as a billionth of a pitch beside",
        check_on_output,
    ),
    HardCase(
        "whole-contact-ratio",
        "Contact ratio exactly 1 or 2, where nothing jumps",
        "No jumps, and the mesh force of a pair that is a millionth away",
        check_whole,
    ),
)
