"""Units of FMI: exponents of its base units."""

import re

BASES = ("kg", "m", "s", "rad")
NAMED: dict[str, dict[str, int]] = {
    "N": {"kg": 1, "m": 1, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
    "1": {},
    **{base: {base: 1} for base in BASES},
}
"""What a unit's factors are in base units."""


def exponents(unit: str) -> dict[str, int]:
    """Return base unit -> exponent of a unit such as ``N*m*s/rad``; exponents of zero are left out.

    Raises
    ------
    KeyError
        If a factor is not known.
    """
    found = dict.fromkeys(BASES, 0)
    for sign, factor, power in re.findall(r"(^|[*/])([A-Za-z0-9]+?)(?:\^(-?[0-9]+))?(?=[*/]|$)", unit):
        for base, exponent in NAMED[factor].items():
            found[base] += exponent * int(power or 1) * (-1 if sign == "/" else 1)
    return {base: exponent for base, exponent in found.items() if exponent}
