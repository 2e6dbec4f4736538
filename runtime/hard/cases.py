"""All hard cases, in the order in which they are shown."""

from . import jumps, times
from .case import HardCase

CASES: tuple[HardCase, ...] = (
    *jumps.CASES,
    *times.CASES,
)
