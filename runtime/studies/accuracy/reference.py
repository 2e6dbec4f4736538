"""Reference motion by two different methods at tight tolerance, and their difference.

Where a model is linear between its jumps, both are compared with the exact motion too.
"""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from ltcgear.generated.errors import LtcgearError, MachineError, SolverError

from ...simulation.matrix_exponential import Exact
from ...simulation.methods.registry import METHODS
from ...simulation.trajectory import Trajectory
from ...simulation.verify import tell_parting
from ..selftest.case import Bench
from .patience import Patience
from .run_errors import MEASURES, ComparedSamples, Errors, find_errors, take_samples, value_of

RTOLS = (1e-13, 1e-12, 1e-11)
LARGEST = 1e-3
"""Distance of the two runs above which there is no reference."""
READING = 1e-9
"""Error over the vibration of reading samples between the nodes of a segment, which both methods may share: they agree
to 1e-13 on a linear model and are up to 8e-10 off the exact motion."""
MOVING = 1e-4
"""States over the scale of vibrations below which nothing moves: less is rounding."""
TRIALS = 3
"""Runs that may be given up for their time before there is no reference."""
MARGIN = 100.0
"""How much larger than the reference's uncertainty an error must be to be trusted."""


@dataclass(frozen=True)
class Reference:
    """The motion that runs are compared with.

    Attributes
    ----------
    samples
        What is compared, of the first run; None if there is no reference.
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
    exact
        Errors of the first run against the exact motion, None if the model is not linear between jumps.
    reading
        What both runs may have in common, since they read samples between the same nodes: ``READING`` where they do.
    """

    samples: ComparedSamples | None
    runs: list[dict[str, Any]]
    uncertainty: Errors
    measure: str | None
    reason: str | None
    failures: list[str] = field(default_factory=list)
    exact: Errors | None = None
    reading: float = 0.0

    @property
    def floor(self) -> float | None:
        """Return the uncertainty of the measure: the runs' difference, or what they have in common if that is more."""
        if self.measure is None:
            return None
        known = [value_of(errors, self.measure) for errors in (self.uncertainty, self.exact or {})]
        return max(self.reading, *(value for value in known if value is not None))

    def trusts(self, errors: Errors) -> bool:
        """Say whether an error is large enough to be told from the reference's own."""
        value = None if self.measure is None else value_of(errors, self.measure)
        return value is not None and self.floor is not None and value >= MARGIN * self.floor

    def to_json(self) -> dict[str, Any]:
        """Return it without its samples."""
        return {
            "runs": self.runs, "uncertainty": self.uncertainty, "measure": self.measure, "floor": self.floor,
            "reason": self.reason, "failures": self.failures, "exact": self.exact, "reading": self.reading,
        }  # fmt: skip


def reference_methods() -> list[str]:
    """Return the methods that may give a reference, the most accurate first."""
    places = {method.reference: name for name, method in METHODS.items() if method.reference is not None}
    return [places[place] for place in sorted(places)]


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
    failures: list[str] = []
    found: list[tuple[str, float, Trajectory]] = []
    for method in reference_methods():
        if sum("more than" in failure for failure in failures) >= TRIALS:
            break
        found += _tightest(bench, patience, method, failures, t_end=t_end, rate=rate)
        if len(found) == 2:
            break
    runs = [{"method": method, "rtol": rtol, "seconds": path.seconds["integrate"]} for method, rtol, path in found]
    if len(found) < 2:
        reason = f"fewer than two methods reach the end at rtol {RTOLS[-1]:g} or less; try a shorter --t-end"
        return Reference(None, runs, {}, None, reason, failures)
    samples = [take_samples(bench, path) for _, _, path in found]
    exact, reading = _exact(bench, found[0][2], samples[0]), _reading(bench, [method for method, _, _ in found])
    return judge(
        samples, Reference(samples[0], runs, find_errors(*samples), None, None, failures, exact, reading), t_end
    )


def _tightest(
    bench: Bench, patience: Patience, method: str, failures: list[str], **times: float
) -> list[tuple[str, float, Trajectory]]:
    """Return method, tolerance and run at the tightest tolerance that the method achieves; none if there is none."""
    for rtol in RTOLS:
        try:
            return [(method, rtol, patience.run(bench, method, rtol, t_end=times["t_end"], rate=times["rate"]))]
        except MachineError:
            raise
        except LtcgearError as error:
            failures.append(f"{method} at rtol {rtol:g}: {error}")
            if not isinstance(error, SolverError):
                break
    return []


def judge(samples: list[ComparedSamples], found: Reference, t_end: float) -> Reference:
    """Return a reference with the measure that it serves, or with the reason why it cannot be used."""
    kinds = (kind for kind in MEASURES if value_of(found.uncertainty, kind) is not None)
    found = replace(found, measure=next(kinds, None) if samples[0].moves(MOVING) else None)
    if found.floor is None:
        reason = "nothing moves from its equilibrium, so there is no vibration to refer errors to"
        return replace(found, samples=None, reason=reason)
    if found.floor <= LARGEST:
        return found
    names = " and ".join(f"{run['method']} at rtol {run['rtol']:g}" for run in found.runs)
    why = _parting(samples, t_end) or f"they are uncertain by {found.floor:.1e}, above {LARGEST:g}"
    return replace(found, samples=None, reason=f"{names}: {why}; try a shorter --t-end")


def _reading(bench: Bench, methods: list[str]) -> float:
    """Return the error that two runs may share: samples are interpolated between nodes where anything switches."""
    manifest = bench.library.manifest
    between = manifest.levels or manifest.signals or manifest.holds
    return READING if between and len({METHODS[method].multistep for method in methods}) == 1 else 0.0


def _exact(bench: Bench, path: Trajectory, samples: ComparedSamples) -> Errors | None:
    """Return the errors of a run against the exact motion; None if there is no such motion."""
    try:
        exact = Exact(bench.point)
    except LtcgearError:
        return None
    x, levels = exact.solve(path.time)
    return find_errors(take_samples(bench, replace(path, x=x, levels=levels)), samples)


def _parting(samples: list[ComparedSamples], t_end: float) -> str | None:
    """Say that the two runs part from each other; None if they do not."""
    forces = [run.signals["mesh_force"] for run in samples]
    if not forces[0]:
        return None
    together = (samples[0].levels == samples[1].levels).all(axis=1)
    return tell_parting(
        np.array([[f.real for f in run.values()] for run in forces]).transpose(0, 2, 1), together, t_end
    )
