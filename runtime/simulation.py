"""The running half of the way through the house: Library -> equilibrium -> trajectory -> Result."""

import json
import os
import sys
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from importlib.metadata import version
from time import perf_counter
from typing import TYPE_CHECKING, Any

from ltcgear.generated.errors import LtcgearError

from .accuracy import estimate_accuracy
from .choice import Choice, choose
from .equilibrium import Equilibrium, Vector, find_equilibrium
from .integration import Trajectory, integrate
from .kernel import Kernel
from .library import Library
from .results import energy_residual, make_dataset
from .scaling import LOADED
from .signals import Pairs
from .statistics import mesh_statistics, steady_start
from .stepper import check_method

if TYPE_CHECKING:
    import xarray as xr

AUTO = "auto"
"""In place of a method: let ``choose`` take one."""
DEFAULT_METHOD = AUTO
DEFAULT_RTOL = 1e-6
WRONG = 1e-2
"""Energy missing over the strain energy from which a run is warned about."""


def check_options(method: str, rtol: float, t_end: float | None = None) -> None:
    """Refuse options that no integrator can serve, before anything is computed."""
    if method != AUTO:
        check_method(method)
    if not 1e-13 <= rtol <= 0.1:
        raise LtcgearError(f"rtol {rtol:g}: must lie between 1e-13 and 0.1")
    if t_end is not None and not 0 < t_end < 1e7:
        raise LtcgearError(f"t_end {t_end:g}: must be a time in seconds, greater than zero and below 1e7")


def _check_size(library: Library, samples: float) -> None:
    """Refuse a run of less than one sample, or of more than the memory holds."""
    if round(samples) < 1:
        raise LtcgearError("t_end is shorter than one sample; simulate longer or raise simulation.rate")
    manifest = library.manifest
    need = samples * 8 * sum(map(len, (manifest.states, manifest.levels, manifest.signals, manifest.reports)))
    have = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    if need > 0.8 * have:
        raise LtcgearError(
            f"the run would take {need / 1e9:.0f} GB of {have / 1e9:.0f} GB memory; lower t_end, rate or oversample"
        )


@dataclass(frozen=True)
class Result:
    """A simulation: the data, and the summary that ``ltcgear simulate --json`` prints."""

    dataset: "xr.Dataset"
    summary: dict[str, Any]


def simulate(
    library: Library,
    values: Mapping[str, float],
    *,
    t_end: float,
    rate: float,
    method: str = DEFAULT_METHOD,
    rtol: float = DEFAULT_RTOL,
    oversample: int = 1,
    attributes: Mapping[str, Any] | None = None,
    told: Callable[[float], None] = lambda t: None,
    tables: Mapping[str, Pairs] | None = None,
    verify: bool = False,
) -> Result:
    """Simulate from the loaded equilibrium.

    Parameters
    ----------
    library
        A built model.
    values
        Parameter name -> value in SI.
    t_end, rate
        Time to simulate [s] and samples a second [Hz].
    method, rtol
        Integrator (see ``stepper.METHODS``; ``auto`` chooses one, see ``choice``) and its relative tolerance,
        which refers to vibrations.
    oversample
        Samples taken for each one kept; above 1, accelerations are low-pass filtered before.
    attributes
        What the result file shall also tell, such as the scene.
    told
        Called with the simulated time now and then.
    tables
        Table name -> rows of time [s] and value in SI; the model's, where its loads are given over time.
    verify
        Run the first samples at ``rtol`` and at a tenth of it as well: ``summary["accuracy"]``, see ``accuracy``.

    Raises
    ------
    SolverError
        If there is no equilibrium to start from. A failure later on is ``summary["status"]``.
    """
    check_options(method, rtol, t_end)
    _check_size(library, t_end * rate * oversample)
    p = library.parameters(values)
    clock = perf_counter()
    at = find_equilibrium(library, p, tables=tables)
    seconds = {"equilibrium": perf_counter() - clock}
    choice = choose(library, at, p, rtol) if method == AUTO else Choice(method, None)
    method = choice.method
    path = integrate(
        library, p, at, t_end=t_end, rate=rate * oversample, method=method, rtol=rtol, told=told, tables=tables
    )
    seconds |= path.seconds
    clock = perf_counter()
    dataset = make_dataset(library, p, path, oversample)
    seconds["outputs"] = perf_counter() - clock
    accuracy = {}
    if verify:
        clock = perf_counter()
        accuracy["accuracy"] = estimate_accuracy(
            library, p, at, t_end=path.end, rate=rate, method=method, rtol=rtol, tables=tables
        )
        seconds["verify"] = perf_counter() - clock
    settings = {"method": method, "why": choice.why, "engine": library.engine, "rtol": rtol, "oversample": oversample}
    summary = settings | _outcome(library, p, at, path, dataset) | accuracy | {"seconds": seconds}
    told_in_file = {**_versions(), **(attributes or {}), **summary}
    del told_in_file["forces"]
    dataset.attrs |= {k: v if isinstance(v, (str, int, float)) else json.dumps(v) for k, v in told_in_file.items()}
    return Result(dataset, summary)


def _versions() -> dict[str, Any]:
    """Return the versions at work."""
    versions = {name: version(name) for name in ("ltcgear", "casadi", "numpy", "xarray")}
    return {"ltcgear": versions["ltcgear"], "versions": versions | {"python": sys.version.split()[0]}}


def _outcome(library: Library, p: Vector, at: Equilibrium, path: Trajectory, dataset: "xr.Dataset") -> dict[str, Any]:
    """Return how an integration went, what it is worth, and the forces it found."""
    strain = float(Kernel(library.functions["energy"])(at.x, at.s, p)[0][1])
    residual = energy_residual(library, p, at, path)
    return {
        "status": path.status,
        "simulated_s": path.end,
        "real_time_factor": path.end / path.seconds["integrate"],
        "counts": asdict(path.counts) | {"expected_events": path.expected_events},
        "energy_residual": residual,
        "static_strain_j": strain,
        "forces": _forces(dataset),
        "warnings": [*_open_balance(residual), *(_pulling(path, dataset) if strain > LOADED else ())],
    }


def _open_balance(residual: float) -> list[str]:
    """Say that a run's energy does not add up, so that its forces are not to be trusted."""
    if abs(residual) < WRONG:
        return []
    open_by = f"the energy balance is open by {abs(residual):.1e} of the strain energy"
    return [f"{open_by}; lower --rtol or try another --method"]


def _pulling(path: Trajectory, dataset: "xr.Dataset") -> list[str]:
    """Say which meshes pull at some time: their teeth would part, which a bilateral mesh does not know."""
    if "mesh_contact" in dataset or "mesh_force" not in dataset:
        return []
    found = zip(dataset["mesh"].values, path.extremes.lowest, strict=True)
    text = "{}: pulls with up to {:.4g} N, where teeth would part; set effects.contact to one-flank or backlash"
    return [text.format(mesh, -force) for mesh, force in found if force < 0]


def _forces(dataset: "xr.Dataset") -> dict[str, Any]:
    """Return mean, extremes and load factor of every mesh force over the second half of the run."""
    if "mesh_force" not in dataset or dataset.sizes["time"] < 4:
        return {}
    return mesh_statistics(dataset, steady_start(dataset))
