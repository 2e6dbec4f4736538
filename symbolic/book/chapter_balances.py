"""Chapter on the equations of motion: the law of a body, the loads on each, and small scenes written out."""

import sympy as sp

from ..elements.base import real
from ..mechanics.frames import FrameMotion
from ..mechanics.model import Body, Model
from .chapter_laws import name_places
from .content import Chapter, Maths, Part
from .model_equations import Assignment, PrintedEquations, assemble, list_terms
from .notation import break_sum, fill_lines, put_signs, typeset, write_name

SMALL = 6
"""Largest number of degrees of freedom for which equations are written out."""


def write_balances(chapter: Chapter, model: Model) -> None:
    """Write the chapter on the equations of motion."""
    _body_law(chapter, model)
    _sums(chapter, model)
    _joints(chapter, model)
    if model.freedoms <= SMALL:
        _written_out(chapter, assemble(model), model)


def _body_law(chapter: Chapter, model: Model) -> None:
    """Write the law of a body in its frame."""
    chapter.head("A body in its frame", "body-law")
    if model.has_turning_frame:
        chapter.say(
            "Newton's and Euler's laws in a frame that turns with ", Maths(r"\rho_{C}\,\dot{\varphi}"),
            ": force, Coriolis, centrifugal and Euler acceleration. The kinetic energy gives the same, "
            "which one of the checks proves.",
        )  # fmt: skip
    else:
        chapter.say("Newton's and Euler's laws; no frame turns in this scene.")
    for axis, value in zip(("x", "y", "u"), FrameMotion.symbols().newton(), strict=True):
        chapter.equate(break_sum(rf"\ddot{{{axis}}}", name_places(value, model)))
    lead = next((body.name for body in model.bodies if body.turning == "reference"), None)
    if lead is not None:
        chapter.equate(break_sum(r"\ddot{\varphi}", real("T") / real("I")), f"torque and inertia are those of {lead}")
    elif any(signal.name == "reference.acceleration" for signal in model.signals):
        chapter.say(Maths(r"\ddot{\varphi}"), " is the slope of the table of the held speed.")
    elif model.reference != "rest":
        chapter.say("The reference speed is held, so ", Maths(r"\ddot{\varphi} = 0"), ".")
    for body in model.bodies:
        if body.turning == "driven":
            value = real("I") * real("rho") * real("phi_dd") - real("T")
            chapter.equate(break_sum(r"T_{\text{drive}}", value), f"torque that holds the speed of {body.name}")


def _sums(chapter: Chapter, model: Model) -> None:
    """Write the loads on every body."""
    chapter.head("What acts on each body", "sums")
    chapter.say(
        Maths(r"\mathbf{W}_{j}^{(n)}"), " is the wrench, force and torque, of element n on its body j; the law of the "
        "element tells it. The sum is the force and torque in the law of the body above. Bodies without a coordinate "
        "are held: their sum is what the housing or the drive takes.",
    )  # fmt: skip
    for name, terms in list_terms(model).items():
        pieces = put_signs([rf"\mathbf{{W}}_{{{port}}}^{{({number})}}" for number, port in terms])
        body = next(body for body in model.bodies if body.name == name)
        left = write_name(f"W@{name}")
        chapter.equate(fill_lines([f"{left} =", *pieces]), *_described(body))


def _described(body: Body) -> tuple[Part, ...]:
    """Describe a body's frame and inertia parameters."""
    moves = list(body.freedoms)
    words = f"{body.name} moves in {', '.join(moves)}" if moves else f"{body.name}: {_held(body)}"
    numbers = [name for name in (body.mass, body.inertia) if name is not None]
    return (words + (f"; {' and '.join(numbers)}" if numbers else ""),)


def _held(body: Body) -> str:
    """Say why a body has no coordinate of its own."""
    return {
        "held": "it is fixed", "driven": "its speed is held", "reference": "its angle is the reference",
        "led": f"it turns with {body.leader}", "point": f"it is a point of {body.leader}",
    }.get(body.turning, "it has no coordinate of its own")  # fmt: skip


def _joints(chapter: Chapter, model: Model) -> None:
    """Write the transfer of forces through rigid joints."""
    seated = [body for body in model.bodies if body.seat is not None]
    led = [body for body in model.bodies if body.leader is not None]
    if seated:
        fx, fy, ax, ay = map(real, ("F_x", "F_y", "a_x", "a_y"))
        chapter.head("Handed on by rigid joints", "joints")
        chapter.say("A body that sits on another hands its force on; the torque about the seat's centre is")
        chapter.equate(break_sum("T", ax * fy - ay * fx), "and the arm is that of the chapter on coordinates")
    if led:
        chapter.head("Shared angles", "leaders")
        chapter.say(
            "The torque on a body that shares the angle of another counts for that one, whose inertia is that of all."
        )
    chapter.tabulate(
        ("body", "sits on", "turns with"),
        [(body.name, body.seat or "", body.leader or "") for body in model.bodies if body.seat or body.leader],
    )
    if any(body.moment is not None for body in model.bodies):
        _offset(chapter)


def _offset(chapter: Chapter) -> None:
    """Write the laws of a body with an offset centre of mass."""
    fx, fy, sx, sy, m, inertia = map(real, ("F_x", "F_y", "s_x", "s_y", "m", "I"))
    turn, turn_d = real("Omega"), real("Omega_d")
    chapter.head("Centre of mass beside the centre", "offset")
    chapter.say("With mass times offset ", Maths(r"\mathbf{s}"), ", what stands in the law of a body becomes")
    chapter.equate(break_sum(r"F_{x}^{\text{all}}", fx + turn**2 * sx + turn_d * sy))
    chapter.equate(break_sum(r"F_{y}^{\text{all}}", fy + turn**2 * sy - turn_d * sx))
    chapter.equate(break_sum(r"T^{\text{all}}", real("T") + (sy * fx - sx * fy) / m))
    chapter.equate(break_sum(r"I^{\text{all}}", inertia - (sx**2 + sy**2) / m))


# --- written out


def _written_out(chapter: Chapter, assembly: PrintedEquations, model: Model) -> None:
    """Write a small scene as scalar equations, in the order in which they are computed."""
    chapter.head("Written out", "written-out")
    chapter.say(
        "All equations of the scene, from states and numbers to accelerations, in the order in which they can be "
        "computed. A number in brackets is that of the element; other letters are those of its law."
    )
    needed = _needed(assembly)
    for item in assembly.assignments:
        if item in needed:
            chapter.equate(break_sum(typeset(item.symbol), item.value), _owner(item, model))
    for state, rate in assembly.rates.items():
        if state.endswith(".rate"):
            body, axis = state.removesuffix(".rate").rsplit(".", 1)
            chapter.equate(break_sum(typeset(real(f"{axis}_dd@{body}")), rate), f"motion of {body}")


def _needed(assembly: PrintedEquations) -> list[Assignment]:
    """Return the named quantities that the rates depend on."""
    wanted: set[sp.Basic] = set().union(*(rate.free_symbols for rate in assembly.rates.values()))
    kept = []
    for item in reversed(assembly.assignments):
        if item.symbol in wanted:
            kept.append(item)
            wanted |= item.value.free_symbols
    return kept


def _owner(item: Assignment, model: Model) -> str:
    """Return the owner of a quantity, in words."""
    return f"element {item.owner}, {model.instances[int(item.owner) - 1].name}" if item.owner.isdigit() else item.owner
