"""Descriptions of modes: which members move, and which elements take the strain energy."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ..model.ties import largest_first
from ..model.topology import HOUSING, Topology
from .energies import Energies
from .modes import SHARE, Mode
from .system import Linear

STILL = 1e-9
"""Strain over kinetic energy below which a motion strains nothing."""


def describe_modes(linear: Linear, modes: list[Mode]) -> list[Mode]:
    """Return the modes with their strain energy by element and their names.

    A mode is named after the element, or the equal elements of a stage, that takes most of its strain energy, and
    after what moves most on either side of it when the train is cut there. Planets of a stage count as one, and so
    does a stage that is not itself cut.
    """
    energies, topology = Energies(linear), Topology(linear.library.manifest)
    carried = linear.motions.matrix[:, linear.kept[linear.positions]]
    moved = carried @ np.array([mode.shape[linear.positions] for mode in modes]).T
    kinetic = linear.motions.mass @ np.abs(moved) ** 2 / 2
    return [
        _described(energies, topology, mode, float(energy) * abs(mode.eigenvalue) ** 2)
        for mode, energy in zip(modes, kinetic, strict=True)
    ]


def _described(energies: Energies, topology: Topology, mode: Mode, kinetic: float) -> Mode:
    """Describe one mode of some kinetic energy [J]."""
    strain = {} if mode.kind == "rigid" else energies.of_shape(mode.shape)
    total = sum(strain.values())
    if total <= STILL * kinetic:
        return replace(mode, name=_together(sum_by(mode.members, topology.labels)))
    shares = {element: energy / total for element, energy in strain.items() if energy != 0}
    return replace(mode, strain=shares, name=_named(mode, next(iter(sum_by(shares, topology.groups))), topology))


def _together(moving: Mapping[str, float]) -> str:
    """Name a motion in which nothing is strained."""
    names = [name for name, share in moving.items() if share > SHARE]
    rest = f" and {len(names) - 3} more" if len(names) > 3 else ""
    return f"{', '.join(names[:3])}{rest} as one" if len(names) > 1 else f"{names[0]} free" if names else "free motion"


def _named(mode: Mode, group: str, topology: Topology) -> str:
    """Name a mode by the elements that are strained most and by what moves on their two sides."""
    link, moving = topology.links[group], sum_by(mode.members, topology.labels)
    if mode.kind == "planet":
        return f"{next(iter(moving))} against each other over {link.told}"
    if link.ends[1] == HOUSING:
        # Supports are named after their members.
        return f"{link.ends[0]} on its {'bearing' if link.kind == 'bearing' else 'torsional support'}"
    one, two = (_mover(side, moving, link.stage, topology) for side in _sides(group, topology))
    return f"{one} against {two} over {link.told}"


def _mover(side: list[str], moving: Mapping[str, float], stage: str, topology: Topology) -> str:
    """Return what moves most on one side, a member of the cut stage or another stage as a whole."""
    wholes = {name: topology.whole(name) for name in side}
    shares = {name: moving.get(name, 0.0) for name in side}
    return next(iter(sum_by(shares, {name: name if whole == stage else whole for name, whole in wholes.items()})))


def _sides(cut: str, topology: Topology) -> tuple[list[str], list[str]]:
    """Return the connected members on either side of a group that is cut; its two ends if these stay connected."""
    ends = topology.links[cut].ends
    one, two = (_reached(start, cut, topology) for start in ends)
    return ([ends[0]], [ends[1]]) if set(one) & set(two) else (one, two)


def _reached(start: str, cut: str, topology: Topology) -> list[str]:
    """Return the members connected to one, except through one group and the housing."""
    reached = [start]
    for name in reached:
        for group, link in topology.links.items():
            if group != cut and name in link.ends and HOUSING not in link.ends:
                reached += [end for end in link.ends if end not in reached]
    return reached


def sum_by(shares: Mapping[str, float], names: Mapping[str, str]) -> dict[str, float]:
    """Add up shares that get the same name, largest first."""
    found: dict[str, float] = {}
    for key, share in shares.items():
        found[names[key]] = found.get(names[key], 0.0) + share
    return largest_first(found)
