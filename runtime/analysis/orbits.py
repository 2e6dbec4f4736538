"""Orbits: where members go sideways."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from ltcgear.generated.errors import LtcgearError

from ..statistics import stage_of
from .trace import FloatArray, list_items, pick, read_trace
from .transmission import parameter

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Orbit:
    """The path of a member's centre, in its stage's frame, which turns with the carrier.

    Attributes
    ----------
    member
        Its name.
    x, y
        Displacement from the nominal place [m], shape (n,) each.
    centre
        Mean of x and y [m].
    static
        Place in the loaded equilibrium, with which a run begins [m]; None where the record does not begin there.
    clearance
        Radial clearance of its bearing [m]; None where it has none.
    floating
        Whether nothing but teeth holds it.
    """

    member: str
    x: FloatArray
    y: FloatArray
    centre: tuple[float, float]
    static: tuple[float, float] | None
    clearance: float | None
    floating: bool

    @property
    def rms(self) -> float:
        """Return the root mean square distance from the orbit's centre [m]."""
        return float(np.sqrt(((self.x - self.centre[0]) ** 2 + (self.y - self.centre[1]) ** 2).mean()))

    @property
    def largest(self) -> float:
        """Return the largest distance from the orbit's centre [m]."""
        return float(np.hypot(self.x - self.centre[0], self.y - self.centre[1]).max())


def list_members(dataset: xr.Dataset) -> list[str]:
    """List the members that move sideways."""
    return list_items(dataset, "displacement_x")


def find_orbit(dataset: xr.Dataset, member: str, record: xr.Dataset | None = None) -> Orbit:
    """Return the path of a member.

    Parameters
    ----------
    dataset
        Result, or a span of it.
    member
        Such as ``lsp.sun``.
    record
        The whole record that a span was cut from; its first sample is the static position.

    Raises
    ------
    LtcgearError
        If the member does not move sideways.
    """
    members = list_members(dataset)
    if member not in members:
        raise LtcgearError(f"{member}: no member that moves sideways; there are {', '.join(members) or 'none'}")
    quantities = ("displacement_x", "displacement_y")
    x, y = (read_trace(pick(dataset, quantity, member)).values for quantity in quantities)
    whole = dataset if record is None else record
    first_x, first_y = (float(pick(whole, quantity, member).values[0]) for quantity in quantities)
    static = (first_x, first_y) if abs(float(whole["time"].values[0])) < 1e-12 else None
    planet = ".planet." in member
    bearing = f"{stage_of(member)}.pin" if planet else f"{member}.bearing"
    held = planet or member in list_items(dataset, "bearing_force_x")
    return Orbit(member, x, y, (float(x.mean()), float(y.mean())), static, parameter(dataset, f"{bearing}.clearance"),
                 not held)  # fmt: skip
