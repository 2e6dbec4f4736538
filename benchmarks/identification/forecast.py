"""Forecast: what a model says of the targets at given parameters, and the derivatives with respect to all of these."""

from dataclasses import dataclass

import numpy as np
from ltcgear.runtime.linear.balance import Balance
from ltcgear.runtime.linear.gradients import Gradients
from ltcgear.runtime.model.equilibrium import find_equilibrium
from ltcgear.runtime.model.function import Kernel
from ltcgear.runtime.model.library import Library
from ltcgear.runtime.model.operating_point import OperatingPoint
from ltcgear.runtime.model.state_matrix import Equilibrium
from ltcgear.runtime.simulation.run_settings import RunSettings
from ltcgear.runtime.studies.sensitivity.adjoint import differentiate_course
from ltcgear.runtime.studies.sensitivity.course import Course, follow_course
from ltcgear.runtime.studies.sensitivity.jumps import gradient_of
from ltcgear.runtime.studies.sensitivity.worth import find_output, find_worth
from numpy.typing import NDArray

Vector = NDArray[np.float64]
LOAD_FACTOR = "load-factor"
"""Measure beside those of ``worth.MEASURES``: the largest value over the static one, the mean of a steady force."""
PULLS = "{}: pulls with up to {:.4g} N, where teeth would part; set effects.contact to one-flank or backlash"


@dataclass(frozen=True)
class Target:
    """Something that is known of a run.

    Attributes
    ----------
    name
        What it is, in words.
    output
        QUANTITY:ITEM of the output it is read from.
    measure
        One of ``worth.MEASURES``, or ``load-factor``.
    value, sigma
        What it is known to be, and how well: one standard deviation.
    """

    name: str
    output: str
    measure: str
    value: float
    sigma: float


@dataclass(frozen=True)
class Span:
    """How a run is made: its end [s], the first instant that counts [s], its tolerance."""

    t_end: float
    start: float
    rtol: float = 1e-6


class Forecast:
    """The run at some parameters, and what it says of the targets.

    Parameters
    ----------
    library, p
        Model and parameters.
    targets
        What is asked for.
    span
        See ``Span``.

    Raises
    ------
    SolverError
        If there is no equilibrium, or the run does not reach its end.
    """

    def __init__(self, library: Library, p: Vector, targets: list[Target], span: Span) -> None:
        self.library, self.p, self.targets, self.span = library, p, targets, span
        self.at: Equilibrium = find_equilibrium(library, p)
        self.course: Course = follow_course(
            OperatingPoint(library, p, self.at), RunSettings(span.t_end, None, "erk", span.rtol)
        )
        self.places = [find_output(library.manifest, target.output) for target in targets]
        report = Kernel(library.functions["outputs"])(self.at.x, self.at.s, p)[0]
        self.static = [float(report[place]) for place in self.places]

    def values(self) -> Vector:
        """Return what the run says of each target."""
        return np.array([self._scaled(k, self._worth(k)) for k in range(len(self.targets))])

    def gradients(self) -> Vector:
        """Return the derivatives with respect to the parameters, shape (targets, n_p)."""
        return np.array([self._gradient(k) for k in range(len(self.targets))])

    def warnings(self) -> tuple[str, ...]:
        """Say which meshes pull at some time of the run, of models whose teeth cannot part; their forces are none."""
        reports = self.library.manifest.reports
        meshes = [place for place, report in enumerate(reports) if report.quantity == "mesh_force"]
        if any(report.quantity == "mesh_contact" for report in reports):
            return ()
        lowest = [(reports[place].item, find_worth(self.course, place, "min", 0.0).value) for place in meshes]
        return tuple(PULLS.format(mesh, -force) for mesh, force in lowest if force < 0)

    def _measure(self, k: int) -> str:
        wanted = self.targets[k].measure
        return wanted if wanted != LOAD_FACTOR else ("max" if self.static[k] >= 0 else "min")

    def _worth(self, k: int) -> float:
        return find_worth(self.course, self.places[k], self._measure(k), self.span.start).value

    def _scaled(self, k: int, value: float) -> float:
        return value / self.static[k] if self.targets[k].measure == LOAD_FACTOR else value

    def _gradient(self, k: int) -> Vector:
        found = differentiate_course(
            self.course, self.places[k], measure=self._measure(k), start=self.span.start, rtol=self.span.rtol
        )
        if self.targets[k].measure != LOAD_FACTOR:
            return found.gradient
        return np.asarray((found.gradient - found.value / self.static[k] * self._static_gradient(k)) / self.static[k])

    def _static_gradient(self, k: int) -> Vector:
        """Return the derivatives of an output at the equilibrium, which moves with the parameters."""
        weights = np.zeros(len(self.library.manifest.reports))
        weights[self.places[k]] = 1.0
        gradient = gradient_of(self.library, "outputs", (0,))
        of_x, of_s, of_p = (part.copy() for part in gradient(self.at.x, self.at.s, self.p, weights))
        return np.asarray(of_p + Balance(Gradients(self.library), self.p, self.at).pull_back(of_x, of_s))
