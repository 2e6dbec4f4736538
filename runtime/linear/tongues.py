"""Instability tongues: where varying stiffness makes two modes grow, to first order.

With z = sum of c_k r_k and A(t) = A_0 + v sum of A_n exp(i n Omega t), two modes a, b whose eigenvalues differ by about
i n Omega see of each other

    c_a' = l_a c_a + v X exp(i n Omega t) c_b,   c_b' = l_b c_b + v Y exp(-i n Omega t) c_a,

X = left_a^H A_n right_b and Y = left_b^H A_-n right_a, all others but small ripple. With the decays d_a, d_b and the
detuning D = n Omega - Im(l_a - l_b) the amplitudes grow where

    v^2 X Y > d_a d_b (1 + D^2 / (d_a + d_b)^2),

which is |D| < 2 v sqrt(X Y) without damping. For l_b = -i omega_j it is the boundary of Lin and Parker (2002, J. Sound
Vib. 249:129) for omega_i + omega_j = n Omega, and of Nayfeh and Mook (1979, Nonlinear Oscillations, chapter 5) with
damping. Of repeated modes the pair that couples most counts.
"""

from dataclasses import dataclass
from itertools import product
from math import ceil

import numpy as np
from numpy.typing import NDArray

from ..model.ties import order_by_size
from .periodic import Periodic
from .resonance_names import Oscillation, Resonance, combine, list_oscillations

Vector = NDArray[np.float64]
Complex = NDArray[np.complex128]
Indices = NDArray[np.int64]
FINE = 64
"""Steps in a pitch by which the harmonics of A are summed where it varies between jumps too."""
FAINT = 1e-4
"""Coupling sqrt(X Y) over the modes' mean frequency below which there is no tongue."""
MOST_ORDERS = 40
"""Tongues of higher orders are too narrow to matter, and too many."""
ROUNDING = 1e-12
"""Decay over the modes' frequencies that is rounding: there is no damping."""


@dataclass(frozen=True)
class Tongue:
    """A region in which two modes grow, by first-order theory.

    Attributes
    ----------
    resonance
        What combines.
    speed
        Speed of the reference [rad/s] in its middle.
    base
        Omega at that speed [rad/s].
    coupling
        sqrt(X Y) [1/s], for the variation 1.
    decays
        d_a, d_b [1/s].
    """

    resonance: Resonance
    speed: float
    base: float
    coupling: float
    decays: tuple[float, float]

    @property
    def least(self) -> float:
        """Return the smallest variation at which it grows."""
        return float(np.sqrt(max(self.decays[0], 0.0) * max(self.decays[1], 0.0)) / self.coupling)

    def half_width(self, variation: Vector) -> Vector:
        """Return how far from its middle the speed may lie [rad/s] for the motion to grow; nan where it does not."""
        one, two = (max(decay, 0.0) for decay in self.decays)
        drive = (np.asarray(variation) * self.coupling) ** 2
        square = (one + two) ** 2 * (drive / (one * two) - 1) if one * two > 0 else 4 * drive
        detuning = np.sqrt(np.where(square >= 0, square, np.nan))
        return np.asarray(detuning / self.resonance.order / self.base * abs(self.speed))


def find_tongues(periodic: Periodic, speed: float, low: float, high: float) -> list[Tongue]:
    """Find the tongues whose middles lie between two speeds, the widest first.

    Parameters
    ----------
    periodic
        The system.
    speed
        Speed of its reference [rad/s].
    low, high
        Sizes of speeds [rad/s]; eigenfrequencies are those at ``speed``.
    """
    parts, base = list_oscillations(periodic), 2 * np.pi / periodic.period
    near = _between(parts, base * low / abs(speed), base * high / abs(speed))
    if not near:
        return []
    left, right = (np.array([getattr(part, side) for part in parts]).T for side in ("left", "right"))
    found = []
    for n, harmonic in enumerate(harmonics(periodic, max(near)), start=1):
        if n in near:
            up = left.conj().T @ (harmonic @ right)
            tongues = (_tongue(parts, pair, n, up, speed / base) for pair in near[n])
            found += [tongue for tongue in tongues if tongue is not None]
    return strongest_first(found)


def strongest_first(tongues: list[Tongue]) -> list[Tongue]:
    """Return tongues by their growth at full variation, largest first."""
    sizes = [float(tongue.coupling / tongue.resonance.order) for tongue in tongues]
    return [tongues[k] for k in order_by_size(sizes, [tongue.resonance.name for tongue in tongues])]


def _between(parts: list[Oscillation], low: float, high: float) -> dict[int, list[tuple[Indices, Indices]]]:
    """Return by order n the pairs of groups of equal eigenvalues with low <= Omega < high, each pair once."""
    groups: dict[tuple[int, bool], list[int]] = {}
    for k, part in enumerate(parts):
        groups.setdefault((part.group, part.value.imag > 0), []).append(k)
    found: dict[int, list[tuple[Indices, Indices]]] = {}
    for one, two in product(groups.values(), repeat=2):
        apart = parts[one[0]].value.imag - parts[two[0]].value.imag
        if abs(parts[two[0]].value.imag) > parts[one[0]].value.imag:
            continue  # the faster mode comes first, in sums and differences
        for n in range(max(ceil(apart / high), 1), min(int(apart / low), MOST_ORDERS) + 1):
            if low <= apart / n < high:
                found.setdefault(n, []).append((np.array(one), np.array(two)))
    return found


def harmonics(periodic: Periodic, count: int) -> Complex:
    """Return A_1, A_2, ... [1/s], each step between jumps by its mean, shape (count, n, n)."""
    pitches = max(abs(n) for n in periodic.cycles.values())
    steps = max(FINE * pitches, 4 * count)
    starts, _ = periodic.steps(steps)
    n, done = np.arange(1, count + 1), 0
    total = np.zeros((count, *periodic.linear.matrix.shape), dtype=np.complex128)
    for lengths, one, two in periodic.samples(steps):
        start = starts[done : done + len(lengths)]
        ends = np.exp(-2j * np.pi * np.outer(n, start)), np.exp(-2j * np.pi * np.outer(n, start + lengths))
        weight = (ends[0] - ends[1]) / (2j * np.pi * n)[:, None]
        total += np.tensordot(weight, (one + two) / 2, 1)
        done += len(lengths)
    return total


def _tongue(
    parts: list[Oscillation], pair: tuple[Indices, Indices], n: int, up: Complex, ratio: float
) -> Tongue | None:
    """Return the tongue of order n of two groups of eigenvalues, None if they are not coupled."""
    a, b = pair
    one, two = parts[a[0]], parts[b[0]]
    # A_-n is the conjugate of A_n, and conjugate parts are neighbours: Y follows from X of the conjugates.
    x, y = up[a[:, None], b], up[b[:, None] ^ 1, a ^ 1].conj()
    apart = one.value.imag - two.value.imag
    least = (FAINT * apart / 2) ** 2
    if np.linalg.norm(x) * np.linalg.norm(y) < least:
        return None
    strength = float(np.linalg.eigvals(x @ y).real.max())
    resonance = combine(one, two, apart / n)
    if strength < least or resonance is None:
        return None
    decays = [0.0 if abs(part.value.real) < ROUNDING * apart else -part.value.real for part in (one, two)]
    return Tongue(resonance, ratio * apart / n, apart / n, float(np.sqrt(strength)), (decays[0], decays[1]))
