"""Hard cases at the limits: stiff and soft, light and heavy parts, unsupported members, colliding gears."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from ltcgear.generated.errors import LtcgearError, MachineError, SolverError
from numpy.typing import NDArray

from ...linear.modes import find_modes
from ...linear.system import linearise
from ...model.rows import over_time
from ...simulation.methods.registry import METHODS
from ...simulation.trajectory import Trajectory
from .case import Bench, Finding, HardCase, Open

Vector = NDArray[np.float64]
SMOOTH = {"effects.mesh_stiffness": "smooth"}


def _forces(bench: Bench, path: Trajectory) -> Vector:
    """Return the mesh forces [N] of a run, shape (times, meshes)."""
    rows = [i for i, report in enumerate(bench.library.manifest.reports) if report.quantity == "mesh_force"]
    return over_time(bench.library, "outputs", path.x, path.s, bench.p)[:, rows]


def _state(bench: Bench, name: str) -> int:
    """Return the index of a state."""
    return [state.name for state in bench.library.manifest.states].index(name)


def _stiffened(bench: Bench, factor: float) -> Bench:
    """Return the bench with bearings that many times as stiff, their damping ratios kept."""
    bearings = [item for item in bench.library.manifest.connections if item.kind == "bearing"]
    powers = {name: 1.0 for item in bearings for name in item.stiffness}
    powers |= {item.damping: 0.5 for item in bearings if item.damping}
    changed = {name: bench.values[name] * factor**power for name, power in powers.items()}
    return replace(bench, values=dict(bench.values) | changed)


def _stiff_bearings(open_: Open, method: str, full: bool) -> Iterator[Finding]:
    """Compare ever stiffer bearings with gears that do not move sideways."""
    options: dict[str, Any] = {"t_end": 0.1 if full else 0.01, "rate": 16384.0, "rtol": 1e-9}
    rigid = open_("psh", SMOOTH | {"effects.lateral": "off"})
    wanted = _forces(rigid, rigid.run(method, **options))
    soft, off, steps = open_("psh", SMOOTH), {}, {}
    for factor in (1.0, 1e2, 1e4, 1e6):
        bench = _stiffened(soft, factor)
        path = bench.run(method, **options)
        off[factor] = float(np.abs(_forces(bench, path) - wanted).max() / wanted.std())
        steps[factor] = path.counts.steps
    yield Finding(
        "decades by which the error falls from x1e2 to x1e4, off 2", abs(np.log10(off[1e2] / off[1e4]) - 2), 0.1
    )
    fall = abs(np.log10(off[1e4] / off[1e6]) - 2)
    yield Finding("and from x1e4 to x1e6, off 2", fall, 0.1)
    yield Finding("error at x1e6 over the forces' standard deviation", off[1e6], 1e-4)
    # The fastest motion is a thousand times faster: only an explicit method has to follow it.
    most = 3e3 if METHODS[method].explicit else 100.0
    yield Finding("steps at x1e6 over those at x1", steps[1e6] / steps[1.0], most)


def _pushed(bench: Bench, size: float) -> Bench:
    """Return the bench, its equilibrium with the rotor turned by ``size`` [rad] and the disc by half of it."""
    x = bench.at.x.copy()
    x[_state(bench, "rotor.u")] += size
    x[_state(bench, "speck.u")] += size / 2
    pushed = replace(bench)
    pushed.__dict__["at"] = replace(bench.at, x=x)
    return pushed


def _tiny_inertia(open_: Open, method: str, full: bool) -> Iterator[Finding]:
    """Swing the heavy rotor on both springs, undamped: A cos(sqrt(k / 2 I) t)."""
    bench = open_("hard-tiny-inertia", {"effects.damping": "off"})
    size, place = 1e-4, _state(bench, "rotor.u")
    path = _pushed(bench, size).run(method, t_end=0.05, rate=2000.0, rtol=1e-8)
    wanted = size * np.cos(np.sqrt(1e6 / 2) * path.time)
    found = path.x[:, place] - bench.at.x[place]
    yield Finding("error of the rotor's swing over its size", float(np.abs(found - wanted).max() / size), 1e-5)
    middle = path.x[:, _state(bench, "speck.u")] - bench.at.x[_state(bench, "speck.u")]
    # Explicit steps at the bound of stability keep a motion that nothing damps at the size of the tolerance.
    limit = 1e-4 if METHODS[method].explicit else 1e-5
    yield Finding("disc against the middle of the shaft", float(np.abs(middle - found / 2).max() / size), limit)


def _tiny_inertia_long(open_: Open, method: str, full: bool) -> Iterator[Finding]:
    """Let the damped oscillation decay for a minute; the disc's own motion decays within 1e-11 s."""
    bench = open_("hard-tiny-inertia", {})
    size, place = 1e-4, _state(bench, "rotor.u")
    path = _pushed(bench, size).run(method, t_end=60.0, rate=2.0, rtol=1e-6)
    left = float(np.abs(path.x[-1, place] - bench.at.x[place]) / size)
    yield Finding("swing left after a minute over its size", left, 1e-5)
    yield Finding("steps", path.counts.steps, 1e5)


IDLE = {
    "effects.contact": "backlash",
    "stages.lsp.sun_planet.backlash": "0.2 mm",
    "stages.lsp.ring_planet.backlash": "0.2 mm",
    "loads.sun.torque": "0 N*m",
}


FREE = {
    "stages.gear.ring": '{base_radius = "124 mm", support = "floating", mass = "2.35 kg", inertia = "0.046128 kg*m^2"}',
    "stages.gear.sun": '{base_radius = "34 mm", support = "floating", mass = "0.4 kg", inertia = "0.00045084 kg*m^2"}',
}
"""Sun and ring of lin-parker-4 without any support."""


def _free(open_: Open, method: str, full: bool) -> Iterator[Finding]:
    """Leave sun and ring to the planets.

    Two turns of the train have no stiffness. Nor have two whirls: 2 x 2 shifts of sun and ring and the 2 patterns
    cos, sin of the planets' turning meet 4 such patterns of mesh deflections.
    """
    bench = open_("lin-parker-4", FREE)
    position = bench.library.index("")
    yield Finding("displacement at rest [m], [rad]", float(np.abs(bench.at.x[position]).max()), 1e-12)
    modes = find_modes(linearise(bench.point))
    kinds = [mode.kind for mode in modes]
    yield Finding("rigid modes, off 4", abs(kinds.count("rigid") - 4), 0)
    yield Finding(
        "modes that grow, or of no class of a symmetric stage", sum(map(kinds.count, ("divergent", "mixed"))), 0
    )
    yield Finding("lowest elastic frequency under 100 Hz (0: none)", sum(0 < m.frequency_hz < 100 for m in modes), 0)


def _idle(open_: Open, method: str, full: bool) -> Iterator[Finding]:
    """Turn without load: nothing touches, so nothing moves."""
    bench = open_("lsp", IDLE)
    path = bench.run(method, t_end=1.0 if full else 0.1, rate=8192.0, rtol=1e-6)
    yield Finding("largest mesh force [N]", float(np.abs(_forces(bench, path)).max()), 1e-6)


def _refusal(open_: Open, scene: str, changes: Mapping[str, str]) -> str:
    """Return why a scene cannot be had, empty where it can."""
    try:
        open_(scene, changes)
    except MachineError:
        raise
    except LtcgearError as error:
        return str(error)
    return ""


COLLISIONS = (
    ({"stages.psh.center_distance": "338 mm"}, "stages.psh.mesh: the base circles' sum"),
    ({"stages.psh.center_distance": "300 mm"}, "stages.psh.mesh: the base circles' sum"),
    ({"stages.psh.center_distance": "600 mm"}, "stages.psh.mesh: the centre distance"),
    ({"stages.psh.pressure_angle": "90 deg"}, "stages.psh.pressure_angle"),
    ({"stages.psh.pressure_angle": "0 deg"}, "stages.psh.pressure_angle"),
    ({"stages.psh.helix_angle": "90 deg"}, "stages.psh.helix_angle"),
)
"""Changes that leave no teeth, and what the refusal must name. Base circles of ``psh`` touch at 341.2 mm."""


def _geometry(open_: Open, method: str, full: bool) -> Iterator[Finding]:
    """Ask for gears that cannot mesh."""
    untold = [key for changes, key in COLLISIONS if key not in _refusal(open_, "psh", changes)]
    yield Finding(f"scenes without teeth of {len(COLLISIONS)} that are not refused by their key", len(untold), 0)


CLOSING = {
    "effects.mesh_stiffness": "mean",
    "stages.psh.mesh.flank": "printed",
    "stages.psh.input.bearing.stiffness": "1e6 N/m",
    "stages.psh.output.bearing.stiffness": "1e6 N/m",
    "loads.output": '{member = "psh.output", torque_over_time = [["0 s", "0 N*m"], ["0.2 s", "-1.06e4 N*m"]]}',
}
"""On the flank that is not loaded bilateral teeth pull, and soft bearings let them."""


def _closing(open_: Open, method: str, full: bool) -> Iterator[Finding]:
    """Raise the torque until the teeth have pulled their base circles together; the run must stop there and say so."""
    bench = open_("psh", CLOSING)
    try:
        bench.run(method, t_end=0.2, rate=8192.0, rtol=1e-5)
    except SolverError as error:
        told = "psh.mesh come so close that their base circles touch" in str(error)
        yield Finding("stopped, and the mesh is named (0: yes)", 0.0 if told else 1.0, 0)
    else:
        yield Finding("went on beyond the end (0: no)", 1.0, 0)


CASES: tuple[HardCase, ...] = (
    HardCase(
        "stiff-bearings", "Bearings up to a million times stiffer",
        "mesh forces tend to those of gears that cannot move sideways, tenfold nearer a decade; steps stay bounded",
        _stiff_bearings,
    ),
    HardCase(
        "tiny-inertia", "A disc of 1e-9 of the inertia behind it, undamped",
        "the heavy rotor swings as on both springs in a row, A cos(sqrt(k / 2 I) t)", _tiny_inertia,
    ),
    HardCase(
        "tiny-inertia-long", "The same damped, for a minute",
        "it comes to rest in few steps; an explicit method says before the start that it would need too many",
        _tiny_inertia_long,
    ),
    HardCase(
        "free-members", "Sun and ring without support, no load",
        "rest is the equilibrium, and the four motions without stiffness are rigid modes", _free, integrates=False,
    ),
    HardCase("idle", "A stage within its gaps turns without load, its sun floating", "no tooth presses", _idle),
    HardCase(
        "no-teeth", "Centre distances and angles that leave no teeth",
        "each is refused by its key", _geometry, integrates=False,
    ),
    HardCase(
        "closing", "Gears that pull each other together", "the run stops, names the mesh and keeps finite values",
        _closing,
    ),
)  # fmt: skip
