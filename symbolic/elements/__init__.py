"""Element types, one file each; ``make`` turns the name in a model into the written element."""

from collections.abc import Callable
from functools import cache

from .base import Element, Output, Port
from .bearing import ground_bearing, pin, pin_friction
from .clearance import ground_clearance, pin_clearance, pin_clearance_friction
from .gravity import gravity
from .mesh import mesh
from .mesh_friction import mesh_friction
from .mesh_sliding import mesh_sliding
from .rayleigh import rayleigh
from .torsion import coupling, drag, external_torque, slip_torque, torsional_support

TYPES: dict[str, Callable[..., Element]] = {
    "mesh": mesh,
    "mesh_friction": mesh_friction,
    "mesh_sliding": mesh_sliding,
    "pin": pin,
    "pin_friction": pin_friction,
    "ground_bearing": ground_bearing,
    "pin_clearance": pin_clearance,
    "pin_clearance_friction": pin_clearance_friction,
    "ground_clearance": ground_clearance,
    "coupling": coupling,
    "torsional_support": torsional_support,
    "drag": drag,
    "external_torque": external_torque,
    "slip_torque": slip_torque,
    "rayleigh": rayleigh,
    "gravity": gravity,
}


@cache
def make(element: tuple[str | bool, ...]) -> Element:
    """Write the element that ``Instance.element`` names: type, then its options."""
    return TYPES[str(element[0])](*element[1:])


__all__ = ["TYPES", "Element", "Output", "Port", "make"]
