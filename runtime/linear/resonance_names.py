"""Names of parametric resonances: the modes that combine, omega_i + omega_j = n Omega."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .modes import Mode, find_modes
from .periodic import Periodic

Vector = NDArray[np.float64]
Complex = NDArray[np.complex128]
ALIKE = 0.02
"""Share of the largest part of a motion below which another mode's has nothing to do with its growth."""


@dataclass(frozen=True)
class Resonance:
    """A parametric resonance.

    Attributes
    ----------
    kind
        ``primary`` (2 omega_i = n Omega), ``combination`` (omega_i + omega_j = n Omega) or ``difference``
        (omega_i - omega_j = n Omega).
    modes
        Numbers i and j, counted from 1 as ``ltcgear modes`` lists them.
    frequencies_hz
        omega_i and omega_j over 2 pi.
    order
        n; Omega / 2 pi is the mesh frequency, or one over the common period of several stages.
    """

    kind: str
    modes: tuple[int, int]
    frequencies_hz: tuple[float, float]
    order: int

    @property
    def name(self) -> str:
        """Return it as an equation."""
        i, j = self.modes
        n = "" if self.order == 1 else f"{self.order} "
        if self.kind == "primary":
            return f"2 w{i} = {n}W"
        return f"w{i} {'+' if self.kind == 'combination' else '-'} w{j} = {n}W"


@dataclass(frozen=True)
class Oscillation:
    """One eigenvalue of the mean system, conjugates by themselves: number of its mode, vectors of unit size."""

    number: int
    group: int
    value: complex
    right: Complex
    left: Complex


class Naming:
    """Says which modes of the mean system a motion is made of."""

    def __init__(self, periodic: Periodic) -> None:
        self.base = 2 * np.pi / periodic.period
        self.parts = list_oscillations(periodic)

    def likeness(self, vector: Complex) -> tuple[int | None, float]:
        """Return the number and the angular frequency [rad/s] of the mode that a motion is most like."""
        if not self.parts:
            return None, 0.0
        best = int(np.argmax([abs(part.left.conj() @ vector) for part in self.parts]))
        return self.parts[best].number, abs(self.parts[best].value.imag)

    def resonance(self, vector: Complex) -> Resonance | None:
        """Return the two modes that a growing motion is made of, None if it is not made of two."""
        size: dict[tuple[int, bool], float] = {}
        first: dict[tuple[int, bool], Oscillation] = {}
        for part in self.parts:
            key = part.group, part.value.imag > 0
            size[key] = float(np.hypot(size.get(key, 0.0), abs(part.left.conj() @ vector)))
            first.setdefault(key, part)
        order = sorted(size, key=lambda key: -size[key])
        if len(order) < 2 or size[order[1]] < ALIKE * size[order[0]]:
            return None
        return combine(first[order[0]], first[order[1]], self.base)


def combine(one: Oscillation, two: Oscillation, base: float) -> Resonance | None:
    """Name the resonance of two eigenvalues at a base frequency [rad/s], None if no multiple is near."""
    order = abs(round((one.value.imag - two.value.imag) / base))
    if order == 0:
        return None
    kind = "primary" if one.group == two.group else "combination"
    if one.value.imag * two.value.imag > 0:
        kind = "difference"
    i, j = sorted((one, two), key=lambda part: part.number, reverse=kind == "difference")
    hertz = abs(i.value.imag) / (2 * np.pi), abs(j.value.imag) / (2 * np.pi)
    return Resonance(kind, (i.number, j.number), hertz, order)


def list_oscillations(periodic: Periodic) -> list[Oscillation]:
    """Return the eigenvalues of the mean system that oscillate, states in sizes of their vibration.

    Conjugates are adjacent, the one that turns forwards first.
    """
    size = periodic.linear.scale[periodic.linear.kept]
    found = []
    for number, mode in enumerate(find_modes(periodic.linear), start=1):
        if mode.eigenvalue.imag > 0:
            one = _oscillation(number, mode, size)
            found += [one, Oscillation(number, one.group, one.value.conjugate(), one.right.conj(), one.left.conj())]
    return found


def _oscillation(number: int, mode: Mode, size: Vector) -> Oscillation:
    """Return a mode in sizes of vibrations, its right vector of unit size."""
    right, left = mode.shape / size, mode.left * size
    length = np.linalg.norm(right)
    return Oscillation(number, mode.group, mode.eigenvalue, right / length, left * length)
