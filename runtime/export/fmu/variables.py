"""Variables of an FMU, in the order of their value references."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from ltcgear.generated.contract import BOUNDS, LARGEST, Manifest
from ltcgear.generated.errors import LtcgearError

from ...model.equilibrium import find_equilibrium
from ...model.library import Library
from ...model.operating_point import OperatingPoint
from ...model.parameter_values import name_values
from ...model.quantity_names import LONG_NAMES
from ...results.dataset import speed_ratio
from ..plain_c.data import PlainRun, fixed_parameters
from .names import structure

KINDS = ("time", "state", "rate", "parameter", "output", "angle", "count", "statistic", "indicator", "input")
"""Kinds of variables, in the order of the C's enumeration."""
COUNTS = {
    "switchings": "tooth pairs that have come or gone so far",
    "regime_changes": "contacts that have opened or closed, and friction forces that have turned, so far",
}
STATISTICS = {"mean": "mean", "rms": "root mean square", "min": "least", "max": "largest"}
"""Statistics of a mesh force over a communication step, in the order of the C's structure."""
OUTPUTS = ("output", "angle", "count", "statistic")
"""Kinds that are outputs of the FMU."""
STATES = {
    "reference angle": "angle of the reference",
    "reference speed": "speed of the reference",
    "deviation": "deviation from the rigid motion",
    "rate": "rate of the deviation from the rigid motion",
}
"""Kind of state -> what it is."""
INITIAL_SPEED = "reference.initial_speed"
DUTY = "the user's duty: the rate of the speed beside it, zero while that is constant"


@dataclass(frozen=True)
class Variable:
    """One variable, see FMI 2.0, 2.2.7; ``derivative`` is the value reference of the state it is the rate of."""

    kind: str
    name: str
    reference: int
    unit: str
    causality: str
    variability: str
    initial: str = ""
    start: float | None = None
    lowest: float | None = None
    highest: float | None = None
    nominal: float | None = None
    derivative: int | None = None
    description: str = ""


@dataclass(frozen=True)
class Input:
    """One input: its name, unit and start value, the index of the table it replaces, whether it is the slope."""

    name: str
    unit: str
    start: float
    table: int
    slope: bool

    @property
    def ramps(self) -> bool:
        """Return whether it is a speed, which does not jump."""
        return self.unit == "rad/s"


class Interface:
    """The variables of a model.

    Parameters
    ----------
    library
        The model.
    run
        Numbers and tables of the scene.
    inputs
        Tables that others lead.
    exchange
        Whether it is for model exchange: rates, indicators and the slopes of speeds are variables then.

    Raises
    ------
    SolverError
        If the scene has no equilibrium.
    LtcgearError
        If two variables had the same name.
    """

    def __init__(self, library: Library, run: PlainRun, inputs: Sequence[str], exchange: bool) -> None:
        self.manifest, self.exchange = library.manifest, exchange
        self.p = library.parameters(run.values)
        self.at = find_equilibrium(library, self.p, tables=run.tables)
        self.point = OperatingPoint(library, self.p, self.at)
        self.nominal = [float(size) for size in self.point.scale]
        self.fixed = fixed_parameters(library.manifest)
        self.bounds = [BOUNDS[self.manifest.bounds[name]] for name, _ in self.manifest.parameters]
        self.inputs = list(_inputs(self.manifest, run, inputs, exchange))
        self.rotors = [(i, r.item) for i, r in enumerate(self.manifest.reports) if r.quantity == "twist"]
        number = name_values(self.manifest, self.p)
        self.ratios = [speed_ratio(library, number, rotor) for _, rotor in self.rotors]
        _check_names([variable.name for variable in self.variables])

    @cached_property
    def slots(self) -> dict[str, list[Variable | None]]:
        """Return kind -> variables by place; None for a parameter that cannot be set."""
        slots: dict[str, list[Variable | None]] = {}
        first = 0
        for kind in KINDS:
            slots[kind] = list(getattr(self, f"_{kind}s")(first))
            first += len(slots[kind])
        return slots

    @property
    def variables(self) -> list[Variable]:
        """Return all variables that there are."""
        return [variable for slot in self.slots.values() for variable in slot if variable is not None]

    def of(self, *kinds: str) -> list[Variable]:
        """Return the variables of some kinds."""
        return [variable for variable in self.variables if variable.kind in kinds]

    @property
    def first(self) -> list[int]:
        """Return the value reference at which each kind begins, and the end."""
        ends = [0]
        for slot in self.slots.values():
            ends.append(ends[-1] + len(slot))
        return ends

    def _times(self, first: int) -> Iterator[Variable]:
        yield Variable("time", "time", first, "s", "independent", "continuous", description="time")

    def _states(self, first: int) -> Iterator[Variable]:
        for i, (state, size) in enumerate(zip(self.manifest.states, self.nominal, strict=True), start=first):
            yield Variable(
                "state", structure(state.name), i, state.unit, "local", "continuous", "calculated", nominal=size,
                description=STATES[state.kind],
            )  # fmt: skip

    def _rates(self, first: int) -> Iterator[Variable]:
        count = len(self.manifest.states)
        for i, state in enumerate(self.manifest.states if self.exchange else ()):
            yield Variable(
                "rate", f"der({structure(state.name)})", first + i, f"{state.unit}/s".replace("/s/s", "/s^2"),
                "local", "continuous", "calculated", derivative=first - count + i,
            )  # fmt: skip

    def _parameters(self, first: int) -> Iterator[Variable | None]:
        for i, (name, unit) in enumerate(self.manifest.parameters):
            if self.fixed[i]:
                yield None
                continue
            low, high = (None if abs(bound) == LARGEST else bound for bound in self.bounds[i])
            # Where the speed of the reference is free, it is a state, and the parameter what it begins with.
            name = INITIAL_SPEED if any(state.name == name for state in self.manifest.states) else name
            yield Variable(
                "parameter", structure(name), first + i, unit, "parameter", "fixed", "exact", start=float(self.p[i]),
                lowest=low, highest=high,
            )  # fmt: skip

    def _outputs(self, first: int) -> Iterator[Variable]:
        for i, report in enumerate(self.manifest.reports, start=first):
            yield Variable(
                "output", f"{structure(report.item)}.{report.quantity}", i, report.unit, "output", "continuous",
                "calculated", description=LONG_NAMES[report.quantity],
            )  # fmt: skip

    def _angles(self, first: int) -> Iterator[Variable]:
        for i, (_, rotor) in enumerate(self.rotors, start=first):
            yield Variable(
                "angle", f"{structure(rotor)}.angle", i, "rad", "output", "continuous", "calculated",
                description="angle, whole turns included",
            )  # fmt: skip

    def _counts(self, first: int) -> Iterator[Variable]:
        for i, (name, text) in enumerate(COUNTS.items(), start=first):
            yield Variable("count", name, i, "", "output", "discrete", "calculated", description=text)

    def _statistics(self, first: int) -> Iterator[Variable]:
        forces = [r for r in self.manifest.reports if r.quantity == "mesh_force" and not self.exchange]
        pairs = ((force, name, text) for force in forces for name, text in STATISTICS.items())
        for i, (force, name, text) in enumerate(pairs, start=first):
            yield Variable(
                "statistic", f"{structure(force.item)}.{force.quantity}_{name}", i, force.unit, "output", "discrete",
                "calculated", description=f"{text} of the mesh force over the last communication step",
            )  # fmt: skip

    def _indicators(self, first: int) -> Iterator[Variable]:
        if not self.exchange:
            return
        units = dict(self.manifest.parameters)
        sides = ("ahead", "behind")
        named = [(f"{structure(mesh)}.border_{side}", "") for mesh in self.manifest.levels for side in sides]
        named += [(f"{structure(hold.removeprefix('hold.'))}.border", units[hold]) for hold in self.manifest.holds]
        for i, (name, unit) in enumerate(named, start=first):
            yield Variable(
                "indicator", name, i, unit, "local", "continuous", "calculated", description="event indicator"
            )

    def _inputs(self, first: int) -> Iterator[Variable]:
        for i, item in enumerate(self.inputs, start=first):
            yield Variable(
                "input", structure(item.name), i, item.unit, "input", "continuous", "exact", item.start,
                description=DUTY if item.slope else _describe_input(item, self.exchange),
            )  # fmt: skip


def _inputs(manifest: Manifest, run: PlainRun, wanted: Sequence[str], exchange: bool) -> Iterator[Input]:
    """Yield the inputs that replace some tables, each followed by its slope where this is needed."""
    tables = list(dict.fromkeys(signal.table for signal in manifest.signals))
    for table in wanted:
        first, place = float(run.tables[table][0][1]), tables.index(table)
        for signal in (signal for signal in manifest.signals if signal.table == table):
            if exchange or not signal.slope:
                yield Input(signal.quantity, signal.unit, 0.0 if signal.slope else first, place, signal.slope)


def _describe_input(item: Input, exchange: bool) -> str:
    """Say what an input does."""
    if not item.ramps:
        return "torque of the load"
    return "speed that is held" + ("" if exchange else "; it is reached at the end of a communication step")


def _check_names(names: Sequence[str]) -> None:
    """Refuse names that occur twice."""
    twice = sorted(name for name, count in Counter(names).items() if count > 1)
    if twice:
        raise LtcgearError(f"two variables would be called {', '.join(twice)}; rename members or loads of the scene")
