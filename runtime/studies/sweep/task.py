"""One point of a sweep, from its changes to its row, in any process that has the plan."""

import hashlib
import pickle
import signal
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from importlib.metadata import version
from threading import Lock, current_thread, main_thread
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np
from ltcgear.generated.contract import Artifact
from ltcgear.generated.errors import LtcgearError, MachineError
from numpy.typing import NDArray

from ...model.building import build
from ...model.library import Library
from ...model.load_tables import Pairs
from ...simulation.methods.registry import EXHAUSTED
from ...simulation.run_settings import RunSettings
from ...simulation.simulate import simulate
from .design import Design
from .faults import describe, is_machines
from .metrics import take_values
from .sweep_reading import DONE

if TYPE_CHECKING:
    import xarray as xr

Vector = NDArray[np.float64]
UNBUILT = "not built yet"
"""Status of a point whose structure no library was built for."""


class Maker(Protocol):
    """What makes models of changes, such as ``ltcgear.symbolic.Template``; it can be pickled."""

    name: str

    def make(self, changes: Mapping[str, str]) -> tuple[str, dict[str, float], Mapping[str, Pairs]]:
        """Return the key of a variant's C, its parameters in SI, and its tables over time."""

    def obtain(self, changes: Mapping[str, str], told: Callable[[str, float], None] = ...) -> Artifact:
        """Return a variant's C."""

    def times(self, changes: Mapping[str, str]) -> tuple[float, float | None]:
        """Return the time to simulate [s] and the samples a second [Hz], None if they are to be chosen."""

    def entries(self) -> dict[str, Any]:
        """Return all settings on which results depend, by name."""

    def about(self) -> dict[str, Any]:
        """Return what a file keeps of the scene."""


class PointOutcome(NamedTuple):
    """What came of a point: its number, ``done`` or a reason, its numbers in the row's order or None, its warnings."""

    point: int
    status: str
    values: Vector | None = None
    warnings: tuple[str, ...] = ()


@dataclass
class Plan:
    """Everything needed to compute any point of a sweep.

    Attributes
    ----------
    maker, design, metrics
        What makes models, the points, and what is kept of each.
    form
        A row without numbers, with all items of all variants.
    settings
        Settings of every run, but for the tables, which are each point's own.
    models
        Generated models by key.
    rows
        Rows of the variants without numbers, by key.
    """

    maker: Maker
    design: Design
    metrics: Sequence[str]
    form: "xr.Dataset"
    settings: RunSettings
    models: dict[str, Artifact]
    rows: dict[str, "xr.Dataset"]
    version: str = field(default_factory=lambda: version("ltcgear"))

    @cached_property
    def libraries(self) -> dict[str, Library]:
        """Return the libraries of this process by key."""
        return {}

    @cached_property
    def places(self) -> dict[str, Vector | None]:
        """Return the indices of a variant's numbers in the row, by key; None if it has all of them in order."""
        return {key: find_places(row, self.form) for key, row in self.rows.items()}

    def __getstate__(self) -> dict[str, Any]:
        """Leave out what belongs to a process."""
        return {name: value for name, value in vars(self).items() if name not in ("libraries", "places")}

    def pack(self) -> tuple[str, bytes]:
        """Return a name and the bytes by which the plan goes to other processes, makers of a script included."""
        from joblib.externals.loky.backend.reduction import dumps

        data = bytes(dumps(self))
        return hashlib.sha256(data).hexdigest(), data

    def library(self, key: str) -> Library:
        """Return a variant's library, loaded once in a process."""
        if key not in self.libraries:
            self.libraries[key] = build(self.models[key])
        return self.libraries[key]

    def compute(self, point: int) -> PointOutcome:
        """Compute a point.

        Raises
        ------
        KeyboardInterrupt
            If the run was interrupted.
        LtcgearError
            If the scene, the start or a metric fails.
        """
        key, values, tables = self.maker.make(self.design.changes(point))
        if key not in self.models:
            return PointOutcome(point, UNBUILT)
        result = simulate(self.library(key), values, **vars(replace(self.settings, tables=tables)))
        status, warnings = result.summary["status"], tuple(result.summary["warnings"])
        if status.startswith("interrupted"):
            raise KeyboardInterrupt
        if status != DONE:
            return PointOutcome(point, status, None, warnings)
        return PointOutcome(point, DONE, _arrange(take_values(result, self.metrics), self.places[key]), warnings)


def flatten(row: "xr.Dataset") -> Vector:
    """Return the numbers of a row, one variable after the other."""
    parts = [np.ravel(variable.values) for variable in row.data_vars.values()]
    return np.concatenate(parts) if parts else np.zeros(0)


def find_places(row: "xr.Dataset", form: "xr.Dataset") -> Vector | None:
    """Return which number of a row belongs at each position of the form, NaN for none; None if all are in order."""
    numbered, count = row.copy(), 0
    for name, variable in row.data_vars.items():
        numbered[name] = variable.copy(
            data=np.arange(count, count + variable.size, dtype=float).reshape(variable.shape)
        )
        count += variable.size
    fitted = numbered.reindex_like(form)
    for name in form.data_vars:
        if name not in fitted:
            fitted[name] = form[name]
    places = flatten(fitted[list(form.data_vars)])
    if np.nansum(~np.isnan(places)) < count:
        raise LtcgearError("this variant has items that no other has; put its value at an end of an axis")
    return None if np.array_equal(places, np.arange(count)) else places


def _arrange(values: Vector, places: Vector | None) -> Vector:
    """Return the numbers of a row in the order of the form."""
    if places is None:
        return values
    held = ~np.isnan(places)
    arranged = np.full(len(places), np.nan)
    arranged[held] = values[places[held].astype(int)]
    return arranged


# --- in a process that computes

_PLANS: dict[str, Plan | LtcgearError] = {}
"""Plans by name; the reason in place of one that cannot be used here."""
UNUSABLE = "a worker cannot use what makes the models: {}; see that it can be pickled"
_ALONE = Lock()
"""CasADi serves one thread; a cluster's workers may have several."""


def keep_plan(name: str, data: bytes) -> None:
    """Make a plan known to this process.

    Raises
    ------
    LtcgearError
        If it comes from another version of ltcgear.
    """
    plan: Plan = pickle.loads(data)
    if plan.version != version("ltcgear"):
        raise LtcgearError(
            f"a worker has ltcgear {version('ltcgear')}, the sweep {plan.version}; install the same on all machines"
        )
    _PLANS[name] = plan


def start_process(name: str, data: bytes) -> None:
    """Make a plan known to a process that does nothing else; Ctrl-C is for the one that started it.

    If that fails, the process stays alive to report why: its death would be taken for a point's fault.
    """
    if current_thread() is main_thread():
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        keep_plan(name, data)
    except Exception as error:  # whatever a maker raises that cannot be unpickled
        text = f"{type(error).__name__}: {error}"
        _PLANS[name] = MachineError(text) if is_machines(error) else LtcgearError(UNUSABLE.format(text))


def forget_plan(name: str) -> None:
    """Let go of a plan and its libraries."""
    _PLANS.pop(name, None)


def run_point(name: str, point: int) -> PointOutcome:
    """Compute a point of a plan that this process knows; what fails is a reason in place of numbers.

    Raises
    ------
    LtcgearError
        If the process cannot use the plan, which is no point's fault.
    MachineError
        If the machine fails, which is none either.
    """
    plan = _PLANS.get(name, LtcgearError(UNUSABLE.format("it was not sent")))
    if isinstance(plan, LtcgearError):
        raise plan
    with _ALONE:
        try:
            outcome = plan.compute(point)
        except Exception as error:  # one point in thousands must not end all others
            if is_machines(error):
                raise MachineError(f"{plan.design.tell(point)}: {describe(error)}") from error
            return PointOutcome(point, describe(error))
    if EXHAUSTED in outcome.status:
        raise MachineError(f"{plan.design.tell(point)}: {outcome.status}")
    return outcome
