"""Floquet multipliers: what one period of the mesh stiffness makes of a small motion.

On a step of length h between two jumps A is A(t), and z is advanced by exp(h (A_1 + A_2) / 2 + h^2 sqrt(3) / 12 [A_2,
A_1]) with A at the two Gauss points of the step: Magnus's expansion of order four (Blanes, Casas, Oteo and Ros 2009,
Phys. Rep. 470:151, section 5). It is exact where A is constant between the jumps. The product over a period is the
monodromy matrix; its eigenvalues are the multipliers mu, and the motion grows where one lies outside the unit circle.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from ltcgear.generated.errors import SolverError
from numpy.typing import NDArray
from scipy.linalg import expm

from .periodic import Periodic
from .resonance_names import Naming, Resonance

Vector = NDArray[np.float64]
Complex = NDArray[np.complex128]
MARGIN = 1e-6
"""Growth in a period, ln |mu|, that counts as rounding."""
TOLERANCE = 1e-9
"""Error of the monodromy matrix, over its size, up to which steps are halved."""
FIRST = 16
"""Steps in a pitch to begin with, and at least as many as the fastest mode turns by half."""
FINEST = 20_000
"""The most steps in a period that are tried."""
LOST = 1e-12
"""Share of the largest multiplier below which another is lost in rounding."""


@dataclass(frozen=True)
class Multiplier:
    """A Floquet multiplier; of two that are conjugate the one whose angle is positive.

    Attributes
    ----------
    value
        mu: its motion returns mu times as large after a period.
    growth
        ln |mu| / T [1/s].
    frequency_hz
        Frequency of the motion, that of the mode it is most like.
    shape
        Motion at the start of a period, shape (kept states,), in SI units; any size.
    mode
        Number of the mode it is most like, counted from 1 as ``ltcgear modes`` lists them; None for a motion that
        does not oscillate.
    resonance
        What makes it grow, None if it does not.
    """

    value: complex
    growth: float
    frequency_hz: float
    shape: Complex
    mode: int | None
    resonance: Resonance | None


@dataclass(frozen=True)
class Floquet:
    """Multipliers of a periodic system.

    Attributes
    ----------
    periodic
        The system.
    variation
        Factor on the deviation of A from its mean.
    matrix
        Monodromy matrix, shape (n, n), states in sizes of their vibration.
    multipliers
        Largest first; those that rounding hides are left out.
    error
        Estimated error of the matrix over its size; 0 where A is constant between the jumps.
    """

    periodic: Periodic
    variation: float
    matrix: Vector
    multipliers: list[Multiplier]
    error: float

    @property
    def stable(self) -> bool:
        """Return whether no small motion grows."""
        return bool(np.log(abs(self.multipliers[0].value)) <= MARGIN)


def find_multipliers(
    periodic: Periodic, variation: float = 1.0, told: Callable[[float], None] | None = None
) -> Floquet:
    """Find the multipliers of a periodic system.

    Parameters
    ----------
    periodic
        The system.
    variation
        Factor on the deviation of A from its mean: 0 leaves the mean alone.
    told
        Is called with the part of the period that is done.

    Raises
    ------
    SolverError
        If no number of steps resolves what varies.
    """
    count, error = settle(periodic, variation)
    matrix = find_monodromies(periodic, [variation], count, told)[0]
    values, vectors = np.linalg.eig(matrix)
    naming = Naming(periodic)
    listed = [
        _multiplier(periodic, naming, complex(values[k]), vectors[:, k])
        for k in np.argsort(-np.abs(values))
        if values[k].imag >= 0 and abs(values[k]) > LOST * np.abs(values).max()
    ]
    return Floquet(periodic, variation, matrix, listed, error)


def settle(periodic: Periodic, variation: float, tolerance: float = TOLERANCE) -> tuple[int, float]:
    """Return how many steps in a period are fine enough, and the error that is left.

    Raises
    ------
    SolverError
        If no number of steps is.
    """
    if not periodic.follows:
        return 1, 0.0
    count = _first(periodic)
    before = find_monodromies(periodic, [variation], count)[0]
    while 2 * count <= FINEST:
        count *= 2
        now = find_monodromies(periodic, [variation], count)[0]
        error = float(np.linalg.norm(now - before) / np.linalg.norm(now)) / (2**4 - 1)
        if error <= tolerance:
            return count, error
        before = now
    raise SolverError(
        f"stability: {count} steps in a period do not resolve how the stiffness of {periodic.meshes[0]} varies; "
        "take two-level, a wider transition, or fewer meshes, --mesh"
    )


def find_monodromies(
    periodic: Periodic, variations: Sequence[float], count: int, told: Callable[[float], None] | None = None
) -> Vector:
    """Return the monodromy matrices under some variations, shape (variations, n, n).

    Parameters
    ----------
    periodic
        The system.
    variations
        Factors on the deviation of A from its mean.
    count
        Steps in a period, about.
    told
        Is called with the part of the period that is done.
    """
    found = periodic.mean(count)
    # The samples hold the meshes that do not vary as they stand at the start; the linear system has their means.
    mean = found if periodic.whole else periodic.linear.scaled()
    products, done = np.array([np.eye(len(mean))] * len(variations)), 0.0
    for lengths, one, two in periodic.samples(count):
        for i, factor in enumerate(variations):
            first, second = (mean + factor * (part - found) for part in (one, two))
            products[i] = _product(_exponentials(first, second, lengths * periodic.period)) @ products[i]
        done += float(lengths.sum())
        if told is not None:
            told(done)
    return products


def _first(periodic: Periodic) -> int:
    """Return with how many steps in a period to begin."""
    pitches = max(abs(n) for n in periodic.cycles.values())
    fastest = float(np.abs(np.linalg.eigvals(periodic.linear.scaled())).max())
    return max(FIRST * pitches, int(np.ceil(fastest * periodic.period / np.pi)))


def _exponentials(one: Vector, two: Vector, h: Vector) -> Vector:
    """Return what steps of lengths h [s] make of z, shape (m, n, n)."""
    h = h[:, None, None]
    omega = h * (one + two) / 2
    if one is not two and not np.array_equal(one, two):
        omega = omega + h**2 * (np.sqrt(3) / 12) * (two @ one - one @ two)
    return np.asarray(expm(omega))


def _product(factors: Vector) -> Vector:
    """Return the product of matrices, the first one rightmost, by halves."""
    while len(factors) > 1:
        paired = factors[1::2] @ factors[: len(factors) - len(factors) % 2 : 2]
        factors = np.concatenate([paired, factors[-1:]]) if len(factors) % 2 else paired
    return np.asarray(factors[0])


def _multiplier(periodic: Periodic, naming: "Naming", value: complex, vector: Complex) -> Multiplier:
    """Describe a multiplier."""
    size = periodic.linear.scale[periodic.linear.kept]
    growth = float(np.log(abs(value)) / periodic.period)
    mode, near = naming.likeness(vector)
    turned, whole = np.angle(value) / periodic.period, 2 * np.pi / periodic.period
    candidates = [abs(sign * turned + whole * round((near - sign * turned) / whole)) for sign in (1, -1)]
    frequency = min(candidates, key=lambda each: abs(each - near))
    grows = growth * periodic.period > MARGIN
    resonance = naming.resonance(vector) if grows else None
    return Multiplier(value, growth, float(frequency / (2 * np.pi)), vector * size, mode, resonance)
