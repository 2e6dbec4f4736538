"""Hard cases of contact: teeth that part, fall back, graze, rattle and change flanks."""

from collections.abc import Iterable, Sequence
from math import asin, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from ...simulation.methods.registry import METHODS
from ...simulation.trajectory import Trajectory
from .case import Bench, Finding, HardCase, Open
from .dead_band import CASES as SWEPT
from .impact import Impact
from .pair import TorsionalPair, read, started

Vector = NDArray[np.float64]
RTOL = 1e-9
PARTING = 1e-9
"""Share of the largest force that a tooth may pull: how well the instant of parting can be located."""
GAP = "0.1 mm"


def allowed(method: str, limit: float) -> float:
    """Return the limit of a one-step method, or that of a multistep one at the same tolerance.

    These control the error of a step, not of an oscillation, and restart with small steps of low
    order after every parting. On a swing without any, BDF at 1e-9 loses 1e-7 of the energy, ``erk`` 1e-9.
    """
    return 20 * limit if METHODS[method].multistep else limit


# --- undamped bounces


def bounce(pair: TorsionalPair, size: float, time: Vector) -> Vector:
    """Return the deflection [m] of an undamped pair that starts at its static deflection.

    In contact it swings about the static deflection d, d + A sin w t, and in flight it falls, F / m being its
    acceleration; where A, ``size``, is at most d the teeth stay together.
    """
    w, d = pair.omega, pair.static
    if size <= d:
        return np.asarray(d + size * np.sin(w * time))
    early, fall = asin(d / size) / w, d * w**2
    speed = sqrt(size**2 - d**2) * w
    contact = pi / w + 2 * early
    since = np.mod(time + early, contact + 2 * speed / fall)
    flown = since - contact
    return np.where(flown < 0, d + size * np.sin(w * (since - early)), flown * (fall * flown / 2 - speed))


def bounce_period(pair: TorsionalPair, size: float) -> float:
    """Return the time from landing to landing [s]."""
    w, d = pair.omega, pair.static
    return (pi + 2 * asin(d / size) + 2 * sqrt(size**2 - d**2) / d) / w


def landings(pair: TorsionalPair, time: Vector, depth: Vector, speed: Vector) -> Vector:
    """Return when the gear lands, from each last sample in flight, since flight is a parabola."""
    last = np.flatnonzero((depth[:-1] <= 0) & (depth[1:] > 0))
    v, fall = speed[last], pair.static * pair.omega**2
    return np.asarray(time[last] + (-v + np.sqrt(v**2 - 2 * fall * depth[last])) / fall)


def _swing(bench: Bench, method: str, size: float, t_end: float) -> tuple[Trajectory, Vector, Vector]:
    """Run from the static deflection with the speed of a swing of this size; return deflections and their rates."""
    pair = TorsionalPair.of(bench)
    at = started(bench, pair_output_u_rate=size * pair.omega / pair.r)
    path = bench.run(method, at=at, t_end=t_end, rate=20 * pair.omega, rtol=RTOL)
    return path, read(bench, path, "mesh_deflection")["pair.mesh"], path.x[:, -1] * pair.r


def _energy(pair: TorsionalPair, depth: Vector, speed: Vector) -> Vector:
    """Return kinetic energy, strain energy and the torque's potential [J]."""
    pressed = np.maximum(depth, 0.0)
    return np.asarray(pair.m * speed**2 / 2 + pair.k * (pressed**2 / 2 - pair.static * depth))


def check_bounce(opened: Open, method: str, long: bool) -> Iterable[Finding]:
    """Throw a gear ten static deflections high and let it bounce.

    A bounce that loses the share E of its energy is short by E / 2 of its period, and these shorts add up: instants
    may be off by the square of the number of bounces times E / 4.
    """
    bench, count = opened("hard-bounce", {}), 200 if long else 20
    pair = TorsionalPair.of(bench)
    size, peak = 10 * pair.static, 11 * pair.static
    period = bounce_period(pair, size)
    path, depth, speed = _swing(bench, method, size, count * period)
    total, wanted = _energy(pair, depth, speed), bounce(pair, size, path.time)
    found = landings(pair, path.time, depth, speed)
    due = period * np.arange(1, count + 1) - asin(pair.static / size) / pair.omega
    yield Finding("bounces lost or doubled", abs(len(found) - count), 0)
    if len(found) == count:
        yield Finding(
            "instants of landing, over the period and the square of bounces",
            np.abs(found - due).max() / period / count**2,
            allowed(method, 5e-9),
        )
    yield Finding(
        "energy gained or lost a bounce", np.ptp(total) / (pair.k * size**2 / 2) / count, allowed(method, 1e-8)
    )
    yield Finding(
        "mesh deflection, over the largest and the square of bounces",
        np.abs(depth - wanted).max() / peak / count**2,
        allowed(method, 3e-8),
    )
    force = read(bench, path, "mesh_force")["pair.mesh"]
    off = abs(force.max() / (pair.k * np.maximum(wanted, 0).max()) - 1)
    yield Finding("largest mesh force, over bounces", off / count, allowed(method, 1e-8))


def check_grazing(opened: Open, method: str, long: bool) -> Iterable[Finding]:
    """Swing by the static deflection, a billionth more and a billionth less: teeth part for no time, or not quite."""
    bench, count = opened("hard-bounce", {}), 200 if long else 20
    pair = TorsionalPair.of(bench)
    for text, more in (("parting", 1e-9), ("staying", -1e-9)):
        size = pair.static * (1 + more)
        path, depth, speed = _swing(bench, method, size, count * 2 * pi / pair.omega)
        wanted = bounce(pair, size, path.time)
        yield Finding(
            f"mesh deflection, {text}", np.abs(depth - wanted).max() / pair.static / count, allowed(method, 1e-8)
        )
        total = _energy(pair, depth, speed)
        yield Finding(f"energy a swing, {text}", np.ptp(total) / (pair.k * size**2 / 2) / count, allowed(method, 1e-8))
        yield Finding(f"switchings beyond two a swing, {text}", max(path.counts.events - 2 * count, 0), 0)


# --- an impact with damping


def check_impact(opened: Open, method: str, long: bool) -> Iterable[Finding]:
    """Let a gear fall on teeth with a damper: contact ends where the force is zero, before the deflection is."""
    bench = opened("hard-bounce", {"effects.mesh_damping": "on"})
    pair = TorsionalPair.of(bench)
    for speed in (3.0, 10.0, 100.0) if long else (10.0,):
        impact = Impact(pair, speed * pair.static * pair.omega)
        height = -pair.static
        begun = sqrt(impact.v**2 + 2 * impact.fall * height)
        before = (impact.v - begun) / impact.fall
        at = started(bench, pair_output_u=height / pair.r, pair_output_u_rate=begun / pair.r)
        rate = 200 * pair.omega
        path = bench.run(method, at=at, t_end=before + 2 * impact.end, rate=rate, rtol=RTOL)
        shown = [read(bench, path, f"mesh_{name}")["pair.mesh"] for name in ("deflection", "force")]
        x, v, force = impact.motion(path.time - before)
        text = f"at {speed:g} d w"
        yield Finding(
            f"mesh deflection {text}, over the largest", np.abs(shown[0] - x).max() / x.max(), allowed(method, 1e-8)
        )
        yield Finding(
            f"speed {text}, over that of impact",
            np.abs(path.x[:, -1] * pair.r - v).max() / impact.v,
            allowed(method, 1e-8),
        )
        near = np.abs(path.time - before) * rate < 1e-3  # the force jumps here
        yield Finding(
            f"mesh force {text}, over the largest",
            np.abs(shown[1] - force)[~near].max() / force.max(),
            allowed(method, 1e-8),
        )
        yield Finding(f"largest pull {text}, over the largest force", -path.extremes.lowest[0] / force.max(), PARTING)


# --- a gap of zero, and flanks in turn


def check_zero_gap(opened: Open, method: str, long: bool) -> Iterable[Finding]:
    """Let a pair with a gap of zero swing through its unloaded place: it must move as one without a gap does.

    Without damping both flanks together are one spring. A damper differs by design: a bilateral tooth may pull.
    """
    count = 200 if long else 20
    benches = [opened("hard-bounce", {"effects.contact": contact}) for contact in ("bilateral", "backlash")]
    swings = [
        _swing(bench, method, 3 * TorsionalPair.of(bench).static, count * 2 * pi / TorsionalPair.of(bench).omega)
        for bench in benches
    ]
    pair, (path, depth, _) = TorsionalPair.of(benches[0]), swings[1]
    forces = read(benches[1], path, "mesh_force")
    total = forces["pair.mesh"] - forces["pair.mesh.back"]
    peak = 4 * pair.static
    yield Finding("force of both flanks less that of one spring", np.abs(total / pair.k - depth).max() / peak, 1e-12)
    wanted = pair.static * (1 + 3 * np.sin(pair.omega * path.time))
    for (_, found, _), text in zip(swings, ("without a gap", "with a gap of zero"), strict=True):
        yield Finding(f"mesh deflection {text}", np.abs(found - wanted).max() / peak / count, allowed(method, 1e-8))


def reversed_torque(times: Sequence[float]) -> dict[str, str]:
    """Return the changes that put backlash in and take 100 N m to its opposite and back, between five times."""
    rows = [[f"{t} s", f"{v} N*m"] for t, v in zip(times, (100, -100, -100, 100, 100), strict=True)]
    return {
        "effects.contact": "backlash",
        "stages.pair.mesh.backlash": GAP,
        "loads.output": f'{{ member = "pair.output", torque_over_time = {rows} }}',
    }


def check_reversal(opened: Open, method: str, long: bool) -> Iterable[Finding]:
    """Take the torque through zero and back, without damping: no energy is made."""
    times = [(10 if long else 1) * time for time in (0.001, 0.003, 0.005, 0.007, 0.009)]
    bench = opened("hard-bounce", reversed_torque(times))
    pair = TorsionalPair.of(bench)
    path = bench.run(method, t_end=times[-1], rate=40 * pair.omega, rtol=RTOL)
    forces = read(bench, path, "mesh_force").values()
    gained, angle = path.energy[1] - path.energy[0], path.x[:, -2]
    torque = np.interp(path.time, *np.array(bench.tables["loads.output.torque_over_time"]).T)
    given = float(np.sum((torque[1:] + torque[:-1]) / 2 * np.diff(angle)))
    most = max(np.max(force) for force in forces) ** 2 / pair.k / 2
    booked = abs(gained - path.work) / most
    yield Finding("energy balance, over the largest strain energy", booked, allowed(method, 1e-7))
    yield Finding("energy made: gain less work of the torque over the samples", abs(gained - given) / most, 1e-4)
    yield from no_pull(path, list(forces), pair.torque / pair.r)


def check_flanks(opened: Open, method: str, long: bool) -> Iterable[Finding]:
    """Take the torque through zero and back, with damping: the other flank takes over."""
    times = (0.002, 0.012, 0.040, 0.050, 0.078)
    bench = opened("hard-bounce", reversed_torque(times) | {"effects.mesh_damping": "on"})
    pair = TorsionalPair.of(bench)
    path = bench.run(method, t_end=times[-1], rate=10 * pair.omega, rtol=RTOL)
    front, back = read(bench, path, "mesh_force").values()
    half, static = int(np.searchsorted(path.time, times[2])), pair.torque / pair.r
    yield Finding("other flank's force under the reversed torque", abs(back[half] / static - 1), 1e-5)
    yield Finding("first flank's force at the end", abs(front[-1] / static - 1), 1e-5)
    yield from no_pull(path, [front, back], static)


def no_pull(path: Trajectory, forces: Sequence[Vector], size: float) -> Iterable[Finding]:
    """Return the tension of flanks, at samples and between, and their simultaneous force, over a force."""
    yield Finding("largest pull between samples", -path.extremes.lowest.min() / size, PARTING)
    yield Finding("largest pull at samples", -min(float(force.min()) for force in forces) / size, PARTING)
    yield Finding("force on both flanks at once", float(np.min(forces, axis=0).max()) / size, PARTING)


CASES: tuple[HardCase, ...] = (
    HardCase(
        "bounce",
        "a gear bounces on its mate's teeth, undamped",
        "flight is a parabola and contact a piece of a sine: instants, forces and energy in closed form",
        check_bounce,
    ),
    HardCase(
        "grazing",
        "teeth that part for a moment, or just do not",
        "a swing by the static deflection, a billionth more and less, in closed form; at most two switchings each",
        check_grazing,
    ),
    HardCase(
        "impact",
        "impact on teeth with a damper that may not pull",
        "a damped swing until the force, not the deflection, is zero, in closed form",
        check_impact,
    ),
    HardCase(
        "zero-gap",
        "a backlash of zero",
        "force law and motion are those of a mesh without backlash",
        check_zero_gap,
    ),
    HardCase(
        "reversal",
        "torque through zero with backlash and without damping, and back",
        "energy balance closed, no energy made, no tooth pulls",
        check_reversal,
    ),
    HardCase(
        "flanks",
        "torque through zero with backlash and damping, and back",
        "the other flank carries what statics calls for, then the first again",
        check_flanks,
    ),
    *SWEPT,
)
