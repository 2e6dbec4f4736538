"""Motion over time: parametric resonance, no damping, angles that wrap, reruns."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...linear.modes import find_modes
from ...linear.system import linearise
from ...model.function import Kernel
from ...model.parameter_values import name_values
from ...model.state_matrix import Equilibrium
from ...simulation.matrix_exponential import Exact
from ...simulation.methods.registry import METHODS
from ...simulation.trajectory import Trajectory
from .case import Bench, Finding, HardCase, Open
from .case_reading import mesh_forces, off

Vector = NDArray[np.float64]

# --- parametric resonance

FREE = {
    "effects.lateral": "off",
    "loads.output.torque": "0 N*m",
    "stages.psh.mesh.flank": "printed",
    "stages.psh.mesh.double_factor": "1.2",
    "stages.psh.mesh.contact_ratio": "1.5",
}
"""A gear on its mesh alone, without load: Hill's equation with two levels of stiffness (Meissner's)."""
POINTS = ((2.0, "0.005"), (2.05, "0.01"), (2.1, "0.005"), (2.05, "0.02"))
"""Mesh frequency over natural frequency and damping ratio: fast growth, slow growth, outside the tongue, damped."""
TEETH = 59
RTOL, PUSH = 1e-8, 1e3
"""Tolerance, and the first deflection in sizes that tolerances refer to."""


def check_parametric(open_: Open, method: str, full: bool) -> Iterator[Finding]:
    """Compare growth and decay in time with the largest Floquet multiplier of the exact solution."""
    bench = open_("psh", FREE)
    natural = find_modes(linearise(bench.point))[-1].frequency_hz
    for tuning, damping in POINTS:
        speed = 2 * np.pi * tuning * natural / TEETH
        bench = open_(
            "psh", FREE | {"loads.input.speed": f"{-speed!r} rad/s", "stages.psh.mesh.damping_ratio": damping}
        )
        exact = Exact(bench.point)
        period, wanted = exact.period(), exact.growth()
        pitches = 400 if full else 100
        path = bench.run(method, at=_pushed(bench), t_end=pitches * period, rate=1 / period, rtol=RTOL)
        moving = np.concatenate([bench.library.index(""), bench.library.index(".rate")])
        z = ((path.x - exact.start) / exact.scale)[:, moving]
        name = f"mesh at {tuning:g} f_n, damping {damping}"
        yield Finding(f"{name}: growth rate off Floquet's, relative", abs(_growth(z) / period / wanted - 1), 0.01)
        grows = float(np.linalg.norm(z[-1]) > np.linalg.norm(z[0]))
        yield Finding(f"{name}: grows where it should decay, or the other way", abs(grows - float(wanted > 0)), 0)


def _pushed(bench: Bench) -> Equilibrium:
    """Return the equilibrium pushed out of its place, far against what tolerances refer to."""
    x, scale = bench.at.x.copy(), bench.point.scale
    x[bench.library.index("")] += PUSH * scale[bench.library.index("")]
    return replace(bench.at, x=x)


def _growth(z: Vector) -> float:
    """Return ln |largest multiplier| of the linear map that takes each sample to the next, by least squares."""
    size = np.linalg.norm(z[:-1], axis=1, keepdims=True)
    step = np.linalg.lstsq(z[:-1] / size, z[1:] / size, rcond=None)[0]
    return float(np.log(np.abs(np.linalg.eigvals(step)).max()))


# --- no damping

UNDAMPED = {
    "effects.damping": "off",
    "effects.mesh_damping": "off",
    "effects.mesh_stiffness": "fourier",
    "loads.ring.speed": "300 rpm",
}
"""The low-speed stage, turning so fast that its meshes have 590 Hz, among its natural frequencies."""
MESH_HZ = 590.0
KEPT = 1e-8
"""Share of the strain energy that may go missing over ten thousand tooth pitches."""


def check_undamped(open_: Open, method: str, full: bool) -> Iterator[Finding]:
    """Balance energy over many tooth pitches, where the change of stiffness gives torque and where its work is booked.

    A step of a multistep method of order five at most errs more under the same tolerance, so they get a tighter one.
    Its errors are then rounding of very many steps, whose sum grows with the square root of their number only.
    """
    many = METHODS[method].multistep
    rtol, long, growth = (1e-12, 1_000, 0.5) if many else (1e-10, 10_000, 1.0)
    for torque, name in (("on", "torque of k(theta)"), ("off", "work of dk/dt booked")):
        pitches = long if full else 100
        bench = open_("lsp", UNDAMPED | {"effects.stiffness_torque": torque})
        path = bench.run(method, t_end=pitches / MESH_HZ, rate=MESH_HZ, rtol=rtol)
        missing = abs(path.energy[1] - path.energy[0] - path.work - path.jump_energy)
        strain = float(Kernel(bench.library.functions["energy"])(bench.at.x, bench.at.s, bench.p)[0][1])
        yield Finding(f"{name}: energy missing at rtol {rtol:g}", missing / strain, KEPT * (pitches / 10_000) ** growth)


# --- angles that wrap

PLACES = ("0 deg", "170 deg")
"""Where planet 1 starts, so that the planets pass +-pi at other moments."""
CARRIER = 6.25
"""Turns of the carrier a second."""


def check_wrap(open_: Open, method: str, full: bool) -> Iterator[Finding]:
    """Let planets orbit from two places: forces must not see where +-pi lies."""
    turns = 5 if full else 1.2
    benches = [open_("hard-in-phase", {"effects.lateral": "on", "stages.gear.line_of_centres": at}) for at in PLACES]
    paths = [bench.run(method, t_end=turns / CARRIER, rate=8192.0, rtol=1e-7) for bench in benches]
    missing = abs(_turned(benches[0], paths[0]) - CARRIER * paths[0].time[-1])
    yield Finding("turns of the carrier missing", missing, 1e-9)
    one, other = (mesh_forces(bench, path) for bench, path in zip(benches, paths, strict=True))
    same = (paths[0].levels == paths[1].levels).all(axis=1)
    yield Finding("samples in another contact, share", float(1 - same.mean()), 0.01)
    yield Finding("mesh forces, off over std", off(one[same], other[same]), 1e-4)


def _turned(bench: Bench, path: Trajectory) -> float:
    """Return how often the carrier has turned."""
    known = name_values(bench.library.manifest, bench.p)
    angle = [state.name for state in bench.library.manifest.states].index("reference.angle")
    return float(abs(path.x[-1, angle] * known["gear.carrier.speed_ratio"]) / (2 * np.pi))


# --- reruns


def check_rerun(open_: Open, method: str, full: bool) -> Iterator[Finding]:
    """Run the whole rig twice."""
    bench = open_("rig-2mw", {})
    one, two = (bench.run(method, t_end=0.2 if full else 0.02, rate=8192.0, rtol=1e-6) for _ in range(2))
    yield Finding("numbers that differ", int((one.x != two.x).sum() + (one.levels != two.levels).sum()), 0)
    yield Finding("work and energies that differ", int(_ends(one) != _ends(two)), 0)


def _ends(path: Trajectory) -> tuple[float, ...]:
    """Return what a run adds up."""
    return (path.work, path.jump_energy, *path.energy)


CASES = (
    HardCase(
        "parametric",
        "Parametric resonance: mesh frequency about twice a natural one, little damping",
        "Growth and decay in time are the largest Floquet multiplier's within 1 %: no damping of the solver hides them",
        check_parametric,
    ),
    HardCase(
        "no-damping",
        "No damping at all: a planetary stage whose stiffness varies smoothly",
        "Energy is kept over 1e4 tooth pitches to 1e-8 of the strain energy, the work of dk/dtheta in the balance",
        check_undamped,
    ),
    HardCase(
        "wrap",
        "Planets pass +-pi, many times",
        "Nothing happens: forces are those of a gear that starts turned by 170 degrees",
        check_wrap,
    ),
    HardCase(
        "rerun",
        "The same run once more",
        "Every number is the same to the last bit",
        check_rerun,
    ),
)
