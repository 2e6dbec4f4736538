"""Stage drawings of the report: gears at their places, meshes with their lines of action."""

import json
from dataclasses import dataclass, replace
from math import acos, atan2, cos, hypot, isfinite, pi, sin
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray as xr

Pair = dict[str, Any]
"""A mesh of the layout, a ``GearPair`` from JSON."""


@dataclass(frozen=True)
class Wheel:
    """A member in the drawing.

    Attributes
    ----------
    body, part
        Its name and its part, as in the layout.
    x, y, radius
        Place about the middle of its panel, in its stage's frame, and radius of its pitch circle [m].
    teeth
        How many; 0 where they are not known.
    offset
        Angle of a tooth against the wheel's own angle [rad], so that teeth mesh with tooth spaces.
    """

    body: str
    part: str
    x: float
    y: float
    radius: float
    teeth: int = 0
    offset: float = 0.0


@dataclass(frozen=True)
class Contact:
    """A mesh in the drawing.

    Attributes
    ----------
    name, one, two
        The mesh, and the bodies of its gears.
    x, y
        Pitch point, as a wheel's place [m].
    direction
        Angle at which a positive force pushes gear 2, in the stage's frame [rad].
    lever
        What the torque on gear 2 is over the force, signed [m].
    back
        Whether it is the mesh of the unloaded flanks.
    """

    name: str
    one: str
    two: str
    x: float
    y: float
    direction: float
    lever: float
    back: bool


@dataclass(frozen=True)
class Panel:
    """A stage, or a rotor alone.

    Attributes
    ----------
    name
        The stage or the rotor.
    frame
        The member with whose angle its frame turns; "" if that is at rest.
    wheels, contacts
        What is drawn, that behind first.
    """

    name: str
    frame: str
    wheels: tuple[Wheel, ...]
    contacts: tuple[Contact, ...]

    @property
    def reach(self) -> float:
        """Return half of the larger of width and height of its pitch circles [m]."""
        across = [v for wheel in self.wheels for v in (wheel.x - wheel.radius, wheel.x + wheel.radius)]
        up = [v for wheel in self.wheels for v in (wheel.y - wheel.radius, wheel.y + wheel.radius)]
        return max(max(across) - min(across), max(up) - min(up)) / 2


def make_panels(dataset: "xr.Dataset") -> list[Panel]:
    """Lay out the stages of a result.

    Parameters
    ----------
    dataset
        Result with its layout, parameters and angles.

    Returns
    -------
    list of Panel
        In the order of the layout: stages, and the rotors between them.
    """
    sheet = json.loads(dataset.attrs["sheet"])
    alpha, start = _pressure_angles(dataset), start_angles(dataset)
    meshes = sheet["meshes"] if "mesh_force" in dataset else []
    panels = []
    for title, _ in sheet["titles"]:
        wheels = _wheels([disc for disc in sheet["discs"] if disc["stage"] == title])
        if wheels:
            pairs = [mesh for mesh in meshes if mesh["stage"] == title]
            contacts = [_contact(pair, wheels, alpha) for pair in pairs]
            carriers = [wheel.body for wheel in wheels.values() if wheel.part == "carrier" and wheel.body in start]
            frame = carriers[0] if carriers else ""
            wheels = _engage(wheels, pairs, start, start.get(frame, 0.0))
            panels.append(Panel(title, frame, tuple(wheels.values()), tuple(contacts)))
    return panels


def start_angles(dataset: "xr.Dataset") -> dict[str, float]:
    """Return the angles of the rotors at the first sample [rad]."""
    if "rotor" not in dataset.dims:
        return {}
    first = dataset["speed_ratio"] * dataset["reference_angle"][0] + dataset["twist"].isel(time=0)
    return {str(name): float(first.sel(rotor=name)) for name in first["rotor"].values}


def _pressure_angles(dataset: "xr.Dataset") -> dict[str, float]:
    """Return the mean operating pressure angle of each mesh that has one [rad]."""
    if "pressure_angle" not in dataset:
        return {}
    mean = dataset["pressure_angle"].mean("time")
    names = (str(name) for name in mean[mean.dims[0]].values)
    return dict(zip(names, mean.values.tolist(), strict=True))


def _wheels(discs: list[dict[str, Any]]) -> dict[str, Wheel]:
    """Return the wheels of a stage about its own middle, that behind first."""
    if not discs:
        return {}
    middle = next((disc for disc in discs if disc["part"] in ("ring", "sun", "input")), discs[0])
    names = ("body", "part", "radius")
    return {
        disc["body"]: Wheel(
            **{name: disc[name] for name in names}, x=disc["x"] - middle["x"], y=disc["y"] - middle["y"]
        )
        for disc in discs
    }


def _contact(pair: Pair, wheels: dict[str, Wheel], alpha: dict[str, float]) -> Contact:
    r"""Return a mesh; the force on gear 2 is :math:`N(\sigma\sin\alpha\,\mathbf e + s\cos\alpha\,\mathbf t)`."""
    one, two, sigma, flank = wheels[pair["one"]], wheels[pair["two"]], pair["sense"], pair["flank"]
    r1, r2 = pair["radii"]
    c, d = r1 + sigma * r2, hypot(two.x - one.x, two.y - one.y)
    angle = alpha.get(pair["name"], acos(min(1.0, c / d)))
    ex, ey = (two.x - one.x) / d, (two.y - one.y) / d
    along = sigma * sin(angle), flank * cos(angle)
    direction = atan2(along[0] * ey + along[1] * ex, along[0] * ex - along[1] * ey)
    share = r1 / c
    place = one.x + share * d * ex, one.y + share * d * ey
    return Contact(pair["name"], one.body, two.body, *place, direction, -sigma * flank * r2, pair["back"])


def _engage(wheels: dict[str, Wheel], pairs: list[Pair], angle: dict[str, float], turn: float) -> dict[str, Wheel]:
    """Give wheels their teeth, turned so that each mesh starts with a tooth in a gap, in a frame that has turned.

    Outer gears come first: they set the planets' teeth, and one planet the ring's.
    """
    wheels = dict(wheels)
    for pair in sorted((pair for pair in pairs if not pair["back"]), key=lambda pair: -pair["sense"]):
        sigma, counts, (r1, r2) = pair["sense"], pair["teeth"], pair["radii"]
        if not counts[0]:
            continue
        one, two, ratio = wheels[pair["one"]], wheels[pair["two"]], r2 / r1
        gamma = atan2(two.y - one.y, two.x - one.x) + turn
        facing = gamma + (pi if sigma > 0 else 0.0)
        angles = angle.get(one.body, 0.0), angle.get(two.body, 0.0)
        if not two.teeth:
            ahead = angles[0] + one.offset - gamma
            two = replace(two, teeth=counts[1], offset=facing - sigma * ahead / ratio + pi / counts[1] - angles[1])
            one = replace(one, teeth=counts[0])
        elif not one.teeth:
            ahead = angles[1] + two.offset - facing
            one = replace(one, teeth=counts[0], offset=gamma - sigma * ahead * ratio + pi / counts[0] - angles[0])
        wheels |= {one.body: one, two.body: two}
    return wheels


def nice(value: float) -> float:
    """Return the largest of 1, 2, 5 times a power of ten that is not above a value; 1 where it is not positive."""
    if not (value > 0 and isfinite(value)):
        return 1.0
    power = 10.0 ** int(f"{value:e}".split("e")[1])
    return max((step * power for step in (1.0, 2.0, 5.0) if step * power <= value * (1 + 1e-9)), default=power)
