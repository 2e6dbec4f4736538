"""Simulation in memory: library -> equilibrium -> trajectory -> result."""

from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from time import perf_counter
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from ..model.asynchronous_machines import past_breakdown
from ..model.energy_levels import LOADED
from ..model.equilibrium import Vector, find_equilibrium
from ..model.library import Library
from ..model.operating_point import OperatingPoint
from ..results.attributes import to_attributes
from ..results.dataset import make_dataset
from ..results.result import Result
from ..results.rounding import SHARE, round_below
from ..results.samples import Rows, by_quantity, join_rows
from ..results.statistics import STATISTICS, Statistics, name_values
from .choose_method import Choice, choose
from .energy_balance import energy_residual
from .integration import Integration
from .low_pass import BAND, passing_speed
from .method_limits import check_run
from .methods.registry import AUTO
from .output_reader import Reader, judge, motion_statistics
from .room import check_size
from .run_settings import RunOptions, RunSettings, check_length
from .sampling_rate import Rate, choose_rate
from .trajectory import Outcome
from .verify import estimate_accuracy

if TYPE_CHECKING:
    import xarray as xr

WRONG = 1e-2
"""Energy missing over the strain energy from which a run is warned about."""


def simulate(
    library: Library,
    values: Mapping[str, float],
    *,
    attributes: Mapping[str, Any] | None = None,
    told: Callable[[float], None] = lambda t: None,
    **options: Unpack[RunOptions],
) -> Result:
    """Simulate from the loaded equilibrium, and keep all samples in memory (``record`` writes them to a file).

    Parameters
    ----------
    library
        A built model.
    values
        Parameter name -> value in SI.
    attributes
        Further attributes of the result file, such as the scene.
    told
        Called with the simulated time now and then.
    options
        Settings of the run, ``t_end`` at least: the attributes of ``RunSettings``.

    Raises
    ------
    SolverError
        If there is no equilibrium to start from. A failure later on is ``summary["status"]``.
    LtcgearError
        If a name, a number or an option is none that the model or the method can take.
    """
    settings = RunSettings(**options).checked()
    run = Run(library, library.parameters(values), settings)
    run.follow(told)
    dataset, summary = run.conclude()
    if settings.verify:
        summary |= verified(run.point, summary, run.settings)
    dataset.attrs |= to_attributes(attributes, summary)
    return Result(dataset, summary)


class Run:
    """A simulation in memory, in three steps: it is set up, followed to its end, and concluded.

    The first and the last use CasADi, which serves one thread only; with ``erk`` the one between them does not.

    Parameters
    ----------
    library, p
        A built model and its parameters, shape (n_p,).
    settings
        Settings that are checked.

    Raises
    ------
    SolverError
        If there is no equilibrium to start from.
    """

    def __init__(self, library: Library, p: Vector, settings: RunSettings) -> None:
        clock = perf_counter()
        self.point = point = OperatingPoint(library, p, find_equilibrium(library, p, tables=settings.tables))
        self.seconds = {"equilibrium": perf_counter() - clock}
        self.settings, self.about = resolve(point, settings)
        rate = self.settings.sampling_rate
        check_size(library, settings.t_end * rate)
        self.reader, self.rows = Reader(point, self.settings), list[Rows]()
        check_run(point, self.settings)
        self.integration = Integration(point, self.settings, passing=passing_speed(rate, settings.raw))

    def follow(self, told: Callable[[float], None]) -> None:
        """Integrate, and read the outputs."""
        self.integration.follow(lambda block, points: self.rows.append(self.reader.read(block, points)), told)

    def conclude(self) -> tuple["xr.Dataset", dict[str, Any]]:
        """Return the data and the summary."""
        outcome, clock = judge(self.reader, self.integration.conclude()), perf_counter()
        rows, statistics = join_rows([*self.rows, self.reader.finish()]), motion_statistics(self.reader, outcome)
        self.rows.clear()  # lest they take their room beside the quantities
        dataset = make_dataset(self.point.library, self.point.p, rows, statistics)
        outcome.seconds["outputs"] += perf_counter() - clock
        forces = tell_forces(self.point.library, statistics, self.point.strain)
        about = summarise(self.point, outcome, forces, self.reader)
        return dataset, self.about | about | {"seconds": self.seconds | outcome.seconds}


def resolve(point: OperatingPoint, settings: RunSettings) -> tuple[RunSettings, dict[str, Any]]:
    """Choose method and sampling rate where left open; return the settings and their entries of the summary.

    Raises
    ------
    LtcgearError
        If the run is shorter than one sample.
    """
    choice = choose(point, settings) if settings.method == AUTO else Choice(settings.method, None)
    sampling = choose_rate(point, settings.tables) if settings.rate is None else Rate(settings.rate, None)
    check_length(settings.t_end * sampling.rate)
    about = list_settings(point.library, choice, settings.rtol, sampling, settings.raw)
    return replace(settings, method=choice.method, rate=sampling.rate), about


def tell_forces(library: Library, found: Statistics | None, strain: float) -> dict[str, Any]:
    """Return statistics of the mesh forces along the motion, rounding told as 0; none of a run that did not end.

    ``strain`` is the energy that the loaded equilibrium stores [J].
    """
    columns, reports = by_quantity(library), library.manifest.reports
    if found is None or "mesh_force" not in columns:
        return {}
    forces = {reports[i].item: name_values(found.values[:, i].tolist()) for i in columns["mesh_force"]}
    size = np.nan_to_num(np.abs(found.values[[STATISTICS.index(end) for end in ("min", "max")]])).max(axis=0)
    floor = SHARE * max(size[i] for i, report in enumerate(reports) if report.unit == "N")
    if strain < LOADED and "mesh_deflection" in columns:
        force, deflection = (size[columns[name]] for name in ("mesh_force", "mesh_deflection"))
        floor = np.inf if (0.5 * force * deflection < LOADED).all() else floor
    return round_below(forces, floor)


def verified(point: OperatingPoint, summary: Mapping[str, Any], settings: RunSettings) -> dict[str, Any]:
    """Return the accuracy of a run, and its seconds with those that this took."""
    clock = perf_counter()
    if summary["status"] != "done":
        accuracy: dict[str, Any] = {"meshes": {}, "worst": None, "reason": "the run did not reach its end"}
    else:
        accuracy = estimate_accuracy(point, settings)
    return {"accuracy": accuracy, "seconds": summary["seconds"] | {"verify": perf_counter() - clock}}


def list_settings(library: Library, choice: Choice, rtol: float, sampling: Rate, raw: bool) -> dict[str, Any]:
    """Return how a run is computed and sampled; a raw one has no band."""
    told = {"method": choice.method, "why": choice.why, "engine": library.engine, "rtol": rtol}
    told |= {"rate_hz": sampling.rate, "why_rate": sampling.why}
    return told if raw else told | {"band_hz": BAND * sampling.rate}


def summarise(
    point: OperatingPoint, outcome: Outcome, forces: Mapping[str, Any], reader: Reader
) -> dict[str, Any]:  # fmt: skip
    """Return how an integration went, what it is worth, and the forces it found."""
    library, strain, residual = point.library, point.strain, energy_residual(point, outcome)
    told = [*_open_balance(residual), *(_pulling(library, outcome) if strain > LOADED else ())]
    told += [*reader.teeth.strained(reader.deepest), *past_breakdown(library, *outcome.last)]
    return {
        "status": outcome.status,
        "simulated_s": outcome.end,
        "real_time_factor": outcome.end / outcome.seconds["integrate"],
        "counts": asdict(outcome.counts) | {"expected_events": outcome.expected_events},
        "energy_residual": residual,
        "static_strain_j": strain,
        "forces": forces,
        "warnings": told,
    }


def _open_balance(residual: float) -> list[str]:
    """Say that a run's energy does not add up, so that its forces are not to be trusted."""
    if abs(residual) < WRONG:
        return []
    open_by = f"the energy balance is open by {abs(residual):.1e} of the strain energy"
    return [f"{open_by}; lower --rtol or try another --method"]


def _pulling(library: Library, outcome: Outcome) -> list[str]:
    """Say which meshes pull at some time: their teeth would part, which a bilateral mesh does not know."""
    columns = by_quantity(library)
    if "mesh_contact" in columns or "mesh_force" not in columns:
        return []
    meshes = [library.manifest.reports[i].item for i in columns["mesh_force"]]
    found = zip(meshes, outcome.extremes.lowest, strict=True)
    text = "{}: pulls with up to {:.4g} N, where teeth would part; set effects.contact to one-flank or backlash"
    return [text.format(mesh, -force) for mesh, force in found if force < 0]
