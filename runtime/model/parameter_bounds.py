"""Bounds of parameters, for Python, plain C and FMUs."""

import math
import sys

from ltcgear.generated.contract import GEOMETRY, PHYSICAL

ANY = sys.float_info.max
"""Bound of parameters that may be any finite number."""
POSITIVE = ("kg", "kg*m^2")
"""Units of parameters that must be positive."""
DIVISORS = (
    ".base_radius_1", ".base_radius_2", ".friction.speed", ".friction_speed", ".friction_load", ".breakdown_slip_speed",
)  # fmt: skip
"""Suffixes of parameters that must be positive, since laws divide by them."""
NOT_NEGATIVE = ("stiffness", "stiffness_single", "stiffness_double", "stiffness_mean", "damping", "friction_damping")
"""Last parts of the names of parameters that must not be negative."""
SHARES = ("single_share",)
"""Last parts of the names of parameters between 0 and 1."""


def bounds_of(name: str, unit: str) -> tuple[float, float]:
    """Return what a parameter may be at least and at most, both included."""
    last = name.rsplit(".", 1)[-1]
    if last in SHARES:
        return sys.float_info.min, math.nextafter(1.0, 0.0)
    if unit in POSITIVE or name.endswith(DIVISORS):
        return sys.float_info.min, ANY
    return 0.0 if last in NOT_NEGATIVE else -ANY, ANY


def is_continuous(role: str) -> bool:
    """Return whether a parameter of a role is continuous, so that a derivative is meaningful."""
    return role in (PHYSICAL, GEOMETRY)
