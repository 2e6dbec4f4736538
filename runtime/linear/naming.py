"""Descriptions of modes: which members move, and which elements take the strain energy."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from ..model.ties import largest_first
from ..model.topology import HOUSING, label, list_ends, whole
from .energies import Energies, family
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
    energies, ends = Energies(linear), list_ends(linear.library)
    carried = linear.motions.matrix[:, linear.kept[linear.positions]]
    moved = carried @ np.array([mode.shape[linear.positions] for mode in modes]).T
    kinetic = linear.motions.mass @ np.abs(moved) ** 2 / 2
    return [
        _described(energies, ends, mode, float(energy) * abs(mode.eigenvalue) ** 2)
        for mode, energy in zip(modes, kinetic, strict=True)
    ]


def _described(energies: Energies, ends: Mapping[str, list[str]], mode: Mode, kinetic: float) -> Mode:
    """Describe one mode of some kinetic energy [J]."""
    strain = {} if mode.kind == "rigid" else energies.of_shape(mode.shape)
    total = sum(strain.values())
    if total <= STILL * kinetic:
        return replace(mode, name=_together(mode.members))
    shares = {element: energy / total for element, energy in strain.items() if energy != 0}
    return replace(mode, strain=shares, name=_named(mode, sum_by(shares, family), ends))


def _together(members: Mapping[str, float]) -> str:
    """Name a motion in which nothing is strained."""
    names = [name for name, share in sum_by(members, label).items() if share > SHARE]
    rest = f" and {len(names) - 3} more" if len(names) > 3 else ""
    return f"{', '.join(names[:3])}{rest} as one" if len(names) > 1 else f"{names[0]} free" if names else "free motion"


def _named(mode: Mode, strain: Mapping[str, float], ends: Mapping[str, list[str]]) -> str:
    """Name a mode by the elements that are strained most and by what moves on their two sides."""
    element = next(iter(strain))
    over, here = element.removeprefix("couplings."), ends[element]
    if mode.kind == "planet":
        planets = next(iter(sum_by(mode.members, label)))
        return f"{planets} against each other over {over}"
    if here[1] == HOUSING:
        # Supports are named after their members.
        support = "bearing" if element.endswith(".bearing") else "torsional support"
        return f"{here[0]} on its {support}"
    moving = sum_by(mode.members, label)
    one, two = (_mover(side, moving, element.split(".")[0]) for side in _sides(element, ends))
    return f"{one} against {two} over {over}"


def _mover(side: list[str], moving: Mapping[str, float], stage: str) -> str:
    """Return what moves most on one side, a member of the cut stage or another stage as a whole."""
    shares = {name: moving.get(name, 0.0) for name in side}
    return next(iter(sum_by(shares, lambda name: name if name.startswith((f"{stage}.", f"{stage} ")) else whole(name))))


def _sides(element: str, ends: Mapping[str, list[str]]) -> tuple[list[str], list[str]]:
    """Return what hangs together on either side once an element is cut; its two ends where they still do."""
    one, two = (_reached(start, element, ends) for start in ends[element])
    return ([ends[element][0]], [ends[element][1]]) if set(one) & set(two) else (one, two)


def _reached(start: str, cut: str, ends: Mapping[str, list[str]]) -> list[str]:
    """Return what hangs together with a member, but for one element and the housing."""
    reached = [start]
    for name in reached:
        for element, (one, two) in ends.items():
            if element != cut and name in (one, two) and HOUSING not in (one, two):
                reached += [end for end in (one, two) if end not in reached]
    return reached


def sum_by(shares: Mapping[str, float], name: Callable[[str], str]) -> dict[str, float]:
    """Add up shares that get the same name, largest first."""
    found: dict[str, float] = {}
    for key, share in shares.items():
        joint = name(key)
        found[joint] = found.get(joint, 0.0) + share
    return largest_first(found)
