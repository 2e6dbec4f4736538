"""Layout of a drawing of the train: members as circles side by side, stage by stage."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from ltcgear.generated.contract import Manifest, RigidBody
from numpy.typing import NDArray

from .library import Library
from .parameter_values import name_values
from .tooth_deflection import count_teeth
from .topology import HOUSING, Topology

Vector = NDArray[np.float64]

GAP = 0.35
"""Space between stages, over the largest radius."""


@dataclass(frozen=True)
class Circle:
    """A member as a circle.

    Attributes
    ----------
    body
        Its name.
    x, y, radius
        Position in the drawing and radius [m].
    part
        ``sun``, ``planet``, ``ring``, ``carrier``, ``input``, ``output`` or ``rotor``.
    unit
        Radius of the largest circle of its stage [m].
    stage
        Its stage, or the name of a rotor.
    """

    body: str
    x: float
    y: float
    radius: float
    part: str
    unit: float
    stage: str = ""


@dataclass(frozen=True)
class GearPair:
    """A mesh between two members.

    Attributes
    ----------
    name, stage, one, two
        The mesh, its stage, and the bodies of gear 1 and gear 2.
    sense
        1 external, -1 internal.
    back
        Whether it is the mesh of the unloaded flanks.
    flank
        The side on which its teeth push, 1 or -1.
    radii, teeth
        Base radii [m] and numbers of teeth of both gears; 0 teeth where they are not known.
    """

    name: str
    stage: str
    one: str
    two: str
    sense: int
    back: bool
    flank: float
    radii: tuple[float, float]
    teeth: tuple[int, int]


@dataclass(frozen=True)
class Sheet:
    """All members side by side, stage by stage.

    Attributes
    ----------
    discs
        The members, those behind first.
    titles
        Names of stages and rotors with the positions [m] of their centres.
    width, height
        Size [m]; the middle of the left edge is the origin.
    meshes
        How the members mesh.
    """

    discs: tuple[Circle, ...]
    titles: tuple[tuple[str, float], ...]
    width: float
    height: float
    meshes: tuple[GearPair, ...]


Numbers = dict[str, float]


def lay_out(library: Library, p: Vector) -> Sheet:
    """Place the members: pitch circles, carriers as circles through their pins; rotors have no size of their own.

    Parameters
    ----------
    library, p
        Model and its parameters, shape (n_p,).
    """
    manifest = library.manifest
    number = name_values(manifest, p)
    stages = {name: _circles([b for b in manifest.bodies if b.stage == name], number) for name in _order(manifest)}
    largest = max((_reach(discs) for discs in stages.values() if discs), default=1.0)
    placed: list[Circle] = []
    titles, left = [], 0.0
    for name, found in stages.items():
        discs = found or [Circle(name, 0.0, 0.0, largest / 3, "rotor", 0.0)]
        low = min(disc.x - disc.radius for disc in discs)
        high = max(disc.x + disc.radius for disc in discs)
        placed += [replace(disc, x=left + disc.x - low, unit=_reach(discs), stage=name) for disc in discs]
        titles.append((name, left + (high - low) / 2))
        left += high - low + GAP * largest
    behind = {"ring": 0, "carrier": 1}
    discs = sorted(placed, key=lambda disc: behind.get(disc.part, 2))
    return Sheet(tuple(discs), tuple(titles), left - GAP * largest, 2 * largest, tuple(_pairs(manifest, number)))


def _pairs(manifest: Manifest, number: Numbers) -> Iterator[GearPair]:
    """Yield the meshes."""
    stages = {body.name: body.stage for body in manifest.bodies}
    for mesh in manifest.connections:
        if mesh.kind == "mesh":
            one, two = mesh.bodies
            radii = number[mesh.radii[0]], number[mesh.radii[1]]
            yield GearPair(
                mesh.name, stages[one], one, two, mesh.sense, mesh.back, number[mesh.flank], radii,
                count_teeth(mesh, number),
            )  # fmt: skip


def _order(manifest: Manifest) -> list[str]:
    """Return stages and rotors in the order in which shafts join them, from an end."""
    topology = Topology(manifest)
    ends = [link.ends for link in topology.links.values() if HOUSING not in link.ends]
    joined = [[topology.whole(name) for name in pair] for pair in ends]
    moving = [topology.whole(topology.labels[state.body]) for state in manifest.states if state.body]
    names = dict.fromkeys([*(end for pair in joined for end in pair), *moving])
    near = {name: {end for ends in joined if name in ends for end in ends} - {name} for name in names}
    order: list[str] = []
    for start in sorted(names, key=lambda name: len(near[name])):
        order += [start] if start not in order else []
        for name in order:
            order += [end for end in names if end in near[name] and end not in order]
    return order


def _reach(discs: list[Circle]) -> float:
    """Return how far circles reach from the middle, up and down."""
    return max(abs(disc.y) + disc.radius for disc in discs)


def _circles(stage: list[RigidBody], number: Numbers) -> list[Circle]:
    """Return the circles of a stage about its own middle; none of a rotor."""
    planets = [body for body in stage if body.part == "planet"]
    member = {body.part: body for body in stage}
    if planets:
        return _planetary(member, planets, number)
    return _pair(member["input"], member["output"], number) if stage else []


def _pair(driver: RigidBody, driven: RigidBody, number: Numbers) -> list[Circle]:
    """Return the circles of two parallel gears."""
    one, two = number[driver.base_radius], number[driven.base_radius]
    x, y = _place(driven, number, (one + two, 0.0))
    grown = np.hypot(x, y) / (one + two)
    return [
        Circle(driver.name, 0.0, 0.0, one * grown, driver.part, 0.0),
        Circle(driven.name, x, y, two * grown, driven.part, 0.0),
    ]


def _planetary(member: dict[str, RigidBody], planets: list[RigidBody], number: Numbers) -> list[Circle]:
    """Return the circles of a planetary stage."""
    sun, planet, ring = (number[member[part].base_radius] for part in ("sun", "planet", "ring"))
    angles = 2 * np.pi * np.arange(len(planets)) / len(planets)
    nominal = [(float((sun + planet) * np.cos(a)), float((sun + planet) * np.sin(a))) for a in angles]
    places = [_place(body, number, place) for body, place in zip(planets, nominal, strict=True)]
    distance = float(np.hypot(*places[0]))
    size, grown = distance / (sun + planet), distance / (ring - planet)
    middle = {"ring": ring * grown, "carrier": distance, "sun": sun * size}
    return [
        *(Circle(member[part].name, 0.0, 0.0, radius, part, 0.0) for part, radius in middle.items()),
        *(Circle(body.name, *at, planet * size, "planet", 0.0) for body, at in zip(planets, places, strict=True)),
    ]


def _place(body: RigidBody, number: Numbers, nominal: tuple[float, float]) -> tuple[float, float]:
    """Return a body's position; its nominal one without lateral motion."""
    return (number[body.place[0]], number[body.place[1]]) if body.place else nominal
