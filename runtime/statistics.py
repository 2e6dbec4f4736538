"""Statistics: mesh forces, mesh frequencies and shaft speeds of a finished simulation."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import xarray as xr

    from .spectra import FloatArray

BLOCK = 1024
"""Samples that are summed up, and copied to a file, at once."""


def steady_start(dataset: xr.Dataset) -> float:
    """Time from which a result counts as steady when nobody says otherwise.

    Parameters
    ----------
    dataset
        Simulation result with a ``time`` coordinate [s].

    Returns
    -------
    float
        The middle of the record [s].
    """
    time = dataset["time"].values
    return float(0.5 * (time[0] + time[-1]))


def sampling_rate(dataset: xr.Dataset) -> float:
    """Return the sampling rate of a result's uniform ``time`` coordinate [Hz]."""
    time = dataset["time"].values
    return float((time.size - 1) / (time[-1] - time[0]))


def window(dataset: xr.Dataset, start_s: float | None = None, stop_s: float | None = None) -> xr.Dataset:
    """Cut a result to a time window.

    Parameters
    ----------
    dataset
        Simulation result.
    start_s
        First instant kept [s]; by default `steady_start`.
    stop_s
        Last instant kept [s]; by default the end.

    Returns
    -------
    xarray.Dataset
        The samples with ``start_s <= time <= stop_s``.

    Raises
    ------
    ValueError
        If fewer than two samples are left.
    """
    start = steady_start(dataset) if start_s is None else start_s
    part = dataset.sel(time=slice(start, stop_s))
    if part.sizes["time"] < 2:
        time = dataset["time"].values
        raise ValueError(
            f"no result between {start} s and {stop_s or time[-1]} s: "
            f"the record runs from {time[0]} s to {time[-1]} s; choose an earlier start"
        )
    return part


def group_of(mesh: str) -> str:
    """Group of a mesh: ``"lsp.sun_planet.1"`` belongs to ``"lsp.sun_planet"``."""
    head, _, tail = mesh.rpartition(".")
    return head if tail.isdigit() else mesh


def stage_of(mesh: str) -> str:
    """Gear set of a mesh: ``"lsp.sun_planet.1"`` belongs to ``"lsp"``."""
    return mesh.partition(".")[0]


def mesh_statistics(dataset: xr.Dataset, start_s: float) -> dict[str, dict[str, float]]:
    """Statistics of every mesh force after the start-up.

    The load factor is the paper's: largest force over mean force. Its Table 9
    prints 3.34 ± 0.39 and 1.118, which is (3.34 + 0.39) / 3.34 to the digits
    printed. A mesh that is loaded on its other flank has a negative mean; there
    the most negative force is the largest, and the factor is still positive.

    Parameters
    ----------
    dataset
        Simulation result with ``mesh_force`` (time, mesh) [N]; extremes between samples are taken
        from ``mesh_force_lowest`` and ``mesh_force_highest`` (mesh) where they were followed from
        `start_s`.
    start_s
        First instant counted [s].

    Returns
    -------
    dict of dict
        By mesh: ``mean``, ``min``, ``max``, ``rms`` (root mean square of the whole
        force), ``amplitude`` ((max - min) / 2), all [N], and ``load_factor`` [1],
        which is NaN for a mesh whose mean is zero.

    Raises
    ------
    ValueError
        If the record ends before `start_s`.
    """
    forces = window(dataset, start_s)["mesh_force"].transpose("time", "mesh")
    sums = ForceSums(forces.sizes["mesh"])
    for first in range(0, forces.sizes["time"], BLOCK):
        sums.note(forces.values[first : first + BLOCK].astype(np.float64))
    return sums.statistics([str(mesh) for mesh in forces["mesh"].values], *_between_samples(dataset, start_s))


def _between_samples(dataset: xr.Dataset, start_s: float) -> tuple[FloatArray, FloatArray]:
    """Extremes of each mesh force that the integrator saw, NaN where it followed another span [N]."""
    if "mesh_force_lowest" in dataset:
        low, high = dataset["mesh_force_lowest"], dataset["mesh_force_highest"]
        return between_samples(low.values, high.values, float(low.attrs["from_s"]), start_s, sampling_rate(dataset))
    unknown = np.full(dataset.sizes["mesh"], np.nan)
    return unknown, unknown


def between_samples(
    low: FloatArray, high: FloatArray, followed_s: float, start_s: float, rate: float
) -> tuple[FloatArray, FloatArray]:
    """Extremes where they were followed from the start that is asked for, to a sample [s]; else NaN."""
    if abs(followed_s - start_s) < 1.0 / rate:
        return low, high
    return np.full_like(low, np.nan), np.full_like(high, np.nan)


class ForceSums:
    """Sums and extremes of mesh forces, gathered block by block, so that no run needs to be held for them."""

    def __init__(self, meshes: int) -> None:
        self.count, self.sum, self.squares = 0, np.zeros(meshes), np.zeros(meshes)
        self.low, self.high = np.full(meshes, np.inf), np.full(meshes, -np.inf)

    def note(self, forces: FloatArray) -> None:
        """Take in forces of shape (times, meshes) [N]."""
        self.count += len(forces)
        self.sum += forces.sum(axis=0)
        self.squares += (forces**2).sum(axis=0)
        self.low, self.high = np.minimum(self.low, forces.min(axis=0)), np.maximum(self.high, forces.max(axis=0))

    def statistics(self, meshes: list[str], lowest: FloatArray, highest: FloatArray) -> dict[str, dict[str, float]]:
        """Return the statistics by mesh, widened by the extremes between samples [N], NaN where not known."""
        means, rms = self.sum / self.count, np.sqrt(self.squares / self.count)
        lows, highs = np.fmin(self.low, lowest), np.fmax(self.high, highest)
        found = {}
        for k, mesh in enumerate(meshes):
            mean, low, high = (float(values[k]) + 0.0 for values in (means, lows, highs))  # no -0
            peak = high if mean >= 0.0 else low
            found[mesh] = {
                "mean": mean,
                "min": low,
                "max": high,
                "rms": float(rms[k]),
                "amplitude": 0.5 * (high - low),
                "load_factor": peak / mean if mean != 0.0 else float("nan"),
            }
        return found


def mesh_frequencies(
    dataset: xr.Dataset, start_s: float | None = None, stop_s: float | None = None
) -> dict[str, float]:
    """Mesh frequency of every gear set, from the mesh phases' advance.

    Parameters
    ----------
    dataset
        Simulation result with ``mesh_phase`` (time, mesh) [cycles, unwrapped].
    start_s, stop_s
        Window [s], as for `window`.

    Returns
    -------
    dict
        By gear set (``"lsp"``), the mean over its meshes of the magnitude of the
        phase's change divided by the time it took [Hz].
    """
    part = window(dataset, start_s, stop_s)
    time = part["time"].values
    phase = part["mesh_phase"].transpose("time", ...)
    rates = np.abs(phase.values[-1] - phase.values[0]) / (time[-1] - time[0])
    stages: dict[str, list[float]] = {}
    # Flanks of a mesh with backlash share one phase, so phases may have a dimension of their own.
    for mesh, rate in zip(phase[phase.dims[-1]].values, rates, strict=True):
        stages.setdefault(stage_of(str(mesh)), []).append(float(rate))
    return {stage: float(np.mean(values)) for stage, values in stages.items()}


def shaft_speeds(dataset: xr.Dataset, start_s: float | None = None, stop_s: float | None = None) -> dict[str, float]:
    """Mean speed of every rotor.

    Parameters
    ----------
    dataset
        Simulation result with ``speed`` (time, rotor) [rad/s].
    start_s, stop_s
        Window [s], as for `window`.

    Returns
    -------
    dict
        By rotor, counter-clockwise positive [rad/s].
    """
    mean = window(dataset, start_s, stop_s)["speed"].mean("time")
    return {str(rotor): float(mean.sel(rotor=rotor)) for rotor in mean["rotor"].values}


def pressure_angles(dataset: xr.Dataset) -> dict[str, float]:
    """Operating pressure angle of every mesh, where the result carries it.

    Parameters
    ----------
    dataset
        Simulation result, possibly with ``pressure_angle`` (mesh) or (time, mesh) [rad].

    Returns
    -------
    dict
        By mesh, the mean over time [rad]; empty when the variable is absent.
    """
    if "pressure_angle" not in dataset:
        return {}
    angle = dataset["pressure_angle"]
    if "time" in angle.dims:
        angle = angle.mean("time")
    return {str(mesh): float(angle.sel(mesh=mesh)) for mesh in angle["mesh"].values}
