"""Ranking of parameters by their derivatives."""

from dataclasses import dataclass
from math import isnan
from typing import Any

import numpy as np
from ltcgear.generated.contract import CONTINUOUS, PHYSICAL, Manifest
from numpy.typing import NDArray

from ...model.ties import order_by_size

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class ParameterInfluence:
    """What one parameter does to a number.

    Attributes
    ----------
    parameter, value, unit
        Name, value in SI, SI unit.
    kind
        ``size``: something that can be chosen by itself, a stiffness, a mass, a load; or ``geometry``: a radius, which
        is tied to others by the teeth, a place, an angle or a phase.
    derivative
        Change of the number over that of the parameter, SI.
    relative
        Change in percent for one percent of the parameter; None if either is zero.
    beside
        Derivatives of other numbers by name, times the parameter for a size (change for 100 %).
    """

    parameter: str
    value: float
    unit: str
    kind: str
    derivative: float
    relative: float | None
    beside: dict[str, float]

    def to_json(self) -> dict[str, Any]:
        """Return it as plain values."""
        return vars(self) | {"beside": dict(self.beside)}


def list_influences(
    manifest: Manifest, p: Vector, number: float, derivative: Vector, beside: dict[str, Vector] | None = None
) -> list[ParameterInfluence]:
    """List what all parameters do to a number: sizes first, then geometry by its unit, the strongest first.

    Parameters
    ----------
    manifest, p
        The model's parameters and their values.
    number, derivative
        The number, and its derivatives with respect to all parameters, shape (n_p,); NaN for those without one,
        which stand last.
    beside
        Derivatives of other numbers, by name.
    """
    found = []
    for i, (name, unit) in enumerate(manifest.parameters):
        role = manifest.roles[name]
        if role not in CONTINUOUS:
            continue
        value, slope = float(p[i]), float(derivative[i])
        size = role == PHYSICAL and value != 0
        relative = slope * value / number if value and number else None
        others = {key: float(each[i]) * (value if size else 1.0) for key, each in (beside or {}).items()}
        found.append(ParameterInfluence(name, value, unit, "size" if size else "geometry", slope, relative, others))
    return _strongest_first(found)


def _strongest_first(found: list[ParameterInfluence]) -> list[ParameterInfluence]:
    """Return influences by kind and unit, those without derivative last, and the strongest of each first."""
    groups: dict[tuple[bool, bool, str], list[ParameterInfluence]] = {}
    for item in found:
        size = item.kind == "size"
        groups.setdefault((not size, isnan(item.derivative), "" if size else item.unit), []).append(item)
    ordered = []
    for _, group in sorted(groups.items(), key=lambda entry: entry[0]):
        strengths = [abs(item.derivative * (item.value if item.kind == "size" else 1.0)) for item in group]
        ordered += [group[k] for k in order_by_size(strengths, [item.parameter for item in group])]
    return ordered
