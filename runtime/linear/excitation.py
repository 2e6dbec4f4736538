"""Parametric excitation: harmonics with which a mesh's stiffness and errors drive small motions."""

import numpy as np
from numpy.typing import NDArray

from ..model.contact_levels import Phases
from ..model.function import Kernel
from ..model.members import train_of
from ..model.phase_wrapping import TURN
from .orders import mesh_advances
from .system import Linear

Vector = NDArray[np.float64]
Complex = NDArray[np.complex128]
SAMPLES = 1024
"""Phases of a tooth pitch at which forces are read."""


def find_harmonics(linear: Linear, p: Vector, count: int) -> dict[str, Complex]:
    """Return the complex amplitudes [N] of each mesh force's variation with all bodies at rest.

    Deflections are held at those of the equilibrium while the mesh phase advances by one pitch. What the force then
    does, (k(tau) - k) delta and k e of errors, is what drives the motion to first order.

    Parameters
    ----------
    linear
        The linear system at the equilibrium.
    p
        The parameters of the scene, by which stiffness and errors vary (``linear.p`` has their means).
    count
        How many harmonics of the mesh frequency.

    Returns
    -------
    dict
        Mesh -> shape (count,): u_h of u(t) = Re sum u_h exp(i h omega t), time 0 at the equilibrium's phase.
    """
    library = linear.library
    names = [state.name for state in library.manifest.states]
    if "reference.angle" not in names:
        return {}
    phases = Phases(*(part.copy() for part in Kernel(library.functions["phases"])(linear.at.x, linear.at.s, p)))
    outputs, angle, sense = Kernel(library.functions["outputs"]), names.index("reference.angle"), _sense(linear, p)
    places = (np.arange(SAMPLES) + 0.5) / SAMPLES
    waves = np.exp(-1j * TURN * np.outer(np.arange(1, count + 1), places)) * (2 / SAMPLES)
    train, found = train_of(library.manifest), dict[str, Complex]()
    for stage, advance in mesh_advances(library.manifest, p).items():
        columns = [i for i, r in enumerate(library.manifest.reports) if r.quantity == "mesh_force"]
        columns = [i for i in columns if train.stage(library.manifest.reports[i].item) == stage]
        forces = np.empty((SAMPLES, len(columns)))
        for row, place in enumerate(places):
            x = linear.at.x.copy()
            x[angle] += sense * TURN * place / abs(advance)
            levels = _mean_levels(phases.tau + place, phases.share)
            forces[row] = outputs(x, np.concatenate([levels, linear.at.signals]), p)[0][columns]
        found |= {library.manifest.reports[i].item: u for i, u in zip(columns, (waves @ forces).T, strict=True)}
    return found


def _mean_levels(tau: Vector, share: Vector) -> Vector:
    """Return the mean levels about mesh phases, over the distance of two samples: a jump counts where it lies."""

    def double(tau: Vector) -> Vector:
        """Return the double contact that has gone by until a phase [cycles]."""
        whole = np.floor(tau)
        return np.asarray(whole * (1.0 - share) + np.maximum(tau - whole - share, 0.0))

    return (double(tau + 0.5 / SAMPLES) - double(tau - 0.5 / SAMPLES)) * SAMPLES


def _sense(linear: Linear, p: Vector) -> float:
    """Return the sense in which the reference turns."""
    names = [name for name, _ in linear.library.manifest.parameters]
    speed = p[names.index("reference.speed")] if "reference.speed" in names else 1.0
    return -1.0 if speed < 0 else 1.0
