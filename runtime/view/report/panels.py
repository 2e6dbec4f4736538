"""Stage drawings of the report: gears at their places, meshes with their lines of action."""

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import acos, atan2, cos, hypot, isfinite, pi, sin
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray as xr

BACK = ".back"
"""How the name of a mesh ends that stands for the other flanks."""
ENDS = {"sun_planet": ("sun", 1), "ring_planet": ("ring", -1), "mesh": ("input", 1)}
"""First gear of each kind of mesh, and the sign of its mate's radius: 1 outside, -1 inside."""


@dataclass(frozen=True)
class Wheel:
    """A member as it is drawn.

    Attributes
    ----------
    body, part
        Its name, and what it is, as on the sheet.
    x, y, radius
        Place about the middle of its panel, in its stage's frame, and radius of its pitch circle [m].
    teeth
        How many; 0 where they are not known.
    offset
        Angle of a tooth against the wheel's own angle [rad], so that teeth stand in gaps.
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
    """A mesh as it is drawn.

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
    """

    name: str
    one: str
    two: str
    x: float
    y: float
    direction: float
    lever: float


@dataclass(frozen=True)
class Panel:
    """A stage, or a rotor alone.

    Attributes
    ----------
    name
        The stage or the rotor.
    frame
        The member with whose angle its frame turns; "" where that stands still.
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


class Numbers(dict[str, float]):
    """Parameters of a model by name."""

    @classmethod
    def of(cls, dataset: "xr.Dataset") -> "Numbers":
        """Take the parameters from a result."""
        values = dataset["parameter_value"]
        return cls(zip((str(name) for name in values["parameter"].values), values.values.tolist(), strict=True))


def make_panels(dataset: "xr.Dataset") -> list[Panel]:
    """Lay out the stages of a result.

    Parameters
    ----------
    dataset
        Result with its sheet, parameters and angles.

    Returns
    -------
    list of Panel
        In the order of the sheet: stages, and the rotors between them.
    """
    sheet = json.loads(dataset.attrs["sheet"])
    number, alpha = Numbers.of(dataset), _pressure_angles(dataset)
    meshes = [str(name) for name in dataset["mesh"].values] if "mesh_force" in dataset else []
    rotors = {str(name) for name in dataset["rotor"].values} if "rotor" in dataset.dims else set()
    panels = []
    for title, _ in sheet["titles"]:
        wheels = _wheels(title, sheet["discs"])
        if not wheels:
            continue
        contacts = [_contact(name, wheels, number, alpha) for name in meshes if name.split(".")[0] == title]
        frame = f"{title}.carrier"
        panel = Panel(title, frame if frame in rotors else "", tuple(wheels.values()), tuple(contacts))
        panels.append(_engage(panel, number, start_angles(dataset)))
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


def _wheels(title: str, discs: list[dict[str, Any]]) -> dict[str, Wheel]:
    """Return the wheels of a stage about its own middle, that behind first."""
    found = [disc for disc in discs if disc["body"].split(".")[0] == title]
    if not found:
        return {}
    middle = next((disc for disc in found if disc["part"] in ("ring", "sun", "input")), found[0])
    names = ("body", "part", "radius")
    return {
        disc["body"]: Wheel(
            **{name: disc[name] for name in names}, x=disc["x"] - middle["x"], y=disc["y"] - middle["y"]
        )
        for disc in found
    }


def _contact(name: str, wheels: dict[str, Wheel], number: Numbers, alpha: dict[str, float]) -> Contact:
    r"""Return a mesh; the force on gear 2 is :math:`N(\sigma\sin\alpha\,\mathbf e + s\cos\alpha\,\mathbf t)`."""
    front = name.removesuffix(BACK)
    stage, kind, *planet = front.split(".")
    first, sigma = ENDS[kind]
    one = wheels[f"{stage}.{first}"]
    two = wheels[f"{stage}.planet.{planet[0]}" if planet else f"{stage}.output"]
    r1, r2 = (number[f"{stage}.{kind}.base_radius_{k}"] for k in (1, 2))
    flank = number[f"{stage}.{kind}.flank"] * (-1 if name != front else 1)
    c, d = r1 + sigma * r2, hypot(two.x - one.x, two.y - one.y)
    angle = alpha.get(front, acos(min(1.0, c / d)))
    ex, ey = (two.x - one.x) / d, (two.y - one.y) / d
    along = sigma * sin(angle), flank * cos(angle)
    direction = atan2(along[0] * ey + along[1] * ex, along[0] * ex - along[1] * ey)
    share = r1 / c
    place = one.x + share * d * ex, one.y + share * d * ey
    return Contact(name, one.body, two.body, *place, direction, -sigma * flank * r2)


def _engage(panel: Panel, number: Numbers, angle: dict[str, float]) -> Panel:
    """Count teeth and turn them so that each mesh starts with a tooth in a gap."""
    wheels = {wheel.body: wheel for wheel in panel.wheels}
    turn = angle.get(panel.frame, 0.0)
    for mesh in _in_order(panel):
        stage, kind = mesh.name.split(".")[:2]
        teeth = abs(number.get(f"{stage}.{kind}.teeth_1", 0.0))
        if not teeth:
            continue
        sigma = ENDS[kind][1]
        one, two = wheels[mesh.one], wheels[mesh.two]
        ratio = number[f"{stage}.{kind}.base_radius_2"] / number[f"{stage}.{kind}.base_radius_1"]
        counts = round(teeth), round(teeth * ratio)
        gamma = atan2(two.y - one.y, two.x - one.x) + turn
        facing = gamma + (pi if sigma > 0 else 0.0)
        angles = angle.get(mesh.one, 0.0), angle.get(mesh.two, 0.0)
        if not two.teeth:
            ahead = angles[0] + one.offset - gamma
            two = replace(two, teeth=counts[1], offset=facing - sigma * ahead / ratio + pi / counts[1] - angles[1])
            one = replace(one, teeth=counts[0])
        elif not one.teeth:
            ahead = angles[1] + two.offset - facing
            one = replace(one, teeth=counts[0], offset=gamma - sigma * ahead * ratio + pi / counts[0] - angles[0])
        wheels |= {one.body: one, two.body: two}
    return replace(panel, wheels=tuple(wheels.values()))


def _in_order(panel: Panel) -> Iterator[Contact]:
    """Yield the meshes, those of suns and inputs first: they set the planets' teeth, and one planet the ring's."""
    front = [contact for contact in panel.contacts if not contact.name.endswith(BACK)]
    yield from sorted(front, key=lambda contact: ".ring_planet." in contact.name)


def nice(value: float) -> float:
    """Return the largest of 1, 2, 5 times a power of ten that is not above a value; 1 where it is not positive."""
    if not (value > 0 and isfinite(value)):
        return 1.0
    power = 10.0 ** int(f"{value:e}".split("e")[1])
    return max((step * power for step in (1.0, 2.0, 5.0) if step * power <= value * (1 + 1e-9)), default=power)
