"""All hard cases, in the order in which they are shown."""

from . import contact, friction, jumps, limits, symmetry, times
from .case import HardCase

CASES: tuple[HardCase, ...] = (
    *jumps.CASES,
    *times.CASES,
    *contact.CASES,
    *friction.CASES,
    *limits.CASES,
    *symmetry.CASES,
)
