"""A torsional pair whose gear 1 is held, and what its runs show."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...model.rows import over_time
from ...model.state_matrix import Equilibrium
from ...simulation.trajectory import Trajectory
from .case import Bench

Vector = NDArray[np.float64]


def read(bench: Bench, path: Trajectory, quantity: str) -> dict[str, Vector]:
    """Return item -> samples of one quantity."""
    values = over_time(bench.library, "outputs", path.x, path.s, bench.p)
    reports = enumerate(bench.library.manifest.reports)
    return {report.item: values[:, i] for i, report in reports if report.quantity == quantity}


def read_power_lost(bench: Bench, path: Trajectory) -> Vector:
    """Return the samples of the power lost [W]."""
    return over_time(bench.library, "energy", path.x, path.s, bench.p)[:, 4]


def started(bench: Bench, **given: float) -> Equilibrium:
    """Return the equilibrium with some states given, ``_`` in their names standing for a dot."""
    names = [state.name for state in bench.library.manifest.states]
    x = bench.at.x.copy()
    for name, value in given.items():
        x[names.index(name.replace("_", "."))] = value
    return replace(bench.at, x=x)


@dataclass(frozen=True)
class TorsionalPair:
    """A pair without sideways motion whose gear 1 is held: a mass m on the spring k of the mesh.

    Mass [kg] and stiffness [N/m] along the line of action, base radius [m] and constant torque [N m] of gear 2,
    damper of the mesh [N s/m].
    """

    m: float
    k: float
    r: float
    torque: float
    c: float

    @classmethod
    def of(cls, bench: Bench) -> "TorsionalPair":
        """Read a pair called ``pair``; where its torque is over time, that at the start."""
        v, r = bench.values, bench.values["pair.mesh.base_radius_2"]
        table = bench.tables.get("loads.output.torque_over_time", ((0.0, 0.0),))
        torque = v.get("loads.output.torque", table[0][1])
        return cls(
            v["pair.output.inertia"] / r**2, v["pair.mesh.stiffness"], r, torque, v.get("pair.mesh.damping", 0.0)
        )

    @property
    def omega(self) -> float:
        """Return the natural frequency [rad/s]."""
        return float(np.sqrt(self.k / self.m))

    @property
    def static(self) -> float:
        """Return the static deflection [m]."""
        return self.torque / self.r / self.k
