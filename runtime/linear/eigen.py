"""Eigenvalues of the linear system with right and left vectors: all of them, or the lowest of a large train."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from ltcgear.generated.errors import SolverError
from numpy.typing import NDArray
from scipy.linalg import eig, lu_factor, lu_solve, qr
from scipy.sparse import csc_array, csr_array, diags_array, eye_array
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import ArpackError, LinearOperator, eigs, splu

from .system import Linear

Vector = NDArray[np.float64]
Complex = NDArray[np.complex128]
RIGID = 1e-6
"""A mode below this fraction of the highest frequency is a rigid-body mode."""
REPEATED = 1e-6
"""Difference of two eigenvalues over their size up to which they are one, repeated."""
LARGE = 300
"""States from which the lowest modes are looked for by themselves, in place of all."""
SHIFT = 1e-4
"""About which part of the highest frequency the lowest modes are looked for."""
NULL = 1e-10
"""What is left of the forces on a freedom, over their sizes, up to which they cancel: rounding."""
ROUGH = 0.05
"""Relative accuracy with which copies of eigenvalues that were overlooked are looked for."""
UNBRAKED = 1e-11
"""Part of the highest frequency below which the decay of a rigid motion's speed is rounding."""
CLOSE = 1e-7
"""Part of the highest frequency about which rigid motions are looked for."""


@dataclass(frozen=True)
class Eigen:
    """Eigenvalues [1/s] of the elastic motions; right and left vectors in columns, kept states in SI units.

    Attributes
    ----------
    values, right, left
        ``left.conj().T @ right`` is the unit matrix.
    groups
        Number of each eigenvalue; repeated ones share it.
    rigid
        Motions that A makes nothing of, shape (n, number of rigid-body modes); trains that do not touch each
        other have columns of their own.
    top
        Largest modulus of an eigenvalue.
    braked
        How many rigid motions do not turn on for ever: each has a decay among the eigenvalues.
    """

    values: Complex
    right: Complex
    left: Complex
    groups: NDArray[np.int64]
    rigid: Vector
    top: float
    braked: int


def solve_eigen(linear: Linear, count: int | None = None) -> Eigen:
    """Solve the eigenvalue problem with all states in units of their vibrations.

    Parameters
    ----------
    linear
        The linear system.
    count
        How many of the lowest modes are wanted; all where left out. Where the model is small there are more.

    Raises
    ------
    SolverError
        If the matrix holds numbers that are not finite.
    """
    _check(linear)
    size = linear.scale[linear.kept]
    matrix = csc_array(diags_array(1.0 / size) @ linear.matrix @ diags_array(size))
    rates = csr_array((size[linear.positions] / size[linear.rates], (linear.rates, linear.positions)), matrix.shape)
    found = None
    if count is not None and len(size) > max(LARGE, 8 * count):
        found = _few(matrix, rates, count, 2 * count + 20) or _few(matrix, rates, count, 4 * count + 20)
    values, right, left, rigid, top, braked = found or _all(matrix, rates)
    groups = _groups(values)
    weights = np.sqrt(linear.motions.mass)[:, None] * linear.motions.matrix[:, linear.kept] * size
    for group in range(groups.max(initial=-1) + 1):
        same = np.flatnonzero(groups == group)
        right[:, same] = _orthogonal(right[:, same], weights)
        overlap = left[:, same].conj().T @ right[:, same]
        left[:, same] = left[:, same] @ np.linalg.inv(overlap).conj().T
    return Eigen(values, right * size[:, None], left / size[:, None], groups, rigid * size[:, None], top, braked)


def _check(linear: Linear) -> None:
    """Refuse a matrix that is not finite, by the names of the freedoms."""
    bad = np.flatnonzero(~np.isfinite(linear.matrix.data))
    if len(bad):
        rows = np.unique(linear.matrix.tocoo().coords[0][bad])
        everything = linear.library.manifest.states
        moving = {(state.body, state.axis): state.name for state in everything if state.kind == "deviation"}
        states = [everything[linear.kept[i]] for i in rows[:3]]
        names = ", ".join(moving.get((state.body, state.axis), state.name) for state in states)
        raise SolverError(
            f"no modes: the stiffness at {names} is not a finite number at the equilibrium; "
            "check the stiffness, mass and inertia there, and centre distances"
        )


Found = tuple[Complex, Complex, Complex, Vector, float, int]
Solve = Callable[[Vector, str], Vector]


def _all(matrix: csc_array, rates: csr_array) -> Found:
    """Find all eigenvalues by the dense method (QR)."""
    full = matrix.toarray()
    values, left, right = eig(full, left=True, right=True)
    top = float(np.abs(values).max())
    few = int((np.abs(values) <= RIGID * top).sum())
    near = top or 1.0  # gears that fly have no frequency at all
    factors = lu_factor(full - CLOSE * near * np.eye(len(full)))
    rigid, zeros = _rigid(matrix, rates, lambda b, form: np.asarray(lu_solve(factors, b, "NT".index(form))), few, near)
    elastic = np.sort(np.argsort(np.abs(values), kind="stable")[zeros:])
    return values[elastic], right[:, elastic], left[:, elastic], rigid, top, 2 * rigid.shape[1] - zeros


def _few(matrix: csc_array, rates: csr_array, count: int, wanted: int) -> Found | None:
    """Find the lowest eigenvalues by Arnoldi's method about a small shift (ARPACK); None if that fails.

    ``wanted`` are looked for; where the last of them are crowded, those of ``count`` modes may not be among them.
    """
    top, n = _top(matrix), matrix.shape[0]
    shift = SHIFT * top
    factors = splu(csc_array(matrix - shift * eye_array(n)))
    try:
        values, right = _about(matrix, shift, wanted, factors.solve)
        others, left = _about(csc_array(matrix.T), shift, wanted, lambda b: factors.solve(b, "T"))
        near = splu(csc_array(matrix - CLOSE * top * eye_array(n)))
        rigid, zeros = _rigid(matrix, rates, near.solve, int((np.abs(values) <= RIGID * top).sum()), top)
        # What was not found lies farther from the shift than all that was: nothing is missing below this modulus,
        reach = (1 - 1e-6) * min(np.abs(found - shift).max() for found in (values, others)) - shift
        inside, within = (np.argsort(np.abs(part))[zeros : (np.abs(part) < reach).sum()] for part in (values, others))
        if len(inside) != len(within) or rigid.shape[1] + (values[inside].imag >= 0).sum() < count:
            return None
        values, right, left = values[inside], right[:, inside], left[:, within].conj()
        right = _parted(right, _groups(values))
        left = left @ np.linalg.inv(left.conj().T @ right).conj().T
        # unless a copy of a repeated eigenvalue was overlooked: look once more, at what those found leave.
        rest, _ = _about(matrix, shift, zeros + 2, lambda b: _without(factors.solve(b), right, left), ROUGH)
    except (ArpackError, RuntimeError, np.linalg.LinAlgError):
        return None
    return (
        None
        if np.sort(np.abs(rest))[zeros] < (1 - ROUGH) * reach
        else (values, right, left, rigid, top, 2 * rigid.shape[1] - zeros)
    )


def _parted(vectors: Complex, groups: NDArray[np.int64]) -> Complex:
    """Return orthonormal vectors for every repeated eigenvalue: Arnoldi's are almost the same for all its copies."""
    for group in range(groups.max(initial=-1) + 1):
        same = np.flatnonzero(groups == group)
        vectors[:, same] = np.linalg.qr(vectors[:, same])[0]
    return vectors


def _without(vector: Vector, right: Complex, left: Complex) -> Vector:
    """Take the part along some right vectors from a vector."""
    return np.asarray(vector - (right @ (left.conj().T @ vector)).real)


def _about(
    matrix: csc_array, shift: float, wanted: int, solve: Callable[[Vector], Vector], tol: float = 0.0
) -> tuple[Complex, Complex]:
    """Return the eigenvalues next to a shift, and their vectors; the start is always the same.

    ``solve`` applies the inverse of the shifted matrix.
    """
    inverse = LinearOperator(matrix.shape, matvec=solve, dtype=np.float64)
    start = np.random.default_rng(0).standard_normal(matrix.shape[0])
    size = min(2 * wanted + 40, matrix.shape[0])
    values, vectors = eigs(matrix, wanted, sigma=shift, OPinv=inverse, v0=start, ncv=size, tol=tol)
    return np.asarray(values), np.asarray(vectors)


def _top(matrix: csc_array) -> float:
    """Return the largest modulus of an eigenvalue to 1 %: it only sets bounds."""
    start = np.random.default_rng(0).standard_normal(matrix.shape[0])
    return float(np.abs(eigs(matrix, 2, which="LM", v0=start, tol=1e-2, return_eigenvectors=False)).max())


def _rigid(matrix: csc_array, rates: csr_array, solve: Solve, few: int, top: float) -> tuple[Vector, int]:
    """Return the motions that a matrix makes nothing of, and how many of its eigenvalues are zero by them.

    A motion is rigid where the forces on every freedom cancel, not where they are small: a heavy rotor on a soft
    spring is not. Turning on has the eigenvalue zero too, unless something brakes it. With N the motions, W the
    states in which they turn on and Y what A leaves nothing of from the left, its eigenvalues are those of
    -(Y'W)^-1 Y'N.
    """
    motions = _null(matrix, lambda b: solve(b, "N"), few)
    count = motions.shape[1]
    if not count:
        return motions, 0
    left = _null(csc_array(matrix.T), lambda b: solve(b, "T"), few)
    braked = np.linalg.eigvals(np.linalg.solve(left.T @ (rates @ motions), left.T @ motions))
    # Freedoms of which each moves in one motion alone sort out trains that do not touch.
    leads = qr(motions.T, pivoting=True, mode="r")[1][:count]
    motions = motions @ np.linalg.inv(motions[leads])
    motions = np.where(np.abs(motions) > 1e-9 * np.abs(motions).max(axis=0), motions, 0.0)
    return motions, count + int((np.abs(braked) <= UNBRAKED * top).sum())


def _null(matrix: csc_array, solve: Callable[[Vector], Vector], few: int) -> Vector:
    """Return an orthonormal basis of what a matrix makes nothing of, by inverse iteration.

    ``few`` is the number of its eigenvalues next to zero.
    """
    space = np.random.default_rng(0).standard_normal((matrix.shape[0], few))
    for _ in range(12 if few else 0):
        space = np.linalg.qr(solve(space))[0]
    sizes = np.maximum(np.asarray(abs(matrix).sum(axis=1)).ravel(), 1e-300)
    left, turned = np.linalg.svd((matrix @ space) / sizes[:, None], full_matrices=False)[1:]
    return np.asarray(space @ turned[left <= NULL].T)


def _groups(values: Complex) -> NDArray[np.int64]:
    """Give the eigenvalues numbers so that repeated ones share a number."""
    near = np.abs(values[:, None] - values[None, :]) <= REPEATED * np.abs(values)[:, None]
    return np.asarray(connected_components(near, directed=False)[1], dtype=np.int64)


def _orthogonal(vectors: Complex, weights: Vector) -> Complex:
    """Return a basis of the vectors of one eigenvalue whose kinetic energies are apart; itself where it is none."""
    if vectors.shape[1] == 1:
        return vectors
    triangle = np.linalg.qr(weights @ vectors, mode="r")
    diagonal = np.abs(np.diag(triangle))
    return vectors @ np.linalg.inv(triangle / diagonal.max()) if diagonal.min() > 1e-6 * diagonal.max() else vectors
