"""Verification of a run: mesh forces and statistics at its tolerance and at a tenth of it."""

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..model.operating_point import OperatingPoint
from ..results.dataset import make_dataset
from ..results.samples import Rows, join_rows
from ..results.signal_errors import STILL, compare_signals
from ..results.statistics import statistics
from .integration import Integration
from .low_pass import passing_speed
from .method_limits import check_run
from .output_reader import Reader, motion_statistics
from .run_settings import RunSettings
from .trajectory import Told

if TYPE_CHECKING:
    import xarray as xr

Vector = NDArray[np.float64]
WINDOW = 4096
"""Samples that are run twice, from the start on."""
PARTS = 8
"""Parts of the window whose differences are compared with each other."""
GROWTH = 10.0
"""Growth of the difference from the second to the last quarter by which runs part; with time squared it is 4."""
PARTED = 0.3
"""Difference over the vibration from which two runs are no longer the same motion."""
FINER = 0.1
TOLD = ("mean", "min", "max", "rms", "load_factor")
"""Statistics of a mesh force in a summary."""


def estimate_accuracy(
    point: OperatingPoint, settings: RunSettings, told: Told = lambda t: None
) -> dict[str, Any]:  # fmt: skip
    """Run the first samples at ``rtol`` and at a tenth of it, and compare the mesh forces.

    The difference is the error of the first run but for a tenth of it or less, where errors fall with the tolerance.

    Parameters
    ----------
    point, settings
        Where the run begins and how it goes.
    told
        Called with the simulated time now and then.

    Returns
    -------
    dict
        ``window_s`` and ``rtol``; ``meshes``, by name the root mean square and the peak of the difference over
        the vibration (its standard deviation) and over the mean, None if there is nothing to refer to, and for each
        of ``TOLD`` the change of that statistic of the window's second half over its size; ``worst``, the mesh with the
        largest; ``reason``, why there are no numbers, None if there are.
    """
    rtol, window = settings.rtol, min(settings.samples, WINDOW) / settings.sampling_rate
    found = {"window_s": window, "rtol": [rtol, FINER * rtol], "meshes": {}, "worst": None, "reason": None}
    runs = []
    for tolerance in (rtol, FINER * rtol):
        run = _follow(point, replace(settings, t_end=window, rtol=tolerance, raw=True, long=False), told)
        if isinstance(run, str):
            return found | {"reason": run}
        runs.append(run)
    if "mesh_force" not in runs[0]:
        return found | {"reason": "the model has no mesh"}
    names = [str(name) for name in runs[0]["mesh"].values]
    forces = np.array([run["mesh_force"].values for run in runs])
    together = _alike(*runs)
    reason = tell_parting(forces, together, window)
    if reason:
        return found | {"reason": reason}
    changes = compare_statistics(*(statistics(run, run["statistics"].attrs["from_s"]) for run in runs))
    meshes = {name: compare_signals(*forces[:, together, i]) | changes[name] for i, name in enumerate(names)}
    worst = max(meshes, key=lambda name: meshes[name]["rms_over_vibration"] or 0.0)
    return found | {"meshes": meshes, "worst": worst}


def _follow(point: OperatingPoint, settings: RunSettings, told: Told) -> "xr.Dataset | str":
    """Return a run's forces of the instant, levels and statistics; the reason where it did not reach its end."""
    check_run(point, settings)
    reader, rows = Reader(point, settings), list[Rows]()
    integration = Integration(point, settings, passing=passing_speed(settings.sampling_rate, settings.raw))
    outcome = integration.proceed(lambda block, points: rows.append(reader.read(block, points)), told)
    if outcome.status != "done":
        return outcome.status
    return make_dataset(point.library, point.p, join_rows([*rows, reader.finish()]), motion_statistics(reader, outcome))


def _alike(one: "xr.Dataset", two: "xr.Dataset") -> NDArray[np.bool_]:
    """Return the samples at which all meshes have the same level in both runs: near a jump a shift is no error."""
    if "mesh_level" not in one:
        return np.ones(one.sizes["time"], dtype=np.bool_)
    return np.asarray((one["mesh_level"].values == two["mesh_level"].values).all(axis=1))


def compare_statistics(
    coarse: Mapping[str, Mapping[str, float]], fine: Mapping[str, Mapping[str, float]]
) -> dict[str, dict[str, float | None]]:
    """Return by mesh how far the statistics that are told are from those of a finer run, over their size; None at zero.

    Parameters
    ----------
    coarse, fine
        See ``statistics.statistics``.
    """
    found: dict[str, dict[str, float | None]] = {}
    for mesh, true in fine.items():
        pairs = {name: (coarse[mesh][name], true[name]) for name in TOLD}
        found[mesh] = {
            name: abs(a - b) / abs(b) if np.isfinite([a, b]).all() and b != 0 else None
            for name, (a, b) in pairs.items()
        }
    return found


def tell_parting(forces: Vector, together: NDArray[np.bool_], window: float) -> str | None:
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
