"""Chapters on energies and laws: kinetic energy, and each element type that the scene uses, once."""

from collections.abc import Iterable

import sympy as sp

from ..elements.axes import Axis
from ..elements.base import real
from ..mechanics.frames import FrameMotion
from ..mechanics.lagrange import kinetic_energy
from ..mechanics.model import Model
from .content import Chapter, Maths, Text
from .laws import Law, write_law
from .notation import break_sum, typeset

FRAME, GROUND = "the turning frame", "the ground, resolved in the frame"
SIDES = {"frame": FRAME, "absolute": GROUND, "deviation": FRAME}


def write_laws(chapter: Chapter, model: Model) -> None:
    """Write the chapter on energies and force laws."""
    chapter.head("Kinetic energy of a body", "kinetic")
    frame: Text = ("in a frame that turns with ", Maths(r"\rho_{C}\,\dot{\varphi}"), "; X, Y: place in it")
    chapter.equate(break_sum("T", name_places(kinetic_energy(), model)), *(frame if model.has_turning_frame else ()))
    chapter.head("From energies to forces", "lagrange")
    chapter.equate(
        (r"\frac{d}{dt}\frac{\partial T}{\partial\dot{q}} - \frac{\partial T}{\partial q} ="
         r" - \frac{\partial V}{\partial q} - \frac{\partial D}{\partial\dot{q}}",),
        "Lagrange's equations; the wrenches below are written by hand, for Newton's, and proved to be the same",
    )  # fmt: skip
    for key in dict.fromkeys(instance.element for instance in model.instances):
        _write_law(chapter, write_law(key), model)


def name_places(expression: sp.Expr, model: Model) -> sp.Expr:
    """Write a body's position in its frame as X and Y, and omit rotations that the model does not have."""
    f = FrameMotion.symbols()
    known = {f.x: real("X"), f.y: real("Y")} | ({} if model.has_turning_frame else {f.frame_ratio: sp.S.Zero})
    still = dict.fromkeys((f.phi_d, f.phi_dd), sp.S.Zero) if model.reference == "rest" else {}
    return expression.xreplace(known | still)


def law_anchor(law: Law) -> str:
    """Return where a law is found."""
    return "law-" + law.key.name.replace("_", "-")


def _write_law(chapter: Chapter, law: Law, model: Model) -> None:
    """Write one element type."""
    chapter.head(law.title[0].upper() + law.title[1:], law_anchor(law))
    count = sum(instance.element == law.key for instance in model.instances)
    joins = "one body and the housing" if len(law.element.ports) == 1 else f"{len(law.element.ports)} bodies"
    chapter.say(
        f"Joins {joins}; {count} in this scene. Rates are those against {SIDES[law.element.rates]}. "
        f"Source: {law.element.source}."
        + (" It acts from outside: its power is given to the train." if law.element.load else "")
        + ("" if law.element.gradient else " Its force is no gradient of an energy, by design of the paper.")
    )
    for step in law.steps:
        lines = break_sum(typeset(step.symbol, law.letters), step.value, law.letters)
        chapter.equate(lines, law.letters[step.symbol.name][1])
    if law.potential != 0:
        chapter.equate(break_sum("V", law.potential, law.letters), "potential")
    if law.dissipation != 0:
        chapter.equate(break_sum("D", law.dissipation, law.letters), "dissipation function")
    _write_wrench(chapter, law)
    reports = [
        (name.replace("_", " "), Maths(typeset(law.outputs[name], law.letters)), write_unit(output.unit))
        for name, output in law.element.outputs.items()
    ]
    chapter.tabulate(("quantity", "formula", "unit"), reports, "What it reports")
    chapter.tabulate(("letter", "meaning", "unit"), list(_letters(law)), "Letters")


def _write_wrench(chapter: Chapter, law: Law) -> None:
    """Write force and torque on each port, and the derivatives of the energies if short."""
    parts = [
        (_component(law.element.ports.index(port) + 1, axis), hand, energy)
        for (port, axis), hand, energy in zip(law.element.freedoms, law.wrench, law.gradient, strict=True)
        if hand != 0
    ]
    if all(energy is None or energy == hand for _, hand, energy in parts):
        for (port, tex), hand, _ in parts:
            chapter.equate(break_sum(tex, hand, law.letters), f"on body {port}")
        return
    rows = [
        (
            f"body {port}", Maths(tex), Maths(typeset(hand, law.letters)),
            Maths(typeset(energy, law.letters)) if energy is not None else "long",
        )
        for (port, tex), hand, energy in parts
    ]  # fmt: skip
    chapter.tabulate(("on", "", "written by hand", "from the energies"), rows, "Force and torque")


def _component(port: int, axis: Axis) -> tuple[int, str]:
    """Return port and letter of a component of a wrench."""
    return port, f"T_{{{port}}}" if axis.rotation else f"F_{{{axis.name}{port}}}"


def write_unit(unit: str) -> str:
    """Return a unit as printed."""
    return unit.replace("*", " ").replace("^2", "²").replace("^3", "³") or "1"


def _letters(law: Law) -> Iterable[tuple[Maths, str, str]]:
    """List the letters of a law with meaning and unit."""
    units = dict(law.element.parameters)
    for port, axis in law.element.freedoms:
        units |= {port.coordinate(axis): axis.unit, port.rate(axis): axis.rate_unit}
    named = {step.symbol for step in law.steps}
    for symbol in law.symbols:
        if symbol not in named:
            yield Maths(typeset(symbol, law.letters)), law.letters[symbol.name][1], write_unit(units[symbol])
