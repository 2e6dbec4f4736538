"""Sensitivity of eigenvalues to all parameters, repeated eigenvalues included."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..model.state_matrix import Equilibrium
from .balance import Balance
from .gradients import Gradients
from .modes import Mode
from .system import Linear

Vector = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True)
class ModeDerivative:
    """How an eigenvalue follows the parameters.

    Where eigenvalues are repeated, each parameter parts them in its own way: the derivatives of one are those of
    the frequency that rises most, of the next one those of the next, and so on.

    Attributes
    ----------
    number
        Number of the mode in the list of modes, from 1.
    mode
        The mode.
    repeated
        How many modes share the eigenvalue.
    eigenvalue
        d lambda / dp, shape (n_p,), 1/s over the unit of each parameter.
    frequency_hz, damping_ratio
        d |lambda| / 2 pi / dp and d zeta / dp, zeta = - Re lambda / |lambda|, shape (n_p,).
    """

    number: int
    mode: Mode
    repeated: int
    eigenvalue: Complex
    frequency_hz: Vector
    damping_ratio: Vector


def differentiate_modes(
    linear: Linear, modes: list[Mode], numbers: list[int] | None = None, at: Equilibrium | None = None
) -> list[ModeDerivative]:
    """Differentiate eigenvalues with respect to all parameters.

    With left vectors Y and right ones X of one eigenvalue, Y^H X = 1, the derivatives are the eigenvalues of
    Y^H (dA/dp) X (Nelson 1976 where it is single; Mills-Curran 1988 and Friswell 1996 where it is repeated). A is
    that of the equilibrium, which moves with p, and so do the mean levels of switched meshes.

    Parameters
    ----------
    linear
        The linear system.
    modes
        All its modes, as ``find_modes`` lists them.
    numbers
        Those wanted, counted from 1; all where left out. Rigid-body modes have no derivatives and are left out.
    at
        The equilibrium as it was found, where the linear system holds at one angle of the reference: its levels do
        not move with p.

    Returns
    -------
    list of ModeDerivative
        In the order of the modes. Derivatives are NaN for a parameter that leaves no equilibrium when it moves.
    """
    gradients = Gradients(linear.library)
    balance = Balance(gradients, linear.p, at or linear.at)
    found: list[ModeDerivative] = []
    groups: dict[int, list[int]] = {}
    for number, mode in enumerate(modes, start=1):
        if mode.kind != "rigid":
            groups.setdefault(mode.group, []).append(number)
    for members in groups.values():
        if numbers is None or set(members) & set(numbers):
            alike = [modes[k - 1] for k in members]
            shifts = _shifts(linear, gradients, balance, alike, at is None)
            found += [
                _derivative(k, modes[k - 1], shift, len(members)) for k, shift in zip(members, shifts, strict=True)
            ]
    wanted = [item for item in found if numbers is None or item.number in numbers]
    return sorted(wanted, key=lambda item: item.number)


def _shifts(linear: Linear, gradients: Gradients, balance: Balance, modes: list[Mode], moving: bool) -> Complex:
    """Return the derivatives of an eigenvalue, shape (modes, n_p), for each parameter the largest rise first."""
    count = len(linear.p)
    matrix = np.zeros((len(modes), len(modes), count), dtype=np.complex128)
    right, left = (_whole(linear, [getattr(mode, name) for mode in modes]) for name in ("shape", "left"))
    for i, w in enumerate(left):
        for k, v in enumerate(right):
            matrix[i, k] = _product(linear, gradients, balance, v, w, moving)
    if len(modes) == 1:
        return np.asarray(matrix[0])
    undefined = np.isnan(matrix).any(axis=(0, 1))
    matrix[:, :, undefined] = 0.0
    shifts: Complex = np.linalg.eigvals(matrix.transpose(2, 0, 1)).astype(np.complex128).T
    shifts[:, undefined] = np.nan
    value = np.mean([mode.eigenvalue for mode in modes])
    order = np.argsort(-(np.conj(value) * shifts).real, axis=0, kind="stable")
    return np.take_along_axis(shifts, order, axis=0)


def _product(
    linear: Linear, gradients: Gradients, balance: Balance, v: Complex, w: Complex, moving: bool
) -> Complex:  # fmt: skip
    """Return the derivative of w^H A v with respect to all parameters."""
    x, s, p = gradients.of_product(linear.at.x, linear.at.s, linear.p, v, w)
    held = np.zeros(len(s))
    real = balance.pull_back(x.real, s.real if moving else held)
    imaginary = balance.pull_back(x.imag, s.imag if moving else held)
    return np.asarray(p + real + 1j * imaginary)


def _whole(linear: Linear, vectors: list[Complex]) -> Complex:
    """Return vectors of the kept states as vectors of all states, one a row."""
    whole = np.zeros((len(vectors), len(linear.at.x)), dtype=np.complex128)
    whole[:, linear.kept] = vectors
    return whole


def _derivative(number: int, mode: Mode, shift: Complex, repeated: int) -> ModeDerivative:
    """Turn the derivatives of an eigenvalue into those of frequency and damping ratio."""
    value = mode.eigenvalue
    size = abs(value)
    modulus = (np.conj(value) * shift).real / size
    damping = -shift.real / size + value.real * modulus / size**2
    return ModeDerivative(number, mode, repeated, shift, modulus / (2 * np.pi), damping)
