"""Reference: the motion by two different methods at tight tolerance, and how far they are apart."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from ltcgear.generated.errors import LtcgearError, SolverError

from ..accuracy import tell_parting
from ..hard.case import Bench
from .errors import MEASURES, Errors, Samples, find_errors, take_samples, value_of
from .patience import Patience

METHODS = ("erk", "rosenbrock", "cvodes", "idas", "adams")
"""Methods that may give a reference, the most accurate first."""
RTOLS = (1e-13, 1e-12, 1e-11)
LARGEST = 1e-3
"""Distance of the two runs above which there is no reference."""
MARGIN = 100.0
"""How much larger than the reference's uncertainty an error must be to be trusted."""


@dataclass(frozen=True)
class Reference:
    """The motion that runs are compared with.

    Attributes
    ----------
    samples
        What is compared, of the first run; None where there is no reference.
    runs
        Method, tolerance and seconds of both runs.
    uncertainty
        Errors of the second run against the first.
    measure
        The kind of error that settings are judged by.
    reason
        Why there is no reference, None if there is one.
    failures
        What did not get there, and why.
    """

    samples: Samples | None
    runs: list[dict[str, Any]]
    uncertainty: Errors
    measure: str | None
    reason: str | None
    failures: list[str] = field(default_factory=list)

    @property
    def floor(self) -> float | None:
        """Return the uncertainty of the measure."""
        return None if self.measure is None else value_of(self.uncertainty, self.measure)

    def trusts(self, errors: Errors) -> bool:
        """Say whether an error is large enough to be told from the reference's own."""
        value = None if self.measure is None else value_of(errors, self.measure)
        return value is not None and self.floor is not None and value >= MARGIN * self.floor

    def to_json(self) -> dict[str, Any]:
        """Return it without its samples."""
        return {
            "runs": self.runs, "uncertainty": self.uncertainty, "measure": self.measure, "floor": self.floor,
            "reason": self.reason, "failures": self.failures,
        }  # fmt: skip


def find_reference(bench: Bench, patience: Patience, *, t_end: float, rate: float) -> Reference:
    """Run two methods at the tightest tolerance that each can meet, and compare them.

    Parameters
    ----------
    bench
        Model, parameters, start.
    patience
        How long one run may take.
    t_end, rate
        Time to simulate [s], samples a second [Hz].
    """
    runs: list[dict[str, Any]] = []
    samples: list[Samples] = []
    failures: list[str] = []
    for method in METHODS:
        for rtol in RTOLS:
            try:
                path = patience.run(bench, method, rtol, t_end=t_end, rate=rate)
            except LtcgearError as error:
                failures.append(f"{method} at rtol {rtol:g}: {error}")
                if not isinstance(error, SolverError):
                    break
            else:
                samples.append(take_samples(bench, path))
                runs.append({"method": method, "rtol": rtol, "seconds": path.seconds["integrate"]})
                break
        if len(samples) == 2:
            return _compared(samples, runs, failures, t_end)
    reason = "fewer than two methods reach the end at rtol 1e-11 or less, so that no reference can be told to be right"
    return Reference(None, runs, {}, None, reason, failures)


def _compared(samples: list[Samples], runs: list[dict[str, Any]], failures: list[str], t_end: float) -> Reference:
    """Return the reference that two runs make, if they agree."""
    uncertainty = find_errors(*samples)
    measure = next((kind for kind in MEASURES if value_of(uncertainty, kind) is not None), None)
    floor = None if measure is None else value_of(uncertainty, measure)
    if floor is not None and floor <= LARGEST:
        return Reference(samples[0], runs, uncertainty, measure, None, failures)
    names = " and ".join(f"{run['method']} at rtol {run['rtol']:g}" for run in runs)
    if floor is None:
        reason = "nothing moves from its equilibrium, so there is no vibration to refer errors to"
    else:
        apart = _parting(samples, t_end)
        reason = f"{names}: {apart}" if apart else f"{names} differ by {floor:.1e}, above {LARGEST:g}"
        reason += "; try a shorter --t-end"
    return Reference(None, runs, uncertainty, measure, reason, failures)


def _parting(samples: list[Samples], t_end: float) -> str | None:
    """Say that the two runs part from each other; None if they do not."""
    forces = [run.signals["mesh_force"] for run in samples]
    if not forces[0]:
        return None
    together = (samples[0].levels == samples[1].levels).all(axis=1)
    return tell_parting(
        np.array([[f.real for f in run.values()] for run in forces]).transpose(0, 2, 1), together, t_end
    )
