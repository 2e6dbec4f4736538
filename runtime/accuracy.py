"""Achieved accuracy of mesh forces: the same window at the tolerance and at a tenth of it."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .batch import over_time
from .equilibrium import Equilibrium
from .integration import Told, Trajectory, integrate
from .library import Library
from .signals import Pairs

Vector = NDArray[np.float64]
Signal = Vector | NDArray[np.complex128]
WINDOW = 4096
"""Samples that are run twice, from the start on."""
PARTS = 8
"""Parts of the window whose differences are compared with each other."""
GROWTH = 10.0
"""Growth of the difference from the second to the last quarter by which runs part; with time squared it is 4."""
PARTED = 0.3
"""Difference over the vibration from which two runs are no longer the same motion."""
STILL = 1e-6
"""Vibration over the mean below which a force stands still."""
FINER = 0.1


def estimate_accuracy(
    library: Library, p: Vector, at: Equilibrium, *, t_end: float, rate: float, method: str, rtol: float,
    told: Told = lambda t: None, tables: Mapping[str, Pairs] | None = None,
) -> dict[str, Any]:  # fmt: skip
    """Run the first samples at ``rtol`` and at a tenth of it, and compare the mesh forces.

    The difference is the error of the first run but for a tenth of it or less, where errors fall with the tolerance.

    Parameters
    ----------
    library, p, at, t_end, rate, method, rtol, told, tables
        As ``integrate`` takes them.

    Returns
    -------
    dict
        ``window_s`` and ``rtol``; ``meshes``, by name the root mean square and the peak of the difference over
        the vibration (its standard deviation) and over the mean, None where there is nothing to refer to; ``worst``,
        the mesh with the largest; ``reason``, why there are no numbers, None if there are.
    """
    window = min(round(t_end * rate), WINDOW) / rate
    found = {"window_s": window, "rtol": [rtol, FINER * rtol], "meshes": {}, "worst": None, "reason": None}
    runs = []
    for tolerance in (rtol, FINER * rtol):
        path = integrate(
            library, p, at, t_end=window, rate=rate, method=method, rtol=tolerance, told=told, tables=tables
        )
        if path.status != "done":
            return found | {"reason": path.status}
        runs.append(path)
    names, forces = _forces(library, p, runs)
    if not names:
        return found | {"reason": "the model has no mesh"}
    together = (runs[0].levels == runs[1].levels).all(axis=1)
    reason = tell_parting(forces, together, window)
    if reason:
        return found | {"reason": reason}
    meshes = {name: compare_signals(*forces[:, together, i]) for i, name in enumerate(names)}
    worst = max(meshes, key=lambda name: meshes[name]["rms_over_vibration"] or 0.0)
    return found | {"meshes": meshes, "worst": worst}


def _forces(library: Library, p: Vector, runs: list[Trajectory]) -> tuple[list[str], Vector]:
    """Return the names of the meshes and their forces [N], shape (runs, times, meshes)."""
    reports = library.manifest.reports
    rows = [i for i, report in enumerate(reports) if report.quantity == "mesh_force"]
    outputs = [over_time(library, "outputs", run.x, run.s, p)[:, rows] for run in runs]
    return [reports[i].item for i in rows], np.array(outputs)


def compare_signals(coarse: Signal, fine: Signal) -> dict[str, float | None]:
    """Compare a signal with that of a finer run; one in a plane is given as x + iy.

    Returns
    -------
    dict
        Root mean square and peak of the difference over the finer signal's vibration (its standard deviation) and over
        its mean's magnitude; None where there is nothing to refer to.
    """
    difference = np.abs(coarse - fine)
    mean, vibration = float(np.abs(fine.mean())), float(fine.std())
    sizes = {"vibration": vibration if vibration > STILL * mean else 0.0, "mean": mean}
    errors = {"rms": float(np.sqrt(np.mean(difference**2))), "peak": float(difference.max())}
    return {
        f"{error}_over_{size}": value / scale if scale > 0 else None
        for size, scale in sizes.items()
        for error, value in errors.items()
    }


def tell_parting(forces: Vector, together: Vector, window: float) -> str | None:
    """Say that two runs part from each other, so that no tolerance gives the same motion for long; None if not."""
    pieces = np.array_split(np.arange(forces.shape[1]), PARTS)
    size = np.maximum(forces[1].std(axis=0), STILL * np.abs(forces[1]).mean(axis=0))
    moving = size > 0
    if len(pieces[0]) < 2 or not moving.any():
        return None
    apart = np.abs(forces[0] - forces[1])[:, moving] / size[moving] * together[:, None]
    largest = np.array([apart[piece].max() for piece in pieces])
    if largest[-2:].max() < max(PARTED, GROWTH * largest[2:4].max()):
        return None
    when = window * (int(np.argmax(largest >= PARTED)) + 1) / PARTS
    return (
        f"the two runs part: after {when:.3g} s at most their mesh forces differ by {PARTED:g} of the vibration, "
        "and the difference grows; only statistics of such a motion are to be used"
    )
