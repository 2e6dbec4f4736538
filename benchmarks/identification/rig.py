"""The rig's identification: targets of Table 9, unknowns and choices of the print, as plain data to be read."""

import tomllib
from dataclasses import dataclass
from functools import cache
from itertools import product
from math import hypot
from pathlib import Path
from typing import Any

from ltcgear.runtime.studies.wu2021 import comparison
from ltcgear.runtime.studies.wu2021.comparison import published

from benchmarks.identification.forecast import LOAD_FACTOR, Target
from benchmarks.identification.unknowns import Unknown, read_unknowns

ROUNDING = 0.005
"""Half of the last digit in which Table 9 prints forces [1e5 N]."""
VAGUE = 0.10
"""Share of a load factor's part above 1 by which it depends on what is not told: the window, and how steady it was."""
LABELS = {"lsp.sun_planet": "lsp.sun_planet.1", "lsp.ring_planet": "lsp.ring_planet.1",
          "hsp.sun_planet": "hsp.sun_planet.1", "hsp.ring_planet": "hsp.ring_planet.1"}  # fmt: skip
"""The mesh that stands for a group: over many turns all planets see the same."""


@dataclass(frozen=True)
class Choice:
    """A reading of the print of which there are several.

    Attributes
    ----------
    name, key
        What it is, and the scene key that says it.
    values
        The readings, the assumed one first.
    """

    name: str
    key: str
    values: tuple[str, ...]


@cache
def _file() -> dict[str, Any]:
    source = Path(comparison.__file__).with_name("published") / "unknowns.toml"
    return tomllib.loads(source.read_text(encoding="utf-8"))


def rig_unknowns() -> list[Unknown]:
    """Return the numbers that are not printed."""
    return read_unknowns(_file()["unknowns"])


def rig_choices() -> list[Choice]:
    """Return the readings that the print leaves open."""
    return [Choice(item["name"], item["key"], tuple(item["values"])) for item in _file()["choices"]]


def combinations() -> list[dict[str, str]]:
    """Return all combinations of readings as changes of the scene, the assumed one first."""
    choices = rig_choices()
    return [
        dict(zip((choice.key for choice in choices), values, strict=True))
        for values in product(*(choice.values for choice in choices))
    ]


def rig_targets() -> list[Target]:
    """Return Table 9's load factors with their standard deviations.

    The printed factor is 1 + amplitude over mean, of numbers rounded to 0.01; neither the window nor the way in which
    the run began is told, which counts for a tenth of what lies above 1.
    """
    found = []
    for row in published()["table9"]["rows"]:
        rounded = hypot(ROUNDING, (row["load_factor"] - 1) * ROUNDING) / row["mean"]
        sigma = hypot(rounded, VAGUE * (row["load_factor"] - 1))
        output = f"mesh_force:{LABELS.get(row['meshes'], row['meshes'])}"
        found.append(Target(row["position"], output, LOAD_FACTOR, row["load_factor"], sigma))
    return found
