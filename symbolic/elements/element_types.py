"""Element types by key: laws written for their options, dead axes set to zero."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules

import sympy as sp

from .base import TYPES, Element
from .key import ElementKey

for _module in iter_modules([str(Path(__file__).parent)]):  # each enters its element types into TYPES
    if _module.name != __name__.rpartition(".")[2]:
        import_module(f".{_module.name}", __package__)


@cache
def make(key: ElementKey) -> Element:
    """Write the element of a key."""
    written = TYPES[key.type](**dict(key.options))
    return keep_axes(written, key.live) if key.live else written


def keep_axes(element: Element, live: Sequence[Sequence[str]]) -> Element:
    """Set the coordinates of dead axes to zero in an element, and omit loads along them.

    Parameters
    ----------
    element
        The element with all axes that its law uses.
    live
        Names of the axes to keep, for each port.
    """
    kept = {
        port: replace(port, axes=tuple(axis for axis in port.axes if axis.name in names))
        for port, names in zip(element.ports, live, strict=True)
    }
    dead = {
        symbol: sp.S.Zero
        for port, axis in element.freedoms
        if axis not in kept[port].axes
        for symbol in (port.coordinate(axis), port.rate(axis))
    }

    def still(expression: sp.Expr) -> sp.Expr:
        return sp.sympify(expression).xreplace(dead)

    outputs = {name: replace(output, expression=still(output.expression)) for name, output in element.outputs.items()}
    wrench = {(kept[port], axis): still(load) for (port, axis), load in element.wrench.items()}
    return replace(
        element,
        ports=tuple(kept.values()),
        potential=still(element.potential),
        dissipation=still(element.dissipation),
        wrench={at: load for at, load in wrench.items() if at[1] in at[0].axes},
        outputs=outputs,
    )
