"""Units: quantities as text such as "16 mm" or "5.02e9 N/m"; a number without its unit is refused.

The short registry is our own: angle is a dimension, so that Hz is not rad/s and N m is not N m/rad, and it contains
nothing but units.
"""

import re
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING, cast

if TYPE_CHECKING:
    import pint

NUMBER = re.compile(r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?)\s*(.*?)\s*", re.DOTALL)
_POWER = r"[A-Za-zµ°%]+(?:\s*(?:\^|\*\*)\s*-?[0-9])?"
UNIT = re.compile(rf"(?:1\s*/\s*)?{_POWER}(?:\s*[*/·]\s*{_POWER})*")
# Beyond these no gearbox lies, and products of a few quantities stay finite.
SMALLEST, LARGEST = 1e-30, 1e30
DEFINITIONS = """
micro- = 1e-6 = µ- = u-
milli- = 1e-3 = m-
centi- = 1e-2 = c-
kilo- = 1e3 = k-
mega- = 1e6 = M-
giga- = 1e9 = G-
metre = [length] = m = meter
second = [time] = s
gram = 1e-3 * kilogram = g
kilogram = [mass] = kg
radian = [angle] = rad
minute = 60 * second = min
hour = 3600 * second = h
tonne = 1000 * kilogram = t
inch = 0.0254 * metre = inch
newton = kilogram * metre / second ** 2 = N
pascal = newton / metre ** 2 = Pa
joule = newton * metre = J
watt = joule / second = W
hertz = 1 / second = Hz
revolution = 6.283185307179586 * radian = rev = turn
rpm = revolution / minute = rpm
degree = 0.017453292519943295 * radian = deg = °
percent = 0.01 = %
"""
EXAMPLES = {
    "m": "16 mm", "rad": "20 deg", "rad/s": "15 rpm", "kg": "840 kg", "kg*m^2": "120 kg*m^2", "s": "2 s",
    "N/m": "5.02e9 N/m", "N*m/rad": "1.8e8 N*m/rad", "N*s/m": "2e5 N*s/m", "N*m*s/rad": "50 N*m*s/rad",
    "N*m": "1.06e4 N*m", "N": "10 kN", "kg/m^3": "7850 kg/m^3", "m/s^2": "9.81 m/s^2", "m/s": "10 mm/s",
    "1/s": "8192 Hz",
}  # fmt: skip


@cache
def registry() -> "pint.UnitRegistry[Fraction]":
    """Return the unit registry, made on first use; it uses fractions, so that no power of a unit is rounded."""
    import pint

    units: pint.UnitRegistry[Fraction] = pint.UnitRegistry(None, non_int_type=Fraction)
    for line in DEFINITIONS.strip().splitlines():
        units.define(line)
    return units


def parse(text: object, unit: str) -> float:
    """Convert a quantity given as text to a float in ``unit``.

    Parameters
    ----------
    text
        Number and unit, such as ``"16 mm"``.
    unit
        The SI unit wanted, such as ``"m"``.

    Raises
    ------
    ValueError
        If the text is not a finite number with a unit of the right dimension.
    """
    example = f'write it like "{EXAMPLES.get(unit, "1 " + unit)}"'
    shown = f"{text!r:.60}"
    if isinstance(text, list | tuple | dict | bool):
        raise ValueError(f"must be text with a number and a unit, not {shown}; {example}")
    if not isinstance(text, str):
        raise ValueError(f"{shown} has no unit; {example}")
    match = NUMBER.fullmatch(text) if len(text) <= 80 else None
    if match is None:
        raise ValueError(f"{shown} is not a number with a unit; {example}")
    number, name = match.groups()
    if not name:
        raise ValueError(f"{shown} has no unit; {example}")
    try:
        value = float(number) * _factor(name, unit)
    except ValueError as error:
        raise ValueError(f"{shown} {error}; {example}") from error
    if value != 0.0 and not SMALLEST <= abs(value) <= LARGEST:
        raise ValueError(f"{shown} is out of all bounds ({SMALLEST:g} to {LARGEST:g} {unit}); {example}")
    return value


@cache
def _factor(name: str, unit: str) -> float:
    """Return the factor from the unit ``name`` to ``unit``."""
    import pint

    spelt = name.replace("μ", "µ")  # the Greek letter stands for the micro sign
    if UNIT.fullmatch(spelt) is None:
        raise ValueError(f"does not end in a unit, {name!r}")
    units = registry()
    try:
        given = units.parse_units(spelt.replace("·", "*").replace("^", "**"))
    except pint.UndefinedUnitError as error:
        raise ValueError(f"does not end in a known unit, {name!r}") from error
    wanted = units.parse_units(unit.replace("^", "**"))
    if given.dimensionality != wanted.dimensionality:
        raise ValueError(f"has the wrong dimension, a quantity in {unit} is due")
    return float(units.Quantity(Fraction(1), given).to(wanted).magnitude)


def dimension(unit: str) -> dict[str, float]:
    """Return the powers of length, mass and time in a unit; angle counts as a number."""
    if not unit:
        return {}
    powers = registry().parse_units(unit.replace("^", "**")).dimensionality
    return {key.strip("[]"): float(cast(float, power)) for key, power in powers.items() if key != "[angle]"}
