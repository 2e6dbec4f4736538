"""Mode shapes as they are drawn: members at their places, and how far each shifts and turns."""

from dataclasses import dataclass, replace

import numpy as np
from ltcgear.generated.contract import Manifest

from .modes import Mode
from .naming import HOUSING, list_ends, whole
from .system import Linear

SHIFT, TURN = 0.18, 0.7
"""Largest displacement drawn, over the radius of the largest circle of its stage, and largest turn drawn [rad]."""
GAP = 0.35
"""Space between stages, over the largest radius."""


@dataclass(frozen=True)
class Disc:
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

    discs: tuple[Disc, ...]
    titles: tuple[tuple[str, float], ...]
    width: float
    height: float


Numbers = dict[str, float]


def lay_out(linear: Linear) -> Sheet:
    """Place the members: pitch circles, carriers as circles through their pins; rotors have no size of their own."""
    number: Numbers = dict(zip((name for name, _ in linear.library.manifest.parameters), linear.p, strict=True))
    stages = {name: _discs(name, linear.library.manifest, number) for name in _order(linear)}
    largest = max((_reach(discs) for discs in stages.values() if discs), default=1.0)
    placed: list[Disc] = []
    titles, left = [], 0.0
    for name, found in stages.items():
        discs = found or [Disc(name, 0.0, 0.0, largest / 3, "rotor", 0.0)]
        low = min(disc.x - disc.radius for disc in discs)
        high = max(disc.x + disc.radius for disc in discs)
        placed += [replace(disc, x=left + disc.x - low, unit=_reach(discs)) for disc in discs]
        titles.append((name, left + (high - low) / 2))
        left += high - low + GAP * largest
    behind = {"ring": 0, "carrier": 1}
    discs = sorted(placed, key=lambda disc: behind.get(disc.part, 2))
    return Sheet(tuple(discs), tuple(titles), left - GAP * largest, 2 * largest)


def _order(linear: Linear) -> list[str]:
    """Return stages and rotors in the order in which shafts join them, from an end."""
    joined = [[whole(name) for name in ends] for ends in list_ends(linear).values() if HOUSING not in ends]
    bodies = [state.body for state in linear.library.manifest.states if state.body]
    names = dict.fromkeys(whole(name) for name in [*(end for ends in joined for end in ends), *bodies])
    near = {name: {end for ends in joined if name in ends for end in ends} - {name} for name in names}
    order: list[str] = []
    for start in sorted(names, key=lambda name: len(near[name])):
        order += [start] if start not in order else []
        for name in order:
            order += [end for end in names if end in near[name] and end not in order]
    return order


def _reach(discs: list[Disc]) -> float:
    """Return how far circles reach from the middle, up and down."""
    return max(abs(disc.y) + disc.radius for disc in discs)


def _discs(stage: str, manifest: Manifest, number: Numbers) -> list[Disc]:
    """Return the circles of a stage about its own middle; none of a rotor."""
    if f"{stage}.mesh.base_radius_1" in number:
        one, two = (number[f"{stage}.mesh.base_radius_{k}"] for k in (1, 2))
        x, y = _place(f"{stage}.output", number, (one + two, 0.0))
        grown = np.hypot(x, y) / (one + two)
        return [
            Disc(f"{stage}.input", 0.0, 0.0, one * grown, "input", 0.0),
            Disc(f"{stage}.output", x, y, two * grown, "output", 0.0),
        ]
    meshes = [report.item for report in manifest.reports if report.quantity == "mesh_force"]
    return _planetary(stage, len({item.split(".")[2] for item in meshes if item.startswith(f"{stage}.")}), number)


def _planetary(stage: str, planets: int, number: Numbers) -> list[Disc]:
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
        *(Disc(f"{stage}.{part}", 0.0, 0.0, radius, part, 0.0) for part, radius in middle.items()),
        *(Disc(f"{stage}.planet.{k}", *at, planet * size, "planet", 0.0) for k, at in enumerate(places, start=1)),
    ]


def _place(body: str, number: Numbers, nominal: tuple[float, float]) -> tuple[float, float]:
    """Return where a body stands; its nominal place where nothing moves sideways."""
    return number.get(f"{body}.x_0", nominal[0]), number.get(f"{body}.y_0", nominal[1])


@dataclass(frozen=True)
class Motion:
    """How a disc moves in a mode, exaggerated: shift [m] along x and y, and turn [rad], complex amplitudes."""

    x: complex
    y: complex
    turn: complex


def exaggerate(linear: Linear, sheet: Sheet, mode: Mode) -> dict[str, Motion]:
    """Return the motions of all discs in a mode, so large that they are seen, by body.

    All have one factor, so that shifts and turns compare; where turns would be more than ``TURN`` by it, turns
    have a smaller factor of their own. The phase is that at which the shape is most real.
    """
    moved = linear.motions.matrix[:, linear.kept] @ mode.shape
    moved = moved * np.exp(-0.5j * np.angle(np.sum(moved**2)))
    motion = {(state.body, state.axis): value for state, value in zip(linear.motions.states, moved, strict=True)}
    rows = {
        disc.body: [motion.get((disc.body, axis), 0j) for axis in "xy"]
        + [motion.get((disc.body, "u"), motion.get((disc.body, "theta"), 0j))]
        for disc in sheet.discs
    }
    shift = max(
        max(abs(rows[d.body][0]), abs(rows[d.body][1]), abs(rows[d.body][2]) * d.radius) / d.unit for d in sheet.discs
    )
    turn = max(abs(row[2]) for row in rows.values())
    factor = SHIFT / max(shift, 1e-300)
    turned = min(factor, TURN / max(turn, 1e-300))
    return {body: Motion(factor * x, factor * y, turned * u) for body, (x, y, u) in rows.items()}
