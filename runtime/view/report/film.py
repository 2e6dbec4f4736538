"""Animation frames of the report."""

from __future__ import annotations

from base64 import b64encode
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...analysis.orbits import find_shift, list_members
from .panels import nice

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from .panels import Panel

    Vector = NDArray[np.float64]

MOST = 1500
"""Largest number of frames in a window."""
FEWEST = 100
BYTES = 1_200_000
"""About what the frames of both windows may take in the page."""
SHOWN = 0.07
"""How far the largest deflection is drawn, over the reach of its stage."""
STEPS = 32767


@dataclass(frozen=True)
class Window:
    """Samples that are frames: every ``stride``-th from ``first``, ``count`` in all; ``label`` tells which."""

    name: str
    label: str
    first: int
    stride: int
    count: int

    @property
    def samples(self) -> slice:
        """Return which samples these are."""
        return slice(self.first, self.first + self.stride * (self.count - 1) + 1, self.stride)


@dataclass(frozen=True)
class Track:
    """What moves, over all samples, shapes (n,) and (n, items).

    Attributes
    ----------
    time, phi
        Time [s] and reference angle [rad].
    rotors, ratio, twist
        Names, speed over reference speed, and angle against the rigid motion [rad].
    bodies, dx, dy
        Names of members that shift, and shifts against their place, in axes that turn with the stage's carrier [m].
    meshes, force, touching
        Names, forces [N], and whether flanks touch.
    """

    time: Vector
    phi: Vector
    rotors: list[str]
    ratio: Vector
    twist: Vector
    bodies: list[str]
    dx: Vector
    dy: Vector
    meshes: list[str]
    force: Vector
    touching: NDArray[np.bool_]

    def angle(self, rotor: str, sample: int) -> float:
        """Return the angle of a member [rad]; 0 where it cannot turn."""
        if rotor not in self.rotors:
            return 0.0
        k = self.rotors.index(rotor)
        return float(self.ratio[k] * self.phi[sample] + self.twist[sample, k])

    def shift(self, body: str, sample: int) -> tuple[float, float]:
        """Return how far a member is from its place [m]; 0 where it cannot shift."""
        if body not in self.bodies:
            return 0.0, 0.0
        k = self.bodies.index(body)
        return float(self.dx[sample, k]), float(self.dy[sample, k])


def make_track(dataset: xr.Dataset) -> Track:
    """Read the motion of all members and the mesh forces from a result."""
    time = dataset["time"].values
    none = np.zeros((len(time), 0))
    rotors = [str(name) for name in dataset["rotor"].values] if "twist" in dataset else []
    twist = dataset["twist"].transpose("time", "rotor").values if rotors else none
    ratio = dataset["speed_ratio"].values if rotors else np.zeros(0)
    bodies, dx, dy = _shifts(dataset)
    meshes = [str(name) for name in dataset["mesh"].values] if "mesh_force" in dataset else []
    force = dataset["mesh_force"].transpose("time", "mesh").values if meshes else none
    touching = dataset["mesh_contact"].values > 0 if "mesh_contact" in dataset else np.ones(force.shape, dtype=bool)
    phi = dataset["reference_angle"].values
    return Track(time, phi, rotors, ratio, twist, bodies, dx, dy, meshes, force, touching)


def _shifts(dataset: xr.Dataset) -> tuple[list[str], Vector, Vector]:
    """Return by member its shift in axes that turn with its carrier."""
    bodies = list_members(dataset)
    still = np.zeros((dataset.sizes["time"], 0))
    shifts = np.column_stack([still, *(find_shift(dataset, body) for body in bodies)])
    return bodies, shifts.real, shifts.imag


def magnify(track: Track, panels: list[Panel]) -> float:
    """Return how much deflections are exaggerated, so that the largest is seen; 1 where nothing shifts."""
    largest = [
        float(np.max(np.hypot(track.dx[:, k], track.dy[:, k]))) / panel.reach
        for panel in panels
        for wheel in panel.wheels
        for k, body in enumerate(track.bodies)
        if body == wheel.body
    ]
    return max(1.0, nice(SHOWN / max(largest))) if largest and max(largest) > 0 else 1.0


def choose_windows(track: Track, at: float | None = None) -> list[Window]:
    """Choose the frames: consecutive samples about an instant, and all the record in strides.

    Parameters
    ----------
    track
        The motion.
    at
        Middle of the close window [s]; by default it is the end of the record.

    Returns
    -------
    list of Window
        One where every sample of the record can be a frame.
    """
    samples = len(track.time)
    width = 8 + 2 * len(track.rotors) + 4 * len(track.bodies) + 5 * len(track.meshes)
    most = int(np.clip(BYTES / 2 / (width * 4 / 3), FEWEST, MOST))
    rate = _rate(track.time)
    stride = -(-(samples - 1) // (most - 1)) if samples > 1 else 1
    whole = Window("whole", _label("whole record", track.time, 0, stride, samples, rate), 0, stride,
                   (samples - 1) // stride + 1)  # fmt: skip
    if stride == 1:
        return [whole]
    first = (
        samples - most if at is None else int(np.clip(np.searchsorted(track.time, at) - most // 2, 0, samples - most))
    )
    return [Window("close", _label("close up", track.time, first, 1, first + most, rate), first, 1, most), whole]


def _label(name: str, time: Vector, first: int, stride: int, stop: int, rate: float) -> str:
    """Say which samples are frames."""
    every = "every sample" if stride == 1 else f"every {stride}th sample"
    return (
        f"{name}: {time[first]:.4g} to {time[stop - 1]:.4g} s, {every} ({rate / stride:.4g} frames a simulated second)"
    )


def _rate(time: Vector) -> float:
    """Return samples a second [Hz]."""
    return float((len(time) - 1) / (time[-1] - time[0])) if len(time) > 1 and time[-1] > time[0] else 1.0


def pack(track: Track, window: Window) -> dict[str, Any]:
    """Return a window as JSON: forces as 32-bit floats, angles and shifts as 16-bit steps of their range.

    Tables are in the order item by item, so that each item's frames follow each other.
    """
    part = window.samples
    return {
        "name": window.name,
        "count": window.count,
        "time": [float(track.time[part][0]), float(track.time[part][-1])],
        "phi": _text(track.phi[part] - track.phi[part][0], np.float64),
        "start": [float(track.ratio[k] * track.phi[part][0]) % (2 * np.pi) for k in range(len(track.rotors))],
        "twist": _steps(track.twist[part]),
        "dx": _steps(track.dx[part]),
        "dy": _steps(track.dy[part]),
        "force": _text(track.force[part].T, np.float32),
        "touching": _text(track.touching[part].T, np.uint8),
    }


def _steps(table: Vector) -> dict[str, Any]:
    """Return columns as 16-bit steps about the middle of their range."""
    if not table.size:
        return {"middle": [], "step": [], "data": ""}
    low, high = table.min(axis=0), table.max(axis=0)
    middle, step = (low + high) / 2, np.maximum((high - low) / 2, 1e-300) / STEPS
    return {
        "middle": middle.tolist(),
        "step": step.tolist(),
        "data": _text(np.rint((table - middle) / step).T, np.int16),
    }


def _text(values: NDArray[Any], kind: type) -> str:
    """Return numbers as base64 of little-endian bytes."""
    return b64encode(np.ascontiguousarray(values, dtype=np.dtype(kind).newbyteorder("<")).tobytes()).decode("ascii")
