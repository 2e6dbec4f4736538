"""Result of a check, and names of element types for users."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ..elements.base import Element
from ..elements.element_types import make
from ..elements.key import ElementKey
from ..mechanics.model import Instance, Model

Writer = Callable[[ElementKey], Element]


@dataclass(frozen=True)
class Check:
    """The outcome of one check.

    Attributes
    ----------
    name
        Subject of the check, in a drivetrain engineer's words.
    passed
        Whether ``value`` is within ``tolerance``.
    value, tolerance
        Measured and allowed number of faults or relative error.
    note
        Method of the check.
    """

    name: str
    passed: bool
    value: float
    tolerance: float
    note: str


def judged(name: str, value: float, tolerance: float, note: str) -> Check:
    """Make a check that passes if the value is within the tolerance (never if it is NaN)."""
    return Check(name, bool(value <= tolerance), float(value), float(tolerance), note)


WORDS: dict[str, Callable[[Any], str]] = {
    "law": lambda law: f"{law} law",
    "switched": lambda switched: "two-level stiffness" if switched else "one stiffness",
    "contact": str,
    "error": lambda error: "errors" * error,
    "followed": lambda followed: "torque of the stiffness" * followed,
    "damped": lambda damped: "damped" if damped else "undamped",
}
"""Option of an element type -> its words after the title; other options precede it."""


def title(key: ElementKey) -> str:
    """Return the plain name of an element type, options included."""
    options = dict(key.options)
    before = [str(value) for option, value in key.options if option not in WORDS]
    behind = [word for option, say in WORDS.items() if option in options and (word := say(options[option]))]
    return " ".join([*before, make(key).title]) + (f" ({', '.join(behind)})" if behind else "")


def element_types(model: Model) -> dict[ElementKey, Instance]:
    """Return the element types of a model, each with its first instance, in the model's order."""
    found: dict[ElementKey, Instance] = {}
    for instance in model.instances:
        found.setdefault(instance.element, instance)
    return found
