"""Hard case: a scene, an oracle, and findings with their limits."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import isfinite

import numpy as np
from ltcgear.generated.errors import SolverError
from numpy.typing import NDArray

from ...model.equilibrium import find_equilibrium
from ...model.library import Library
from ...model.load_tables import Pairs
from ...model.operating_point import OperatingPoint
from ...model.state_matrix import Equilibrium
from ...simulation.integrate import integrate
from ...simulation.run_settings import RunSettings
from ...simulation.trajectory import Told, Trajectory

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Bench:
    """A built scene on the test bench: its library, parameter values and tables over time."""

    library: Library
    values: Mapping[str, float]
    tables: Mapping[str, Pairs] = field(default_factory=dict)

    @cached_property
    def p(self) -> Vector:
        """Return the parameter vector."""
        return self.library.parameters(self.values)

    @cached_property
    def at(self) -> Equilibrium:
        """Return the loaded equilibrium."""
        return find_equilibrium(self.library, self.p, tables=self.tables)

    @cached_property
    def point(self) -> OperatingPoint:
        """Return the operating point."""
        return OperatingPoint(self.library, self.p, self.at)

    def run(
        self, method: str, *, t_end: float, rate: float, rtol: float, at: Equilibrium | None = None,
        told: Told = lambda t: None,
    ) -> Trajectory:  # fmt: skip
        """Integrate from the equilibrium or another start; SolverError where it does not reach its end.

        Settings are those of ``RunSettings``; ``told`` is called with the simulated time.
        """
        point = self.point if at is None else replace(self.point, at=at)
        path = integrate(point, RunSettings(t_end, rate, method, rtol, tables=self.tables), told)
        if path.status != "done":
            raise SolverError(path.status)
        return path


Open = Callable[[str, Mapping[str, str]], Bench]
"""Builds a scene by name, with changes as ``--set`` takes them."""


@dataclass(frozen=True)
class Finding:
    """One number of a case: it is right where it is finite and at most the limit."""

    what: str
    value: float
    limit: float

    @property
    def right(self) -> bool:
        """Say whether the number passes."""
        return isfinite(self.value) and self.value <= self.limit


@dataclass(frozen=True)
class HardCase:
    """A case where gear models usually break.

    Attributes
    ----------
    name
        Short name, as in ``ltcgear selftest --case NAME``.
    title
        What is hard about it.
    passes
        What it must show, and by which oracle.
    check
        Yields findings for one method; its arguments are the opener of scenes, the method and whether the
        long form is wanted. An LtcgearError is a refusal with a reason.
    integrates
        False where no integrator is at work, so that the case is run once.
    """

    name: str
    title: str
    passes: str
    check: Callable[[Open, str, bool], Iterable[Finding]]
    integrates: bool = True
