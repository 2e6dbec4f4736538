"""Result of a check, and names of element types as users see them."""

from collections.abc import Callable
from dataclasses import dataclass

from ..elements import Element
from ..mechanics.model import Instance, Model

Key = tuple[str | bool, ...]
Writer = Callable[[Key], Element]


@dataclass(frozen=True)
class Check:
    """The outcome of one check.

    Attributes
    ----------
    name
        What was checked, in a drivetrain engineer's words.
    passed
        Whether ``value`` keeps to ``tolerance``.
    value, tolerance
        What was found and what is allowed; a number of faults or a relative error.
    note
        How it was checked.
    """

    name: str
    passed: bool
    value: float
    tolerance: float
    note: str


def judged(name: str, value: float, tolerance: float, note: str) -> Check:
    """Make a check that passes where the value is within the tolerance (never where it is not a number)."""
    return Check(name, bool(value <= tolerance), float(value), float(tolerance), note)


TITLES = {
    "mesh_friction": "mesh friction",
    "mesh_sliding": "mesh sliding friction",
    "pin": "planet bearing",
    "pin_friction": "planet bearing friction",
    "ground_bearing": "housing bearing",
    "pin_clearance": "planet bearing with clearance",
    "pin_clearance_friction": "friction of the planet bearing with clearance",
    "ground_clearance": "housing bearing with clearance",
    "coupling": "shaft coupling",
    "torsional_support": "torsional support",
    "drag": "rotor drag",
    "external_torque": "load torque",
    "slip_torque": "slip law",
    "gravity": "weight",
    "rayleigh": "Rayleigh damping by mass",
}


def title(key: Key) -> str:
    """Return the plain name of an element type, options included."""
    name = TITLES.get(str(key[0]), str(key[0]))
    words = [str(option) for option in key[1:] if isinstance(option, str)]
    flags = [option for option in key[1:] if isinstance(option, bool)]
    extra = []
    if key[0] in ("mesh", "mesh_friction", "mesh_sliding"):
        extra = [f"{words.pop(1)} law", "two-level stiffness" if flags.pop(0) else "one stiffness", *words[1:]]
        words = words[:1]
    if key[0] == "mesh":
        flags, told = flags[:1], zip(flags[1:], ("errors", "torque of the stiffness"), strict=False)
        extra += [word for flag, word in told if flag]
    if key[0] in ("mesh_friction", "mesh_sliding"):
        extra, flags = [*extra, *("errors" for flag in flags if flag)], []
    extra += ["damped" if flag else "undamped" for flag in flags]
    return " ".join([*words, name]) + (f" ({', '.join(extra)})" if extra else "")


def element_types(model: Model) -> dict[Key, Instance]:
    """Return the element types of a model, each with its first instance, in the model's order."""
    found: dict[Key, Instance] = {}
    for instance in model.instances:
        found.setdefault(instance.element, instance)
    return found
