"""Bounds of parameters, for Python, plain C and FMUs."""

import math
import sys

from ltcgear.generated.contract import GEOMETRY, PHYSICAL

ANY = sys.float_info.max
"""Bound of what may be any finite number."""
POSITIVE = ("kg", "kg*m^2")
"""Units of what must be positive."""
DIVISORS = (
    ".base_radius_1", ".base_radius_2", ".friction.speed", ".friction_speed", ".friction_load", ".breakdown_slip_speed",
)  # fmt: skip
"""Ends of names of what must be positive, since laws divide by it."""
NOT_NEGATIVE = ("stiffness", "stiffness_single", "stiffness_double", "stiffness_mean", "damping", "friction_damping")
"""Last parts of names of what must not be negative."""
SHARES = ("single_share",)
"""Last parts of names of what lies between 0 and 1."""


def bounds_of(name: str, unit: str) -> tuple[float, float]:
    """Return what a parameter may be at least and at most, both included."""
    last = name.rsplit(".", 1)[-1]
    if last in SHARES:
        return sys.float_info.min, math.nextafter(1.0, 0.0)
    if unit in POSITIVE or name.endswith(DIVISORS):
        return sys.float_info.min, ANY
    return 0.0 if last in NOT_NEGATIVE else -ANY, ANY


def is_continuous(role: str) -> bool:
    """Tell whether a parameter of a role can change by a little, so that it has a derivative that means something."""
    return role in (PHYSICAL, GEOMETRY)
