"""Modes: eigenvalues of the linear system, what each moves, and what kind it is."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eig
from scipy.sparse.csgraph import connected_components

from .system import Linear, Motions

Vector = NDArray[np.float64]
Complex = NDArray[np.complex128]
RIGID = 1e-6
"""A mode below this fraction of the highest frequency is a rigid-body mode."""
SHARE = 1e-6
"""Share of kinetic energy below which a group of freedoms counts as standing still."""
ROUNDING = 1e-12
"""A real part below this fraction of the highest eigenvalue is rounding: the mode has no damping."""
REPEATED = 1e-6
"""Difference of two eigenvalues over their size up to which they are one, repeated."""


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
    eigenvalue
        [1/s]; of two that are conjugate the one that turns forwards, of an overdamped pair the slower.
    shape
        Displacements and their rates, shape (kept states,), in SI units; any size.
    left
        The left vector: ``left.conj() @ shape`` is 1, and 0 for the shape of any other mode.
    group
        Number of the eigenvalue: modes that share it are repeated, and any mixture of them is one too.
    """

    frequency_hz: float
    damping_ratio: float
    kind: str
    energy: dict[str, float]
    eigenvalue: complex
    shape: Complex
    left: Complex
    group: int


@dataclass(frozen=True)
class _Eigen:
    """Eigenvalues [1/s], right and left vectors in columns, kept states in SI units; biorthonormal."""

    values: Complex
    right: Complex
    left: Complex
    groups: NDArray[np.int64]
    motions: Motions
    moved: Complex


def find_modes(linear: Linear) -> list[Mode]:
    """Return all modes of a linear system, ascending, rigid-body modes first."""
    found = _solve(linear)
    top = float(np.abs(found.values).max())
    elastic = np.abs(found.values) > RIGID * top
    modes = [_mode(found, k, top) for k in np.flatnonzero(elastic & (found.values.imag > 0))]
    modes += _real_modes(found, np.flatnonzero(elastic & (found.values.imag == 0)), top)
    rigid = np.flatnonzero(~elastic)[: (int((~elastic).sum()) + 1) // 2]
    return [_rigid(found, k) for k in rigid] + sorted(modes, key=lambda mode: mode.frequency_hz)


def _solve(linear: Linear) -> _Eigen:
    """Solve the eigenvalue problem with all states in units of their vibrations."""
    size = linear.scale[linear.kept]
    values, left, right = eig(linear.scaled(), left=True, right=True)
    groups = _groups(values)
    elastic = np.abs(values) > RIGID * np.abs(values).max()
    left[:, ~elastic] = 0.0
    for group in range(groups.max() + 1):
        same = np.flatnonzero((groups == group) & elastic)
        if len(same):
            overlap = left[:, same].conj().T @ right[:, same]
            left[:, same] = left[:, same] @ np.linalg.inv(overlap).conj().T
    moved = linear.motions.matrix[:, linear.kept] @ (right * size[:, None])
    return _Eigen(values, right * size[:, None], left / size[:, None], groups, linear.motions, moved)


def _groups(values: Complex) -> NDArray[np.int64]:
    """Number the eigenvalues so that repeated ones share a number."""
    near = np.abs(values[:, None] - values[None, :]) <= REPEATED * np.abs(values)[:, None]
    return np.asarray(connected_components(near, directed=False)[1], dtype=np.int64)


def _rigid(found: _Eigen, k: int) -> Mode:
    """Describe a rigid-body mode."""
    return Mode(0.0, 0.0, "rigid", {}, 0j, found.right[:, k], found.left[:, k], int(found.groups[k]))


def _real_modes(found: _Eigen, real: NDArray[np.int64], top: float) -> list[Mode]:
    """Describe the real eigenvalues: two that decay in like shapes are one overdamped mode.

    Such a pair has omega^2 = l1 l2 and zeta = -(l1 + l2) / 2 omega. One that grows stands alone, as does
    the one that decays in its shape, and one without a partner.
    """
    unit = np.sqrt(found.motions.mass)[:, None] * found.moved.real
    unit = unit / np.maximum(np.linalg.norm(unit, axis=0), 1e-300)
    left = sorted(real.tolist(), key=lambda k: -abs(found.values[k]))
    modes = []
    while left:
        one = left.pop(0)
        two = max(left, key=lambda k: abs(float(unit[:, one] @ unit[:, k])), default=None)
        alone = [one]
        if two is not None:
            left.remove(two)
            alone = [one, two]
            if max(found.values[one].real, found.values[two].real) < 0:
                modes.append(_overdamped(found, one, two))
                continue
        modes += [_mode(found, k, top) for k in alone]
    return modes


def _overdamped(found: _Eigen, one: int, two: int) -> Mode:
    """Describe one overdamped mode by its slower part, the second."""
    fast, slow = found.values[one].real, found.values[two].real
    omega = float(np.sqrt(fast * slow))
    damping = -float(fast + slow) / 2 / omega
    return Mode(omega / (2 * np.pi), damping, *_shape(found, two), *_vectors(found, two))


def _mode(found: _Eigen, k: int, top: float) -> Mode:
    """Describe the mode of one eigenvalue, of its conjugate too where it is complex."""
    value = complex(found.values[k])
    kind, energy = _shape(found, k)
    if value.imag == 0 and value.real > 0:
        kind = "divergent"
    damping = 0.0 if abs(value.real) < ROUNDING * top else -value.real / abs(value)
    return Mode(abs(value) / (2 * np.pi), damping, kind, energy, *_vectors(found, k))


def _vectors(found: _Eigen, k: int) -> tuple[complex, Complex, Complex, int]:
    """Return what a mode has of its eigenvalue."""
    return complex(found.values[k]), found.right[:, k], found.left[:, k], int(found.groups[k])


def _shape(found: _Eigen, k: int) -> tuple[str, dict[str, float]]:
    """Classify a mode shape by the kinetic energy of its parts."""
    energy = found.motions.mass * np.abs(found.moved[:, k]) ** 2
    energy = energy / energy.sum()
    groups = {"shifting": 0.0, "turning": 0.0, "planet shifting": 0.0, "planet turning": 0.0}
    parts: dict[str, float] = {}
    for state, share in zip(found.motions.states, energy.tolist(), strict=True):
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
