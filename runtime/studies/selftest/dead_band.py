"""Hard cases of a gear pair with a dead band: jumps of a slow sweep, both branches of steady motion, rattling.

Without dimensions (lengths over half the gap b, times by the natural frequency w) the shipped scene is

    y'' + 2 zeta (y' + e') + f(y) = F - e'',    e = E cos(angle of the mesh),

the gear pair of Kahraman and Singh 1990, J. Sound Vib. 142:49, but for the damper, which sees the gear's vibration
y + e and not the mesh's alone.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...model.load_tables import Pairs
from ...simulation.energy_balance import energy_residual
from ...simulation.trajectory import Trajectory
from .case import Bench, Finding, HardCase, Open
from .pair import TorsionalPair, read

Vector = NDArray[np.float64]
SAMPLES, FINE = 40, 160
"""Samples in a natural period: for sweeps, and where amplitudes are compared (read to 1e-4 then)."""
RTOL = 1e-8
JUMP = 0.2
"""Amplitude that separates the branches at both jumps: below it the small one, above it the large one."""
SHORT_SWEEP = ((200.0, 2200.0, 2400.0, 5900.0), (0.75, 0.95, 0.95, 0.60), 6000.0)
LONG_SWEEP = ((300.0, 10300.0, 10600.0, 20600.0), (0.4, 1.4, 1.4, 0.4), 20700.0)
"""Knots over the time w t, frequencies over w, and the end: 1e-4 of w in each unit of time, up and back."""
JUMPS = (0.8346, 0.6932)
"""Frequencies of the jumps up and down of the short sweep, from tests/reference/dead_band.py."""
STEPS = (0.6, 0.7, 0.8, 0.9, 0.8, 0.75)
"""Frequencies to dwell at, one after the other: on the branch of small amplitudes, then on that of large ones."""
DWELL, CHANGE = 300.0, 100.0
"""How long each lasts, and the way to the next; a vibration then dies down to exp(-15)."""
AMPLITUDES = (0.028388, 0.048075, 0.087443, 0.229582, 0.286314, 0.319225)
"""Steady amplitudes there, by the same reference."""


@dataclass(frozen=True)
class DeadBand:
    """The scene ``hard-dead-band`` without dimensions."""

    bench: Bench

    @cached_property
    def pair(self) -> TorsionalPair:
        """Return the pair."""
        return TorsionalPair.of(self.bench)

    @cached_property
    def half(self) -> float:
        """Return half the gap [m]."""
        return self.bench.values["pair.mesh.backlash"] / 2

    @property
    def force(self) -> float:
        """Return F, the mean force."""
        return self.pair.static / self.half

    @property
    def error(self) -> float:
        """Return E, the amplitude of the transmission error."""
        return self.bench.values["pair.mesh.transmission_error_cos_1"] / self.half

    @property
    def zeta(self) -> float:
        """Return the damping ratio."""
        damper = self.bench.values["couplings.damper.damping"] / self.pair.r**2
        return damper / (2 * self.pair.m * self.pair.omega)

    def swept(self, times: Sequence[float], frequencies: Sequence[float]) -> "DeadBand":
        """Return the scene with other frequencies over time, linear between knots.

        The torque is changed by what accelerates the gear, so that F stays as it is.
        """
        t = np.array(times) / self.pair.omega
        speed = np.array(frequencies) * self.pair.omega / self.bench.values["pair.mesh.teeth_1"]
        torque, inertia, instant = self.pair.torque, self.bench.values["pair.output.inertia"], 1e-9
        rows: list[tuple[float, float]] = []
        for i, gain in enumerate(np.diff(speed) / np.diff(t)):
            during = torque - inertia * gain
            rows += [(t[i], torque), (t[i] + instant, during), (t[i + 1] - instant, during)]
        rows.append((t[-1], torque))
        tables: dict[str, Pairs] = {
            "loads.input.speed_over_time": tuple(zip(t, speed, strict=True)),
            "loads.output.torque_over_time": tuple(rows),
        }
        return DeadBand(replace(self.bench, tables=tables))

    def run(self, method: str, end: float, samples: int = SAMPLES) -> Trajectory:
        """Integrate to a time w t."""
        rate = samples * self.pair.omega / (2 * np.pi)
        return self.bench.run(method, t_end=end / self.pair.omega, rate=rate, rtol=RTOL)

    def cycles(self, path: Trajectory) -> "MeshCycles":
        """Read the whole mesh cycles off a run."""
        y = read(self.bench, path, "mesh_deflection")["pair.mesh"] / self.half + 1
        phase = path.x[:, 0] * self.bench.values["pair.mesh.cycles"]
        first = np.searchsorted(phase, np.arange(int(phase[-1]) + 1))
        swing = (np.maximum.reduceat(y, first) - np.minimum.reduceat(y, first))[:-1] / 2
        time = path.time * self.pair.omega
        knots = np.array(self.bench.tables["loads.input.speed_over_time"])
        speed = np.interp(path.time, *knots.T) * self.bench.values["pair.mesh.teeth_1"] / self.pair.omega
        middle = (first[:-1] + first[1:]) // 2
        return MeshCycles(time[middle], speed[middle], swing)


@dataclass(frozen=True)
class MeshCycles:
    """Whole cycles of the mesh: time w t, frequency over w, and half of what y moves through, one a cycle."""

    time: Vector
    frequency: Vector
    amplitude: Vector

    def jumps(self, turn: float) -> tuple[float, float]:
        """Return the frequencies at which the amplitude jumps up before the time ``turn``, and down after it."""
        up, down = self.time < turn, (self.time >= turn) & (self.frequency < 0.9)
        rises, falls = (up & (self.amplitude > JUMP)), (down & (self.amplitude < JUMP))
        return tuple(float(self.frequency[np.argmax(x)]) if x.any() else np.nan for x in (rises, falls))  # type: ignore[return-value]

    def before(self, time: float) -> float:
        """Return the mean amplitude of the last ten cycles before a time."""
        last = int(np.searchsorted(self.time, time))
        return float(self.amplitude[last - 10 : last].mean())


def small_amplitude(pair: DeadBand, frequency: float) -> float:
    """Return the amplitude of y where the teeth stay together, in closed form; it must not exceed F."""
    e_2 = frequency**2 - 2j * pair.zeta * frequency
    return pair.error * abs(e_2 / (1 - frequency**2 + 2j * pair.zeta * frequency))


# --- the cases


def check_sweep(opened: Open, method: str, long: bool) -> Iterable[Finding]:
    """Sweep slowly up through the resonance and back."""
    pair = DeadBand(opened("hard-dead-band", {}))
    times, frequencies, end = LONG_SWEEP if long else SHORT_SWEEP
    cycles = pair.swept(times, frequencies).cycles(pair.swept(times, frequencies).run(method, end))
    found, turn = cycles.jumps((times[1] + times[2]) / 2), abs(frequencies[1] - frequencies[0]) / (times[1] - times[0])
    for text, jump, wanted in zip(("up", "down"), found, JUMPS, strict=True):
        one = 2 * np.pi * turn / wanted**2  # what the frequency changes by in a cycle, over itself
        yield Finding(f"frequency of the jump {text}, against the reference", abs(jump / wanted - 1), 1.5 * one)
    yield Finding("frequency of the jump down over that of the jump up", found[1] / found[0], 0.9)
    yield Finding("frequency of the jump up, over the natural one: it softens", found[0], 0.9)


def check_steps(opened: Open, method: str, long: bool) -> Iterable[Finding]:
    """Dwell at a few frequencies, on the way up and on the way back."""
    pair = DeadBand(opened("hard-dead-band", {}))
    times, frequencies = staircase(STEPS)
    run = pair.swept(times, frequencies)
    cycles = run.cycles(run.run(method, times[-1], samples=FINE))
    for i, (frequency, wanted) in enumerate(zip(STEPS, AMPLITUDES, strict=True)):
        amplitude = cycles.before(times[2 * i + 1])
        together = wanted <= pair.force
        limit = small_amplitude(pair, frequency) if together else wanted
        text = "small" if together else "large"
        yield Finding(f"{text} amplitude at {frequency:g}", abs(amplitude / limit - 1), 2e-4)


def staircase(frequencies: Sequence[float]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return knots that dwell at frequencies, one after the other; dwell i ends at knot 2 i + 1."""
    starts = np.arange(len(frequencies)) * (DWELL + CHANGE)
    times = np.stack([starts, starts + DWELL], axis=1).ravel()
    return tuple(times), tuple(np.repeat(frequencies, 2))


def check_rattle(opened: Open, method: str, long: bool) -> Iterable[Finding]:
    """Let a pair rattle from flank to flank: no force is tensile, and never do both flanks carry load."""
    scene = DeadBand(opened("hard-dead-band", {}))
    bench = scene.bench
    wide = {**bench.values, "pair.mesh.transmission_error_cos_1": scene.half}
    run = DeadBand(replace(bench, values=wide)).swept((0.0, 1.0), (0.9, 0.9))
    path = run.run(method, 3000.0 if long else 400.0)
    forces = read(run.bench, path, "mesh_force")
    front, back = forces["pair.mesh"], forces["pair.mesh.back"]
    peak = max(front.max(), back.max())
    yield Finding("flanks that are never touched", sum(force.max() < peak / 10 for force in (front, back)), 0)
    # Borders are met to what the tolerance lets an indicator be off: a held side may pull by as much (seen: 2e-9).
    yield Finding("largest pull between samples, over the largest force", -path.extremes.lowest.min() / peak, 1e-8)
    yield Finding("largest pull at samples, over the largest force", -min(front.min(), back.min()) / peak, 1e-9)
    yield Finding("force of both flanks at once, over the largest", np.minimum(front, back).max() / peak, 1e-9)
    residual = energy_residual(run.bench.point, path)
    yield Finding("energy balance, over the strain energy", abs(residual), 1e-4)


CASES: tuple[HardCase, ...] = (
    HardCase(
        "dead-band",
        "the classic gear pair with clearance, swept slowly through its resonance and back",
        "jumps and hysteresis at the frequencies of an independent integration, to 1.5 mesh cycles of the sweep",
        check_sweep,
    ),
    HardCase(
        "dead-band-steps",
        "the same pair dwelling on both branches of its response",
        "steady amplitudes: closed form where teeth stay together, else an independent integration",
        check_steps,
    ),
    HardCase(
        "rattle",
        "a pair that rattles from flank to flank",
        "no mesh force is tensile, at samples and between; energy balance closed",
        check_rattle,
    ),
)
