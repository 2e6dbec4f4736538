"""Asynchronous machines that have left the stable part of their slip law."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from .function import Kernel
from .library import Library

Vector = NDArray[np.float64]

NUDGE = 1e-6
"""Change of the synchronous speed, over breakdown slip, by which the slope of a slip law is seen."""


def past_breakdown(library: Library, x: Vector, s: Vector, p: Vector) -> Iterator[str]:
    """Yield which machines turn beyond their breakdown slip at a state.

    There the torque of a slip law (Kloss), T = -2 T_b z / (1 + z^2) with slip over breakdown slip z, decreases as the
    speed departs further: a machine passes it on a start, and stays there only if it has been overpowered. The sign of
    the slope of its torque over its synchronous speed shows on which side of |z| = 1 it is.
    """
    names = [name for name, _ in library.manifest.parameters]
    told = {r.item: i for i, r in enumerate(library.manifest.reports) if r.quantity == "load_torque"}
    outputs = Kernel(library.functions["outputs"])
    for machine in (item for item in library.manifest.connections if len(item.law) == 3):
        synchronous, slip, most = map(names.index, machine.law)
        column, moved = told[machine.item], p.copy()
        moved[synchronous] += NUDGE * p[slip]
        torque, after = (float(outputs(x, s, given)[0][column]) for given in (p, moved))
        part = min(abs(torque / p[most]), 1.0)
        if after < torque and part > 0:
            times = (1 + np.sqrt(1 - part**2)) / part
            yield (
                f"{machine.group}: turns at {times:.3g} times its breakdown slip at the end, where its torque falls "
                "the further it goes; simulate longer if it is still starting, else lower the load or raise "
                "breakdown_torque"
            )
