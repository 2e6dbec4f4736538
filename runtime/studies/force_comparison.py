"""Comparison of the mesh forces of two runs: vibration, peaks, load shares, amplitudes at the mesh orders."""

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..analysis.sharing import group_meshes
from ..results.signal_errors import STILL
from ..results.statistics import statistics, steady_start, window
from ..results.train_record import read_train

if TYPE_CHECKING:
    import xarray as xr

Vector = NDArray[np.float64]
Forces = Mapping[str, Vector]

ORDERS = 20
"""Mesh orders that are compared at most."""
MEASURES = ("force_rms", "force_peak", "load_share", "spectrum")


def compare_forces(full: "xr.Dataset", other: "xr.Dataset") -> dict[str, dict[str, float | None]]:
    """Say by how much the mesh forces of another run differ from those of the full one, stage by stage.

    Parameters
    ----------
    full, other
        Results at the same times; their second halves are compared. A mesh that one of them lacks counts as
        unloaded there.

    Returns
    -------
    dict of dict
        By stage, the worst of its meshes, None if there is nothing to refer to:
        ``force_rms``, change of the root mean square of force less mean, over the full one's;
        ``force_peak``, change of the largest force, over the full one's;
        ``load_share``, change of the most loaded planet's mean force over the planets' mean;
        ``spectrum``, root mean square of the amplitudes' differences at the mesh orders, over the full one's.
    """
    if "mesh_force" not in full:
        return {}
    one, two = _forces(full), _forces(other)
    names = list(dict.fromkeys([*one, *two]))
    zero = np.zeros(len(next(iter(one.values()))))
    one, two = ({name: forces.get(name, zero) for name in names} for forces in (one, two))
    phase = _phases(full)
    peaks = [_peaks(run) for run in (full, other)]
    train, found = read_train(full), {}
    for stage in dict.fromkeys(map(train.stage, names)):
        meshes = [name for name in names if train.stage(name) == stage]
        found[stage] = {
            "force_rms": find_worst([_rms_change(one[m], two[m]) for m in meshes]),
            "force_peak": find_worst(
                [_ratio(peaks[1].get(m, 0.0) - peaks[0].get(m, 0.0), peaks[0].get(m, 0.0)) for m in meshes]
            ),
            "load_share": _share_change(one, two, group_meshes(meshes, train).values()),
            "spectrum": find_worst([_spectrum_change(one[m], two[m], phase[m]) for m in meshes if m in phase]),
        }
    return found


def find_worst(values: Sequence[float | None]) -> float | None:
    """Return the largest change, its sign kept; None if there is none."""
    return max((value for value in values if value is not None), key=abs, default=None)


def _peaks(dataset: "xr.Dataset") -> dict[str, float]:
    """Return the largest force [N] of the second half in every mesh, on whichever flank."""
    train, found = read_train(dataset), dict[str, float]()
    for name, force in statistics(dataset, steady_start(dataset)).items():
        mesh = train.front(name)
        found[mesh] = max(found.get(mesh, 0.0), abs(force["min"]), abs(force["max"]))
    return found


def _forces(dataset: "xr.Dataset") -> dict[str, Vector]:
    """Return the mesh forces [N] of the second half, those on the other flank against those on the loaded one."""
    forces = window(dataset)["mesh_force"]
    found = {str(name): forces.sel(mesh=name).values for name in forces["mesh"].values}
    train = read_train(dataset)
    behind = {train.front(name): force for name, force in found.items() if train.front(name) != name}
    return {name: force - behind.get(name, 0.0) for name, force in found.items() if train.front(name) == name}


def _phases(dataset: "xr.Dataset") -> dict[str, Vector]:
    """Return the mesh phases [cycles] of the second half, where there are teeth."""
    if "mesh_phase" not in dataset:
        return {}
    phases = window(dataset)["mesh_phase"]
    return {str(name): values for name, values in zip(phases[phases.dims[1]].values, phases.values.T, strict=True)}


def _ratio(change: float, reference: float) -> float | None:
    """Return a relative change; None if there is nothing to refer to."""
    return change / reference if reference > 0 else None


def _vibrates(force: Vector) -> bool:
    """Return whether a force varies: variation below `STILL` of the mean is rounding."""
    return float(force.std()) > STILL * abs(float(force.mean()))


def _rms_change(one: Vector, two: Vector) -> float | None:
    """Return the change of the vibration's root mean square."""
    return _ratio(float(two.std() - one.std()), float(one.std())) if _vibrates(one) else None


def _share_change(one: Forces, two: Forces, groups: Iterable[Sequence[str]]) -> float | None:
    """Return the change of the largest planet's share; the worst group of meshes."""
    shares = share_loads(one, two, groups)
    return find_worst([float(after.max() - before.max()) for before, after in shares.values()])


def share_loads(
    one: Forces, two: Forces, groups: Iterable[Sequence[str]]
) -> dict[tuple[str, ...], tuple[Vector, Vector]]:  # fmt: skip
    """Return the load shares of planets in two runs: the size of a mesh's mean force over the mean of its group.

    Parameters
    ----------
    one, two
        Forces by mesh, shape (n,) each [N].
    groups
        Equal meshes each; groups of one, and those that carry nothing in one of the runs, are left out.

    Returns
    -------
    dict
        The meshes of a group -> shares in both runs, shape (meshes,) each [1].
    """
    found: dict[tuple[str, ...], tuple[Vector, Vector]] = {}
    for group in groups:
        before, after = (np.array([abs(forces[mesh].mean()) for mesh in group]) for forces in (one, two))
        if len(group) > 1 and before.sum() > 0 and after.sum() > 0:
            found[tuple(group)] = before / before.mean(), after / after.mean()
    return found


def _spectrum_change(one: Vector, two: Vector, phase: Vector) -> float | None:
    """Return the distance of two amplitude spectra at the mesh orders over the first one's size."""
    before, after = pair_orders(one, two, phase)
    return _ratio(float(np.linalg.norm(after - before)), float(np.linalg.norm(before)))


def pair_orders(one: Vector, two: Vector, phase: Vector) -> tuple[Vector, Vector]:
    """Return the amplitudes of two forces at the orders of their mesh; none if the first is constant."""
    if not _vibrates(one):
        return np.zeros(0), np.zeros(0)
    return mesh_orders(one, phase), mesh_orders(two, phase)


def mesh_orders(force: Vector, phase: Vector) -> Vector:
    """Return the amplitudes of a force at the orders of its mesh.

    Parameters
    ----------
    force
        Samples, shape (n,) [any unit].
    phase
        Mesh phase at the samples, shape (n,) [cycles]; it may speed up or slow down.

    Returns
    -------
    numpy.ndarray
        Amplitude of order 1, 2, ... under a Hann window, as many as 0.4 of the sampling rate and ``ORDERS``
        allow; none if less than two teeth pass, since their orders cannot be told apart.
    """
    steps = np.abs(np.diff(phase))
    if abs(phase[-1] - phase[0]) < 2 or not steps.max() > 0:
        return np.zeros(0)
    count = min(ORDERS, int(0.4 / steps.max()))
    weight = np.hanning(len(force))
    turns = np.exp(-2j * np.pi * np.outer(np.arange(1, count + 1), phase))
    amplitudes: Vector = np.abs(turns @ (weight * (force - force.mean()))) * (2 / weight.sum())
    return amplitudes
