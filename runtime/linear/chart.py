"""Stability chart: the largest Floquet multiplier over the reference's speed and the stiffness' variation."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from ltcgear.generated.errors import LtcgearError, SolverError
from numpy.typing import NDArray

from ..model.library import Library
from .floquet import MARGIN, find_monodromies, settle
from .periodic import Periodic, take_sense, vary
from .tongues import Tongue, find_tongues, strongest_first

Vector = NDArray[np.float64]
RPM = 2 * np.pi / 60
"""[rad/s]"""
TOLERANCE = 1e-6
"""Error of a monodromy matrix over its size."""
MOST_STEPS = 5_000_000
"""Matrix exponentials of a chart beyond which it is refused: half an hour and more."""


@dataclass(frozen=True)
class Chart:
    """Largest multipliers over speed and variation.

    Attributes
    ----------
    meshes
        The meshes whose stiffness varies.
    speeds
        Sizes of the reference's speed [rad/s], shape (k,); its sense is the scene's.
    variations
        Factors on the stiffness' deviation from its mean, shape (m,).
    base_hz
        One over the common period at each speed, shape (k,): the mesh frequency where one stage varies.
    largest
        Largest |mu|, shape (k, m).
    tongues
        First-order tongues with their middles between the speeds, the widest first.
    """

    meshes: list[str]
    speeds: Vector
    variations: Vector
    base_hz: Vector
    largest: Vector
    tongues: list[Tongue]

    @property
    def growth(self) -> Vector:
        """Return ln |mu| / T [1/s], shape (k, m)."""
        return np.asarray(np.log(self.largest) * self.base_hz[:, None])

    @property
    def stable(self) -> NDArray[np.bool_]:
        """Return where no small motion grows, shape (k, m)."""
        return np.asarray(np.log(self.largest) <= MARGIN)


def draw_up(
    library: Library, p: Vector, speeds: Vector, variations: Vector, mesh: str | None = None,
    told: Callable[[int], None] = lambda done: None,
) -> Chart:  # fmt: skip
    """Compute a chart.

    At every speed the equilibrium, and with it A, is that of this speed.

    Parameters
    ----------
    library, p
        The model and its parameters.
    speeds
        Sizes of the reference's speed [rad/s], ascending and above 0.
    variations
        Factors on the deviation of the stiffness from its mean, ascending.
    mesh
        Whose stiffness varies, see `vary`.
    told
        Is called with the number of speeds that are done.

    Raises
    ------
    LtcgearError
        If the chart would take too long, or nothing is periodic.
    SolverError
        If there is no equilibrium at a speed, or no number of steps resolves the stiffness.
    """
    if not speeds[0] > 0:
        raise LtcgearError("--speed 0: at rest no stiffness varies; begin above 0")
    edges = np.concatenate([speeds[:1], (speeds[1:] + speeds[:-1]) / 2, speeds[-1:] * (1 + 1e-12)])
    largest, base, tongues = np.empty((len(speeds), len(variations))), np.empty(len(speeds)), list[Tongue]()
    meshes: list[str] = []
    for k, speed in enumerate(speeds.tolist()):
        try:
            periodic = vary(library, p, mesh, take_sense(library, p, speed))
        except SolverError as error:
            raise SolverError(f"speed {speed / RPM:g} rpm: {error}") from error
        meshes, base[k] = periodic.meshes, 1 / periodic.period
        largest[k] = _largest(periodic, variations, len(speeds))
        tongues += find_tongues(periodic, speed, edges[k], edges[k + 1])
        told(k + 1)
    return Chart(meshes, speeds, variations, base, largest, strongest_first(tongues))


def _largest(periodic: Periodic, variations: Vector, speeds: int) -> Vector:
    """Return the largest |mu| under each variation."""
    count, _ = settle(periodic, float(variations[-1]), TOLERANCE)
    steps = len(periodic.steps(count)[0])
    if steps * len(variations) * speeds > MOST_STEPS:
        stages = periodic.mesh_frequencies
        fewer = f", or vary fewer meshes, --mesh {next(iter(stages))}" if len(stages) > 1 else ""
        raise LtcgearError(
            f"stability: {len(variations) * speeds} points of {steps} steps in a common period are too many; "
            f"take {max(MOST_STEPS // steps, 1)} points at most{fewer}"
        )
    return np.asarray(np.abs(np.linalg.eigvals(find_monodromies(periodic, variations.tolist(), count))).max(axis=1))
