"""Run settings: how long, how finely and by which method a motion is simulated."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypedDict

import numpy as np
from ltcgear.generated.contract import MOST_SAMPLES
from ltcgear.generated.errors import LtcgearError

from ..model.load_tables import Pairs
from ..model.parameter_values import is_number
from .methods.registry import AUTO, Method, find_method

DEFAULT_METHOD = AUTO
DEFAULT_RTOL = 1e-6


class ChosenOptions(TypedDict, total=False):
    """Settings of a run that may be left out, as keyword arguments; see ``RunSettings``."""

    rate: float | None
    method: str
    rtol: float
    raw: bool
    tables: Mapping[str, Pairs] | None
    verify: bool
    long: bool


class RunOptions(ChosenOptions):
    """Settings of a run as keyword arguments, see ``RunSettings``."""

    t_end: float


@dataclass(frozen=True)
class RunSettings:
    """Settings of a run; public functions take them as keyword arguments, check them and hand them on.

    Attributes
    ----------
    t_end, rate
        Time to simulate [s] and samples a second [Hz]; without, the rate is chosen from modes and meshes
        (``sampling_rate``).
    method, rtol
        Name of the integrator (``registry.METHODS``; ``auto`` chooses one, see ``choose_method``) and its relative
        tolerance, which refers to vibrations.
    raw
        Keep outputs of the instant, in which what lies above half the rate shows as false lines below it. Else all are
        band-limited: filtered before they are sampled (``low_pass``).
    tables
        Table name -> rows of time [s] and value in SI; the model's, where its loads are given over time.
    verify
        Run the first samples at ``rtol`` and at a tenth of it as well: ``summary["accuracy"]``, see ``verify``.
    long
        Begin a run too that is estimated to take more than about an hour (``method_limits``); else it is refused.
    """

    t_end: float
    rate: float | None = None
    method: str = DEFAULT_METHOD
    rtol: float = DEFAULT_RTOL
    raw: bool = False
    tables: Mapping[str, Pairs] | None = None
    verify: bool = False
    long: bool = False

    @property
    def sampling_rate(self) -> float:
        """Return the sampling rate [Hz]; LtcgearError where it is still to be chosen."""
        if self.rate is None:
            raise LtcgearError("rate: give the samples a second, which are chosen for whole runs only")
        return self.rate

    @property
    def integrator(self) -> Method:
        """Return the record of the method; LtcgearError where there is none of that name."""
        return find_method(self.method)

    @property
    def samples(self) -> int:
        """Return the samples after the first."""
        return round(self.t_end * self.sampling_rate)

    def identity(self) -> dict[str, Any]:
        """Return by name the settings that a resumed run must share."""
        return {name: getattr(self, name) for name in ("t_end", "rate", "method", "rtol", "raw")}

    def checked(self) -> "RunSettings":
        """Return the settings themselves; LtcgearError for those that no integrator can serve."""
        check_options(self.method, self.rtol, self.t_end, self.rate)
        if self.rate is not None:
            check_length(self.t_end * self.rate)
        return self


def check_options(method: str, rtol: float, t_end: float | None = None, rate: float | None = None) -> None:
    """Refuse options that no integrator can serve, before anything is computed."""
    if method != AUTO:
        find_method(method)
    if not (is_number(rtol) and 1e-13 <= rtol <= 0.1):
        raise LtcgearError(f"rtol {_told(rtol)}: must lie between 1e-13 and 0.1")
    if t_end is not None and not (is_number(t_end) and 0 < t_end < 1e7):
        raise LtcgearError(f"t_end {_told(t_end)}: must be a time in seconds, greater than zero and below 1e7")
    if rate is not None and not (is_number(rate) and 0 < rate < np.inf):
        raise LtcgearError(f"rate {_told(rate)}: must be a number of samples a second, greater than zero")


def check_length(samples: float) -> None:
    """Refuse a run of less than one sample, or of more than a result may hold."""
    if samples > MOST_SAMPLES:
        raise LtcgearError(f"t_end times rate are {samples:.2g} samples, above {MOST_SAMPLES:.0e}; lower t_end or rate")
    if round(samples) < 1:
        raise LtcgearError("t_end is shorter than one sample; simulate longer or raise simulation.rate")


def _told(value: object) -> str:
    """Return an option as its message tells it."""
    return f"{value:g}" if isinstance(value, int | float) and not isinstance(value, bool) else f"{value!r:.60}"
