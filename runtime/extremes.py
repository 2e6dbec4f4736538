"""Extremes of mesh forces between samples, at the integrator's own nodes, both sides of every jump included."""

import numpy as np
from numpy.typing import NDArray

from .kernel import Kernel
from .library import Library

Vector = NDArray[np.float64]


class MeshExtremes:
    """Follow the smallest and largest mesh forces of a run.

    Samples miss peaks: a force jumps with its stiffness and then swings at frequencies that the sampling
    rate does not resolve. Segments end at the jumps and their nodes do resolve the fastest mode. Where
    nothing switches, nodes are samples and this adds nothing to them.

    Parameters
    ----------
    library, p
        Model and parameters.
    nodes
        Nodes of a segment, its start included.
    end
        End of the run [s]; from half of it on a force counts as steady, beyond it not at all.
    """

    def __init__(self, library: Library, p: Vector, nodes: int, end: float) -> None:
        rows = [i for i, report in enumerate(library.manifest.reports) if report.quantity == "mesh_force"]
        self.rows, self.half, self.end = np.array(rows, dtype=np.int64), end / 2, end
        self.lowest = np.full(len(rows), np.inf)
        self.steady = np.full((2, len(rows)), np.nan)
        outputs = library.functions["outputs"]
        self.kernel = Kernel(outputs.map("outputs_at_nodes", "serial", nodes, [2], [])) if rows else None

    def note(self, states: Vector, s: Vector, p: Vector, times: Vector) -> None:
        """Take in a segment: states (nodes, n), levels and signals (nodes, n_s), parameters, node times [s]."""
        if self.kernel is None:
            return
        self.kernel.arguments[2][:] = p
        self.kernel.arguments[0][:] = states.ravel()
        self.kernel.arguments[1].reshape(len(times), -1)[:] = s
        self.kernel.evaluate()
        within = times <= self.end * (1 + 1e-12)
        forces, times = self.kernel.results[0].reshape(len(times), -1)[:, self.rows][within], times[within]
        self.lowest = np.minimum(self.lowest, forces.min(axis=0))
        late = forces[times >= self.half]
        if len(late):
            self.steady[0] = np.fmin(self.steady[0], late.min(axis=0))
            self.steady[1] = np.fmax(self.steady[1], late.max(axis=0))
