"""Modes: eigenvalues of the linear system, what each moves, and what kind it is."""

from collections import Counter
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ..model.ties import largest_first
from .eigen import Eigen, solve_eigen
from .system import Linear, Motions

Vector = NDArray[np.float64]
Complex = NDArray[np.complex128]
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
    eigenvalue
        [1/s]; of two that are conjugate the one that turns forwards, of an overdamped pair the slower.
    shape
        Displacements and their rates, shape (kept states,), in SI units; any size.
    left
        The left vector: ``left.conj() @ shape`` is 1, and 0 for the shape of any other mode.
    group, multiplicity
        Number of the eigenvalue from 0, ascending, and how many modes share it: any mixture of them is a mode too.
    members
        Share of kinetic energy by body, largest first.
    strain, name
        Share of strain energy by element, largest first, and what moves against what: see ``describe_modes``.
    """

    frequency_hz: float
    damping_ratio: float
    kind: str
    energy: dict[str, float]
    eigenvalue: complex
    shape: Complex
    left: Complex
    group: int
    members: dict[str, float]
    multiplicity: int = 1
    strain: dict[str, float] = field(default_factory=dict)
    name: str = ""


@dataclass(frozen=True)
class _Found:
    """What modes are made of: eigenvalues, motions, and how eigenvectors and rigid motions move them, in columns."""

    eigen: Eigen
    motions: Motions
    moved: Complex
    rigid: Vector


def find_modes(linear: Linear, count: int | None = None) -> list[Mode]:
    """Return the modes of a linear system, ascending, rigid-body modes first.

    Parameters
    ----------
    linear
        The linear system.
    count
        How many of the lowest; all where left out.
    """
    eigen = solve_eigen(linear, count)
    carried = linear.motions.matrix[:, linear.kept]
    found = _Found(eigen, linear.motions, carried @ eigen.right, carried @ eigen.rigid)
    modes = [_mode(found, k) for k in np.flatnonzero(eigen.values.imag > 0).tolist()]
    modes += _real_modes(found, np.flatnonzero(eigen.values.imag == 0))
    rigid = [_rigid(found, k) for k in range(eigen.rigid.shape[1])]
    return _grouped([*rigid, *sorted(modes, key=lambda mode: mode.frequency_hz)])[:count]


def _grouped(modes: list[Mode]) -> list[Mode]:
    """Renumber the eigenvalues in ascending order, and count the modes of each."""
    number = {group: k for k, group in enumerate(dict.fromkeys(mode.group for mode in modes))}
    times = Counter(mode.group for mode in modes)
    return [replace(mode, group=number[mode.group], multiplicity=times[mode.group]) for mode in modes]


def _rigid(found: _Found, k: int) -> Mode:
    """Describe a rigid-body mode."""
    shape = found.eigen.rigid[:, k].astype(complex)
    members = _members(_shape(found.motions, found.rigid[:, k].astype(complex))[1])
    return Mode(0.0, 0.0, "rigid", {}, 0j, shape, np.zeros_like(shape), -1, members)


def _real_modes(found: _Found, real: NDArray[np.int64]) -> list[Mode]:
    """Describe the real eigenvalues: two that decay in like shapes are one overdamped mode.

    Such a pair has omega^2 = l1 l2 and zeta = -(l1 + l2) / 2 omega. A growing one is single, as does
    the one that decays in its shape, and one without a partner: a rigid motion that is braked.
    """
    unit = np.sqrt(found.motions.mass)[:, None] * found.moved.real
    unit = unit / np.maximum(np.linalg.norm(unit, axis=0), 1e-300)
    order = sorted(real.tolist(), key=lambda k: -abs(found.eigen.values[k]))
    decays = _decays(found, unit, order)
    left = [k for k in order if k not in decays]
    modes = [_mode(found, k) for k in decays]
    while left:
        one = left.pop(0)
        two = max(left, key=lambda k: abs(float(unit[:, one] @ unit[:, k])), default=None)
        alone = [one]
        if two is not None:
            left.remove(two)
            alone = [one, two]
            if max(found.eigen.values[one].real, found.eigen.values[two].real) < 0:
                modes.append(_overdamped(found, one, two))
                continue
        modes += [_mode(found, k) for k in alone]
    return modes


def _decays(found: _Found, unit: Vector, real: list[int]) -> list[int]:
    """Return the eigenvalues by which rigid motions come to rest: those that are most like rigid motions."""
    rigid = np.sqrt(found.motions.mass)[:, None] * found.rigid
    part = np.linalg.norm(np.linalg.qr(rigid)[0].T @ unit, axis=0)
    alike = [k for k in sorted(real, key=lambda k: -part[k]) if part[k] > 0.5 and found.eigen.values[k].real < 0]
    return alike[: found.eigen.braked]


def _overdamped(found: _Found, one: int, two: int) -> Mode:
    """Describe one overdamped mode by its slower part, the second."""
    fast, slow = found.eigen.values[one].real, found.eigen.values[two].real
    omega = float(np.sqrt(fast * slow))
    damping = -float(fast + slow) / 2 / omega
    return _described(found, two, omega, damping)


def _mode(found: _Found, k: int) -> Mode:
    """Describe the mode of one eigenvalue, of its conjugate too where it is complex."""
    value = complex(found.eigen.values[k])
    damping = 0.0 if abs(value.real) < ROUNDING * found.eigen.top else -value.real / abs(value)
    mode = _described(found, k, abs(value), damping)
    return replace(mode, kind="divergent") if value.imag == 0 and value.real > 0 else mode


def _described(found: _Found, k: int, omega: float, damping: float) -> Mode:
    """Describe a mode by one of its eigenvalues."""
    eigen = found.eigen
    kind, energy = _shape(found.motions, found.moved[:, k])
    vectors = complex(eigen.values[k]), eigen.right[:, k], eigen.left[:, k], int(eigen.groups[k])
    return Mode(omega / (2 * np.pi), damping, kind, energy, *vectors, _members(energy))


def _shape(motions: Motions, moved: Complex) -> tuple[str, dict[str, float]]:
    """Classify a mode shape by the kinetic energy of its parts."""
    energy = motions.mass * np.abs(moved) ** 2
    energy = energy / energy.sum()
    groups = {"shifting": 0.0, "turning": 0.0, "planet shifting": 0.0, "planet turning": 0.0}
    parts: dict[str, float] = {}
    for state, whose, share in zip(motions.states, motions.parts, energy.tolist(), strict=True):
        motion = "turning" if state.turns else "shifting"
        groups[("planet " if whose == "planet" else "") + motion] += share
        part = f"{state.body} {motion}"
        parts[part] = parts.get(part, 0.0) + share
    return _kind(groups), largest_first(parts)


def _members(energy: dict[str, float]) -> dict[str, float]:
    """Add up the energy of each body, shifting and turning."""
    members: dict[str, float] = {}
    for part, share in energy.items():
        body = part.rpartition(" ")[0]
        members[body] = members.get(body, 0.0) + share
    return largest_first(members)


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
