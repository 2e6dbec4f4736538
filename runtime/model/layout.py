"""Layout of the train: its members as circles side by side, stage by stage."""

from dataclasses import dataclass, replace

import numpy as np
from ltcgear.generated.contract import Manifest
from numpy.typing import NDArray

from .library import Library
from .topology import HOUSING, list_ends, whole

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
        Place on the sheet and radius [m].
    part
        ``sun``, ``planet``, ``ring``, ``carrier``, ``input``, ``output`` or ``rotor``.
    unit
        Radius of the largest circle of its stage [m].
    """

    body: str
    x: float
    y: float
    radius: float
    part: str
    unit: float


@dataclass(frozen=True)
class Sheet:
    """All members side by side, stage by stage.

    Attributes
    ----------
    discs
        The members, those behind first.
    titles
        Names of stages and rotors with the places [m] of their middles.
    width, height
        Size [m]; the middle of the left edge is the origin.
    """

    discs: tuple[Circle, ...]
    titles: tuple[tuple[str, float], ...]
    width: float
    height: float


Numbers = dict[str, float]


def lay_out(library: Library, p: Vector) -> Sheet:
    """Place the members: pitch circles, carriers as circles through their pins; rotors have no size of their own.

    Parameters
    ----------
    library, p
        Model and its parameters, shape (n_p,).
    """
    number: Numbers = dict(zip((name for name, _ in library.manifest.parameters), p, strict=True))
    stages = {name: _discs(name, library.manifest, number) for name in _order(library)}
    largest = max((_reach(discs) for discs in stages.values() if discs), default=1.0)
    placed: list[Circle] = []
    titles, left = [], 0.0
    for name, found in stages.items():
        discs = found or [Circle(name, 0.0, 0.0, largest / 3, "rotor", 0.0)]
        low = min(disc.x - disc.radius for disc in discs)
        high = max(disc.x + disc.radius for disc in discs)
        placed += [replace(disc, x=left + disc.x - low, unit=_reach(discs)) for disc in discs]
        titles.append((name, left + (high - low) / 2))
        left += high - low + GAP * largest
    behind = {"ring": 0, "carrier": 1}
    discs = sorted(placed, key=lambda disc: behind.get(disc.part, 2))
    return Sheet(tuple(discs), tuple(titles), left - GAP * largest, 2 * largest)


def _order(library: Library) -> list[str]:
    """Return stages and rotors in the order in which shafts join them, from an end."""
    joined = [[whole(name) for name in ends] for ends in list_ends(library).values() if HOUSING not in ends]
    bodies = [state.body for state in library.manifest.states if state.body]
    names = dict.fromkeys(whole(name) for name in [*(end for ends in joined for end in ends), *bodies])
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


def _discs(stage: str, manifest: Manifest, number: Numbers) -> list[Circle]:
    """Return the circles of a stage about its own middle; none of a rotor."""
    if f"{stage}.mesh.base_radius_1" in number:
        one, two = (number[f"{stage}.mesh.base_radius_{k}"] for k in (1, 2))
        x, y = _place(f"{stage}.output", number, (one + two, 0.0))
        grown = np.hypot(x, y) / (one + two)
        return [
            Circle(f"{stage}.input", 0.0, 0.0, one * grown, "input", 0.0),
            Circle(f"{stage}.output", x, y, two * grown, "output", 0.0),
        ]
    meshes = [report.item for report in manifest.reports if report.quantity == "mesh_force"]
    return _planetary(stage, len({item.split(".")[2] for item in meshes if item.startswith(f"{stage}.")}), number)


def _planetary(stage: str, planets: int, number: Numbers) -> list[Circle]:
    """Return the circles of a planetary stage; none where there are no planets."""
    if not planets:
        return []
    sun, planet = (number[f"{stage}.sun_planet.base_radius_{k}"] for k in (1, 2))
    ring = number[f"{stage}.ring_planet.base_radius_1"]
    angles = 2 * np.pi * np.arange(planets) / planets
    nominal = [(float((sun + planet) * np.cos(a)), float((sun + planet) * np.sin(a))) for a in angles]
    places = [_place(f"{stage}.planet.{k}", number, place) for k, place in enumerate(nominal, start=1)]
    distance = float(np.hypot(*places[0]))
    size, grown = distance / (sun + planet), distance / (ring - planet)
    middle = {"ring": ring * grown, "carrier": distance, "sun": sun * size}
    return [
        *(Circle(f"{stage}.{part}", 0.0, 0.0, radius, part, 0.0) for part, radius in middle.items()),
        *(Circle(f"{stage}.planet.{k}", *at, planet * size, "planet", 0.0) for k, at in enumerate(places, start=1)),
    ]


def _place(body: str, number: Numbers, nominal: tuple[float, float]) -> tuple[float, float]:
    """Return where a body stands; its nominal place where nothing moves sideways."""
    return number.get(f"{body}.x_0", nominal[0]), number.get(f"{body}.y_0", nominal[1])
