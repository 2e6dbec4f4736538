"""Load sharing of the planets of a stage."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from ltcgear.generated.errors import LtcgearError

from ..model.members import Train
from ..results.statistics import statistics
from ..results.train_record import read_train
from .trace import FEWEST, FloatArray, list_items, pick, read_trace

if TYPE_CHECKING:
    import xarray as xr

UNLOADED = 1e-9
"""Mean load of a group over its largest force below which it carries nothing."""
ALIKE = 0.99
"""Part of what the most loaded mesh of a group carries from which another counts as loaded alike."""
WEAK = 0.05
"""Part of the mean total load below which shares of an instant say nothing."""


@dataclass(frozen=True)
class LoadShare:
    """Shares of equal meshes in the load they carry together; 1 is an equal share.

    Attributes
    ----------
    group, meshes
        ``lsp.sun_planet`` and its meshes.
    mean
        Each mesh's mean force over the mean of all [1], shape (meshes,).
    lowest, highest
        Extremes over time of each share [1], shape (meshes,).
    time, share
        Instants [s], and n F_i / sum F_j [1], shape (n, meshes); NaN where hardly any load is carried.
    """

    group: str
    meshes: tuple[str, ...]
    mean: FloatArray
    lowest: FloatArray
    highest: FloatArray
    time: FloatArray
    share: FloatArray

    @property
    def mesh_load_factor(self) -> float:
        """Return the largest mean share [1], in the sense of ISO 6336-1's K_gamma."""
        return float(self.mean.max())

    @property
    def largest(self) -> float:
        """Return the largest share at any time [1]."""
        return float(self.highest.max())


def list_groups(dataset: xr.Dataset) -> dict[str, list[str]]:
    """Return the meshes by group: ``lsp.sun_planet`` -> its planets' meshes."""
    return group_meshes(list_items(dataset, "mesh_force"), read_train(dataset))


def group_meshes(meshes: Iterable[str], train: Train) -> dict[str, list[str]]:
    """Return meshes by group."""
    found: dict[str, list[str]] = {}
    for mesh in meshes:
        found.setdefault(train.group(mesh), []).append(mesh)
    return found


def find_leads(dataset: xr.Dataset) -> list[str]:
    """Return the mesh of each group that is analysed: the first of those that carry most.

    The two flanks of a mesh with backlash are one group here, so that it is not the idle one.
    """
    meshes = list_items(dataset, "mesh_force")
    if not meshes:
        return []
    carried = np.abs(dataset["mesh_force"].transpose("time", ...).values).mean(axis=0)
    train, groups = read_train(dataset), dict[str, list[int]]()
    for k, mesh in enumerate(meshes):
        groups.setdefault(train.group(train.front(mesh)), []).append(k)
    most = {group: float(carried[members].max()) for group, members in groups.items()}
    return [meshes[next(k for k in members if carried[k] >= ALIKE * most[group])] for group, members in groups.items()]


def mean_shares(means: FloatArray, largest: float) -> FloatArray | None:
    """Return each mesh's mean force over the mean of all [1]; None if the mean is negligible against their largest."""
    middle = float(means.mean())
    return means / middle if abs(middle) > UNLOADED * largest else None


def find_load_share(dataset: xr.Dataset, group: str) -> LoadShare:
    """Return how the meshes of a group share their load, by their normal forces.

    Parameters
    ----------
    dataset
        Result, or a span of it, with ``mesh_force``.
    group
        Such as ``lsp.sun_planet``.

    Raises
    ------
    LtcgearError
        If there is no such group, it has one mesh only, or carries nothing in the mean.
    """
    groups = list_groups(dataset)
    meshes = groups.get(group, [])
    if len(meshes) < 2:
        several = [name for name, members in groups.items() if len(members) > 1]
        raise LtcgearError(f"{group}: no group of several meshes; there are {', '.join(several) or 'none'}")
    time, force = _read_forces(dataset, meshes)
    total = force.mean(axis=1)
    found = statistics(dataset, float(time[0]))
    mean = mean_shares(np.array([found[mesh]["mean"] for mesh in meshes]), float(np.abs(force).max()))
    if mean is None:
        raise LtcgearError(f"{group}: carries no load in the mean, so it has no shares")
    carried = total / total.mean()
    share = np.where(carried[:, None] > WEAK, force / np.where(carried > WEAK, total, 1.0)[:, None], np.nan)
    none = np.full(len(meshes), np.nan)
    known = bool((carried > WEAK).any())
    low, high = (np.nanmin(share, axis=0), np.nanmax(share, axis=0)) if known else (none, none)
    return LoadShare(group, tuple(meshes), mean, low, high, time, share)


def _read_forces(dataset: xr.Dataset, meshes: list[str]) -> tuple[FloatArray, FloatArray]:
    """Return the instants and the forces of some meshes, shape (n, meshes); `read_trace` says what is wrong."""
    listed, signal = list_items(dataset, "mesh_force"), dataset["mesh_force"].transpose("time", ...)
    force = np.asarray(signal.values, dtype=np.float64)[:, [listed.index(mesh) for mesh in meshes]]
    if len(force) < FEWEST or not np.isfinite(force).all():
        for mesh in meshes:
            read_trace(pick(dataset, "mesh_force", mesh))
    return np.asarray(signal["time"].values, dtype=np.float64), force
