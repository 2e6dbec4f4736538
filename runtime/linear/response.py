"""Frequency response of mesh forces to a sinusoidal transmission error or torque ripple.

With zdot = A z + b(omega) u and y = C z + d(omega) u, the response is H = C (i omega - A)^-1 b + d. Of a mesh's
transmission error e the additional normal force is -(k + i omega c) e, that of a torque its ripple.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from ltcgear.generated.errors import LtcgearError
from numpy.typing import NDArray
from scipy.signal import find_peaks as find_maxima
from scipy.sparse import csc_array, diags_array, eye_array
from scipy.sparse.linalg import splu

from ..model.ties import order_by_size
from .inputs import TorqueInput, find_input
from .modes import Mode
from .system import Linear

Vector = NDArray[np.float64]
Complex = NDArray[np.complex128]
QUANTITIES = (
    "mesh_force", "bearing_force_x", "bearing_force_y", "pin_force_x", "pin_force_y", "coupling_torque",
)  # fmt: skip
MOTION = "dynamic_transmission_error"
"""Motion of a mesh along its line of action, the error itself left out [m]."""
BESIDE = np.array([-8.0, -4.0, -2.0, -1.0, -0.5, -0.25, 0.0, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0])
"""Frequencies around a resonance, in half-power half-widths."""

PROMINENT = 0.1
"""Least prominence of a peak, over its height."""

UNDAMPED = 1e-5
"""Damping ratio assumed at least for the grid around a resonance, which is unbounded without damping."""


@dataclass(frozen=True)
class Response:
    """A frequency response.

    Attributes
    ----------
    excited
        The mesh or load.
    unit
        Of what excites: ``m`` or ``N*m``.
    frequency
        [Hz], shape (m,).
    outputs
        (quantity, item, unit) of each column.
    values
        Complex amplitudes over a unit of what excites, the real part in phase with it; shape (m, outputs).
    push, rows
        What a unit force of it does to the kept states, and how each output follows them.
    """

    excited: str
    unit: str
    frequency: Vector
    outputs: list[tuple[str, str, str]]
    values: Complex
    push: Vector
    rows: Vector

    def of(self, quantity: str, item: str) -> Complex:
        """Return the response of one output; KeyError where it is not among them."""
        for column, (known, name, _) in enumerate(self.outputs):
            if (known, name) == (quantity, item):
                return self.values[:, column]
        raise KeyError(f"{quantity} of {item}")


def respond(linear: Linear, excited: str, frequency: Vector) -> Response:
    """Compute the response of all forces to a transmission error of a mesh [m] or a load's torque [N m].

    Parameters
    ----------
    linear
        The linear system.
    excited
        Name of the mesh or load.
    frequency
        [Hz], shape (m,), each above 0.

    Raises
    ------
    LtcgearError
        If nothing of that name excites.
    """
    source = find_input(linear, excited)
    outputs, rows = _rows(linear)
    omega = 2 * np.pi * np.asarray(frequency, dtype=np.float64)
    if isinstance(source, TorqueInput):
        values = propagate(linear, source.push, omega) @ rows.T
        return Response(excited, "N*m", omega / (2 * np.pi), outputs, values, source.push, rows)
    gain = np.array([source.of_error(w) for w in omega])
    values = gain[:, None] * (propagate(linear, source.push, omega) @ rows.T)
    values[:, outputs.index(("mesh_force", excited, "N"))] += gain
    return Response(excited, "m", omega / (2 * np.pi), outputs, values, source.push, rows)


def propagate(linear: Linear, push: Vector | Complex, omega: Vector) -> Complex:
    """Return (i omega - A)^-1 push at angular frequencies [rad/s], shape (m, n)."""
    size = linear.scale[linear.kept]
    matrix = csc_array(diags_array(1 / size) @ linear.matrix @ diags_array(size))
    unit = eye_array(len(size), format="csc")
    scaled = np.asarray(push / size, dtype=np.complex128)
    return np.array([splu(csc_array(1j * w * unit - matrix)).solve(scaled) * size for w in omega])


def _rows(linear: Linear) -> tuple[list[tuple[str, str, str]], Vector]:
    """Return the outputs, and how each follows the kept states."""
    outputs, rows = [], []
    units = {(r.quantity, r.item): r.unit for r in linear.library.manifest.reports}
    for quantity in (*QUANTITIES, "mesh_deflection"):
        for item, row in linear.outputs(quantity).items():
            outputs.append((MOTION if quantity == "mesh_deflection" else quantity, item, units[quantity, item]))
            rows.append(row)
    return outputs, np.array(rows)


def choose_frequencies(modes: Sequence[Mode], low: float | None = None, high: float | None = None) -> Vector:
    """Choose frequencies [Hz] that show every resonance: evenly by logarithm, and closely about every mode.

    Parameters
    ----------
    modes
        The modes.
    low, high
        Ends [Hz]; a third of the lowest and three times the highest oscillation where left out.

    Raises
    ------
    LtcgearError
        If the ends are no range of frequencies above zero.
    """
    ringing = [(abs(m.eigenvalue.imag) / (2 * np.pi), abs(m.eigenvalue.real) / (2 * np.pi)) for m in modes]
    ringing = [(f, half) for f, half in ringing if f > 0]
    if low is None:
        low = min((f for f, _ in ringing), default=3.0) / 3
    if high is None:
        high = 3 * max((f for f, _ in ringing), default=1.0)
    if not (np.isfinite([low, high]).all() and 0 < low < high):
        raise LtcgearError(
            f"--from {low:g} --to {high:g}: frequencies in Hz are needed, 0 < from < to; "
            "give both, for example --from 10 --to 1000"
        )
    base = np.geomspace(low, high, 400)
    about = [
        f + half * BESIDE if half > UNDAMPED * f else f * (1 + UNDAMPED * BESIDE[BESIDE != 0]) for f, half in ringing
    ]
    every = np.unique(np.concatenate([base, *about]))
    return np.asarray(every[(every >= low) & (every <= high)])


def find_peaks(response: Response, column: int, modes: Sequence[Mode]) -> list[tuple[int, int]]:
    """Return the peaks of an output's amplitude, highest first: where they are, and which mode gives most of each.

    Modes are told by their places in the list, -1 where none oscillates. What a mode gives is
    y r (l^H b) / (i omega - lambda), with its left and right vectors l and r, and y the output's row.
    """
    size = np.abs(response.values[:, column])
    inner = find_maxima(np.log(np.maximum(size, 1e-300)), prominence=PROMINENT)[0]
    parts = {
        k: (response.rows[column] @ mode.shape) * (mode.left.conj() @ response.push)
        for k, mode in enumerate(modes)
        if mode.eigenvalue.imag
    }
    found = []
    for i in inner[order_by_size(size[inner])]:
        iw = 2j * np.pi * response.frequency[i]
        given = {k: abs(part / (iw - modes[k].eigenvalue)) for k, part in parts.items()}
        found.append((int(i), max(given, key=lambda k: given[k]) if given else -1))
    return found
