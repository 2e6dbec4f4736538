"""Eigenfrequencies: the generated Jacobian at the equilibrium, its eigenvalues, what each mode moves."""

from dataclasses import dataclass

import numpy as np
from ltcgear.generated.contract import State
from numpy.typing import NDArray

from .equilibrium import Equilibrium, settled, state_matrix
from .library import Library
from .scaling import vibration_scale

Vector = NDArray[np.float64]
Complex = NDArray[np.complex128]
RIGID = 1e-6
"""A mode below this fraction of the highest frequency is a rigid-body mode."""
SHARE = 1e-6
"""Share of kinetic energy below which a group of freedoms counts as standing still."""
ROUNDING = 1e-12
"""A real part below this fraction of the highest eigenvalue is rounding: the mode has no damping."""


@dataclass(frozen=True)
class Mode:
    """An eigenmode.

    Attributes
    ----------
    frequency_hz, damping_ratio
        Modulus of the eigenvalue over 2 pi, and minus its real part over its modulus; negative where the
        motion grows.
    kind
        ``rigid``, ``torsional`` (nothing moves sideways), ``rotational`` (central members only turn),
        ``translational`` (they only shift), ``planet`` (they stand still), ``mixed``, or ``divergent`` (grows
        without oscillating).
    energy
        Share of kinetic energy, largest first, by body and motion: ``sun shifting``, ``sun turning``.
    """

    frequency_hz: float
    damping_ratio: float
    kind: str
    energy: dict[str, float]


@dataclass(frozen=True)
class _Motions:
    """The motions that store kinetic energy: their states, inertias, and matrix @ x, the motions of a state."""

    states: list[State]
    mass: Vector
    matrix: Vector


def find_modes(library: Library, at: Equilibrium, p: Vector) -> list[Mode]:
    """Return all modes about an equilibrium, ascending, rigid-body modes first.

    Stiffness is its mean over the mesh phase. The coordinates turn with the carriers, so gyroscopic and centrifugal
    terms are in the Jacobian.
    """
    names = [state.name for state in library.manifest.states]
    # Where the speed is held, the reference angle is a clock and no freedom.
    kept = [
        i for i, name in enumerate(names) if not (name == "reference.angle" and library.manifest.reference == "speed")
    ]
    scale = vibration_scale(library, at, p)[kept]
    matrix = state_matrix(library, at.x, at.s, settled(library, p))[np.ix_(kept, kept)]
    found = np.linalg.eig(matrix * scale[None, :] / scale[:, None])
    values: Complex = found.eigenvalues.astype(np.complex128)
    motions = _motions(library, at, p)
    shapes: Complex = (motions.matrix[:, kept] @ (found.eigenvectors * scale[:, None])).astype(np.complex128)
    top = float(np.abs(values).max())
    elastic = np.abs(values) > RIGID * top
    modes = [_mode(motions, values[k], shapes[:, k], top) for k in np.flatnonzero(elastic & (values.imag > 0))]
    modes += _real_modes(motions, values, shapes, np.flatnonzero(elastic & (values.imag == 0)), top)
    rigid = [Mode(0.0, 0.0, "rigid", {}) for _ in range((int((~elastic).sum()) + 1) // 2)]
    return rigid + sorted(modes, key=lambda mode: mode.frequency_hz)


def _motions(library: Library, at: Equilibrium, p: Vector) -> _Motions:
    """Describe the absolute motions: where no speed is held, the reference angle carries everything along."""
    everything = library.manifest.states
    names = [state.name for state in everything]
    number = {name: float(value) for (name, _), value in zip(library.manifest.parameters, p, strict=True)}
    position = library.index("")
    states = [everything[i] for i in position]
    if library.manifest.reference == "torque":
        states.append(everything[names.index("reference.speed")])
    matrix = np.zeros((len(states), len(names)))
    matrix[np.arange(len(position)), position] = 1.0
    if library.manifest.reference == "torque":
        place = dict(zip(names, at.x, strict=True))
        matrix[:, names.index("reference.angle")] = [_carried(state, number, place) for state in states]
    return _Motions(states, np.array([number[state.inertia] for state in states]), matrix)


def _carried(state: State, number: dict[str, float], place: dict[str, float]) -> float:
    """Return how far a unit of reference angle carries a body along an axis, in the axes of its frame.

    Angles follow by the speed ratio; a planet is carried round by its frame, which turns with its carrier.
    """
    if state.axis not in ("x", "y"):
        return number.get(f"{state.inertia.removesuffix('.inertia')}.speed_ratio", 0.0)
    turn = number.get(f"{state.body.split('.')[0]}.carrier.speed_ratio", 0.0)
    other, sign = ("y", -1.0) if state.axis == "x" else ("x", 1.0)
    return sign * turn * (number.get(f"{state.body}.{other}_0", 0.0) + place[f"{state.body}.{other}"])


def _real_modes(motions: _Motions, values: Complex, shapes: Complex, real: NDArray[np.int64], top: float) -> list[Mode]:
    """Describe the real eigenvalues: two that decay in like shapes are one overdamped mode.

    Such a pair has omega^2 = l1 l2 and zeta = -(l1 + l2) / 2 omega. One that grows stands alone, as does
    the one that decays in its shape, and one without a partner.
    """
    unit = np.sqrt(motions.mass)[:, None] * shapes.real
    unit = unit / np.maximum(np.linalg.norm(unit, axis=0), 1e-300)
    left = sorted(real.tolist(), key=lambda k: -abs(values[k]))
    modes = []
    while left:
        one = left.pop(0)
        two = max(left, key=lambda k: abs(float(unit[:, one] @ unit[:, k])), default=None)
        alone = [one]
        if two is not None:
            left.remove(two)
            alone = [one, two]
            if max(values[one].real, values[two].real) < 0:
                modes.append(_overdamped(motions, values[one].real, values[two].real, shapes[:, two]))
                continue
        modes += [_mode(motions, values[k], shapes[:, k], top) for k in alone]
    return modes


def _overdamped(motions: _Motions, one: float, two: float, shape: Complex) -> Mode:
    """Describe one overdamped mode."""
    omega = float(np.sqrt(one * two))
    return Mode(omega / (2 * np.pi), -(one + two) / 2 / omega, *_shape(motions, shape))


def _mode(motions: _Motions, value: complex, shape: Complex, top: float) -> Mode:
    """Describe the mode of one eigenvalue, of its conjugate too where it is complex."""
    kind, energy = _shape(motions, shape)
    if value.imag == 0 and value.real > 0:
        kind = "divergent"
    damping = 0.0 if abs(value.real) < ROUNDING * top else -float(value.real) / float(abs(value))
    return Mode(float(abs(value)) / (2 * np.pi), damping, kind, energy)


def _shape(motions: _Motions, shape: Complex) -> tuple[str, dict[str, float]]:
    """Classify a mode shape by the kinetic energy of its parts."""
    energy = motions.mass * np.abs(shape) ** 2
    energy = energy / energy.sum()
    groups = {"shifting": 0.0, "turning": 0.0, "planet shifting": 0.0, "planet turning": 0.0}
    parts: dict[str, float] = {}
    for state, share in zip(motions.states, energy.tolist(), strict=True):
        motion = "shifting" if state.axis in ("x", "y") else "turning"
        groups[("planet " if ".planet." in state.body else "") + motion] += share
        part = f"{state.body} {motion}"
        parts[part] = parts.get(part, 0.0) + share
    return _kind(groups), dict(sorted(parts.items(), key=lambda item: -item[1]))


def _kind(groups: dict[str, float]) -> str:
    """Name the class of a mode from its energy shares (Lin and Parker 1999 for planetary gears)."""
    shift, turn = groups["shifting"] > SHARE, groups["turning"] > SHARE
    if not shift and groups["planet shifting"] <= SHARE:
        return "torsional"
    if not shift and not turn:
        return "planet"
    if not shift:
        return "rotational"
    return "mixed" if turn else "translational"
