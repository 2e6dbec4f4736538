"""Eigenfrequencies: the generated Jacobian at the equilibrium, its eigenvalues, what each mode moves."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .equilibrium import Equilibrium, inertias, state_matrix
from .integration import vibration_scale
from .library import Library

Vector = NDArray[np.float64]
RIGID = 1e-6
"""A mode below this fraction of the highest frequency is a rigid-body mode."""
SHARE = 1e-6
"""Share of kinetic energy below which a group of freedoms counts as standing still."""


@dataclass(frozen=True)
class Mode:
    """An eigenmode.

    Attributes
    ----------
    frequency_hz, damping_ratio
        Modulus of the eigenvalue over 2 pi, and minus its real part over its modulus.
    kind
        ``rigid``, ``torsional`` (nothing moves sideways), ``rotational`` (central members only turn),
        ``translational`` (they only shift), ``planet`` (they stand still) or ``mixed``.
    energy
        Share of kinetic energy by body, largest first.
    """

    frequency_hz: float
    damping_ratio: float
    kind: str
    energy: dict[str, float]


def find_modes(library: Library, at: Equilibrium, p: Vector) -> list[Mode]:
    """Return all modes about an equilibrium, ascending, rigid-body modes first.

    The coordinates turn with the carriers, so gyroscopic and centrifugal terms are in the Jacobian.
    """
    names = [state.name for state in library.manifest.states]
    # Where the speed is held, the reference angle is a clock and no freedom.
    kept = [
        i for i, name in enumerate(names) if not (name == "reference.angle" and library.manifest.reference == "speed")
    ]
    scale = vibration_scale(library, at, p)[kept]
    matrix = state_matrix(library, at.x, at.levels, p)[np.ix_(kept, kept)]
    values, vectors = np.linalg.eig(matrix * scale[None, :] / scale[:, None])
    vectors = vectors * scale[:, None]
    top = float(np.abs(values).max())
    row = {original: new for new, original in enumerate(kept)}
    position = [row[i] for i in library.index("")]
    mass = inertias(library, p)
    modes = [
        _mode(library, value, vectors[position, k], mass, top)
        for k, value in enumerate(values)
        if value.imag > 0 and abs(value) > RIGID * top
    ]
    modes += _overdamped(library, values, vectors[position], mass, top)
    loose = int((np.abs(values) <= RIGID * top).sum())
    rigid = [Mode(0.0, 0.0, "rigid", {}) for _ in range((loose + 1) // 2)]
    return rigid + sorted(modes, key=lambda mode: mode.frequency_hz)


def _overdamped(library: Library, values: Vector, shapes: Vector, mass: Vector, top: float) -> list[Mode]:
    """Join the real eigenvalues whose shapes are alike: omega^2 = l1 l2, zeta = -(l1 + l2) / 2 omega."""
    real = [k for k in np.argsort(-np.abs(values)) if values[k].imag == 0 and abs(values[k]) > RIGID * top]
    unit = np.sqrt(mass)[:, None] * shapes.real
    unit = unit / np.maximum(np.linalg.norm(unit, axis=0), 1e-300)
    modes = []
    while len(real) > 1:
        one = real.pop(0)
        two = max(real, key=lambda k: abs(float(unit[:, one] @ unit[:, k])))
        real.remove(two)
        omega = float(np.sqrt(abs((values[one] * values[two]).real)))
        damping = float(-(values[one] + values[two]).real / 2 / omega)
        kind, energy = _shape(library, shapes[:, two], mass)
        modes.append(Mode(omega / (2 * np.pi), damping, kind, energy))
    return modes


def _mode(library: Library, value: complex, shape: Vector, mass: Vector, top: float) -> Mode:
    """Describe one oscillating mode."""
    kind, energy = _shape(library, shape, mass)
    return Mode(float(abs(value)) / (2 * np.pi), float(-value.real / abs(value)), kind, energy)


def _shape(library: Library, shape: Vector, mass: Vector) -> tuple[str, dict[str, float]]:
    """Classify a mode shape by the kinetic energy of its parts."""
    energy = mass * np.abs(shape) ** 2
    energy = energy / energy.sum()
    states = [library.manifest.states[i] for i in library.index("")]
    groups = {"shift": 0.0, "turn": 0.0, "planet_shift": 0.0, "planet_turn": 0.0}
    bodies: dict[str, float] = {}
    for state, share in zip(states, energy, strict=True):
        group = ("planet_" if ".planet." in state.body else "") + ("turn" if state.axis == "u" else "shift")
        groups[group] += float(share)
        bodies[state.body] = bodies.get(state.body, 0.0) + float(share)
    ordered = dict(sorted(bodies.items(), key=lambda item: -item[1]))
    return _kind(groups), ordered


def _kind(groups: dict[str, float]) -> str:
    """Name the class of a mode from its energy shares (Lin and Parker 1999 for planetary gears)."""
    shift, turn = groups["shift"] > SHARE, groups["turn"] > SHARE
    if not shift and groups["planet_shift"] <= SHARE:
        return "torsional"
    if not shift and not turn:
        return "planet"
    if not shift:
        return "rotational"
    return "mixed" if turn else "translational"
