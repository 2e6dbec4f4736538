"""Metrics of a sweep: what it keeps of each run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from operator import itemgetter
from typing import TYPE_CHECKING, Any

import numpy as np
from ltcgear.generated.errors import LtcgearError

from ...analysis.sharing import group_meshes, list_groups, mean_shares
from ...analysis.spectrum import find_spectrum
from ...analysis.trace import FEWEST, FloatArray, list_items, select_output
from ...analysis.transmission import find_transmission_error
from ...results.result import Result
from ...results.rounding import without_rounding
from ...results.select import find_columns, nearest
from ...results.statistics import STATISTICS as MOTION
from ...results.statistics import mesh_frequencies, sample_statistics, statistics, steady_start, window
from ...results.train_record import read_train
from ...simulation.low_pass import BAND
from ...simulation.trajectory import Counts

if TYPE_CHECKING:
    import xarray as xr

STATISTICS: dict[str, tuple[str, Callable[[Mapping[str, FloatArray]], FloatArray]]] = {
    "mean": ("mean", itemgetter("mean")),
    "min": ("smallest value", itemgetter("min")),
    "max": ("largest value", itemgetter("max")),
    "rms": ("root mean square", itemgetter("rms")),
    "std": ("standard deviation", itemgetter("std")),
    "peak_to_peak": ("largest less smallest value", lambda found: found["max"] - found["min"]),
}
"""Statistic of an output over the second half of the run -> what it is, and how it follows from those of the motion."""
SPECTRUM = "spectrum"
SUMMARISED = {"forces", "load_share", "energy_residual", "counts"}
"""Metrics that a run's summary holds, where what is rounding is 0 already."""
FORCES = {
    "mean": "mean normal mesh force", "min": "smallest normal mesh force", "max": "largest normal mesh force",
    "rms": "root mean square of the normal mesh force", "amplitude": "half the span of the normal mesh force",
}  # fmt: skip


@dataclass(frozen=True)
class Values:
    """Numbers of one run.

    Attributes
    ----------
    name
        Of the variable.
    values
        Of shape () or (items,).
    unit, words
        Unit, and what it is in words.
    source
        The law or definition behind it, where it has one.
    dimension, items
        What its items are called, and their labels; "" and none for a single number.
    """

    name: str
    values: Any
    unit: str
    words: str
    source: str = ""
    dimension: str = ""
    items: Sequence[Any] = ()


Taken = Iterator[Values]


@dataclass(frozen=True)
class Metric:
    """A metric that is asked for by its name alone.

    Attributes
    ----------
    words
        What it is.
    take
        Function of a run to its values.
    """

    words: str
    take: Callable[[Result], Taken]


def _half(run: Result, name: str, quantities: list[str], fewest: int = 2) -> xr.Dataset:
    """Return the second half of some outputs of a run."""
    count = run.dataset.sizes["time"] // 2
    missing = [quantity for quantity in quantities if quantity not in run.dataset]
    if missing:
        raise LtcgearError(f"--metric {name}: this scene has no {missing[0]}; leave the metric out")
    if count < fewest:
        raise LtcgearError(
            f"--metric {name}: the second half of a run has {count} samples, {fewest} at least are needed; "
            "raise t_end or simulation.rate"
        )
    return window(run.dataset[quantities])


def _take_forces(run: Result) -> Taken:
    """Take the statistics of all mesh forces."""
    found = run.summary.get("forces") or _force_statistics(run, "forces")
    for statistic, words in FORCES.items():
        values = [one[statistic] for one in found.values()]
        yield Values(f"mesh_force_{statistic}", values, "N", words, "", "mesh", list(found))
    factors = [one["load_factor"] for one in found.values()]
    words, source = "load factor: largest over mean normal mesh force", "Wu et al. 2021, Table 9"
    yield Values("load_factor", factors, "1", words, source, "mesh", list(found))


def _force_statistics(run: Result, name: str) -> dict[str, dict[str, float]]:
    """Return the statistics of the mesh forces over the second half, what lies between samples included."""
    _half(run, name, ["mesh_force"])
    kept = [one for one in ("mesh_force", "statistics") if one in run.dataset]
    return statistics(run.dataset[kept], steady_start(run.dataset))


def _take_load_share(run: Result) -> Taken:
    """Take each planet's mean share, and the largest of each group; NaN where a group carries nothing."""
    found = run.summary.get("forces") or _force_statistics(run, "load_share")
    groups = {
        group: meshes for group, meshes in group_meshes(found, read_train(run.dataset)).items() if len(meshes) > 1
    }
    if not groups:
        raise LtcgearError("--metric load_share: this scene has no meshes that share a load; leave the metric out")
    shares = {mesh: share for meshes in groups.values() for mesh, share in _share(found, meshes)}
    largest = [max(shares[mesh] for mesh in meshes) for meshes in groups.values()]
    words = "share of the load: mean force over the mean of the group"
    yield Values("load_share", list(shares.values()), "1", words, "", "planet_mesh", list(shares))
    words, source = "mesh load factor K_gamma: largest share of a group", "ISO 6336-1"
    yield Values("mesh_load_factor", largest, "1", words, source, "group", list(groups))


def _share(found: Mapping[str, Mapping[str, float]], meshes: Sequence[str]) -> Iterator[tuple[str, float]]:
    """Yield the shares of meshes in their mean load, NaN where they carry none."""
    largest = max(abs(found[mesh][end]) for mesh in meshes for end in ("min", "max"))
    shares = mean_shares(np.array([found[mesh]["mean"] for mesh in meshes]), largest)
    yield from zip(meshes, [float("nan")] * len(meshes) if shares is None else shares.tolist(), strict=True)


def _take_transmission_error(run: Result) -> Taken:
    """Take the peak-to-peak dynamic transmission error of all meshes."""
    half = _half(run, "transmission_error", ["mesh_deflection"], FEWEST)
    meshes = list_items(half, "mesh_deflection")
    sizes = [find_transmission_error(half, mesh).peak_to_peak for mesh in meshes]
    words, source = "peak-to-peak dynamic transmission error", "Ozguven and Houser 1988, J. Sound Vib. 121:383"
    dimension = str(half["mesh_deflection"].dims[-1])
    yield Values("transmission_error", sizes, "m", words, source, dimension, meshes)


def _take_energy_residual(run: Result) -> Taken:
    """Take how far the energy balance is open."""
    words = "energy missing in the balance, over the strain energy of the start"
    yield Values("energy_residual", run.summary["energy_residual"], "1", words)


def _take_counts(run: Result) -> Taken:
    """Take what the run has cost."""
    counts = run.summary["counts"]
    yield Values("counts", list(counts.values()), "1", "what the run has cost", "", "count", list(counts))


METRICS = {
    "forces": Metric("mean, min, max, rms, amplitude and load factor of every mesh force", _take_forces),
    "load_share": Metric("each planet's share of the load, and the largest of each group, K_gamma", _take_load_share),
    "transmission_error": Metric("peak-to-peak transmission error of every mesh", _take_transmission_error),
    "energy_residual": Metric("how far the energy balance is open", _take_energy_residual),
    "counts": Metric("steps, right-hand sides, Jacobians and events", _take_counts),
}
"""Metrics by name; ``STATISTIC:QUANTITY[:ITEM]`` and ``spectrum:QUANTITY:ITEM`` stand beside them."""


def _take_statistic(name: str, run: Result) -> Taken:
    """Take a statistic of an output, of all its items where none is named."""
    statistic, _, output = name.partition(":")
    [(quantity, wanted)] = find_columns(run.dataset, [output], f"--metric {statistic}:").items()
    _half(run, name, [quantity])
    signal = run.dataset[quantity].transpose("time", ...)
    attributes = signal.attrs
    words = f"{STATISTICS[statistic][0]} of the {attributes.get('long_name', quantity)}"
    dimension = str(signal.dims[-1]) if signal.ndim > 1 else ""
    items = [str(item) for item in signal[dimension].values] if dimension else []
    values = STATISTICS[statistic][1](_statistics_of(run.dataset, signal, items))
    if wanted:
        words, values = f"{words}, {wanted[0]}", values[items.index(wanted[0])]
        dimension, items = "", []
    yield Values(name, values, str(attributes.get("units", "1")), words, "", dimension, items)


def _statistics_of(dataset: xr.Dataset, signal: xr.DataArray, items: list[str]) -> dict[str, FloatArray]:
    """Return the statistics of an output's items along the motion; of what is no output (states), of its samples."""
    labels = [f"{signal.name}:{item}" for item in items]
    if "statistics" in dataset and labels and labels[0] in dataset.indexes["output"]:
        values = dataset["statistics"].sel(output=labels).values
    else:
        half = window(signal.to_dataset(name="signal"))["signal"].values
        values = sample_statistics(half)
    return dict(zip(MOTION, values, strict=True))


def _take_spectrum(name: str, run: Result) -> Taken:
    """Take the amplitude spectrum of an output, and the mesh frequencies by which its lines are read."""
    output = name.partition(":")[2]
    signals = select_output(run.dataset, output, f"--metric {SPECTRUM}:")
    names = [str(signal.name) for signal in signals]
    half = _half(run, name, names, FEWEST)
    found = find_spectrum(*(signal.sel(time=half["time"]) for signal in signals))
    words, source = f"amplitude spectrum of the {found.title}", f"{found.window} window"
    within = found.axis <= run.dataset.attrs.get("band_hz", np.inf)
    yield Values(name, found.value[within], found.unit, words, source, "frequency", found.axis[within].tolist())
    if "mesh_phase" in run.dataset:
        frequencies = mesh_frequencies(run.dataset[["mesh_phase"]])
        words = "mesh frequency"
        yield Values("mesh_frequency", list(frequencies.values()), "Hz", words, "", "gear_set", list(frequencies))


def find_metric(name: str) -> Callable[[Result], Taken]:
    """Return the function that takes a metric of a run.

    Parameters
    ----------
    name
        One of `METRICS`, ``STATISTIC:QUANTITY[:ITEM]`` with one of `STATISTICS`, or ``spectrum:QUANTITY:ITEM``.

    Raises
    ------
    LtcgearError
        If there is no such metric; the nearest is named.
    """
    head, _, output = name.partition(":")
    if name in METRICS:
        return METRICS[name].take
    if head in STATISTICS and output:
        return partial(_take_statistic, name)
    if head == SPECTRUM and output:
        return partial(_take_spectrum, name)
    if head in (*STATISTICS, SPECTRUM):
        item = ":ITEM" if head == SPECTRUM else "[:ITEM]"
        raise LtcgearError(f"--metric {name}: of what? write {head}:QUANTITY{item}, for example {head}:mesh_force")
    if output and head in METRICS:
        raise LtcgearError(f"--metric {name}: {head} is of all meshes; write {head}")
    raise LtcgearError(f"--metric {name:.80}: no such metric; {nearest(head, [*METRICS, *STATISTICS, SPECTRUM])}")


def choose_metrics(dataset: xr.Dataset) -> list[str]:
    """Return the metrics that are taken where none is asked for: forces, and shares where meshes share a load."""
    sharing = any(len(meshes) > 1 for meshes in list_groups(dataset).values())
    return [*(["forces"] if "mesh_force" in dataset else ["energy_residual"]), *(["load_share"] if sharing else [])]


def lay_out(dataset: xr.Dataset, names: Sequence[str], t_end: float, rate: float, raw: bool = False) -> xr.Dataset:
    """Return a row as `measure` gives it, with NaN in place of all numbers.

    A run of ones is measured, so that the two cannot differ in form.

    Parameters
    ----------
    dataset
        Of a result, or of none yet (``make_dataset`` with ``no_rows``): its quantities and items count.
    names
        Metrics, see `find_metric`.
    t_end, rate, raw
        Time that is simulated [s], samples a second [Hz], and whether they are raw.

    Raises
    ------
    LtcgearError
        If there is no such metric, quantity or item, or runs are too short for it.
    """
    import xarray as xr

    for name in names:
        find_metric(name)
    time = np.arange(round(t_end * rate) + 1) / rate
    ones: dict[str, Any] = {}
    for label, variable in dataset.variables.items():
        if "time" in variable.dims and label != "time":
            shape = tuple(time.size if size == "time" else dataset.sizes[size] for size in variable.dims)
            ones[str(label)] = (variable.dims, np.broadcast_to(1.0, shape), variable.attrs)
    fixed = {label: dataset[label] for label in dataset.coords if label != "time"}
    counts = asdict(Counts()) | {"expected_events": 0}
    band = {} if raw else {"band_hz": BAND * rate}
    run = Result(xr.Dataset(ones, {"time": time, **fixed}, band), {"energy_residual": 0.0, "counts": counts})
    row = measure(run, names)
    return row.map(lambda values: values.astype(np.float64) * np.nan, keep_attrs=True)


def measure(result: Result, names: Sequence[str]) -> xr.Dataset:
    """Measure a run.

    Parameters
    ----------
    result
        Of a simulation that reached its end.
    names
        Metrics, see `find_metric`.

    Returns
    -------
    xarray.Dataset
        Variables without time: over their items (``mesh``, ``planet_mesh``, ``group``, ``frequency`` ...) or single,
        with ``units``, ``long_name`` and, where there is one, ``source``. Statistics and spectra bear the metric's
        name.

    Raises
    ------
    LtcgearError
        If a metric cannot be taken, as of a signal that is not a number throughout.
    """
    import xarray as xr

    data: dict[str, Any] = {}
    coordinates: dict[str, Any] = {}
    for one in _take(result, names).values():
        attributes = {"units": one.unit, "long_name": one.words} | ({"source": one.source} if one.source else {})
        data[one.name] = (one.dimension or (), np.asarray(one.values, dtype=np.float64), attributes)
        if one.dimension == "frequency":
            coordinates["frequency"] = ("frequency", one.items, {"units": "Hz", "long_name": "frequency"})
        elif one.dimension:
            coordinates[one.dimension] = list(one.items)
    return xr.Dataset(data, coordinates)


def take_values(result: Result, names: Sequence[str]) -> FloatArray:
    """Return the numbers of `measure`, one variable after the other, without the cost of a data set."""
    return np.concatenate([np.ravel(np.asarray(one.values, np.float64)) for one in _take(result, names).values()])


def _take(result: Result, names: Sequence[str]) -> dict[str, Values]:
    """Return the values of metrics by the name of the variable; what is rounding is 0."""
    told = set(names) <= SUMMARISED and "forces" in result.summary
    clean = result if told else Result(without_rounding(result.dataset), result.summary)
    return {one.name: one for name in dict.fromkeys(names) for one in find_metric(name)(clean)}


def unite(rows: Sequence[xr.Dataset]) -> xr.Dataset:
    """Return the form that holds rows of several variants of a model: all items of all, in the order they come.

    A row takes this form by ``row.reindex_like(united)``; what a variant has not is NaN.
    """
    import xarray as xr

    labels: dict[str, list[Any]] = {}
    for row in rows:
        for name, coordinate in row.coords.items():
            known = labels.setdefault(str(name), [])
            known += [label for label in coordinate.values.tolist() if label not in set(known)]
    filled = [row.reindex(labels) for row in rows]
    data = {name: row[name] for row in reversed(filled) for name in row.data_vars}
    return xr.Dataset({name: data[name] for row in rows for name in row.data_vars})
