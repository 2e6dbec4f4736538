"""Statistics of a result: mesh forces, mesh frequencies and shaft speeds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .train_record import read_train

if TYPE_CHECKING:
    import xarray as xr

    from .amplitude_spectrum import FloatArray

STATISTICS = ("mean", "rms", "std", "min", "max")
"""What is told of every output, in this order."""


@dataclass(frozen=True)
class Statistics:
    """Statistics of all outputs of a run.

    Attributes
    ----------
    values
        In the order of ``STATISTICS`` and of the outputs, shape (5, n_y).
    span
        First and last instant that count [s].
    """

    values: FloatArray
    span: tuple[float, float]


def taper(part: FloatArray) -> FloatArray:
    """Return the weight of instants, given as parts 0..1 of the span; zero outside of it."""
    return np.where((part > 0) & (part < 1), np.sin(np.pi * np.clip(part, 0.0, 1.0)) ** 4, 0.0)


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


def statistics(dataset: xr.Dataset, start_s: float) -> dict[str, dict[str, float]]:
    """Statistics of every mesh force after the start-up.

    Where a run's own statistics were taken from `start_s` on, they are these: integrated along the motion, extremes at
    the integrator's own steps (``averages``). Over another window they are of its samples, under the same weights.

    The load factor is the paper's: largest force over mean force. Its Table 9
    prints 3.34 ± 0.39 and 1.118, which is (3.34 + 0.39) / 3.34 to the digits
    printed. A mesh that is loaded on its other flank has a negative mean; there
    the most negative force is the largest, and the factor is still positive.

    Parameters
    ----------
    dataset
        Simulation result with ``mesh_force`` (time, mesh) [N].
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
    meshes = [str(mesh) for mesh in dataset["mesh"].values]
    outputs = [f"mesh_force:{mesh}" for mesh in meshes]
    if are_followed(dataset, start_s) and set(outputs) <= set(dataset.indexes["output"]):
        values = dataset["statistics"].sel(output=outputs).values
    else:
        part = window(dataset, start_s)
        values = sample_statistics(part["mesh_force"].transpose("time", "mesh").values)
    return dict(zip(meshes, map(name_values, values.T.tolist()), strict=True))


def are_followed(dataset: xr.Dataset, start_s: float, stop_s: float | None = None) -> bool:
    """Say whether a result's statistics along its motion are those of a window [s], to a sample."""
    if "statistics" not in dataset:
        return False
    if not dataset.sizes["time"]:
        return bool(start_s == dataset["statistics"].attrs["from_s"])
    told, near = dataset["statistics"].attrs, 1.0 / sampling_rate(dataset)
    stop = float(dataset["time"].values[-1]) if stop_s is None else stop_s
    ends = [told.get(name) for name in ("from_s", "to_s")]
    given = [float(end) for end in ends if isinstance(end, int | float | np.number)]
    return len(given) == 2 and all(abs(a - b) < near for a, b in zip(given, (start_s, stop), strict=True))


def sample_statistics(values: FloatArray) -> FloatArray:
    """Return the statistics of samples (times, items), in the order of ``averages.STATISTICS``, shape (5, items)."""
    weights = taper((np.arange(len(values)) + 0.5) / len(values))
    values = values.astype(np.float64)
    mean = weights @ values / weights.sum()
    std = np.sqrt(weights @ (values - mean) ** 2 / weights.sum())
    return np.array([mean, np.hypot(mean, std), std, values.min(axis=0), values.max(axis=0)])


def name_values(values: list[float]) -> dict[str, float]:
    """Name the statistics of a mesh force, and add what follows from them."""
    mean, rms, _, low, high = (value + 0.0 for value in values)  # no -0
    peak = high if mean >= 0.0 else low
    factor = peak / mean if mean != 0.0 else float("nan")
    return {"mean": mean, "min": low, "max": high, "rms": rms, "amplitude": 0.5 * (high - low), "load_factor": factor}


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
    train, stages = read_train(dataset), dict[str, list[float]]()
    # Flanks of a mesh with backlash share one phase, so phases may have a dimension of their own.
    for mesh, rate in zip(phase[phase.dims[-1]].values, rates, strict=True):
        stages.setdefault(train.stage(str(mesh)), []).append(float(rate))
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
