"""Orbits of members: lateral motion, clearance and static position."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from ltcgear.generated.errors import LtcgearError

from ..model.members import CARRIER
from ..results.train_record import read_train
from .trace import FloatArray, list_items, pick, read_trace
from .transmission import parameter

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Orbit:
    """The path of a member's centre, in axes that turn with its stage's carrier, with the carrier's twist.

    Attributes
    ----------
    member
        Its name.
    x, y
        Displacement from the nominal place [m], shape (n,) each.
    centre
        Mean of x and y [m].
    static
        Place in the loaded equilibrium, with which a run begins [m]; None if the record does not begin there.
    clearance
        Radial clearance of its bearing [m]; None if it has none.
    held
        ``bearing``, ``pin`` of a planet, or ``no bearing``: teeth, pins or couplings alone hold it.
    """

    member: str
    x: FloatArray
    y: FloatArray
    centre: tuple[float, float]
    static: tuple[float, float] | None
    clearance: float | None
    held: str

    @property
    def floating(self) -> bool:
        """Say whether it has no bearing."""
        return self.held == "no bearing"

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
    for quantity in ("displacement_x", "displacement_y"):
        read_trace(pick(dataset, quantity, member))
    path = find_shift(dataset, member)
    first = (dataset if record is None else record).isel(time=slice(0, 1))
    begins = abs(float(first["time"].values[0])) < 1e-12
    static = _plane(find_shift(first, member)[0]) if begins else None
    train = read_train(dataset)
    held = parameter(dataset, f"{train.members[member].held}.clearance")
    borne = "bearing" if member in list_items(dataset, "bearing_force_x") else "no bearing"
    return Orbit(
        member, path.real, path.imag, _plane(path.mean()), static, held,
        "pin" if train.is_planet(member) else borne,
    )  # fmt: skip


def _plane(place: complex) -> tuple[float, float]:
    """Return x and y."""
    return float(place.real), float(place.imag)


def find_shift(dataset: xr.Dataset, member: str) -> NDArray[np.complex128]:
    """Return how far a member is from its place on its stage's carrier, x + i y [m], shape (n,).

    Displacements are told in the frame of the rigid motion. The carrier is turned against it by its twist, and with it
    what it carries: a planet's place, and the axes.
    """
    shift = pick(dataset, "displacement_x", member).values + 1j * pick(dataset, "displacement_y", member).values
    train = read_train(dataset)
    carrier = train.part(train.stage(member), CARRIER)
    if carrier not in list_items(dataset, "twist"):
        return np.asarray(shift)
    place = complex(*(parameter(dataset, name) or 0.0 for name in train.members[member].place))
    turned = np.exp(-1j * pick(dataset, "twist", carrier).values)
    return np.asarray((place + shift) * turned - place)
