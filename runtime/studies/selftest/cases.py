"""All hard cases, in the order in which they are shown."""

from . import contact_cases, friction_cases, jump_cases, limit_cases, symmetry_cases, time_cases
from .case import HardCase

CASES: tuple[HardCase, ...] = (
    *jump_cases.CASES,
    *time_cases.CASES,
    *contact_cases.CASES,
    *friction_cases.CASES,
    *limit_cases.CASES,
    *symmetry_cases.CASES,
)
