"""Campbell diagram: eigenfrequencies over speed or load, each point with its own equilibrium."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from ltcgear.generated.errors import LtcgearError, SolverError
from numpy.typing import NDArray

from ..model.equilibrium import find_equilibrium
from ..model.library import Library
from ..model.load_tables import Pairs
from ..model.load_torques import given_torques
from ..model.operating_point import OperatingPoint
from ..model.phase_wrapping import TURN
from .modes import Mode, find_modes
from .system import Linear, linearise
from .tracking import track

Vector = NDArray[np.float64]
RPM = TURN / 60
SPEED, LOAD = "speed", "load"
UNITS = {SPEED: "rpm", LOAD: "times the scene's load"}
AT_HOME = 1e-9
"""How close [relative] a value of the axis counts as the scene's own."""


@dataclass(frozen=True)
class Campbell:
    """Modes along an axis.

    Attributes
    ----------
    axis
        ``speed`` (size of the reference's speed, rpm) or ``load`` (factor of all torques).
    values
        Of the axis, ascending, shape (m,).
    home
        The scene's own value, None if the scene has none.
    at_home
        The point nearest to the scene's own, where modes are numbered.
    turns
        Turns of the reference a second at every point, with their sign, shape (m,).
    parameters, linears, modes
        Parameters, linear system and modes at every point; rigid-body modes are left out.
    first
        Number of the first mode: rigid-body modes are counted before it.
    tracks
        Place of each followed mode among those of a point, shape (m, tracks); -1 where it is not.
    """

    axis: str
    values: Vector
    home: float
    at_home: int
    turns: Vector
    parameters: list[Vector]
    linears: list[Linear]
    modes: list[list[Mode]]
    first: int
    tracks: NDArray[np.int64] = field(repr=False)

    def mode(self, point: int, column: int) -> Mode | None:
        """Return a followed mode at a point, None if it is not."""
        place = self.tracks[point, column]
        return None if place < 0 else self.modes[point][place]

    def number(self, column: int) -> int:
        """Return the number of a followed mode: its place at the scene's own point, from 1, rigid ones counted."""
        return self.first + column

    def frequencies(self, column: int) -> Vector:
        """Return a followed mode's eigenfrequency [Hz] at every point, NaN where it is not."""
        found = [self.mode(i, column) for i in range(len(self.values))]
        return np.array([np.nan if mode is None else mode.frequency_hz for mode in found])


def sweep_speed(
    library: Library, p: Vector, values: Vector | None = None, *, tables: Mapping[str, Pairs] | None = None,
    told: Callable[[int], None] = lambda done: None,
) -> Campbell:  # fmt: skip
    """Follow the modes over the speed of the reference.

    Parameters
    ----------
    library, p, tables
        The model, its parameters, and its tables over time.
    values
        Sizes of the speed [rpm], ascending; the sense is the scene's own. 61 from 0 to 1.5 times the scene's where
        left out. The scene's own speed is put in where it lies between them.
    told
        Called with the number of points that are done.

    Raises
    ------
    LtcgearError
        If the train has no speed of its own: at rest, or a table over time.
    SolverError
        If there is no equilibrium at a speed.
    """
    place = _speed_place(library)
    home = abs(float(p[place])) / RPM
    sense = -1.0 if p[place] < 0 else 1.0
    if values is None:
        if home == 0:
            raise LtcgearError("campbell: the scene's speed is 0; give the speeds, for example --speed 0:100:41")
        values = np.linspace(0.0, 1.5 * home, 61)
    values = _with_home(values, home)

    def at(value: float) -> tuple[Vector, Mapping[str, Pairs]]:
        changed = p.copy()
        changed[place] = sense * value * RPM
        return changed, tables or {}

    return _sweep(library, SPEED, values, home, at, sense * values * RPM / TURN, told)


def sweep_load(
    library: Library, p: Vector, values: Vector, *, tables: Mapping[str, Pairs] | None = None,
    told: Callable[[int], None] = lambda done: None,
) -> Campbell:  # fmt: skip
    """Follow the modes over a factor of all torques, constant ones and those over time.

    Parameters are those of ``sweep_speed``, ``values`` factors.

    Raises
    ------
    LtcgearError
        If no load has a torque.
    SolverError
        If there is no equilibrium at a load.
    """
    places = _torque_places(library)
    torques = given_torques(library.manifest).values()
    moving = list(dict.fromkeys(s.table for s in library.manifest.signals if s.name in torques))
    if not places and not moving:
        raise LtcgearError("campbell --load: no load of the scene has a torque; give one, loads.NAME.torque")
    values = _with_home(values, 1.0)
    turns = p[_speed_place(library)] / TURN if library.manifest.reference != "rest" else 0.0

    def at(value: float) -> tuple[Vector, Mapping[str, Pairs]]:
        changed, scaled = p.copy(), dict(tables or {})
        changed[places] *= value
        scaled |= {name: [(time, value * torque) for time, torque in scaled[name]] for name in moving}
        return changed, scaled

    return _sweep(library, LOAD, values, 1.0, at, np.full(len(values), turns), told)


def _torque_places(library: Library) -> list[int]:
    """Return the indices of constant load torques among the parameters."""
    names = [name for name, _ in library.manifest.parameters]
    return [names.index(name) for name in given_torques(library.manifest).values() if name in names]


def _speed_place(library: Library) -> int:
    """Return the index of the reference's speed among the parameters."""
    names = [name for name, _ in library.manifest.parameters]
    if library.manifest.reference == "rest":
        torques = given_torques(library.manifest)
        raise LtcgearError(
            "campbell: the train stands, so that there is no speed and no order; hold a member's speed, "
            f"loads.NAME.speed{', or sweep the load, for example --load 0.2:2:31' if torques else ''}"
        )
    if "reference.speed" not in names:
        raise LtcgearError(
            "campbell: the speed follows a table over time; give a constant one, loads.NAME.speed, in its place"
        )
    return names.index("reference.speed")


def _with_home(values: Vector, home: float) -> Vector:
    """Put the scene's own value between those of the axis."""
    inside = values[0] < home < values[-1] and np.abs(values - home).min() > AT_HOME * home
    return np.sort(np.append(values, home)) if inside else values


def _sweep(
    library: Library, axis: str, values: Vector, home: float,
    at: Callable[[float], tuple[Vector, Mapping[str, Pairs]]], turns: Vector, told: Callable[[int], None],
) -> Campbell:  # fmt: skip
    """Linearise at every value of an axis, and follow the modes."""
    parameters, linears, everything = [], [], []
    for done, value in enumerate(values.tolist(), start=1):
        p, tables = at(value)
        try:
            linears.append(linearise(OperatingPoint(library, p, find_equilibrium(library, p, tables=tables))))
        except SolverError as error:
            raise SolverError(f"{axis} {value:g} ({UNITS[axis]}): {error}") from error
        parameters.append(p)
        everything.append(find_modes(linears[-1]))
        told(done)
    elastic = [[mode for mode in modes if mode.kind != "rigid"] for modes in everything]
    here = int(np.abs(values - home).argmin())
    first = 1 + len(everything[here]) - len(elastic[here])
    return Campbell(axis, values, home, here, turns, parameters, linears, elastic, first, track(elastic, here))
